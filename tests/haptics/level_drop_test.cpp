// A box that falls level on several fixed bodies leaves them as it leaves one floor: level, and as fast as
// restitution says.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"

namespace tactum::level_drop_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Drop {
  std::vector<Vec3> rails = {{-0.4, 0, 0}, {0.4, 0, 0}};  // their middles, by the box's size
  double size_m = 0.1;
  double rate_Hz = 1000.0;
  double restitution = 1.0;
  bool box_first = false;
};

/// Drops the box by twice its size, and compares its next apex with what restitution says.
void expect_level_bounce(const Drop& drop) {
  World world;
  world.gravity_W = {0, 0, -kGravity};
  const double height_m = 2.0 * drop.size_m;
  int number = -1;
  const auto add_box = [&] {
    number = add_body(world, {.part = solid_box(0.5 * drop.size_m * Vec3(1, 1, 0.5)),
                              .mass_kg = 0.3,
                              .X_WP = {Mat3::Identity(), {0, 0, 0.25 * drop.size_m + height_m}}});
  };
  if (drop.box_first) add_box();
  for (const Vec3& at : drop.rails)
    add_body(world, {.part = solid_box(drop.size_m * Vec3(0.05, 0.05, 0.1)),
                     .X_WP = {Mat3::Identity(), drop.size_m * (at - Vec3(0, 0, 0.1))},
                     .joint = {.kind = JointKind::kFixed}});
  if (!drop.box_first) add_box();
  FrameSettings settings;
  settings.dt_s = 1.0 / drop.rate_Hz;
  const int bodies = static_cast<int>(world.bodies.size());
  settings.impacts.restitution = {
      std::vector<double>(static_cast<std::size_t>(bodies * bodies), drop.restitution), bodies};
  const auto simulation = std::move(*Simulation::make(world, settings));
  const Pose& X_WB = simulation->state().world.X_WB[static_cast<std::size_t>(number)];
  const Twist& V_WB = simulation->state().world.V_WB[static_cast<std::size_t>(number)];
  const double down_s = std::sqrt(2.0 * height_m / kGravity);
  const double apex_s = down_s * (1.0 + drop.restitution);
  for (double t = 0.0; t < apex_s; t += settings.dt_s) simulation->step(Pose{});
  const double apex_m = X_WB.p.z() - 0.25 * drop.size_m;
  // An impact is met within a frame, up to the fall in one above the rails.
  const double early_m = kGravity * down_s * settings.dt_s;
  EXPECT_NEAR(apex_m, drop.restitution * drop.restitution * height_m, 1e-3 * height_m + early_m);
  EXPECT_LT(X_WB.p.head<2>().norm(), 1e-9 * drop.size_m);
  EXPECT_LT(log_rotation(X_WB.R).norm(), 1e-9);
  EXPECT_LT(V_WB.w.norm(), 1e-6);
}

TEST(LevelDrop, LeavesRailsAndPegsAsAFloor) {
  const std::vector<Vec3> three = {{-0.4, -0.4, 0}, {0.4, -0.4, 0}, {0, 0.4, 0}};
  const std::vector<Vec3> four = {{-0.4, -0.4, 0}, {0.4, -0.4, 0}, {-0.4, 0.4, 0}, {0.4, 0.4, 0}};
  for (const Drop& drop :
       {Drop{}, Drop{.rails = three}, Drop{.rails = four}, Drop{.box_first = true},
        Drop{.rails = four, .size_m = 0.005}, Drop{.rails = three, .size_m = 2.0},
        Drop{.rails = four, .rate_Hz = 4000.0}, Drop{.rate_Hz = 500.0},
        Drop{.rails = three, .restitution = 0.5}, Drop{.rails = four, .restitution = 0.8}}) {
    SCOPED_TRACE(::testing::Message()
                 << drop.rails.size() << " rails, " << drop.size_m << " m, " << drop.rate_Hz << " Hz, e "
                 << drop.restitution << ", box first " << drop.box_first);
    expect_level_bounce(drop);
  }
}

}  // namespace
}  // namespace tactum::level_drop_test
