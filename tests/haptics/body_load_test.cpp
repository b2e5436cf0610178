/// Constant forces and torques on bodies, and their damping, against closed forms: free, jointed and grasped,
/// in both responses, from 0.5 to 4 kHz and from 5 mm to 2 m.

#include "tactum/dynamics/body_load.h"
#include "support/effort.h"

#include <gtest/gtest.h>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/response/energy.h"

namespace tactum::body_load_test {
namespace {

struct Case {
  ResponseModel response = ResponseModel::kConstraint;
  double dt_s = 0.001;
  double size_m = 0.1;  ///< the longest side of the body
  double mass_kg = 0.05;

  bool constraint() const { return response == ResponseModel::kConstraint; }
  Vec3 half() const { return size_m * Vec3(0.5, 0.3, 0.2); }
  /// About an axis of the box [kg m^2].
  double inertia(int axis) const {
    const Vec3 squared = half().cwiseAbs2();
    return mass_kg / 3.0 * (squared.sum() - squared[axis]);
  }
  /// When the state's velocity is that of the body, after so many seconds: the state has the one of the
  /// middle of the frame.
  double velocity_time(double t_s) const { return t_s - 0.5 * dt_s; }
  std::string name() const {
    return std::string(constraint() ? "constraint" : "penalty") + ", step " + std::to_string(dt_s) +
           " s, size " + std::to_string(size_m) + " m, " + std::to_string(mass_kg) + " kg";
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double rate_Hz : testing::frame_rates_Hz())
      for (const double size_m : {0.005, 0.1, 2.0})
        for (const double mass_kg : {0.002, 0.5}) all.push_back({response, 1.0 / rate_Hz, size_m, mass_kg});
  return testing::sampled(all, 5);
}

FrameSettings settings_of(const Case& c) {
  FrameSettings settings;
  settings.dt_s = c.dt_s;
  settings.response = c.response;
  settings.budget.sleep = false;
  settings.coupling.damping_Ns_per_m = settings.coupling.damping_Nms_per_rad = 0.0;
  settings.smoothing.on = false;
  return settings;
}

/// A box that nothing touches.
class Alone {
 public:
  Alone(const Case& c, const BodyLoad& load, const Joint& joint = {}, const Twist& V = {},
        const Vec3& gravity_W = Vec3::Zero()) {
    World world;
    world.gravity_W = gravity_W;
    add_body(world,
             {.part = solid_box(c.half()), .mass_kg = c.mass_kg, .V_WB = V, .joint = joint, .load = load});
    simulation_ = std::move(*Simulation::make(std::move(world), settings_of(c)));
  }
  void run(double time_s) {
    const auto frames = std::lround(time_s / simulation_->settings().dt_s);
    for (long i = 0; i < frames; ++i) simulation_->step(Pose{});
  }
  double joint_position() const { return state().world.joints[0].now; }
  const Pose& X_WB() const { return state().world.X_WB[0]; }
  const Twist& V_WB() const { return state().world.V_WB[0]; }
  const FrameState& state() const { return simulation_->state(); }
  const World& world() const { return simulation_->world(); }

 private:
  std::unique_ptr<Simulation> simulation_;
};

constexpr double kTime_s = 0.4;

/// s = F t^2 / 2 m. The penalty response adds a whole frame's speed before it moves, so it is ahead by t h.
TEST(BodyLoad, AConstantForceMovesABodyByFtSquaredOverTwoM) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const Vec3 force = 3.0 * c.mass_kg * Vec3(0.6, -0.2, 1.0);
    Alone body(c, {.constant = {force, Vec3::Zero()}});
    body.run(kTime_s);
    const Vec3 expected = force / c.mass_kg * 0.5 * kTime_s * kTime_s;
    EXPECT_LT((body.X_WB().p - expected).norm(), 1e-9 * expected.norm());
  }
}

