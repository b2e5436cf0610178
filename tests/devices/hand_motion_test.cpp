#include "tactum/devices/hand_motion.h"

#include <gtest/gtest.h>

#include "tactum/base/random.h"
#include "tactum/devices/hand_model.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

constexpr double kStep = 1e-6;  // of the finite differences [s]

/// The reported velocity equals the change of the pose, at many times.
void expect_velocity_is_the_derivative(const HandMotion& motion, double tolerance) {
  Random random(21);
  for (int i = 0; i < 500; ++i) {
    const double t = random.uniform(0.0, motion.duration_s());
    const Twist analytic = motion.at(t).V_DH;
    const Pose before = motion.at(t - kStep).X_DH;
    const Pose after = motion.at(t + kStep).X_DH;
    const Twist seen = twist_between(before, after, 2 * kStep);
    EXPECT_LT((analytic.v - seen.v).norm(), tolerance) << "seed 21, t = " << t;
    EXPECT_LT((analytic.w - seen.w).norm(), tolerance) << "seed 21, t = " << t;
  }
}

TEST(ScriptedMotion, GoesThroughItsKeyframesAtRest) {
  std::vector<Keyframe> keys(3);
  keys[0] = {0.5, {Mat3::Identity(), {0.01, 0, 0}}, 0};
  keys[1] = {1.0, {exp_rotation({0, 0.4, 0}), {0.01, 0.02, 0}}, 1};
  keys[2] = {2.0, {exp_rotation({0.3, 0.4, 0}), {0, 0, 0.05}}, 2};
  const Result<ScriptedMotion> motion = motion_through(keys);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->duration_s(), 2.0);
  for (const Keyframe& key : keys) {
    const HandState state = motion->at(key.time_s);
    EXPECT_LT((state.X_DH.p - key.X_DH.p).norm(), 1e-15);
    EXPECT_LT((state.X_DH.R - key.X_DH.R).norm(), 1e-14);
    EXPECT_LT(state.V_DH.v.norm() + state.V_DH.w.norm(), 1e-12);
  }
  EXPECT_EQ(motion->at(1.5).buttons, 1u);
  EXPECT_EQ(motion->at(-3.0).X_DH.p, keys[0].X_DH.p);
  EXPECT_EQ(motion->at(99.0).X_DH.p, keys[2].X_DH.p);
  // Half the time is half the path, by symmetry, at 15/8 of the mean speed.
  EXPECT_LT((motion->at(0.75).X_DH.p - Vec3(0.01, 0.01, 0)).norm(), 1e-15);
  EXPECT_NEAR(motion->at(0.75).V_DH.v.y(), 0.02 / 0.5 * 15.0 / 8.0, 1e-12);
  expect_velocity_is_the_derivative(*motion, 1e-6);
}

TEST(ScriptedMotion, TurningKeepsTheDistanceToTheAxis) {
  const Vec3 p(0.02, -0.01, 0.0);
  const Vec3 axis = Vec3(1, 2, 2) / 3.0;
  ScriptedMotion motion({exp_rotation({0.1, 0, 0}), {0.05, 0.02, 0.01}});
  motion.turn_about(2.0, p, 5.0 * axis, 3.0 * kPi, MotionProfile::kSteady);
  const auto distance = [&](const Vec3& q) { return (q - p).cross(axis).norm(); };
  const double radius = distance(motion.at(0.0).X_DH.p);
  for (double t = 0.0; t < 2.0; t += 0.01) {
    const HandState state = motion.at(t);
    EXPECT_NEAR(distance(state.X_DH.p), radius, 1e-14);
    EXPECT_NEAR(state.V_DH.v.norm(), radius * 1.5 * kPi, 1e-12);
    EXPECT_NEAR(state.V_DH.w.dot(axis), 1.5 * kPi, 1e-12);
  }
  // One and a half turns end opposite to the start.
  const Vec3 start = motion.at(0.0).X_DH.p - p;
  const Vec3 along = axis * axis.dot(start);
  EXPECT_LT((motion.end_pose().p - (p + along - (start - along))).norm(), 1e-15);
  expect_velocity_is_the_derivative(motion, 1e-6);
}

TEST(ScriptedMotion, SegmentsJoinWithoutAJump) {
  ScriptedMotion motion;
  motion.move_to(0.3, {exp_rotation({0, 0, 1}), {0.03, 0, 0}})
      .turn_about(0.4, Vec3::Zero(), Vec3::UnitX(), 1.0)
      .hold(0.2, 4)
      .move_to(0.3, {});
  for (double joint : {0.3, 0.7, 0.9, 1.2}) {
    const Pose before = motion.at(joint - 1e-9).X_DH;
    const Pose after = motion.at(joint + 1e-9).X_DH;
    EXPECT_LT((before.p - after.p).norm() + (before.R - after.R).norm(), 1e-9);
  }
  EXPECT_EQ(motion.at(0.8).buttons, 4u);
}

TEST(ScriptedMotion, BadKeyframesAreNamed) {
  std::vector<Keyframe> keys(2);
  EXPECT_FALSE(motion_through({}));
  keys[1].time_s = 0.0;
  Result<ScriptedMotion> motion = motion_through(keys);
  ASSERT_FALSE(motion);
  EXPECT_NE(motion.error().message().find("keyframe 2"), std::string::npos);
  keys[1].time_s = 1.0;
  keys[1].X_DH.R *= 1.01;
  EXPECT_FALSE(motion_through(keys));
}

TEST(TremorMotion, StaysWithinItsAmplitudeAndRepeats) {
  auto base = std::make_shared<ScriptedMotion>();
  base->move_to(2.0, {exp_rotation({0, 0, 0.5}), {0.02, 0, 0}});
  const TremorMotion motion(base, physiological_tremor(2e-4, 5e-3, 3));
  const TremorMotion again(base, physiological_tremor(2e-4, 5e-3, 3));
  const TremorMotion other(base, physiological_tremor(2e-4, 5e-3, 4));
  double largest = 0.0;
  for (double t = 0.0; t < 3.0; t += 0.001) {
    const Pose calm = base->at(t).X_DH;
    const Pose shaken = motion.at(t).X_DH;
    largest = std::max(largest, (shaken.p - calm.p).norm());
    EXPECT_LE(log_rotation(shaken.R * calm.R.transpose()).norm(), 5e-3 + 1e-12);
    EXPECT_EQ(shaken.p, again.at(t).X_DH.p);
  }
  EXPECT_LE(largest, 2e-4 + 1e-15);
  EXPECT_GT(largest, 2e-5);
  EXPECT_NE(motion.at(0.1).X_DH.p, other.at(0.1).X_DH.p);
  // Exact but for terms of the amplitude squared in the rotation (5e-3 rad at 75 rad/s).
  expect_velocity_is_the_derivative(motion, 2e-3);
}

TEST(HandModel, GripsGrowFirmerAndUnknownOnesAreListed) {
  const HandModel loose = *hand_model("loose");
  const HandModel medium = *hand_model("medium");
  const HandModel firm = *hand_model("firm");
  EXPECT_LT(loose.stiffness_N_per_m, medium.stiffness_N_per_m);
  EXPECT_LT(medium.stiffness_N_per_m, firm.stiffness_N_per_m);
  const Result<HandModel> unknown = hand_model("iron");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message().find("loose, medium, firm"), std::string::npos);
}

}  // namespace
}  // namespace tactum
