#include <algorithm>

#include "bench/mechanics_scene.h"
#include "tactum/haptics/simulation.h"

namespace tactum::bench {
namespace {

constexpr double kCoupling_N_per_m = 600.0, kHand_m = 0.01;

/// Leads the handle of body 0 to `offset_m` in a second, and holds it there for another one.
std::unique_ptr<Simulation> led(const MechanicsScene& scene, ResponseModel response, const Vec3& offset_m) {
  FrameSettings settings;
  settings.dt_s = kMechanicsStep_s;
  settings.response = response;
  settings.tool.body = 0;
  settings.coupling.stiffness_N_per_m = kCoupling_N_per_m;
  auto simulation = std::move(*Simulation::make(scene.motion.world, settings));
  const double frames = 1.0 / kMechanicsStep_s;
  for (int i = 0; i < 2 * frames; ++i)
    simulation->step(Pose{Mat3::Identity(), std::min(1.0, i / frames) * offset_m});
  return simulation;
}

/// A block that the hand presses on a floor. No weight acts.
MechanicsCase press() {
  const auto seen = [](ResponseModel response) {
    MechanicsScene scene;
    scene.add_box(Vec3::Constant(0.01), {Mat3::Identity(), {0, 0, 0.01}});
    scene.add_fixed_box({0.1, 0.1, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    return led(scene, response, {0, 0, -kHand_m})->report().coupling.f.z();
  };
  return {.name = "grasped block pressed on a floor, the hand 10 mm below it, force",
          .law = "k d",
          .unit = "N",
          .right = kCoupling_N_per_m * kHand_m,
          .bounds = {.constraint = 1e-4},
          .grasped = seen};
}

/// A grasped slider with a spring: the coupling and the spring are in series.
MechanicsCase spring(bool force) {
  constexpr double kSpring_N_per_m = 300.0;
  const auto seen = [=](ResponseModel response) {
    MechanicsScene scene;
    scene.add_box(Vec3::Constant(0.01), {}, {},
                  {.kind = JointKind::kSlider, .axis_W = Vec3::UnitZ(), .stiffness = kSpring_N_per_m});
    const auto simulation = led(scene, response, {0, 0, -kHand_m});
    return force ? simulation->report().coupling.f.z() : simulation->bodies().X_WB[0].p.z();
  };
  const double place = -kHand_m * kCoupling_N_per_m / (kCoupling_N_per_m + kSpring_N_per_m);
  return {.name = force ? "grasped slider with a spring, the hand at -10 mm, force" : "... position",
          .law = force ? "k_s k d / (k + k_s)" : "- k d / (k + k_s)",
          .unit = force ? "N" : "m",
          .right = force ? -kSpring_N_per_m * place : place,
          .bounds = {.constraint = 1e-6, .penalty = 1e-6},
          .grasped = seen};
}

}  // namespace

std::vector<MechanicsCase> grasped_cases() { return {press(), spring(true), spring(false)}; }

}  // namespace tactum::bench
