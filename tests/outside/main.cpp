/// A program that knows the library by its public header alone: a grasped block is led down on a plate and
/// pressed. Prints the hash of all frames. check.py builds it outside the tree and compares.

#include <tactum/tactum.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

static_assert(TACTUM_VERSION >= 100);

namespace {

using namespace tactum;

/// The value, or the end of the program with the error.
template <class T>
T or_exit(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message().c_str());
  std::exit(1);
}

std::shared_ptr<const Part> box(const Vec3& half_m) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? half_m.x() : -half_m.x(), i & 2 ? half_m.y() : -half_m.y(),
                         i & 4 ? half_m.z() : -half_m.z());
  return std::make_shared<const Part>(or_exit(part_from_clouds({corners}, {.about_center_of_mass = true})));
}

/// The block grasped a little above the plate, whose top is at z = 0.
std::unique_ptr<Simulation> block_over_plate() {
  World world;
  FrameSettings settings;
  settings.tool.body = or_exit(world.add({.name = "block",
                                          .part = box({0.010, 0.007, 0.005}),
                                          .mass_kg = 0.05,
                                          .X_WP = {Mat3::Identity(), {0.0, 0.0, 0.008}}}));
  or_exit(world.add({.name = "plate",
                     .part = box({0.05, 0.05, 0.01}),
                     .X_WP = {Mat3::Identity(), {0.0, 0.0, -0.01}},
                     .joint = {.kind = JointKind::kFixed}}));
  return or_exit(Simulation::make(std::move(world), settings));
}

}  // namespace

int main() {
  const std::unique_ptr<Simulation> simulation = block_over_plate();
  RunRecord record;
  for (int frame = 0; frame < 500; ++frame) {
    const Vec3 led = Vec3(0.5, -0.2, -1.0) * 1e-5 * frame;  // 5 mm down in half a second
    simulation->step({Mat3::Identity(), led});
    record.add(simulation->report(), simulation->bodies());
  }
  if (record.grasped_contact_frames == 0) {
    std::fprintf(stderr, "the block never touched the plate\n");
    return 1;
  }
  std::printf("%016" PRIx64 "\n", record.hash());
}
