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

namespace tactum {
namespace {

constexpr double kPeriod_s = 0.001;

/// A spring of stiffness K about the origin, and the stage around it, led along a given path.
struct Spring {
  double K = 1000.0;        // [N/m]
  double K_turning = 10.0;  // [N m/rad]
  PortSettings settings;
  PortState state;
  PortReport report;
  Wrench sent;

  Spring() { settings.credit_J = settings.credit_turning_J = std::numeric_limits<double>::infinity(); }

  void go(const Pose& X_DH) {
    DeviceSample sample;
    sample.valid = true;
    sample.X_DH = X_DH;
    PortInput input;
    input.wanted = {-K * X_DH.p, -K_turning * log_rotation(X_DH.R)};
    input.sent = sent;
    sent = passive_wrench(settings, state, sample, input, report);
  }
};

TEST(Passivity, TheBalanceOfASampledSpringIsKnownExactly) {
  // - f_(n-1) (x_n - x_(n-1)), summed over a spring f = - K x, is  K x_N^2 / 2 - K / 2 sum (x_n - x_(n-1))^2:
  // the stored energy, less the energy that sampling has generated.
  Random random(11);
  Spring spring, turned;  // one that is moved and one that is turned: neither pays for the other
  Vec3 x = Vec3::Zero(), turn = Vec3::Zero();
  double squares = 0.0, turned_squares = 0.0;
  spring.go({});
  turned.go({});
  for (int i = 0; i < 5000; ++i) {
    Vec3 step(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double turn_step = random.uniform(-0.01, 0.01);
    x += step *= 1e-4;
    turn.z() += turn_step;  // about one axis, where turns add up
    squares += step.squaredNorm();
    turned_squares += turn_step * turn_step;
    spring.go({Mat3::Identity(), x});
    turned.go({exp_rotation(turn), Vec3::Zero()});
  }
  EXPECT_NEAR(spring.report.energy_balance_J, 500.0 * (x.squaredNorm() - squares), 1e-10);
  EXPECT_NEAR(turned.report.energy_balance_turning_J, 5.0 * (turn.squaredNorm() - turned_squares), 1e-9);
  EXPECT_LT(spring.report.energy_balance_J, spring.K * 0.5 * x.squaredNorm()) << "sampling makes energy";
}

TEST(Passivity, TheTotalsAreTheWorkEitherWayAndWhatTheControllerTookOut) {
  for (const double most : {0.0, 50.0}) {
    Random random(13);
    Spring spring;
    spring.settings.max_injected_Ns_per_m = most;
    spring.settings.max_injected_Nms_per_rad = 0.1 * most;
    double from_hand = 0.0, to_hand = 0.0, damped = 0.0, turned = 0.0, turned_damped = 0.0;
    Vec3 x = Vec3::Zero(), turn = Vec3::Zero();
    spring.go({});
    Wrench damper;  // the controller's part of the wrench
    for (int i = 0; i < 5000; ++i) {
      const Vec3 before = x;
      const double turn_before = turn.z();
      const Wrench sent = spring.sent;
      x = 0.3 * x + 1e-3 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      turn.z() = 0.3 * turn.z() + random.uniform(-0.01, 0.01);
      spring.go({exp_rotation(turn), x});
      const double work = sent.f.dot(x - before);
      (work > 0.0 ? to_hand : from_hand) += std::abs(work);
      damped -= damper.f.dot(x - before);
      turned += sent.t.z() * (turn.z() - turn_before);
      turned_damped -= damper.t.z() * (turn.z() - turn_before);
      damper = {spring.sent.f + spring.K * x, spring.sent.t + spring.K_turning * turn};
    }
    const EnergyTotals& total = spring.report.total;
    const EnergyTotals& turning = spring.report.total_turning;
    EXPECT_NEAR(total.from_hand_J, from_hand, 1e-9);
    EXPECT_NEAR(total.to_hand_J, to_hand, 1e-9);
    EXPECT_NEAR(total.damped_J, damped, 1e-9);
    EXPECT_NEAR(turning.to_hand_J - turning.from_hand_J, turned, 1e-9);
    EXPECT_NEAR(turning.damped_J, turned_damped, 1e-9);
    EXPECT_EQ(total.damped_J != 0.0, most > 0.0);
    // Without bounds the two balances together are the energy that came less the energy that went.
    const double kept = total.from_hand_J - total.to_hand_J + turning.from_hand_J - turning.to_hand_J;
    EXPECT_NEAR(spring.report.energy_balance_J + spring.report.energy_balance_turning_J, kept, 1e-9);
    EXPECT_GT(total.to_hand_J, 0.1);
  }
}

TEST(Passivity, DampingOfHalfThePeriodTimesStiffnessIsEnoughAndNecessary) {
  // [Colgate and Schenkel 1994]: b > K T / 2, here as an identity of the balance, for any path whatever.
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
      lowest = std::min(lowest, spring.report.energy_balance_J);
    }
    if (share == 1.0) {
      EXPECT_GE(lowest, -1e-9);
    } else {
      EXPECT_LT(lowest, -1e-3);
    }
  }
}

TEST(Passivity, WhereNoEnergyIsMadeTheWrenchPassesUntouched) {
  Spring spring;
  spring.settings.damping_Ns_per_m = 1.0;  // twice what is needed
  spring.settings.damping_Nms_per_rad = 0.01;
  spring.settings.max_injected_Ns_per_m = 100.0;
  spring.settings.max_injected_Nms_per_rad = 1.0;
  for (int i = 0; i < 1000; ++i) {
    const Pose X{exp_rotation({0, 0.1 * std::sin(0.02 * i), 0}), {0, 0, 0.01 * std::sin(0.03 * i)}};
    spring.go(X);
    ASSERT_EQ(spring.sent.f, Vec3(-spring.K * X.p)) << i;
    ASSERT_EQ(spring.sent.t, Vec3(-spring.K_turning * log_rotation(X.R))) << i;
    ASSERT_EQ(spring.report.injected_Ns_per_m, 0.0);
  }
}

TEST(Passivity, MadeEnergyIsTakenOutByDamping) {
  // Led to and fro at 100 Hz a sampled spring makes energy all the time; with the controller the balance
  // comes back to zero, and the wrench is the spring's and a damper's.
  for (const double most : {0.0, 50.0}) {
    Spring spring;
    spring.settings.max_injected_Ns_per_m = most;
    double least = 0.0;
    for (int i = 0; i < 2000; ++i) {
      spring.go({Mat3::Identity(), {1e-3 * std::sin(0.2 * kPi * i), 0, 0}});
      ASSERT_LE(spring.report.injected_Ns_per_m, most);
      ASSERT_GE(spring.report.injected_Ns_per_m, 0.0);
      least = std::min(least, spring.report.energy_balance_J);
    }
    if (most == 0.0) {
      EXPECT_LT(least, -0.1) << "watching only";
    } else {
      EXPECT_GT(least, -5e-4) << "never more than of one swing";
    }
  }
}

/// A spring that keeps a simulated device on a plane from both sides, like a part in a slot, knocked at in a
/// loose hand: how fast the handle still moves in the last half second, and the energy that the spring
/// generated meanwhile, computed at the true handle. Without friction and hard limits, which would calm it as
/// well.
struct Buzz {
  double speed_m_per_s = 0.0;
  double made_J = 0.0;
};
Buzz buzz(double stiffness, bool controlled) {
  SimulatedDeviceModel model = *simulated_device_preset("sigma.7");
  model.friction_N = 0.0;
  SimulatedDevice device(model, *hand_model("loose"), nullptr);
  EXPECT_TRUE(device.open());
  device.place({}, {{0.02, 0, 0}, Vec3::Zero()});
  PortSettings settings = port_settings(device.info(), 1.0 / kPeriod_s);
  if (!controlled) settings.max_injected_Ns_per_m = settings.max_injected_Nms_per_rad = 0.0;
  PortState state;
  PortReport report;
  Wrench sent;
  Vec3 x_before = Vec3::Zero();
  Buzz result;
  for (int i = 0; i < 2000; ++i) {
    DeviceSample sample;
    device.read(i * kPeriod_s, sample);
    if (i >= 1500) {
      result.speed_m_per_s = std::max(result.speed_m_per_s, device.true_twist().v.norm());
      result.made_J += sent.f.dot(device.true_pose().p - x_before);
    }
    x_before = device.true_pose().p;
    PortInput input;
    input.wanted.f.x() = std::clamp(-stiffness * sample.X_DH.p.x(), -12.0, 12.0);
    input.spring_J = 0.5 * stiffness * sample.X_DH.p.squaredNorm();
    input.sent = sent;
    sent = passive_wrench(settings, state, sample, input, report);
    device.write(sent);
  }
  return result;
}

TEST(Passivity, ASpringThatIsTooStiffForTheDeviceBuzzesLessWithTheController) {
  const double allowed = stiffness_allowed(0.5 + 3.0, 0.0, kPeriod_s, 0.0);
  const Buzz wild = buzz(2 * allowed, false);
  const Buzz tame = buzz(2 * allowed, true);
  std::printf("  twice the bound: %.4f m/s, made %.4f J; controlled: %.4f m/s, made %.4f J\n",
              wild.speed_m_per_s, wild.made_J, tame.speed_m_per_s, tame.made_J);
  EXPECT_GT(wild.speed_m_per_s, 0.05) << "or there is nothing to tame";
  EXPECT_GT(wild.made_J, 1e-3);
  EXPECT_LT(tame.speed_m_per_s, 0.2 * wild.speed_m_per_s);
  EXPECT_LT(tame.made_J, 0.1 * wild.made_J);
  // A tenth of the damping is left: from 20 mm/s, exp(- 0.1 b t / 2 m).
  EXPECT_LT(buzz(0.9 * allowed, false).speed_m_per_s, 0.012) << "within the bound it rings down";
}

TEST(Passivity, NeitherCreditNorDebtOutlivesItsBound) {
  Spring spring;
  spring.settings.credit_J = 1e-3;
  spring.settings.damping_Ns_per_m = 50.0;  // eats a lot of energy in free motion
  spring.K = 0.0;
  for (int i = 0; i < 1000; ++i) spring.go({Mat3::Identity(), {0.01 * std::sin(0.1 * i), 0, 0}});
  EXPECT_EQ(spring.report.energy_balance_J, 1e-3);
  spring.sent.f.x() = 10.0;
  spring.go({Mat3::Identity(), {1.0, 0, 0}});  // a leap: 10 J
  EXPECT_GE(spring.report.energy_balance_J, -1e-3);
}

TEST(Passivity, EnergyThatBodiesGiveUpIsNoneThatWasMade) {
  // A weight of 1 N is lowered by 0.1 m: the hand is pushed all the way.
  for (const bool bodies_known : {true, false}) {
    PortSettings settings;
    settings.max_injected_Ns_per_m = 10.0;
    PortState state;
    PortReport report;
    PortInput input;
    input.wanted.f.z() = -1.0;
    double injected = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      DeviceSample sample;
      sample.valid = true;
      sample.X_DH.p.z() = -1e-4 * i;
      if (bodies_known) input.bodies_J = 1.0 * sample.X_DH.p.z();
      input.sent = passive_wrench(settings, state, sample, input, report);
      injected = std::max(injected, report.injected_Ns_per_m);
    }
    if (bodies_known) {
      EXPECT_EQ(injected, 0.0);
    } else {
      EXPECT_GT(injected, 0.0) << "or this test could not fail";
    }
  }
}

