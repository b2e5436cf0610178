/// Stages on the path of the whole frame, each by its closed form: the smoothing of the wrench, shaded
/// normals, the margin of bodies that turn, the joint of the grasped part, and the passivity of the port.

#include <gtest/gtest.h>

#include <cmath>

#include "support/add_body.h"
#include "support/block_rig.h"
#include "support/rotation_between.h"
#include "support/sandbox.h"
#include "support/solid_box.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/force_stage.h"
#include "tactum/haptics/simulation.h"

namespace tactum::frame_path_test {
namespace {

constexpr std::array kResponses = {ResponseModel::kConstraint, ResponseModel::kPenalty};

struct Smoothed {
  double step_N = 0.5;  // in 1 ms
  double depth = 0.02;  // to which the hand goes at once [m]
  double rate_Hz = 1000.0;
};

/// The hand goes below the plate at once. In steps that are as long as set the force rises to what the
/// coupling has, and the last two steps are halves: |d| falls to F_max or less before the whole is shown.
TEST(FramePath, NoStepOfTheSmoothedWrenchIsLongerThanSet) {
  for (const ResponseModel response : kResponses)
    for (const Smoothed& c : {Smoothed{}, Smoothed{.step_N = 0.1}, Smoothed{.depth = 0.005},
                              Smoothed{.rate_Hz = 500.0}, Smoothed{.rate_Hz = 4000.0}}) {
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", " << c.step_N << " N, "
                                        << c.depth << " m, " << c.rate_Hz << " Hz");
      BlockRig rig;
      rig.settings.response = response;
      rig.settings.dt_s = 1.0 / c.rate_Hz;
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      rig.settings.smoothing = {.max_force_N_per_s = 1e3 * c.step_N,
                                .max_torque_Nm_per_s = 20.0 * c.step_N,
                                .beyond_hand_N_per_s = kInfinity,
                                .beyond_hand_Nm_per_s = kInfinity};
      rig.step({});
      rig.go(at(0, 0, -0.003), 500);
      const double most_N = c.step_N * 1000.0 / c.rate_Hz;
      double before_N = rig.report.smoothed.f.z();
      double force_N = 0.0;
      int full_steps = 0;
      int frames = 0;
      for (; frames < 4000; ++frames) {
        rig.step(at(0, 0, -0.003 - c.depth));
        force_N = rig.report.coupling.f.z();
        const double rise_N = rig.report.smoothed.f.z() - before_N;
        ASSERT_LE(rise_N, most_N * (1.0 + 1e-12));
        if (rise_N > most_N * (1.0 - 1e-9)) ++full_steps;
        before_N = rig.report.smoothed.f.z();
        if (before_N == force_N) break;
      }
      EXPECT_GT(force_N, 2.0 * most_N);
      EXPECT_EQ(before_N, force_N);
      if (response == ResponseModel::kConstraint) {  // the whole force is there at once
        EXPECT_NEAR(force_N, 600.0 * c.depth, 0.01);
        EXPECT_NEAR(full_steps, force_N / most_N - 1.0, 1.0);
      }
    }
}

struct Bar {
  int sides = 24;
  double radius_m = 0.02;
  double beside = 0.5;  // of half a facet: where the corner is pressed on it
  double depth = 0.5e-3;
  double rate_Hz = 1000.0;
};

/// A corner is pressed on a facet of a bar, beside the facet's middle. The normal that is interpolated
/// between those of the facet's two edges is there the radius of the bar through the corner.
TEST(FramePath, AFacetedBarPushesAlongItsRadius) {
  for (const ResponseModel response : kResponses)
    for (const Bar& c : {Bar{}, Bar{.sides = 12}, Bar{.sides = 60, .beside = -0.7}, Bar{.radius_m = 0.2},
                         Bar{.depth = 1e-3}, Bar{.rate_Hz = 500.0}, Bar{.rate_Hz = 4000.0}}) {
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", " << c.sides << " sides of "
                                        << c.radius_m << " m, at " << c.beside << ", " << c.rate_Hz << " Hz");
      const double half_rad = kPi / c.sides;
      const double top = c.radius_m * std::cos(half_rad);
      const double beside_m = c.beside * c.radius_m * std::sin(half_rad);
      Rig rig(2);
      rig.settings.response = response;
      rig.settings.dt_s = 1.0 / c.rate_Hz;
      // A cube on its corner, which is the handle: the coupling's force has no lever.
      const double half_m = 0.004;
      const Vec3 corner_B(-half_m, -half_m, -half_m);
      rig.world.bodies[0].part = solid_box({half_m, half_m, half_m});
      rig.world.bodies[0].X_WB.R = testing::rotation_between(corner_B.normalized(), -Vec3::UnitZ());
      const Vec3 start(beside_m, 0.0, top + 1e-4);
      rig.world.bodies[0].X_WB.p = start - rig.world.bodies[0].X_WB.R * corner_B;
      rig.settings.tool.X_BH.p = corner_B;
      // The axis of the bar is y; a facet lies on top.
      rig.world.bodies[1].part = solid_of(make_prism(c.sides, c.radius_m, 0.1));
      rig.world.bodies[1].X_WB.R = exp_rotation({kPi / 2, 0, 0}) * exp_rotation({0, 0, kPi / 2 + half_rad});
      rig.world.bodies[1].joint.kind = JointKind::kFixed;
      rig.step({});
      rig.go(at(0, 0, -1e-4 - c.depth), 300);
      for (int i = 0; i < 1500; ++i) rig.step(rig.X_DH);
      const Vec3 corner_W = rig.X_WB() * corner_B;
      const Vec3 F = rig.report.restoring.f;
      ASSERT_GT(F.z(), 0.05);
      EXPECT_LT(std::abs(corner_W.x()), c.radius_m * std::sin(half_rad));  // it is on the facet
      EXPECT_NEAR(std::atan2(F.x(), F.z()), std::atan2(corner_W.x(), corner_W.z()), 0.02 * half_rad);
      EXPECT_GT(std::abs(std::atan2(F.x(), F.z())), 0.1 * half_rad);
    }
}

