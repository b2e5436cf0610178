/// A hand that turns on while the part it holds cannot: the torque grows with the turn between them, over
/// half a turn and full turns, and never points along the turn.

#include <gtest/gtest.h>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/rotation_between.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::full_turns_test {
namespace {

constexpr double kStop = 0.35;  // [rad]

struct Knob {
  std::unique_ptr<Simulation> simulation;
  Vec3 axis;

  Knob(ResponseModel response, double rate_Hz, const Vec3& axis_W, bool slot) : axis(axis_W.normalized()) {
    World world;
    Joint joint{.kind = JointKind::kHinge, .axis_W = axis, .anchor_W = Vec3::Zero()};
    joint.lower = -kStop;
    joint.upper = kStop;
    if (slot) joint.kind = JointKind::kFixed;  // of the walls below
    const Pose X{testing::rotation_between(Vec3::UnitZ(), axis), Vec3::Zero()};
    add_body(world, {.part = solid_box({0.06, 0.005, 0.005}),
                     .mass_kg = 0.1,
                     .X_WP = X,
                     .joint = slot ? Joint{} : joint});
    if (slot)
      for (const double side : {-1.0, 1.0})
        add_body(world, {.part = solid_box({0.1, 0.01, 0.02}),
                         .X_WP = {X.R, X.R * Vec3(0, side * 0.0151, 0)},
                         .joint = joint});
    FrameSettings settings;
    settings.dt_s = 1.0 / rate_Hz;
    settings.response = response;
    settings.tool.body = 0;
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    simulation = std::move(*Simulation::make(std::move(world), settings));
  }
  /// The torque about the axis that the hand feels when it has turned by `angle`.
  double torque_at(double angle) {
    simulation->step(Pose{exp_rotation(axis * angle), Vec3::Zero()});
    return simulation->report().coupling.t.dot(axis);
  }
};

TEST(FullTurns, TheTorqueGrowsWithTheTurnBeyondAStop) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double rate_Hz : testing::frame_rates_Hz())
      for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 2, -0.5)})
        for (const double to : {2.0, 3.5, 6.5, 20.0}) {
          if (testing::kSanitized && to > 6.0) continue;
          SCOPED_TRACE(::testing::Message() << int(response) << " " << rate_Hz << " Hz, to " << to << " rad");
          Knob knob(response, rate_Hz, axis, false);
          const double k = knob.simulation->settings().coupling.stiffness_Nm_per_rad;
          const int frames = int(to * 200 * std::max(1.0, rate_Hz / 1000.0));  // 5 rad/s at most
          for (int i = 0; i <= frames; ++i) {
            const double angle = to * i / frames;
            const double torque = knob.torque_at(angle);
            ASSERT_NEAR(torque, -k * std::max(0.0, angle - kStop), 0.05 * k) << angle;
          }
          for (int i = frames; i >= 0; --i) {
            const double angle = to * i / frames;
            ASSERT_NEAR(knob.torque_at(angle), -k * std::max(0.0, angle - kStop), 0.05 * k) << angle;
          }
        }
}

/// In a slot, held by contacts, as it turns on about an axis that the contacts give.
TEST(FullTurns, ABarInASlotHoldsTheHandBack) {
  for (const double rate_Hz : {1000.0, 4000.0})
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0.3, -1, 0.4)}) {
      SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, about " << axis.transpose());
      Knob knob(ResponseModel::kConstraint, rate_Hz, axis, true);
      const double k = knob.simulation->settings().coupling.stiffness_Nm_per_rad;
      const double play = 2.0 * 0.0001 / 0.12;
      for (int i = 0; i <= 1600; ++i) {
        const double angle = 0.005 * i;
        ASSERT_NEAR(knob.torque_at(angle), -k * std::max(0.0, angle - play), 0.02 * k) << angle;
      }
    }
}

/// The turn has no step as it grows past half a turn and full turns, with a turn aside that is undone.
TEST(FullTurns, TheTurnIsFollowedWithoutSteps) {
  for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(1, -2, 0.3)})
    for (const double aside : {0.0, 1e-6, 0.1}) {
      const Vec3 axis = direction.normalized();
      const Vec3 across = aside * any_orthogonal(axis);
      FollowedTurn followed;
      for (int i = 0; i < 4000; ++i) {
        const double along = 0.005 * i;
        const Mat3 R = exp_rotation(along * axis) * exp_rotation(across);  // aside first
        const Vec3 last = followed.turn;
        follow(R, followed);
        const Vec3& turn = followed.turn;
        ASSERT_NEAR(turn.dot(axis), along, aside * (0.2 + aside * along) + 1e-6);
        ASSERT_LT((turn - last).norm(), 0.02 + aside) << along;
        if (along > 3.0 && aside > 0.0) {
          ASSERT_GT(turn.dot(across), 0.0) << along;
        }
      }
    }
}

}  // namespace
}  // namespace tactum::full_turns_test