TEST(Passivity, AScrewMayPassWorkFromTurningToPushing) {
  // A frictionless thread of 2 mm pitch, turned steadily against 1 N along its axis: the work that the hand
  // does by turning it gets back by being pushed. With half the torque half of it is generated.
  constexpr double kLead = 0.002 / (2.0 * kPi);  // [m/rad]
  for (const double share : {1.0, 0.5}) {
    PortSettings settings;
    settings.max_injected_Ns_per_m = 10.0;
    PortState state;
    PortReport report;
    PortInput input;
    input.wanted = {{0, 0, -1.0}, {0, 0, share * kLead}};
    double injected = 0.0;
    for (int i = 0; i <= 5000; ++i) {
      DeviceSample sample;
      sample.valid = true;
      const double angle = -1e-3 * i;
      sample.X_DH = {exp_rotation({0, 0, angle}), {0, 0, kLead * angle}};
      // An encoder gives the displacement along the axis now and then only.
      sample.X_DH.p.z() = 1e-5 * std::ceil(sample.X_DH.p.z() / 1e-5);
      input.sent = passive_wrench(settings, state, sample, input, report);
      injected = std::max(injected, report.injected_Ns_per_m);
    }
    if (share == 1.0) {
      EXPECT_EQ(injected, 0.0);
    } else {
      EXPECT_GT(injected, 0.0) << "or this test could not fail";
    }
  }
}