struct Turning {
  double length_m = 0.1;
  double rate_rad_per_s = 2.0;
  double rate_Hz = 1000.0;
  bool grasped = false;
};

/// The margin of a bar that turns about its middle is the arc of its farthest point in a frame, and what is
/// added to it so that contacts at rest are kept.
TEST(FramePath, TheMarginHoldsTheTurnOfABody) {
  for (const ResponseModel response : kResponses)
    for (const Turning& c :
         {Turning{}, Turning{.length_m = 0.01, .rate_rad_per_s = 30.0}, Turning{.length_m = 1.0},
          Turning{.rate_rad_per_s = 8.0}, Turning{.rate_Hz = 500.0},
          Turning{.rate_rad_per_s = 20.0, .rate_Hz = 4000.0}, Turning{.grasped = true}}) {
      // The margin of a grasped part in the constraint response is the length that its steps are trusted for.
      if (c.grasped && response == ResponseModel::kConstraint) continue;
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", " << c.length_m << " m, "
                                        << c.rate_rad_per_s << " rad/s, " << c.rate_Hz << " Hz");
      const double dt_s = 1.0 / c.rate_Hz;
      const Vec3 half_m = 0.5 * c.length_m * Vec3(1.0, 0.1, 0.1);
      const double arc_m = half_m.norm() * c.rate_rad_per_s * dt_s;
      Sandbox box;
      box.settings.response = response;
      box.settings.dt_s = dt_s;
      const Twist turning{Vec3::Zero(), {0, 0, c.rate_rad_per_s}};
      box.add(make_box(half_m), {}, c.grasped ? Twist{} : turning);
      box.add_fixed(make_box(Vec3::Constant(0.1 * c.length_m)),
                    {Mat3::Identity(), {0, 0, half_m.z() + 0.1 * c.length_m + 0.5 * arc_m}});
      if (c.grasped) box.settings.tool.body = 0;
      for (int frame = 0; frame < 4; ++frame) {
        DeviceSample sample;
        sample.valid = true;
        if (c.grasped) sample.X_DH.R = exp_rotation({0, 0, frame * c.rate_rad_per_s * dt_s});
        sample.time_s = frame * dt_s;
        box.step(sample);
      }
      EXPECT_GE(box.report.tolerance_m, arc_m * (1.0 - 1e-3));
      EXPECT_LE(box.report.tolerance_m, arc_m * (1.0 + 1e-3) + 1e-4 * c.length_m);
    }
}

