/// A world made in code and stepped by hand: a wooden block, held, is led down on a steel plate.

#include <tactum/tactum.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

std::shared_ptr<const tactum::Part> box(const tactum::Vec3& half_m) {
  auto part = tactum::part_from_clouds({tactum::make_box(half_m).vertices}, {.about_center_of_mass = true});
  return part ? std::make_shared<const tactum::Part>(std::move(*part)) : nullptr;
}

}  // namespace

int main() {
  using namespace tactum;
  World world;
  const Result<int> block = world.add({.name = "block",
                                       .part = box({0.010, 0.007, 0.005}),
                                       .density_kg_per_m3 = 700.0,
                                       .X_WP = {Mat3::Identity(), {0, 0, 0.008}},
                                       .material = "wood"});
  const Result<int> plate = world.add({.name = "plate",
                                       .part = box({0.05, 0.05, 0.01}),
                                       .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                                       .joint = {.kind = JointKind::kFixed},
                                       .material = "steel"});
  if (!block || !plate) return 1;

  DeviceInfo device;  // what the hand holds: it bounds stiffness and force
  device.actuates_force = device.actuates_torque = device.senses_rotation = true;
  device.max_force_N = 8.0;
  device.max_torque_Nm = 0.5;
  device.max_stiffness_N_per_m = 2000.0;
  device.max_stiffness_Nm_per_rad = 5.0;
  FrameSettings settings = settings_for(device, 1000.0);
  settings.tool.body = *block;
  if (!set_coefficient(world, {"wood", "steel", 0.3}, settings.friction)) return 1;
  const auto simulation = Simulation::make(std::move(world), settings);
  if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().message().c_str()), 1;

  Wrench wrench;
  for (int frame = 0; frame < 2000; ++frame)  // 8 mm down in a second; the plate is met after 3 mm
    wrench = (*simulation)->step(Pose{Mat3::Identity(), {0, 0, -0.008 * std::min(1.0, frame * 1e-3)}});
  const Pose& X_WB = (*simulation)->bodies().X_WB[0];
  std::printf("force %.2f N, block at %.6f m\n", wrench.f.z(), X_WB.p.z());
  return wrench.f.z() > 0.1 && std::abs(X_WB.p.z() - 0.005) < 1e-4 ? 0 : 1;
}
