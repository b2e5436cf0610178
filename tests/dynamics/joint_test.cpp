#include "tactum/dynamics/joint.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tactum/base/random.h"
#include "tactum/dynamics/solve_penalty.h"
#include "tactum/math/screw.h"

namespace tactum::joint_test {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// Any mass and any inertia, which need not be those of one shape.
Body random_body(Random& random, JointKind kind) {
  Body body;
  body.mass_kg = random.uniform(0.05, 2.0);
  const Mat3 R = exp_rotation(random_vector(random, 2));
  body.inertia_B =
      R *
      Vec3(random.uniform(1e-5, 1e-3), random.uniform(1e-5, 1e-3), random.uniform(1e-5, 1e-3)).asDiagonal() *
      R.transpose();
  body.X_WB = {exp_rotation(random_vector(random, 2)), random_vector(random, 0.1)};
  body.joint.kind = kind;
  body.joint.axis_W = random_vector(random, 1).normalized();
  body.joint.anchor_W = random_vector(random, 0.1);
  return body;
}

/// The change of a body's twist by an impulse at its origin, through the contact problem: a unit row along
/// the impulse, loaded with its size.
Twist twist_after(const Body& body, const Vec6& impulse) {
  ContactProblem problem(1, 1);
  problem.add_body({0, body, body.X_WB}, body.X_WB.p, inertial_metric(body, body.X_WB, 1.0), Vec6::Zero(),
                   0.0);
  problem.begin({});
  problem.add_load(problem.row_of(0, -1, {body.X_WB.p, impulse.head<3>(), impulse.tail<3>()}), 1.0);
  problem.solve_on(1);
  return to_twist(problem.displacement(0));
}

TEST(Joint, AFreeBodyAnswersAnImpulseWithItsInertia) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Body body = random_body(random, JointKind::kFree);
    const Resistance M = inertial_resistance(body, body.X_WB);
    Vec6 impulse;
    impulse << random_vector(random, 1), random_vector(random, 1);
    EXPECT_LT((M * to_vector(twist_after(body, impulse)) - impulse).norm(), 1e-9);
  }
}

TEST(Joint, HingeAnswersAnImpulseWithItsMomentAboutTheAxis) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Body body = random_body(random, JointKind::kHinge);
    const Vec3 axis = body.joint.axis_W;
    const Vec3 impulse = random_vector(random, 1);
    const Vec3 at = random_vector(random, 0.2);
    Vec6 p;
    p << impulse, (at - body.X_WB.p).cross(impulse);
    const Twist V = twist_after(body, p);
    // Textbook: angular rate = moment about the axis / (inertia about the axis through the anchor).
    const Vec3 r = body.X_WB.p - body.joint.anchor_W;
    const Vec3 off = r - axis * axis.dot(r);
    const double inertia = axis.dot(body.X_WB.R * body.inertia_B * body.X_WB.R.transpose() * axis) +
                           body.mass_kg * off.squaredNorm();
    const double rate = axis.dot((at - body.joint.anchor_W).cross(impulse)) / inertia;
    EXPECT_NEAR(axis.dot(V.w), rate, 1e-9 * (1 + std::abs(rate)));
    EXPECT_LT(velocity_at(V, body.joint.anchor_W - body.X_WB.p).norm(), 1e-9 * (1 + std::abs(rate)));
  }
}

TEST(Joint, ConstrainedVelocityKeepsTheAnchorStillAndItsOwnResults) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Body body = random_body(random, JointKind::kHinge);
    const Resistance M = inertial_resistance(body, body.X_WB);
    const Twist wanted{random_vector(random, 1), random_vector(random, 5)};
    const Twist V = constrained_velocity(body.joint, body.X_WB, M, wanted);
    EXPECT_LT(velocity_at(V, body.joint.anchor_W - body.X_WB.p).norm(), 1e-12);
    EXPECT_LT((V.w - body.joint.axis_W * body.joint.axis_W.dot(V.w)).norm(), 1e-12);
    const Twist again = constrained_velocity(body.joint, body.X_WB, M, V);
    EXPECT_LT((again.v - V.v).norm() + (again.w - V.w).norm(), 1e-9);
    // Nearest in the metric: the difference is M-orthogonal to the free motion.
    EXPECT_NEAR(joint_motions(body.joint, body.X_WB).col(0).dot(M * (to_vector(wanted) - to_vector(V))), 0.0,
                1e-12);
  }
}