struct GraspedJoint {
  JointKind kind = JointKind::kSlider;
  double stiffness = 300.0;  // [N/m or N m/rad]
  double damping = 0.0;      // [N s/m or N m s/rad]
  double hand = 0.01;        // how far the hand goes [m or rad]
  double rate_Hz = 1000.0;
};

/// At rest the coupling and the joint's spring are in series. Of a damper the hand feels damping times speed.
TEST(FramePath, TheJointOfAGraspedPartIsFelt) {
  constexpr JointKind kHinge = JointKind::kHinge;
  for (const ResponseModel response : kResponses)
    for (const GraspedJoint& c :
         {GraspedJoint{}, GraspedJoint{.stiffness = 2000.0}, GraspedJoint{.hand = -0.002},
          GraspedJoint{.rate_Hz = 500.0}, GraspedJoint{.rate_Hz = 4000.0},
          GraspedJoint{.kind = kHinge, .stiffness = 0.3, .hand = 0.5},
          GraspedJoint{.kind = kHinge, .stiffness = 0.05, .hand = -0.2, .rate_Hz = 2000.0},
          GraspedJoint{.stiffness = 0.0, .damping = 20.0},
          GraspedJoint{.kind = kHinge, .stiffness = 0.0, .damping = 0.02, .hand = 0.5}}) {
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", joint " << int(c.kind) << ", "
                                        << c.stiffness << ", " << c.damping << ", " << c.rate_Hz << " Hz");
      Rig rig(1);
      rig.settings.response = response;
      rig.settings.dt_s = 1.0 / c.rate_Hz;
      rig.world.bodies[0].part = solid_box({0.01, 0.01, 0.01});
      rig.world.bodies[0].joint = {.kind = c.kind, .damping = c.damping, .stiffness = c.stiffness};
      const bool turns = c.kind == kHinge;
      const auto hand_at = [&](double q) { return turns ? at(0, 0, 0, {0, 0, q}) : at(0, 0, q); };
      rig.step({});
      rig.go(hand_at(c.hand), static_cast<int>(c.rate_Hz));  // in one second
      const auto felt = [&] { return turns ? rig.report.coupling.t.z() : rig.report.coupling.f.z(); };
      if (c.damping > 0.0) {
        EXPECT_NEAR(felt(), -c.damping * c.hand, 1e-3 * std::abs(c.damping * c.hand));
        continue;
      }
      for (int i = 0; i < static_cast<int>(c.rate_Hz); ++i) rig.step(rig.X_DH);
      const double coupling = turns ? 0.3 : 600.0;
      const double position = c.hand * coupling / (coupling + c.stiffness);
      EXPECT_NEAR(felt(), -c.stiffness * position, 1e-6 * std::abs(c.stiffness * position));
      EXPECT_NEAR(joint_position(rig.world.bodies[0], rig.X_WB()), position, 1e-6 * std::abs(position));
    }
}

struct Bounce {
  JointKind kind = JointKind::kHinge;
  double size_m = 0.02;
  double height_m = 0.05;
  double restitution = 0.5;
  double rate_Hz = 1000.0;
};

/// The speed of a cube a while after it fell on a plate of this joint.
double speed_after_bounce(const Bounce& c, const Joint& joint) {
  Sandbox box;
  box.settings.dt_s = 1.0 / c.rate_Hz;
  box.world.gravity_W = {0, 0, -9.81};  // [m/s^2]
  const double half_m = 0.5 * c.size_m;
  box.add(make_box(Vec3::Constant(half_m)), at(0, 0, half_m + c.height_m));
  box.add(make_box(c.size_m * Vec3(3, 3, 0.5)), at(0, 0, -half_m), {}, joint);
  box.bounce(c.restitution);
  const double fall_s = std::sqrt(2.0 * c.height_m / 9.81);
  box.run(fall_s * (1.0 + c.restitution));
  return box.V(0).v.z();
}