/// theta = tau t^2 / 2 I, about each axis of the box.
TEST(BodyLoad, AConstantTorqueTurnsABodyByTauTSquaredOverTwoI) {
  for (const Case& c : cases())
    for (int axis = 0; axis < 3; ++axis) {
      SCOPED_TRACE(c.name() + ", axis " + std::to_string(axis));
      const double torque = 20.0 * c.inertia(axis);
      Alone body(c, {.constant = {Vec3::Zero(), torque * Vec3::Unit(axis)}});
      body.run(kTime_s);
      const double expected = 10.0 * kTime_s * kTime_s;
      EXPECT_LT((log_rotation(body.X_WB().R) - expected * Vec3::Unit(axis)).norm(), 1e-9 * expected);
      EXPECT_LT(body.X_WB().p.norm(), 1e-12);
    }
}

/// m g / c in the end, from slow fading to one in a hundredth of a frame; the same for turns.
TEST(BodyLoad, AFallingBodyComesToItsTerminalSpeed) {
  for (const Case& c : cases())
    for (const double fading : {20.0, 300.0, 1e5}) {
      SCOPED_TRACE(c.name() + ", fading " + std::to_string(fading));
      const double damping = fading * c.mass_kg;
      const double turning = fading * c.inertia(2);
      const double torque = 3.0 * turning;
      Alone body(c,
                 {.constant = {Vec3::Zero(), Vec3(0, 0, torque)},
                  .damping_Ns_per_m = damping,
                  .damping_Nms_per_rad = turning},
                 {}, {}, {0, 0, -9.81});
      body.run(2.0);
      const double expected = -9.81 * c.mass_kg / damping;
      EXPECT_NEAR(body.V_WB().v.z(), expected, 1e-9 * std::abs(expected));
      EXPECT_NEAR(body.V_WB().w.z(), 3.0, 1e-9);
    }
}

/// v = v_0 exp(-c t / m), w = w_0 exp(-c t / I), and the way that is made of it.
TEST(BodyLoad, SpeedsFadeExponentially) {
  for (const Case& c : cases())
    for (const double fading : {0.5, 10.0, 200.0})
      for (int axis = 0; axis < 3; ++axis) {
        SCOPED_TRACE(c.name() + ", fading " + std::to_string(fading) + ", axis " + std::to_string(axis));
        // The box turns about one of its axes, whose rate of fading is given; the others fade differently.
        const BodyLoad load{.constant = {},
                            .damping_Ns_per_m = fading * c.mass_kg,
                            .damping_Nms_per_rad = fading * c.inertia(axis)};
        const Vec3 along = Vec3::Unit(axis);
        Alone body(c, load, {}, {0.3 * along, 2.0 * along});
        body.run(kTime_s);
        const double left = std::exp(-fading * c.velocity_time(kTime_s));
        EXPECT_NEAR(body.V_WB().v[axis], 0.3 * left, 1e-9 * 0.3 * left);
        // Exact for the axis of the least inertia; for the others to the second order of the step.
        const double x = fading * c.dt_s;
        EXPECT_NEAR(body.V_WB().w[axis], 2.0 * left, 2.0 * left * (1e-9 + 0.5 * fading * kTime_s * x * x));
        const double displacement = 0.3 / fading * (1.0 - std::exp(-fading * kTime_s));
        EXPECT_NEAR(body.X_WB().p[axis], displacement, displacement * (1e-9 + x * x));
      }
}

/// A body that stops within a hundredth of a frame neither turns round nor becomes infinite.
TEST(BodyLoad, DampingOfAnySizeIsStable) {
  for (const Case& c : cases())
    for (const JointKind kind : {JointKind::kFree, JointKind::kHinge, JointKind::kSlider, JointKind::kBall}) {
      SCOPED_TRACE(c.name() + ", joint " + std::to_string(static_cast<int>(kind)));
      const Joint joint{.kind = kind, .axis_W = Vec3::UnitX(), .anchor_W = c.size_m * Vec3(0, 0.4, 0.1)};
      const Vec3 arm = -joint.anchor_W;
      Twist V{Vec3(0.2, 0, 0), Vec3(3.0, 0, 0)};
      if (kind == JointKind::kHinge || kind == JointKind::kBall) V.v = V.w.cross(arm);
      if (kind == JointKind::kSlider) V.w.setZero();
      const double strong = 1e8;
      Alone body(c,
                 {.constant = {},
                  .damping_Ns_per_m = strong * c.mass_kg,
                  .damping_Nms_per_rad = strong * c.inertia(0)},
                 joint, V);
      body.run(10.0 * c.dt_s);
      EXPECT_TRUE(body.X_WB().finite());
      EXPECT_LT(body.V_WB().v.norm() + body.V_WB().w.norm(), 1e-9);
      EXPECT_GE(body.X_WB().p.x(), -1e-12);
      EXPECT_LT((body.X_WB().p).norm(), c.dt_s * (0.2 + 3.0 * c.size_m));
    }
}

