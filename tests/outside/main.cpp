/// A program that knows the library by its public header alone: a held block is led down on a plate and
/// pressed. Prints the hash of all frames. check.py builds it outside the tree and compares.

#include <tactum/tactum.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

static_assert(TACTUM_VERSION >= 100);

namespace {

using namespace tactum;

std::shared_ptr<const Part> box(const Vec3& half_m) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? half_m.x() : -half_m.x(), i & 2 ? half_m.y() : -half_m.y(),
                         i & 4 ? half_m.z() : -half_m.z());
  Result<Part> part = part_from_clouds({corners});
  if (!part) {
    std::fprintf(stderr, "%s\n", part.error().message().c_str());
    std::exit(1);
  }
  return std::make_shared<const Part>(std::move(*part));
}

World block_over_plate() {
  World world;
  world.bodies.resize(2);
  world.bodies[0].part = box({0.010, 0.007, 0.005});
  world.bodies[0].mass_kg = 0.05;
  world.bodies[0].inertia_B = Vec3(1.2e-6, 2.1e-6, 2.5e-6) /* kg m^2 */.asDiagonal();
  world.bodies[0].X_WB.p.z() = 0.008;
  world.bodies[1].part = box({0.05, 0.05, 0.01});
  world.bodies[1].X_WB.p.z() = -0.01;
  world.bodies[1].joint.kind = JointKind::kFixed;
  return world;
}

}  // namespace

int main() {
  const World world = block_over_plate();
  FrameSettings settings;
  settings.tool.body = 0;
  FrameState state(world, settings);
  FrameReport report;
  RunRecord record;
  for (int frame = 0; frame < 500; ++frame) {
    FrameTick tick;
    tick.index = static_cast<std::uint64_t>(frame);
    tick.now_s = frame * settings.dt_s;
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = tick.now_s;
    sample.X_DH.p = Vec3(0.5, -0.2, -1.0) * 1e-5 * frame;  // 5 mm down in half a second
    haptic_frame(world, settings, sample, tick, state, report);
    record.add(report, state.world);
  }
  if (record.grasped_contact_frames == 0) {
    std::fprintf(stderr, "the block never touched the plate\n");
    return 1;
  }
  std::printf("%016" PRIx64 "\n", record.hash());
}
