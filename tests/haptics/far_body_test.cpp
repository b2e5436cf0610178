/// A body elsewhere changes nothing: what the hand feels of a contact is to the bit what it feels without it.

#include <gtest/gtest.h>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::far_body_test {
namespace {

/// A block in the hand over a plate, and a body far away, of half `size` m, unless that is zero.
std::unique_ptr<Simulation> block_and_far_body(ResponseModel response, double rate_Hz, double size,
                                               JointKind joint) {
  World world;
  world.gravity_W = {0, 0, -9.81};
  add_body(
      world,
      {.part = solid_box({0.010, 0.007, 0.005}), .mass_kg = 0.05, .X_WP = {Mat3::Identity(), {0, 0, 0.008}}});
  add_body(world, {.part = solid_box({0.05, 0.05, 0.01}),
                   .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                   .joint = {.kind = JointKind::kFixed}});
  if (size > 0.0)
    add_body(world,
             {.part = solid_box({size, 0.1 * size, 0.02 * size}),
              .mass_kg = 3.0,
              .X_WP = {Mat3::Identity(), {20.0 + 3.0 * size, 0, 0}},
              .V_WB = {Vec3::Zero(), Vec3::Zero()},
              .joint = {.kind = joint, .axis_W = Vec3::UnitZ(), .anchor_W = {20.0 + 3.0 * size, 0, 0}}});
  FrameSettings settings;
  settings.dt_s = 1.0 / rate_Hz;
  settings.response = response;
  settings.tool.body = 0;
  const int bodies = static_cast<int>(world.bodies.size());
  std::vector<double> friction(std::size_t(bodies * bodies), 0.0);
  friction[1] = friction[std::size_t(bodies)] = 0.2;
  settings.friction = {friction, bodies};
  return std::move(*Simulation::make(std::move(world), settings));
}

Pose pressed(double time_s) {
  const double down = std::min(1.0, time_s / 0.1);
  return {exp_rotation({0.1 * time_s, 0.05 * time_s, 0.3 * time_s}),
          {0.02 * time_s, 0.01 * time_s, -0.006 * down}};
}

TEST(FarBody, ChangesNothing) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double rate_Hz : {500.0, 2000.0})
      for (const double size : {0.005, 5.0, 50.0})
        for (const JointKind joint : {JointKind::kFree, JointKind::kHinge, JointKind::kBall}) {
          SCOPED_TRACE(::testing::Message()
                       << int(response) << " " << rate_Hz << " Hz " << size << " m, joint " << int(joint));
          const auto alone = block_and_far_body(response, rate_Hz, 0.0, joint);
          const auto both = block_and_far_body(response, rate_Hz, size, joint);
          for (int i = 0; i < 0.15 * rate_Hz; ++i) {
            const Pose X = pressed(i / rate_Hz);
            alone->step(X);
            both->step(X);
            ASSERT_EQ(alone->report().coupling.f, both->report().coupling.f) << "frame " << i;
            ASSERT_EQ(alone->report().coupling.t, both->report().coupling.t) << "frame " << i;
            ASSERT_EQ(alone->bodies().X_WB[0].p, both->bodies().X_WB[0].p) << "frame " << i;
            ASSERT_EQ(alone->bodies().X_WB[0].R, both->bodies().X_WB[0].R) << "frame " << i;
          }
          EXPECT_GT(alone->report().coupling.f.z(), 0.5) << "the hand presses";
        }
}

}  // namespace
}  // namespace tactum::far_body_test