TEST(Joint, ConstrainedPoseIsTheTurnAboutTheAxis) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Body body = random_body(random, JointKind::kHinge);
    const double angle = random.uniform(-3.1, 3.1);
    const Mat3 turn = exp_rotation(body.joint.axis_W * angle);
    const Vec3 anchor = body.joint.anchor_W;
    const Pose exact{turn * body.X_WB.R, anchor + turn * (body.X_WB.p - anchor)};
    EXPECT_NEAR(hinge_angle(body, exact), angle, 1e-12);
    const Pose drifted{exp_rotation(random_vector(random, 1e-6)) * exact.R,
                       exact.p + random_vector(random, 1e-6)};
    const Pose back = constrained_pose(body, drifted);
    EXPECT_LT((back.R - exact.R).norm(), 1e-5);
    EXPECT_NEAR((back.p - anchor).norm(), (body.X_WB.p - anchor).norm(), 1e-14);
  }
}

TEST(Joint, AnyTurnOfAHingeBecomesItsTurnAboutTheAxis) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Body body = random_body(random, JointKind::kHinge);
    const Pose any{exp_rotation(random_vector(random, 3)) * body.X_WB.R, random_vector(random, 0.1)};
    const Pose back = constrained_pose(body, any);
    const Mat3 turn = exp_rotation(body.joint.axis_W * hinge_angle(body, any));
    EXPECT_LT((back.R - turn * body.X_WB.R).norm(), 1e-13);
    EXPECT_LT((back.R * back.R.transpose() - Mat3::Identity()).norm(), 1e-14);
  }
  // Half a turn about an axis square to the hinge's does not determine the angle.
  Body body = random_body(random, JointKind::kHinge);
  body.X_WB.R = Mat3::Identity();
  body.joint.axis_W = Vec3::UnitZ();
  EXPECT_EQ(constrained_pose(body, {Vec3(1, -1, -1).asDiagonal(), Vec3::Zero()}).R, Mat3::Identity());
}

/// A value that is not a number must stay so, for the frame to detect it.
TEST(Joint, APoseThatIsNoNumberStaysNone) {
  Random random(7);
  for (JointKind kind : {JointKind::kFree, JointKind::kHinge, JointKind::kBall}) {
    const Body body = random_body(random, kind);
    const double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(constrained_pose(body, {Mat3::Constant(none), Vec3::Constant(none)}).finite());
  }
}

/// The twist of a body after its joint alone has acted on it for a millisecond.
Twist joint_alone(const Body& body, const Pose& X_WB, const Twist& V) {
  constexpr double kStep_s = 0.001;
  ContactProblem problem(1, 1);
  problem.add_body({0, body, X_WB, {joint_position(body, X_WB), joint_position(body, X_WB)}}, X_WB.p,
                   inertial_metric(body, X_WB, kStep_s), to_vector(V * kStep_s), kStep_s);
  problem.add_joint_rows(false);
  EXPECT_TRUE(PenaltySolver(8).solve({}, 100, problem).converged);
  return to_twist(problem.displacement(0) / kStep_s);
}

/// A hinge or slider of unit mobility, for which mass and inertia are set to 1, 0.02 from its start, after a
/// millisecond.
class AfterJoint : public ::testing::TestWithParam<JointKind> {
 protected:
  AfterJoint() {
    body_.mass_kg = 1.0;
    body_.inertia_B = Mat3::Identity();
    body_.joint.kind = GetParam();
  }
  Twist along(double rate) const {
    Twist V;
    (GetParam() == JointKind::kHinge ? V.w : V.v).z() = rate;
    return V;
  }
  Twist after(const Twist& V) const {
    const Pose X_WB = advanced(body_.X_WB, along(0.02), 1.0);
    return joint_alone(body_, X_WB, V);
  }
  double rate_after(double rate) const {
    const Twist V = after(along(rate));
    return GetParam() == JointKind::kHinge ? V.w.z() : V.v.z();
  }
  Body body_;
};

