/// A hinged body is held by the place at which it is taken, picked by the button or held from the start: near
/// its axis the probe becomes the body, farther out it is a rod in a wheel. Angle and wrench against closed
/// forms, on wheels of 10 mm to 1 m, in both responses, from 0.5 to 4 kHz.

#include <gtest/gtest.h>

#include "support/effort.h"
#include "support/sandbox.h"
#include "tactum/haptics/picking.h"
#include "tactum/math/screw.h"

namespace tactum::grasp_place_test {
namespace {

struct Case {
  ResponseModel response = ResponseModel::kConstraint;
  double dt_s = 0.001;
  double radius_m = 0.036;  ///< of the wheel
  double fraction = 0.1;    ///< of it, where the wheel is taken
  bool picked = true;       ///< by the button; false: the hand holds it from the start

  double taken_m() const { return radius_m * fraction; }
  std::string name() const {
    return std::string(response == ResponseModel::kConstraint ? "constraint" : "penalty") + ", step " +
           std::to_string(dt_s) + " s, radius " + std::to_string(radius_m) + " m, " +
           (picked ? "taken at " : "held from the start at ") + std::to_string(fraction);
  }
};

std::vector<Case> cases(std::initializer_list<double> fractions) {
  std::vector<Case> all;
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double radius_m : {0.005, 0.03, 0.5})
      for (const double fraction : fractions) {
        all.push_back({response, 0.001, radius_m, fraction});
        all.push_back({response, 0.001, radius_m, fraction, false});
        if (radius_m == 0.03)
          for (const double rate_Hz : {500.0, 4000.0})
            all.push_back({response, 1.0 / rate_Hz, radius_m, fraction});
      }
  return testing::sampled(all, 5);
}

const auto kNearAxis = {0.0, 0.1, 0.2};
const auto kFarOut = {0.5, 0.95};

/// A wheel on a slanting hinge that is picked, and led in the frame A of its hinge: z along the axis, x to
/// where it is taken.
class Wheel : public Sandbox {
 public:
  explicit Wheel(const Case& c, double torque_Nm = 0.0, double friction_Nm = 0.0,
                 double centre_fraction = 0.25)
      : case_(c), X_WA_{exp_rotation(Vec3(0.4, -0.3, 0.8)), Vec3(0.1, -0.05, 0.2)} {
    const Joint hinge{
        .kind = JointKind::kHinge, .axis_W = X_WA_.R.col(2), .anchor_W = X_WA_.p, .friction = friction_Nm};
    add_body(world, {.part = solid_of(make_prism(48, c.radius_m, 0.3 * c.radius_m)),
                     .mass_kg = 0.1,
                     .X_WP = X_WA_,
                     .joint = hinge,
                     .load = {.constant = {Vec3::Zero(), torque_Nm * X_WA_.R.col(2)}}});
    settings.dt_s = c.dt_s;
    settings.response = c.response;
    settings.tool.picks = c.picked;
    if (!c.picked) {
      settings.tool.body = 0;
      settings.tool.X_BH.p = Vec3(c.taken_m(), 0, 0);  // the body's axes are those of A
    }
    settings.tool.centre_fraction = centre_fraction;
    settings.coupling.damping_Ns_per_m = settings.coupling.damping_Nms_per_rad = 0.0;
    settings.smoothing.on = false;
    settings.workspace.X_WD = {X_WA_.R, X_WA_ * Vec3(c.taken_m(), 0, 0)};
    settle(true);
  }
  /// Leads the hand to a place in A and a turn about the axes of A, and lets everything come to rest.
  void lead(const Vec3& p_A, const Vec3& turn_A = Vec3::Zero()) {
    const Pose from = X_DH_;
    const Pose to{exp_rotation(turn_A), p_A - Vec3(case_.taken_m(), 0, 0)};
    const double path_m = (to.p - from.p).norm() + case_.radius_m * turn_A.norm();
    const int frames = 200 + static_cast<int>(path_m / 2e-4);
    for (int i = 1; i <= frames; ++i) {
      X_DH_ = interpolated(from, to, static_cast<double>(i) / frames);
      frame(true);
    }
    settle(true);
  }
  /// Leads the hand round the axis, in its own orientation or turning with the way.
  void lead_round(double angle, bool turning) {
    const double r = case_.taken_m();
    const int frames = 400 + static_cast<int>(angle * r / 2e-4);
    for (int i = 1; i <= frames; ++i) {
      const double at = angle * i / frames;
      X_DH_ = {exp_rotation(Vec3(0, 0, turning ? at : 0.0)), Vec3(r * std::cos(at) - r, r * std::sin(at), 0)};
      frame(true);
    }
  }
  void settle(bool pressed) {
    for (int i = 0; i < 300; ++i) frame(pressed);
  }
  double angle() { return begun().world.joints[0].now; }
  /// The felt wrench, axes of A, at the handle.
  Wrench felt() const { return rotated(X_WA_.R.transpose(), report.coupling); }
  Hold hold() { return begun().hand.grasp.hold; }
  double k() const { return settings.coupling.stiffness_N_per_m; }
  double k_turning() const { return settings.coupling.stiffness_Nm_per_rad; }