/// tau / c of joint and body together, and the way there: w = w_end (1 - exp(-c t / I)).
TEST(BodyLoad, AHingeDrivenByATorqueComesToTauOverC) {
  for (const Case& c : cases())
    for (const double share : {0.0, 0.4, 1.0}) {  // of the damping that is the body's
      SCOPED_TRACE(c.name() + ", share " + std::to_string(share));
      const double arm = 0.4 * c.size_m;
      const double inertia = c.inertia(2) + c.mass_kg * arm * arm;
      const double fading = 20.0;
      const double damping = fading * inertia;
      const double torque = 5.0 * damping;
      const Joint hinge{.kind = JointKind::kHinge,
                        .axis_W = Vec3::UnitZ(),
                        .anchor_W = Vec3(arm, 0, 0),
                        .damping = (1.0 - share) * damping};
      // Half of the body's damping is that of its centre of mass on its way round the axis.
      const BodyLoad load{.constant = {Vec3::Zero(), Vec3(0.3 * torque, 0, torque)},
                          .damping_Ns_per_m = 0.5 * share * damping / (arm * arm),
                          .damping_Nms_per_rad = 0.5 * share * damping};
      Alone body(c, load, hinge);
      body.run(0.1);
      const double grown = 1.0 - std::exp(-fading * c.velocity_time(0.1));
      // The joint's own damper acts at the end of the step.
      EXPECT_NEAR(body.V_WB().w.z(), 5.0 * grown, 5.0 * (1e-9 + (share < 1.0 ? 2.0 * fading * c.dt_s : 0.0)));
      body.run(2.0);
      EXPECT_NEAR(body.V_WB().w.z(), 5.0, 5e-9);
      EXPECT_LT(body.V_WB().w.head<2>().norm(), 1e-9);
    }
}

/// A force on a slider acts along its axis only: s = F t^2 / 2 m there; with damping it comes to F / c.
TEST(BodyLoad, AForceDrivesASliderAlongItsAxis) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const Vec3 axis = Vec3(1, 2, 2) / 3.0;
    const Joint slider{.kind = JointKind::kSlider, .axis_W = axis};
    const Vec3 force = c.mass_kg * Vec3(2.0, -1.0, 0.5);
    Alone body(c, {.constant = {force, Vec3(1e-3, 0, 0)}}, slider);
    body.run(kTime_s);
    const double expected = axis.dot(force) / c.mass_kg * 0.5 * kTime_s * kTime_s;
    EXPECT_NEAR(body.joint_position(), expected, 1e-9 * std::abs(expected));
    Alone damped(c, {.constant = {force, Vec3::Zero()}, .damping_Ns_per_m = 30.0 * c.mass_kg}, slider);
    damped.run(2.0);
    EXPECT_NEAR(damped.V_WB().v.dot(axis), axis.dot(force) / (30.0 * c.mass_kg), 1e-9);
  }
}

/// On a ball at its centre of mass a body fades as a free one, about any axis.
TEST(BodyLoad, ABodyOnABallFades) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const Joint ball{.kind = JointKind::kBall};
    const double fading = 10.0;
    Alone body(c, {.constant = {}, .damping_Nms_per_rad = fading * c.inertia(2)}, ball,
               {Vec3::Zero(), Vec3(0, 0, 1.5)});
    body.run(kTime_s);
    const double left = std::exp(-fading * c.velocity_time(kTime_s));
    const double x = fading * c.dt_s;
    EXPECT_NEAR(body.V_WB().w.z(), 1.5 * left, 1.5 * left * (1e-9 + 0.5 * fading * kTime_s * x * x));
  }
}