TEST_P(AfterJoint, NothingChangesWhereNothingActs) { EXPECT_NEAR(rate_after(0.7), 0.7, 1e-12); }

TEST_P(AfterJoint, DryFrictionHoldsBelowItsLimitAndSlowsAboveIt) {
  body_.joint.friction = 100.0;  // it takes 0.1 a step
  EXPECT_NEAR(rate_after(0.05), 0.0, 1e-9);
  EXPECT_NEAR(rate_after(-0.5), -0.4, 1e-9);
}

TEST_P(AfterJoint, EachLimitAloneIsNotOverrun) {
  body_.joint.upper = 0.0201;
  EXPECT_NEAR(rate_after(1.0), 0.1, 1e-8);
  EXPECT_NEAR(rate_after(-1.0), -1.0, 1e-12);
  body_.joint.upper = 0.01;  // overrun: not farther, nor thrown back
  EXPECT_NEAR(rate_after(1.0), 0.0, 1e-8);
  body_.joint.upper = std::numeric_limits<double>::infinity();
  body_.joint.lower = 0.0199;
  EXPECT_NEAR(rate_after(-1.0), -0.1, 1e-8);
  EXPECT_NEAR(rate_after(1.0), 1.0, 1e-12);
}

TEST_P(AfterJoint, SpringActsAtTheMeanOfTheStepOrStiffAtItsEnd) {
  body_.joint.rest = 0.01;
  body_.joint.stiffness = 50.0;
  const double rate = rate_after(0.3);
  EXPECT_NEAR(rate, 0.3 - 0.001 * 50.0 * (0.02 + 0.25 * 0.001 * rate - 0.01), 1e-12);
  body_.joint.stiffness = 2e6;  // [N/m] more than the inertia over the square of the step
  const double stiff = rate_after(0.3);
  EXPECT_NEAR(stiff, 0.3 - 0.001 * 2e6 * (0.02 + 0.001 * stiff - 0.01), 1e-9);
}

TEST_P(AfterJoint, DamperActsAtTheEndOfTheStep) {
  body_.joint.damping = 2.0;
  EXPECT_NEAR(rate_after(0.3), 0.3 / (1.0 + 0.001 * 2.0), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Kinds, AfterJoint, ::testing::Values(JointKind::kHinge, JointKind::kSlider),
                         [](const auto& kind) {
                           return std::string(kind.param == JointKind::kHinge ? "Hinge" : "Slider");
                         });

TEST(Joint, ABallIsDampedAboutEveryAxisAndHeldByItsLimit) {
  Body body;
  body.mass_kg = 1.0;
  body.inertia_B =
      Mat3::Identity();  // of unit mobility about every axis, so that the rates have round numbers
  body.joint.kind = JointKind::kBall;
  const Pose X_WB = advanced(body.X_WB, {Vec3::Zero(), Vec3(0, 0, 0.02)}, 1.0);
  const Twist V{Vec3::Zero(), Vec3(0.1, 0.2, 0.3)};
  body.joint.damping = 2.0;
  EXPECT_LT((joint_alone(body, X_WB, V).w - V.w / 1.002).norm(), 1e-12);
  body.joint.damping = 0.0;
  body.joint.upper = 0.0201;
  EXPECT_LT((joint_alone(body, X_WB, V).w - Vec3(0.1, 0.2, 0.1)).norm(), 1e-8);
}

TEST(Joint, FixedBodiesStay) {
  Random random(5);
  const Body body = random_body(random, JointKind::kFixed);
  const Resistance M = inertial_resistance(body, body.X_WB);
  EXPECT_EQ(constrained_velocity(body.joint, body.X_WB, M, {Vec3::Ones(), Vec3::Ones()}).v.norm(), 0.0);
}

}  // namespace
}  // namespace tactum::joint_test