 private:
  void frame(bool pressed) {
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH = X_DH_;
    sample.buttons = pressed ? 1u : 0u;
    step(sample);
  }

  Case case_;
  Pose X_WA_, X_DH_;
};

double least(const Case& c) { return 1e-6 * 600.0 * c.radius_m; }  // of a force that is none [N]

TEST(GraspPlace, NothingIsPulledWhereTheBodyIsTaken) {
  for (const Case& c : cases({0.0, 0.1, 0.2, 0.5, 0.95})) {
    SCOPED_TRACE(c.name());
    Wheel wheel(c);
    EXPECT_EQ(wheel.report.grasped_body, 0);
    EXPECT_EQ(wheel.hold(), c.fraction < 0.25 ? Hold::kCentre : Hold::kRod);
    EXPECT_LT(wheel.felt().f.norm(), least(c));
    EXPECT_LT(wheel.felt().t.norm(), 1e-9);
    EXPECT_NEAR(wheel.angle(), 0.0, 1e-9);
    EXPECT_LT((wheel.report.X_WH_proxy.p - wheel.report.X_WH.p).norm(), 1e-9 * c.radius_m);
  }
}

TEST(GraspPlace, NearTheAxisTheHandsPlaceTurnsNothing) {
  for (const Case& c : cases(kNearAxis)) {
    SCOPED_TRACE(c.name());
    Wheel wheel(c);
    for (const Vec3& offset : {Vec3(0.2, 0, 0), Vec3(0, 0.25, 0), Vec3(-0.4, 0.3, 0.1)}) {
      const Vec3 led = c.radius_m * offset;
      wheel.lead(Vec3(c.taken_m(), 0, 0) + led);
      EXPECT_NEAR(wheel.angle(), 0.0, 1e-9);
      EXPECT_LT((wheel.felt().f + wheel.k() * led).norm(), least(c));
      EXPECT_LT(wheel.felt().t.norm(), 1e-9);
    }
  }
}

TEST(GraspPlace, NearTheAxisTheHandsTurnTurnsTheBody) {
  for (const Case& c : cases(kNearAxis))
    for (const double turn : {0.7, -1.3}) {
      SCOPED_TRACE(c.name());
      Wheel wheel(c);
      wheel.lead(Vec3(c.taken_m(), 0, 0), Vec3(0, 0, turn));
      EXPECT_NEAR(wheel.angle(), turn, 1e-6);
      EXPECT_LT(wheel.felt().f.norm(), least(c));
      EXPECT_LT(wheel.felt().t.norm(), 1e-6);
    }
}

/// A torque on the body is felt as that torque, and the body is ahead of the hand by it over the coupling.
TEST(GraspPlace, NearTheAxisTheBodyIsFeltByItsTorque) {
  for (const Case& c : cases(kNearAxis)) {
    SCOPED_TRACE(c.name());
    const double torque = 0.02;
    Wheel wheel(c, torque);
    EXPECT_NEAR(wheel.angle(), torque / wheel.k_turning(), 1e-6);
    EXPECT_LT((wheel.felt().t - Vec3(0, 0, torque)).norm(), 1e-6);
    EXPECT_LT(wheel.felt().f.norm(), least(c));
  }
}

TEST(GraspPlace, FarOutTheHandsWayRoundTheAxisTurnsTheBody) {
  for (const Case& c : cases(kFarOut))
    for (const bool turning : {false, true}) {
      SCOPED_TRACE(c.name() + (turning ? ", turning" : ""));
      Wheel wheel(c);
      wheel.lead_round(2.5, turning);
      wheel.settle(true);
      EXPECT_NEAR(wheel.angle(), 2.5, 1e-6);
      EXPECT_LT(wheel.felt().f.norm(), least(c));
      EXPECT_LT(wheel.felt().t.norm(), 1e-6);
    }
}

TEST(GraspPlace, FarOutTheHandsTurnTurnsNothing) {
  for (const Case& c : cases(kFarOut)) {
    SCOPED_TRACE(c.name());
    Wheel wheel(c);
    wheel.lead(Vec3(c.taken_m(), 0, 0), Vec3(0, 0, 1.2));
    EXPECT_NEAR(wheel.angle(), 0.0, 1e-6);
    EXPECT_LT(wheel.felt().f.norm(), least(c));
    EXPECT_LT(wheel.felt().t.norm(), 1e-6);
  }
}

/// Led anywhere: the body turns to face the hand, and the spring is stretched along the radius and the axis.
/// A tilt is held as by every grasp.
TEST(GraspPlace, FarOutTheRadiusIsKept) {
  for (const Case& c : cases(kFarOut))
    for (const Vec3& place : {Vec3(0.4, 0.7, 0.1), Vec3(0.1, -0.2, 0.1), Vec3(1.9, 2.4, -0.2)}) {
      SCOPED_TRACE(c.name());
      Wheel wheel(c);
      const Vec3 p = c.radius_m * place;
      const Vec3 tilt(0.1, 0, 0);
      wheel.lead(p, tilt);
      EXPECT_NEAR(wheel.angle(), std::atan2(p.y(), p.x()), 1e-6);
      const double out = p.head<2>().norm();
      const Vec3 stretch(p.x() * (1.0 - c.taken_m() / out), p.y() * (1.0 - c.taken_m() / out), p.z());
      EXPECT_LT((wheel.felt().f + wheel.k() * stretch).norm(), least(c));
      EXPECT_NEAR(wheel.felt().t.z(), 0.0, 1e-6);
      EXPECT_NEAR(wheel.felt().t.norm(), wheel.k_turning() * tilt.norm(), 1e-6);
    }
}

/// A torque on the body is felt as a force round the axis: k r^2 sin of the angle by which it is ahead.
TEST(GraspPlace, FarOutTheBodyIsFeltByForce) {
  for (const Case& c : cases(kFarOut)) {
    SCOPED_TRACE(c.name());
    const double torque = 0.2 * 600.0 * c.taken_m() * c.taken_m();
    Wheel wheel(c, torque);
    const double ahead = std::asin(0.2);
    const Vec3 expected = 600.0 * c.taken_m() * Vec3(std::cos(ahead) - 1.0, std::sin(ahead), 0);
    EXPECT_NEAR(wheel.angle(), ahead, 1e-6);
    EXPECT_LT((wheel.felt().f - expected).norm(), least(c));
    EXPECT_LT(wheel.felt().t.norm(), 1e-6);
  }
}

/// Dry friction of the hinge, while the body is turned: its torque by the wrist, its torque over the radius
/// by the arm.
TEST(GraspPlace, FrictionOfTheHingeIsFeltByTorqueOrByForce) {
  for (const Case& c : cases({0.1, 0.5, 0.95})) {
    SCOPED_TRACE(c.name());
    const bool centre = c.fraction < 0.25;
    const double friction = centre ? 0.003 : 0.1 * 600.0 * c.taken_m() * c.taken_m();
    Wheel wheel(c, 0.0, friction);
    if (centre) {
      wheel.lead(Vec3(c.taken_m(), 0, 0), Vec3(0, 0, 1.0));
      EXPECT_NEAR(wheel.felt().t.z(), -friction, 2e-3 * friction);
      EXPECT_LT(wheel.felt().f.norm(), least(c));
    } else {
      wheel.lead_round(1.0, false);
      const double round = -std::sin(1.0) * wheel.felt().f.x() + std::cos(1.0) * wheel.felt().f.y();
      EXPECT_NEAR(round * c.taken_m(), -friction, 0.01 * friction);
      EXPECT_LT(wheel.felt().t.norm(), 1e-6);
    }
  }
}

TEST(GraspPlace, TheFractionIsASetting) {
  const Case c{ResponseModel::kConstraint, 0.001, 0.03, 0.4};
  EXPECT_EQ(Wheel(c).hold(), Hold::kRod);
  EXPECT_EQ(Wheel(c, 0.0, 0.0, 0.5).hold(), Hold::kCentre);
  EXPECT_EQ(Wheel({ResponseModel::kConstraint, 0.001, 0.03, 0.0}, 0.0, 0.0, 0.0).hold(), Hold::kCentre)
      << "on the axis";
  EXPECT_EQ(Wheel({ResponseModel::kConstraint, 0.001, 0.03, 0.95}, 0.0, 0.0, 1.0).hold(), Hold::kCentre);
}

/// A free body is held as before: it goes and turns with the hand, wherever it was taken.
TEST(GraspPlace, AFreeBodyIsHeldFirmly) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double x : {0.0, 0.003, 0.028}) {
      Sandbox hand;
      hand.add(make_prism(48, 0.03, 0.01), {});
      hand.settings.response = response;
      hand.settings.tool.picks = true;
      hand.settings.workspace.X_WD.p = {x, 0, 0};
      DeviceSample sample;
      sample.valid = true;
      sample.buttons = 1u;
      const Vec3 turn(0.1, 0.2, 0.5);
      for (int i = 0; i <= 600; ++i) {
        const double share = std::min(1.0, i / 400.0);
        sample.X_DH = {exp_rotation(share * turn), share * Vec3(0.01, 0.02, -0.01)};
        hand.step(sample);
      }
      EXPECT_EQ(hand.begun().hand.grasp.hold, Hold::kFirm);
      const Pose expected = sample.X_DH * Pose{Mat3::Identity(), {-x, 0, 0}};
      EXPECT_LT((hand.X(0).R - sample.X_DH.R).norm(), 1e-6);
      EXPECT_LT((hand.X(0).p - expected.p - Vec3(x, 0, 0)).norm(), 1e-6);
      EXPECT_LT(hand.report.coupling.t.norm(), 1e-6);
    }
}

}  // namespace
}  // namespace tactum::grasp_place_test