/// What loads give is what the body has: their work is its kinetic energy.
TEST(BodyLoad, TheWorkOfLoadsIsTheEnergyOfTheBody) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const double fading = 5.0;
    const BodyLoad load{.constant = {c.mass_kg * Vec3(4, 0, 1), Vec3(0, 0, 30.0 * c.inertia(2))},
                        .damping_Ns_per_m = fading * c.mass_kg,
                        .damping_Nms_per_rad = fading * c.inertia(2)};
    Alone body(c, load, {}, {Vec3(-0.5, 0.2, 0), Vec3(0, 0, -4)});
    const double at_start = 0.5 * c.mass_kg * 0.29 + 0.5 * c.inertia(2) * 16.0;
    body.run(1.0);
    const double energy = bodies_energy(body.world(), body.state().world.X_WB, body.state().world, {});
    // To half a frame of the power, and the first order of the step.
    const double most = at_start + energy;
    EXPECT_NEAR(energy - at_start, body.state().load_work_J, most * 4.0 * fading * c.dt_s);
  }
}

/// A grasped box whose handle stands beside its centre of mass.
struct Grasped {
  Case c;
  FrameSettings settings;
  std::unique_ptr<Simulation> simulation;
  Vec3 p_BH;

  Grasped(const Case& of, const BodyLoad& load, const Joint& joint = {}, PortSettings port = {})
      : c(of), settings(settings_of(of)), p_BH(of.size_m * Vec3(0.3, -0.2, 0.1)) {
    World world;
    add_body(world, {.part = solid_box(c.half()), .mass_kg = c.mass_kg, .joint = joint, .load = load});
    settings.tool = {.body = 0, .X_BH = {Mat3::Identity(), p_BH}};
    // So that the torque of a force beside a large part's handle turns it by little.
    settings.coupling.stiffness_Nm_per_rad = std::max(0.3, 60.0 * c.size_m * c.size_m);
    settings.penalty.max_step_m = 1.0;
    settings.constraint.max_step_m = 1.0;
    settings.constraint.max_turn_rad = 1.0;
    settings.port = port;
    settings.safety.max_force_N = settings.safety.max_torque_Nm = 100.0;
    settings.safety.max_force_slew_N_per_s = settings.safety.max_torque_slew_Nm_per_s = 1e5;
    settings.safety.start_ramp_s = 0.1;
    simulation = std::move(*Simulation::make(std::move(world), settings));
  }
  const FrameReport& step(const Pose& X_DH) {
    simulation->step(X_DH);
    return simulation->report();
  }
  const Pose& X_WB() const { return simulation->state().world.X_WB[0]; }
};

/// The hand feels the force, and about the handle the torque and that of the force.
TEST(BodyLoad, AGraspedPartShowsItsLoadToTheHand) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const Wrench load{Vec3(0.5, -0.2, 0.7), Vec3(0.003, 0.001, -0.002)};
    Grasped grasped(c, {.constant = load});
    for (int i = 0; i < 400; ++i) grasped.step({});
    const Wrench felt = grasped.step({}).coupling;
    const Vec3 lever = -(grasped.X_WB().R * grasped.p_BH);  // from the handle to the centre of mass
    EXPECT_LT((felt.f - load.f).norm(), 1e-9);
    EXPECT_LT((felt.t - load.t - lever.cross(load.f)).norm(), 1e-6 * (load.t.norm() + lever.norm()));
  }
}

/// In free motion, along a line and round its own handle, the hand feels the drag of the part, nothing else.
TEST(BodyLoad, AGraspedPartShowsItsDrag) {
  for (const Case& c : cases())
    for (const Vec3& spin : {Vec3(0, 0, 0), Vec3(0.2, -0.5, 1.0)}) {
      SCOPED_TRACE(c.name());
      const BodyLoad load{.constant = {}, .damping_Ns_per_m = 6.0, .damping_Nms_per_rad = 0.004};
      Grasped grasped(c, load);
      const Twist hand{Vec3(0.05, 0.02, -0.01), spin};
      Pose X;
      Pose before;
      const auto frames = static_cast<int>(0.5 / c.dt_s);
      for (int i = 0; i < frames; ++i) {
        X = advanced(X, hand, c.dt_s);
        before = grasped.X_WB();
        grasped.step(X);
      }
      const Wrench felt = grasped.simulation->report().coupling;
      const Twist V = twist_between(before, grasped.X_WB(), c.dt_s);
      const Vec3 force = -load.damping_Ns_per_m * V.v;
      const Vec3 lever = -(grasped.X_WB().R * grasped.p_BH);
      const Vec3 torque = -load.damping_Nms_per_rad * V.w + lever.cross(force);
      EXPECT_LT((felt.f - force).norm(), 0.01 * force.norm());
      EXPECT_LT((felt.t - torque).norm(), 0.01 * (torque.norm() + lever.norm() * force.norm()));
      EXPECT_LT((V.w - spin).norm(), 0.02 * (1.0 + spin.norm()));
    }
}

