// A free box between two jaws that springs press together: friction holds it as far as mu allows, whichever
// corners carry the load, and the box falls as fast as the excess weight says beyond that.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"

namespace tactum::grip_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Grip {
  double size_m = 0.04;
  double rate_Hz = 1000.0;
  double mass_kg = 0.1;
  double used = 0.82;  // weight over the most that friction can hold
  double mu = 0.3;
  bool box_first = false;
};

struct Fall {
  double by_m = 0.0;          // in half a second
  double acceleration = 0.0;  // from the places at its start, middle and end [m/s^2]
};

/// The fall of the box between jaws on sliders, each of five times its mass.
Fall fall_of(const Grip& grip) {
  World world;
  world.gravity_W = {0, 0, -kGravity};
  const auto box = solid_box(0.5 * grip.size_m * Vec3(1, 1, 1));
  const auto jaw = solid_box(0.5 * grip.size_m * Vec3(0.5, 1, 1));
  const double press_N = grip.mass_kg * kGravity / (2.0 * grip.mu * grip.used);
  const double stretch_m = 0.5 * grip.size_m;
  int number = -1;
  const auto add_box = [&] { number = add_body(world, {.part = box, .mass_kg = grip.mass_kg}); };
  if (grip.box_first) add_box();
  for (const double side : {-1.0, 1.0}) {
    Joint joint{.kind = JointKind::kSlider, .axis_W = {-side, 0, 0}};
    joint.stiffness = press_N / stretch_m;
    joint.rest = stretch_m;
    joint.damping = 2.0 * std::sqrt(joint.stiffness * 5.0 * grip.mass_kg);
    add_body(world, {.part = jaw,
                     .mass_kg = 5.0 * grip.mass_kg,
                     .X_WP = {Mat3::Identity(), {side * 0.75 * grip.size_m, 0, 0}},
                     .joint = joint});
  }
  if (!grip.box_first) add_box();
  FrameSettings settings;
  settings.dt_s = 1.0 / grip.rate_Hz;
  settings.friction = {std::vector<double>(9, grip.mu), 3};
  const auto simulation = std::move(*Simulation::make(world, settings));
  const Vec3& p_WB = simulation->state().world.X_WB[static_cast<std::size_t>(number)].p;
  const int frames = static_cast<int>(0.25 * grip.rate_Hz);
  for (int i = 0; i < frames; ++i) simulation->step(Pose{});
  const double middle_m = -p_WB.z();
  for (int i = 0; i < frames; ++i) simulation->step(Pose{});
  EXPECT_LT(p_WB.head<2>().norm(), 1e-3 * grip.size_m);
  return {-p_WB.z(), (-p_WB.z() - 2.0 * middle_m) / (0.25 * 0.25)};
}

const Grip kGrips[] = {{},
                       {.box_first = true},
                       {.size_m = 0.004, .mass_kg = 0.001},
                       {.size_m = 0.4, .mass_kg = 20.0},
                       {.rate_Hz = 500.0},
                       {.rate_Hz = 4000.0},
                       {.mu = 0.8}};

TEST(GrippedBox, IsHeldBelowTheLimitOfFriction) {
  for (Grip grip : kGrips)
    for (const double used : {0.33, 0.82, 0.95}) {
      grip.used = used;
      SCOPED_TRACE(::testing::Message() << grip.size_m << " m, " << grip.rate_Hz << " Hz, mu " << grip.mu
                                        << ", used " << used << ", box first " << grip.box_first);
      EXPECT_LT(std::abs(fall_of(grip).by_m), 1e-3 * grip.size_m);
    }
}

TEST(GrippedBox, FallsByTheExcessOfItsWeight) {
  for (Grip grip : kGrips) {
    grip.used = 1.02;
    SCOPED_TRACE(::testing::Message() << grip.size_m << " m, " << grip.rate_Hz << " Hz, mu " << grip.mu
                                      << ", box first " << grip.box_first);
    const double expected = kGravity * (1.0 - 1.0 / grip.used);
    if (0.5 * expected * 0.25 < 0.8 * grip.size_m) {  // it is still between the jaws
      EXPECT_NEAR(fall_of(grip).acceleration, expected, 0.02 * expected);
    }
  }
}

}  // namespace
}  // namespace tactum::grip_test
