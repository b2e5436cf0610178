#include "tactum/loop/passivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "support/pressed_block.h"
#include "tactum/base/random.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/math/screw.h"

namespace tactum::passivity_test {
namespace {

constexpr double kPeriod_s = 0.001;

/// A spring about the origin, whose stiffness is the share that the stage leaves, and the stage around it,
/// led along a given path. It need not state what it has stored.
struct Spring {
  double K = 1000.0;        // [N/m]
  double K_turning = 10.0;  // [N m/rad]
  bool states_energy = true;
  PortSettings settings;
  PortState state;
  PortReport report;
  Wrench sent;

  void go(const Pose& X_DH) {
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH = X_DH;
    PortInput input;
    const double share = state.booked.stiffness_share;
    const Vec3 turn = log_rotation(X_DH.R);
    input.felt = input.wanted = {-share * K * X_DH.p, -share * K_turning * turn};
    input.sent = sent;
    input.dt_s = kPeriod_s;
    if (states_energy) {
      input.stored.spring_J = input.stored.total_J =
          0.5 * share * (K * X_DH.p.squaredNorm() + K_turning * turn.squaredNorm());
      input.stored.force_N = input.felt.f.norm();
      input.stored.torque_Nm = input.felt.t.norm();
    }
    sent = passive_wrench(settings, state, handle_motion(state, sample), input, report);
  }
};

TEST(Passivity, TheBalanceOfASampledSpringIsKnownExactly) {
  // - f_(n-1) (x_n - x_(n-1)), summed over a spring f = - K x, is  K x_N^2 / 2 - K / 2 sum (x_n - x_(n-1))^2:
  // what the spring holds, less the energy that sampling has generated.
  for (const bool stated : {false, true}) {
    Random random(11);
    Spring spring;
    spring.states_energy = stated;
    spring.settings.credit_J = std::numeric_limits<double>::infinity();
    Vec3 x = Vec3::Zero(), turn = Vec3::Zero();
    double squares = 0.0;  // [J]
    spring.go({});
    const double first_J = spring.report.balance_J;
    for (int i = 0; i < 5000; ++i) {
      Vec3 step(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const double turn_step = random.uniform(-0.01, 0.01);
      x += step *= 1e-4;
      turn.z() += turn_step;  // about one axis, where turns add up
      squares += 500.0 * step.squaredNorm() + 5.0 * turn_step * turn_step;
      spring.go({exp_rotation(turn), x});
    }
    const double left_J = stated ? 0.0 : 500.0 * x.squaredNorm() + 5.0 * turn.squaredNorm();
    EXPECT_NEAR(spring.report.balance_J - first_J, left_J - squares, 1e-9);
    EXPECT_GT(squares, 0.1) << "sampling generates energy";
  }
}

TEST(Passivity, TheTotalsAreTheWorkEitherWay) {
  Random random(13);
  Spring spring;
  spring.settings.credit_J = std::numeric_limits<double>::infinity();
  double from_hand = 0.0, to_hand = 0.0, turned = 0.0;
  Vec3 x = Vec3::Zero(), turn = Vec3::Zero();
  spring.go({});
  for (int i = 0; i < 5000; ++i) {
    const Vec3 before = x;
    const double turn_before = turn.z();
    const Wrench sent = spring.sent;
    x = 0.3 * x + 1e-3 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    turn.z() = 0.3 * turn.z() + random.uniform(-0.01, 0.01);
    spring.go({exp_rotation(turn), x});
    const double work = sent.f.dot(x - before);
    (work > 0.0 ? to_hand : from_hand) += std::abs(work);
    turned += sent.t.z() * (turn.z() - turn_before);
  }
  const EnergyTotals& total = spring.report.total;
  const EnergyTotals& turning = spring.report.total_turning;
  EXPECT_NEAR(total.from_hand_J, from_hand, 1e-9);
  EXPECT_NEAR(total.to_hand_J, to_hand, 1e-9);
  EXPECT_NEAR(turning.to_hand_J - turning.from_hand_J, turned, 1e-9);
  EXPECT_GT(total.to_hand_J, 0.1);
}

TEST(Passivity, DampingOfHalfThePeriodTimesStiffnessIsEnoughAndNecessary) {
  // [Colgate and Schenkel 1994]: b > K T / 2, here as an identity of the balance, for any path whatever. The
  // delay of a whole frame asks for b > K 3 T / 2 of a path that goes to and fro.
  for (const double share : {1.0, 0.9}) {
    Random random(12);
    Spring spring;
    spring.settings.damping_Ns_per_m = share * spring.K * kPeriod_s / 2;
    double lowest = 0.0;
    Vec3 x = Vec3::Zero();
    spring.go({});
    for (int i = 0; i < 20000; ++i) {
      x = -0.2 * x + 1e-3 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      spring.go({Mat3::Identity(), x});
      lowest = std::min(lowest, spring.report.balance_J);
    }
    if (share == 1.0) {
      EXPECT_GE(lowest, -1e-9);
    } else {
      EXPECT_LT(lowest, -1e-3);
    }
  }
}

TEST(Passivity, ADelayIsPartOfTheBalance) {
  // A sine of frequency w and amplitude A against a spring that acts tau late does, each period, the work
  // pi K A^2 sin(w (tau + T / 2)) on the hand, whole frames of delay or parts of them.
  for (const double delay_s : {0.0, 0.5e-3, 1e-3, 2.3e-3, 10e-3}) {
    Spring spring;
    spring.settings.delay_s = delay_s;
    spring.settings.credit_J = std::numeric_limits<double>::infinity();
    constexpr int kPeriod = 200;  // frames
    const double w = 2.0 * kPi / (kPeriod * kPeriod_s);
    double before_J = 0.0;
    for (int i = 0; i <= 4 * kPeriod; ++i) {
      spring.go({Mat3::Identity(), {1e-3 * std::sin(w * i * kPeriod_s), 0, 0}});
      if (i == 3 * kPeriod) before_J = spring.report.balance_J;
    }
    const double generated_J = before_J - spring.report.balance_J;
    const double right_J = kPi * spring.K * 1e-6 * std::sin(w * (delay_s + 0.5 * kPeriod_s));
    EXPECT_NEAR(generated_J, right_J, 0.002 * right_J) << delay_s;
  }
}

TEST(Passivity, WhereNoEnergyIsMadeTheWrenchPassesUntouched) {
  Spring spring;
  spring.settings.keeps_balance = true;
  spring.settings.damping_Ns_per_m = 1.0;  // twice what is needed
  spring.settings.damping_Nms_per_rad = 0.01;
  for (int i = 0; i < 1000; ++i) {
    const Pose X{exp_rotation({0, 0.1 * std::sin(0.02 * i), 0}), {0, 0, 0.01 * std::sin(0.03 * i)}};
    spring.go(X);
    ASSERT_EQ(spring.sent.f, Vec3(-spring.K * X.p)) << i;
    ASSERT_EQ(spring.sent.t, Vec3(-spring.K_turning * log_rotation(X.R))) << i;
    ASSERT_EQ(spring.report.stiffness_share, 1.0);
  }
}

TEST(Passivity, TheSpringPaysForGeneratedEnergyWithoutAStep) {
  // Led to and fro at 100 Hz a sampled spring generates energy all the time; its stiffness sinks until it
  // generates no more than the device's damping eats.
  Spring spring;
  spring.settings.keeps_balance = true;
  spring.settings.damping_Ns_per_m = 0.1;  // enough for 200 N/m
  double stiffness = spring.K;
  for (int i = 0; i < 3000; ++i) {
    const double x = 1e-3 + 2e-4 * std::sin(0.2 * kPi * i);
    spring.go({Mat3::Identity(), {x, 0, 0}});
    const double now = spring.K * spring.report.stiffness_share;
    ASSERT_LE((stiffness - now) * x, 20.0 * kPeriod_s * (1.0 + 1e-9)) << "the felt force changes by 20 N/s";
    ASSERT_LE(now, stiffness);
    stiffness = now;
  }
  EXPECT_LT(stiffness, 210.0);
  EXPECT_GT(stiffness, 100.0) << "no softer than it must be";
  for (int i = 0; i < 10000; ++i) spring.go({});
  EXPECT_EQ(spring.report.stiffness_share, 1.0) << "in free air it comes back";
}

/// A spring that keeps a simulated device on a plane from both sides, like a part in a slot, knocked at in a
/// loose hand, without friction, which would calm it as well.
struct Swing {
  const char* device = "sigma.7";
  const char* grip = "loose";
  double stiffness_in_bounds = 2.0;
  double delay_s = 0.0;
  bool controlled = true;
};
struct Swung {
  double early_m_per_s = 0.0, late_m_per_s = 0.0;  // fastest in the first 0.1 s, and after 1 s
  double change_N_per_s = 0.0;                     // the fastest change of the controller's force
  double generated_late_J = 0.0;                   // at the true handle, after 1 s
};
Swung swing(const Swing& c) {
  SimulatedDeviceModel model = *simulated_device_preset(c.device);
  model.friction_N = 0.0;
  model.command_delay_s = c.delay_s;
  SimulatedDevice device(model, *hand_model(c.grip), nullptr);
  EXPECT_TRUE(device.open());
  device.place({}, {{0.02, 0, 0}, Vec3::Zero()});
  const double stiffness =
      c.stiffness_in_bounds * stiffness_allowed(model.damping_Ns_per_m + hand_model(c.grip)->damping_Ns_per_m,
                                                0.0, kPeriod_s, c.delay_s);
  PortSettings settings = port_settings(device.info());
  settings.keeps_balance = c.controlled;
  PortState state;
  PortReport report;
  Wrench sent;
  Swung result;
  Vec3 x_before = Vec3::Zero();
  for (int i = 0; i < 2000; ++i) {
    DeviceSample sample;
    device.read(i * kPeriod_s, sample);
    const double speed = device.true_twist().v.norm();
    if (i < 100) result.early_m_per_s = std::max(result.early_m_per_s, speed);
    if (i >= 1000) {
      result.late_m_per_s = std::max(result.late_m_per_s, speed);
      result.generated_late_J += device.motor_wrench().f.dot(device.true_pose().p - x_before);
    }
    x_before = device.true_pose().p;
    PortInput input;
    const double x = sample.X_DH.p.x();
    const double k = stiffness * state.booked.stiffness_share, most = model.max_force_N;
    input.felt.f.x() = input.wanted.f.x() = std::clamp(-k * x, -most, most);
    const double load = input.felt.f.norm();
    input.stored = {load * (std::abs(x) - 0.5 * load / k), load * (std::abs(x) - 0.5 * load / k), load, 0.0};
    input.sent = sent;
    const double share = state.booked.stiffness_share;
    sent = passive_wrench(settings, state, handle_motion(state, sample), input, report);
    result.change_N_per_s =
        std::max(result.change_N_per_s, load * (share - state.booked.stiffness_share) / share / kPeriod_s);
    device.write(sent);
  }
  return result;
}

TEST(Passivity, ASpringThatIsTooStiffForTheDeviceComesToRestWithinASecond) {
  for (const Swing& c : {Swing{}, Swing{.stiffness_in_bounds = 3.0}, Swing{.stiffness_in_bounds = 1.5},
                         Swing{.stiffness_in_bounds = 2.0, .delay_s = 1e-3},
                         Swing{.stiffness_in_bounds = 2.0, .delay_s = 2e-3}, Swing{.device = "omega.6"},
                         Swing{.device = "virtuose-6d", .grip = "medium"}, Swing{.device = "touch"},
                         Swing{.device = "premium-1.5-6dof", .delay_s = 1e-3}}) {
    SCOPED_TRACE(::testing::Message() << c.device << ", " << c.grip << ", " << c.stiffness_in_bounds
                                      << " bounds, delay " << c.delay_s);
    Swing free = c;
    free.controlled = false;
    const Swung wild = swing(free), tame = swing(c);
    std::printf("  %s %s %.1f bounds, %.1f ms: %.4f m/s alone, %.4f with it (%.4f at first), %.1f N/s\n",
                c.device, c.grip, c.stiffness_in_bounds, 1e3 * c.delay_s, wild.late_m_per_s,
                tame.late_m_per_s, tame.early_m_per_s, tame.change_N_per_s);
    EXPECT_GT(wild.late_m_per_s, 0.02) << "or there is nothing to tame";
    EXPECT_LT(tame.late_m_per_s, 0.004);
    EXPECT_LE(tame.change_N_per_s, 20.0 * (1.0 + 1e-9));
    EXPECT_LT(tame.generated_late_J, 1e-4);
  }
}

TEST(Passivity, NeitherCreditNorDebtOutlivesItsBound) {
  Spring spring;
  spring.settings.credit_J = 1e-3;
  spring.settings.damping_Ns_per_m = 50.0;  // eats a lot of energy in free motion
  spring.K = 0.0;
  for (int i = 0; i < 1000; ++i) spring.go({Mat3::Identity(), {0.01 * std::sin(0.1 * i), 0, 0}});
  EXPECT_EQ(spring.report.balance_J, 1e-3);
  spring.settings.keeps_balance = true;
  spring.settings.damping_Ns_per_m = 0.0;
  spring.sent.f.x() = 10.0;
  spring.go({Mat3::Identity(), {1.0, 0, 0}});  // a leap: 10 J
  EXPECT_NEAR(spring.report.generated_J, 10.0, 0.1) << "all of it is told";
  EXPECT_GE(spring.report.balance_J, -1e-3) << "but a debt that no spring can pay is not kept";
}

TEST(Passivity, EnergyThatBodiesGiveUpIsNoneThatWasMade) {
  // A weight of 1 N is lowered by 0.1 m: the hand is pushed all the way.
  for (const bool bodies_known : {true, false}) {
    PortSettings settings;
    settings.keeps_balance = true;
    PortState state;
    PortReport report;
    PortInput input;
    input.felt.f.z() = input.wanted.f.z() = -1.0;
    input.stored = {0.01, 0.01, 1.0, 0.0};
    for (int i = 0; i <= 1000; ++i) {
      DeviceSample sample;
      sample.valid = true;
      sample.X_DH.p.z() = -1e-4 * i;
      if (bodies_known) input.stored.total_J = 1.0 * sample.X_DH.p.z();
      input.sent = passive_wrench(settings, state, handle_motion(state, sample), input, report);
    }
    EXPECT_EQ(report.stiffness_share == 1.0, bodies_known);
  }
}

TEST(Passivity, WhatComesInByOneAxisMayLeaveByAnother) {
  // A frictionless thread of 2 mm pitch, turned steadily against 1 N along its axis: the work that the hand
  // does by turning it gets back by being pushed. With half the torque half of it is generated. On a device
  // that cannot drive the turn, its work counts as if it were felt.
  constexpr double kLead = 0.002 / (2.0 * kPi);  // [m/rad]
  for (const bool torque : {true, false})
    for (const double share : {1.0, 0.5}) {
      PortSettings settings;
      settings.keeps_balance = true;
      settings.actuates_torque = torque;
      PortState state;
      PortReport report;
      PortInput input;
      input.felt.f.z() = -1.0;
      (torque ? input.felt.t.z() : input.unfelt_Nm.z()) = share * kLead;
      input.wanted = input.felt;
      input.stored = {0.01, 0.01, 1.0, 0.0};
      for (int i = 0; i <= 5000; ++i) {
        DeviceSample sample;
        sample.valid = true;
        const double angle = -1e-3 * i;
        sample.X_DH = {exp_rotation({0, 0, angle}), {0, 0, kLead * angle}};
        // An encoder gives the displacement along the axis now and then only.
        sample.X_DH.p.z() = 1e-5 * std::ceil(sample.X_DH.p.z() / 1e-5);
        input.sent = passive_wrench(settings, state, handle_motion(state, sample), input, report);
        ASSERT_EQ(input.sent.t.z() != 0.0, torque);
      }
      EXPECT_EQ(report.stiffness_share == 1.0, share == 1.0) << "torque " << torque;
    }
}

TEST(Passivity, WhatTheCallersStageAddsMayGiveBackWhatItTookAndFadesBeyond) {
  // A guiding spring of the caller's, led out and back twice; then a push that never took anything.
  PortSettings settings;
  settings.keeps_balance = true;
  PortState state;
  PortReport report;
  PortInput input;
  double given_J = 0.0, x = 0.0;
  const auto go = [&](double to, double force) {
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH.p.x() = to;
    given_J += input.sent.f.x() * (to - x);
    x = to;
    input.wanted.f.x() = force;
    input.sent = passive_wrench(settings, state, handle_motion(state, sample), input, report);
  };
  for (int i = 0; i <= 2000; ++i) {
    const double to = 0.01 * (1.0 - std::cos(2.0 * kPi * i / 1000.0)) / 2.0;
    go(to, -400.0 * to);
    ASSERT_EQ(report.added_share, 1.0) << i;
    ASSERT_EQ(input.sent.f.x(), -400.0 * to);
  }
  EXPECT_NEAR(given_J, 0.0, 2e-4) << "but for sampling";
  given_J = 0.0;
  double last = input.sent.f.x();
  for (int i = 0; i < 2000; ++i) {
    go(x + 1e-4, 1.0);  // 0.1 W
    ASSERT_LT(i == 0 ? 0.0 : std::abs(input.sent.f.x() - last), 0.25) << "it fades";
    last = input.sent.f.x();
  }
  EXPECT_LT(given_J, 2.0 * settings.credit_J);
  EXPECT_LT(input.sent.f.x(), 0.01);
}

TEST(Passivity, ARampIsNotBooked) {
  Spring spring;
  spring.settings.keeps_balance = true;
  PortInput input;
  input.ramp = 0.5;
  DeviceSample sample;
  sample.valid = true;
  spring.go({});
  const double first_J = spring.report.balance_J;
  for (int i = 0; i < 100; ++i) {
    input.stored = {1e-3 * i, 1e-3 * i, 1.0, 0.0};  // the ramp lets the scene store without any work
    sample.X_DH.p.x() = 1e-4 * i;
    input.felt.f.x() = 1.0;
    passive_wrench(spring.settings, spring.state, handle_motion(spring.state, sample), input, spring.report);
    ASSERT_EQ(spring.report.balance_J, first_J);
    ASSERT_EQ(spring.report.stiffness_share, 1.0);
  }
}

TEST(Passivity, WhatIsNotANumberLeavesTheBalanceAsItWas) {
  for (int bad = 0; bad < 4; ++bad) {
    Spring spring;
    spring.settings.keeps_balance = true;
    spring.go({});
    spring.go({Mat3::Identity(), {1e-4, 0, 0}});
    const PortReport before = spring.report;
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH.p.x() = 2e-4;
    PortInput input;
    input.sent = spring.sent;
    (bad == 0   ? input.felt.f.x()
     : bad == 1 ? input.wanted.f.x()
     : bad == 2 ? input.unfelt_Nm.x()
                : input.stored.total_J) = std::nan("");
    passive_wrench(spring.settings, spring.state, handle_motion(spring.state, sample), input, spring.report);
    EXPECT_EQ(spring.report.balance_J, before.balance_J) << bad;
    spring.go({Mat3::Identity(), {3e-4, 0, 0}});
    EXPECT_TRUE(std::isfinite(spring.report.balance_J)) << bad;
    EXPECT_EQ(spring.report.added_share, 1.0) << bad;
    EXPECT_EQ(spring.sent.f.x(), -1000.0 * 3e-4) << bad;
  }
}

TEST(Passivity, ABadSampleIsNotBooked) {
  Spring spring;
  spring.go({});
  spring.go({Mat3::Identity(), {1e-3, 0, 0}});
  const double before = spring.report.balance_J;
  DeviceSample bad;
  bad.valid = true;
  bad.X_DH.p.x() = std::nan("");
  PortInput input;
  input.felt.f.x() = input.wanted.f.x() = 1.0;
  input.sent = spring.sent;
  EXPECT_EQ(
      passive_wrench(spring.settings, spring.state, handle_motion(spring.state, bad), input, spring.report)
          .f.x(),
      1.0);
  bad.X_DH.p.x() = 0.5;
  bad.valid = false;
  passive_wrench(spring.settings, spring.state, handle_motion(spring.state, bad), input, spring.report);
  EXPECT_EQ(spring.report.balance_J, before);
}

TEST(Passivity, AHandleThatCannotBeTurnedIsSentNoTorqueAndItsRotationFollows) {
  // A block pressed onto a plate off its middle, on a device that senses rotation and drives force only.
  World world = block_over_plate();
  SimulatedDevice device(*simulated_device_preset("touch"), *hand_model("medium"), pressing_hand(0.004));
  FrameSettings settings;
  settings.tool.body = 0;
  settings.coupling = coupling_gains(device.info(), 1000.0).coupling;
  settings.port = port_settings(device.info());
  settings.safety = safety_limits(device.info());
  FrameState state(world, settings);
  FrameReport report;
  ASSERT_TRUE(device.open());
  double computed = 0.0;
  for (int i = 0; i < 1500; ++i) {
    DeviceSample sample;
    FrameTick tick;
    tick.index = static_cast<std::uint64_t>(i);
    tick.now_s = i * kPeriod_s;
    device.read(tick.now_s, sample);
    device.write(haptic_frame(world, settings, sample, tick, state, report));
    computed = std::max(computed, report.coupling.t.norm());
    ASSERT_EQ(report.smoothed.t.norm(), 0.0);
    ASSERT_EQ(report.shown.t.norm(), 0.0);
    ASSERT_EQ(report.safety & safety_flag::kTorqueLimited, 0u) << "not wanted, so not limited";
    ASSERT_EQ(report.port.stiffness_share, 1.0) << "no energy comes out of a motor that is not there";
  }
  EXPECT_GT(computed, 1e-3) << "it is computed and can be shown on a screen";
  EXPECT_GT(report.shown.f.norm(), 0.5);
  const Vec3 intended = log_rotation(device.intended().X_DH.R);
  EXPECT_LT((log_rotation(device.true_pose().R) - intended).norm(), 0.05) << "the hand turns it as it likes";
}

}  // namespace
}  // namespace tactum::passivity_test