/// On a slider: the component of force and drag along its axis turns nothing and is all that moves the part.
TEST(BodyLoad, AGraspedSliderShowsItsDrag) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    const Joint slider{.kind = JointKind::kSlider, .axis_W = Vec3::UnitX()};
    Grasped grasped(c, {.constant = {Vec3(1.0, 5.0, 0), Vec3::Zero()}, .damping_Ns_per_m = 20.0}, slider);
    Pose X;
    for (int i = 0; i < static_cast<int>(0.5 / c.dt_s); ++i) {
      X.p.x() += 0.02 * c.dt_s;
      grasped.step(X);
    }
    EXPECT_NEAR(grasped.simulation->report().coupling.f.x(), 1.0 - 20.0 * 0.02, 2e-3);
  }
}

/// The hand is led by the force for a tenth of a metre: that energy was not generated, and is not taken out.
TEST(BodyLoad, TheWorkOfAForceOnTheGraspedPartIsCounted) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name());
    PortSettings port;
    port.keeps_balance = true;
    Grasped grasped(c, {.constant = {Vec3(2.0, 0, 0), Vec3::Zero()}}, {}, port);
    double share = 1.0;
    Pose X;
    for (int i = 0; i < static_cast<int>(0.2 / c.dt_s); ++i) grasped.step(X);
    for (int i = 0; i < static_cast<int>(0.5 / c.dt_s); ++i) {
      X.p.x() += std::min(0.2, 2.0 * i * c.dt_s) * c.dt_s;  // no hand starts at once
      share = std::min(share, grasped.step(X).port.stiffness_share);
    }
    EXPECT_EQ(share, 1.0);
    EXPECT_GT(grasped.simulation->report().port.total.to_hand_J, 0.15);
  }
}

/// A grasped block pushes a damped free one steadily: the hand feels c v.
TEST(BodyLoad, APushedBodyResistsByItsDamping) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const double dt_s : {0.002, 0.001, 0.00025})
      for (const double size_m : {0.02, 0.2}) {
        const Case c{response, dt_s, size_m, 0.05};
        SCOPED_TRACE(c.name());
        World world;
        FrameSettings settings = settings_of(c);
        const double apart = 1.02 * c.half().x();
        for (const double x : {-apart, apart})
          add_body(world, {.part = solid_box(c.half()),
                           .mass_kg = c.mass_kg,
                           .X_WP = {Mat3::Identity(), {x, 0, 0}},
                           .load = {.constant = {},
                                    .damping_Ns_per_m = x > 0.0 ? 25.0 : 0.0,
                                    .damping_Nms_per_rad = 0.0}});
        settings.tool = {.body = 0, .X_BH = {}};
        const auto simulation = std::move(*Simulation::make(std::move(world), settings));
        Pose X;
        double sum = 0.0;
        const auto frames = static_cast<int>(1.5 / c.dt_s);
        for (int i = 0; i < frames; ++i) {
          X.p.x() += 0.04 * c.dt_s;
          simulation->step(X);
          if (i >= frames / 2) sum += simulation->report().coupling.f.x() / (frames - frames / 2);
        }
        EXPECT_NEAR(sum, -25.0 * 0.04, 0.01);
        EXPECT_NEAR(simulation->state().world.V_WB[1].v.x(), 0.04, 1e-3);
      }
}

}  // namespace
}  // namespace tactum::body_load_test