/// Weight moves no plate that turns about a vertical axis, or slides along a level one: a cube that falls on
/// it bounces as on a fixed plate.
TEST(FramePath, ACubeBouncesOnAJointedPlateAsOnAFixedOne) {
  for (const Bounce& c :
       {Bounce{}, Bounce{.kind = JointKind::kSlider}, Bounce{.size_m = 0.1, .height_m = 0.2},
        Bounce{.restitution = 1.0}, Bounce{.rate_Hz = 500.0}, Bounce{.height_m = 0.01, .rate_Hz = 4000.0}}) {
    SCOPED_TRACE(::testing::Message() << "joint " << int(c.kind) << ", " << c.size_m << " m, e "
                                      << c.restitution << ", " << c.rate_Hz << " Hz");
    const Vec3 axis = c.kind == JointKind::kHinge ? Vec3::UnitZ() : Vec3::UnitX();
    const double fixed = speed_after_bounce(c, {.kind = JointKind::kFixed});
    const double jointed = speed_after_bounce(c, {.kind = c.kind, .axis_W = axis});
    const double falls = std::sqrt(2.0 * 9.81 * c.height_m);
    const double skin_m = 5e-5 * c.size_m;  // [m/m] at most, of the plate: bodies meet where their skins do
    EXPECT_NEAR(jointed, fixed, 9.81 * (1.0 + c.restitution) * skin_m / falls);
    EXPECT_LT(std::abs(fixed), 0.1 * falls);  // it is at its highest then
  }
}

/// A caller's stage that pushes the hand on as it moves: it generates energy.
class PushOn final : public ForceStage {
 public:
  PushOn(double gain_Ns_per_m, double dt_s) : gain_Ns_per_m_(gain_Ns_per_m), dt_s_(dt_s) {}
  Wrench apply(const Wrench& /*F_D*/, const DeviceSample& sample,
               const FrameReport& /*report*/) noexcept override {
    const Vec3 moved = known_ ? Vec3(sample.X_DH.p - last_) : Vec3(Vec3::Zero());
    last_ = sample.X_DH.p;
    known_ = true;
    generated_J_ += gain_Ns_per_m_ / dt_s_ * moved.squaredNorm();
    return {gain_Ns_per_m_ / dt_s_ * moved, Vec3::Zero()};
  }
  double generated_J() const { return generated_J_; }

 private:
  double gain_Ns_per_m_, dt_s_;
  double generated_J_ = 0.0;
  bool known_ = false;
  Vec3 last_ = Vec3::Zero();
};

struct Pushed {
  double gain_Ns_per_m = 20.0;
  double rate_Hz = 1000.0;
  double frequency_Hz = 2.0;
  Vec3 along = Vec3::UnitX();
};

/// The hand moves to and fro in free space. Whatever the stage generates, no more than the credit of the
/// balance is given to the hand: what the stage adds fades as its tank runs dry.
TEST(FramePath, TheHandIsGivenNoEnergyThatAStageGenerates) {
  for (const ResponseModel response : kResponses)
    for (const Pushed& c : {Pushed{}, Pushed{.gain_Ns_per_m = 5.0}, Pushed{.rate_Hz = 4000.0},
                            Pushed{.frequency_Hz = 3.0}, Pushed{.along = Vec3(0.6, 0.0, 0.8)}}) {
      SCOPED_TRACE(::testing::Message() << "response " << int(response) << ", " << c.gain_Ns_per_m
                                        << " N s/m, " << c.rate_Hz << " Hz, " << c.frequency_Hz << " Hz");
      World world;
      add_body(world, {.part = solid_box({0.01, 0.01, 0.01}), .mass_kg = 1e-6 /* kg */});
      DeviceInfo device;
      device.actuates_force = device.senses_rotation = true;
      device.max_force_N = 20.0;
      device.max_stiffness_N_per_m = 2000.0;
      FrameSettings settings = settings_for(device, c.rate_Hz);
      settings.response = response;
      settings.tool.body = 0;
      const auto simulation = std::move(*Simulation::make(std::move(world), settings));
      PushOn stage(c.gain_Ns_per_m, settings.dt_s);
      simulation->set_force_stage(&stage);
      double given_J = 0.0;
      Vec3 sent = Vec3::Zero();
      Pose X_DH;
      for (int i = 1; i < static_cast<int>(2.0 * c.rate_Hz); ++i) {
        const Vec3 next = 0.01 * std::sin(2.0 * kPi * c.frequency_Hz * i / c.rate_Hz) * c.along;
        given_J += sent.dot(next - X_DH.p);
        X_DH.p = next;
        sent = simulation->step(X_DH).f;
      }
      EXPECT_GT(stage.generated_J(), 10.0 * settings.port.credit_J);
      EXPECT_LT(given_J, 2.0 * settings.port.credit_J);
    }
}

}  // namespace
}  // namespace tactum::frame_path_test