TEST(Passivity, ABadSampleIsNotBooked) {
  Spring spring;
  spring.go({});
  spring.go({Mat3::Identity(), {1e-3, 0, 0}});
  const double before = spring.report.energy_balance_J;
  DeviceSample bad;
  bad.valid = true;
  bad.X_DH.p.x() = std::nan("");
  PortInput input;
  input.wanted.f.x() = 1.0;
  input.sent = spring.sent;
  EXPECT_EQ(passive_wrench(spring.settings, spring.state, bad, input, spring.report).f.x(), 1.0);
  bad.X_DH.p.x() = 0.5;
  bad.valid = false;
  passive_wrench(spring.settings, spring.state, bad, input, spring.report);
  EXPECT_EQ(spring.report.energy_balance_J, before);
}

TEST(Passivity, AHandleThatCannotBeTurnedIsSentNoTorqueAndItsRotationFollows) {
  // A block pressed onto a plate off its middle, on a device that senses rotation and drives force only.
  World world = block_over_plate();
  SimulatedDevice device(*simulated_device_preset("touch"), *hand_model("medium"), pressing_hand(0.004));
  FrameSettings settings;
  settings.tool.body = 0;
  settings.coupling = coupling_gains(device.info(), 1000.0).coupling;
  settings.port = port_settings(device.info(), 1000.0);
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
    computed = std::max(computed, report.smoothed.t.norm());
    ASSERT_EQ(report.shown.t.norm(), 0.0);
    ASSERT_EQ(report.safety & safety_flag::kTorqueLimited, 0u) << "not wanted, so not limited";
    ASSERT_GE(report.port.energy_balance_turning_J, 0.0)
        << "no energy comes out of a motor that is not there";
    ASSERT_EQ(report.port.injected_Nms_per_rad, 0.0);
  }
  EXPECT_GT(computed, 1e-3) << "it is computed and can be shown on a screen";
  EXPECT_GT(report.shown.f.norm(), 0.5);
  const Vec3 intended = log_rotation(device.intended().X_DH.R);
  EXPECT_LT((log_rotation(device.true_pose().R) - intended).norm(), 0.05) << "the hand turns it as it likes";
}

}  // namespace
}  // namespace tactum
