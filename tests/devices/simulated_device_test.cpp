#include "tactum/devices/simulated_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tactum/base/random.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

/// A device without friction, steps, delay or velocity estimate; each test adds the property it tests.
SimulatedDeviceModel plain_model() {
  SimulatedDeviceModel model;
  model.name = "plain";
  model.mass_kg = 0.1;
  model.inertia_kg_m2 = 1e-4;
  model.max_force_N = 10.0;
  model.max_torque_Nm = 0.5;
  model.velocity_window_s = 0.0;
  model.workspace_radius_m = 1.0;
  return model;
}

HandModel plain_hand() {
  HandModel hand;
  hand.name = "plain";
  hand.mass_kg = 0.1;
  hand.inertia_kg_m2 = 1e-4;
  hand.stiffness_N_per_m = 300.0;
  hand.damping_Ns_per_m = 1.5;
  hand.stiffness_Nm_per_rad = 1.0;
  hand.damping_Nms_per_rad = 0.002;
  return hand;
}

/// x(t) of m x'' + b x' + k x = 0 from x(0) = x0 at rest, underdamped: the textbook's closed form.
double free_oscillation(double m, double b, double k, double x0, double t) {
  const double decay = b / (2.0 * m);
  const double omega = std::sqrt(k / m - decay * decay);
  return x0 * std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
}

/// Reads at 1 kHz from frame `first` to `last`, writing `F` after each.
DeviceSample run(SimulatedDevice& device, int first, int last, const Wrench& F) {
  DeviceSample sample;
  for (int i = first; i <= last; ++i) {
    EXPECT_TRUE(device.read(i * 0.001, sample));
    EXPECT_TRUE(device.write(F));
  }
  return sample;
}

TEST(SimulatedDevice, FreeOscillationFollowsTheClosedForm) {
  SimulatedDevice device(plain_model(), plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  const double x0 = 0.02;
  const double turn0 = 0.1;
  device.place({exp_rotation({0, 0, turn0}), {0, x0, 0}}, {});
  DeviceSample sample;
  double worst = 0.0;
  double worst_turn = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    ASSERT_TRUE(device.read(i * 0.001, sample));
    worst = std::max(worst, std::abs(sample.X_DH.p.y() - free_oscillation(0.2, 1.5, 300.0, x0, i * 0.001)));
    const double turn = log_rotation(sample.X_DH.R).z();
    worst_turn = std::max(worst_turn, std::abs(turn - free_oscillation(2e-4, 0.002, 1.0, turn0, i * 0.001)));
  }
  // Second order: the phase error over 6 and 11 oscillations at 0.1 ms is (omega h)^2 / 12 of the phase.
  EXPECT_LT(worst, 1e-4 * x0);
  EXPECT_LT(worst_turn, 3e-4 * turn0);
}

TEST(SimulatedDevice, SteadyStateIsForceOverStiffness) {
  SimulatedDevice device(plain_model(), plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  const DeviceSample sample = run(device, 0, 8000, {{3.0, -1.5, 0.6}, {0.05, 0.0, 0.1}});
  EXPECT_LT((sample.X_DH.p - Vec3(0.01, -0.005, 0.002)).norm(), 1e-12);
  EXPECT_LT((log_rotation(sample.X_DH.R) - Vec3(0.05, 0.0, 0.1)).norm(), 1e-9);
}

TEST(SimulatedDevice, HeldForceMovesAFreeHandleByTheBook) {
  SimulatedDevice device(plain_model(), no_hand(), nullptr);
  ASSERT_TRUE(device.open());
  const DeviceSample sample = run(device, 0, 200, {{0.1, 0, 0}, {0, 0, 0}});
  EXPECT_NEAR(sample.X_DH.p.x(), 0.5 * (0.1 / 0.1) * 0.2 * 0.2, 1e-12);
  EXPECT_NEAR(device.true_twist().v.x(), 0.2, 1e-12);
}

TEST(SimulatedDevice, CoulombFrictionHoldsAndBrakes) {
  SimulatedDeviceModel model = plain_model();
  model.friction_N = 0.5;
  SimulatedDevice device(model, no_hand(), nullptr);
  ASSERT_TRUE(device.open());
  const DeviceSample stuck = run(device, 0, 1000, {{0.499, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(stuck.X_DH.p, Vec3(Vec3::Zero())) << "a push below the friction moves nothing, not even slowly";
  // Thrown at 0.4 m/s it stops after v^2 m / (2 F) = 16 mm and stays.
  ASSERT_TRUE(device.write({}));
  device.place({}, {{0, 0.4, 0}, {0, 0, 0}});
  const DeviceSample stopped = run(device, 1001, 1300, {});
  EXPECT_NEAR(stopped.X_DH.p.y(), 0.016, 1e-8);
  EXPECT_EQ(device.true_twist().v, Vec3(Vec3::Zero()));
}

TEST(SimulatedDevice, EncodersQuantise) {
  SimulatedDeviceModel model = plain_model();
  model.encoder_step_m = 1e-3;
  model.encoder_step_rad = 0.01;
  SimulatedDevice device(model, plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  Random random(11);
  DeviceSample sample;
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-0.05, 0.05);
    const double y = random.uniform(-0.05, 0.05);
    const double angle = random.uniform(-1.0, 1.0);
    device.place({exp_rotation({angle, 0, 0}), {x, y, 0}}, {});
    ASSERT_TRUE(device.read(0.0, sample));
    EXPECT_LE(std::abs(sample.X_DH.p.x() - x), 0.5e-3 + 1e-12) << "seed 11, try " << i;
    const double steps = sample.X_DH.p.y() / 1e-3;
    EXPECT_NEAR(steps, std::round(steps), 1e-9) << "seed 11, try " << i;
    const double turns = log_rotation(sample.X_DH.R).x() / 0.01;
    EXPECT_NEAR(turns, std::round(turns), 1e-9) << "seed 11, try " << i;
    EXPECT_LE(std::abs(turns * 0.01 - angle), 0.005 + 1e-9) << "seed 11, try " << i;
  }
}

TEST(SimulatedDevice, CommandsActAfterTheDelay) {
  SimulatedDeviceModel model = plain_model();
  model.command_delay_s = 0.003;
  SimulatedDevice device(model, no_hand(), nullptr);
  ASSERT_TRUE(device.open());
  DeviceSample sample;
  for (int i = 0; i <= 10; ++i) {
    ASSERT_TRUE(device.read(i * 0.001, sample));
    // The write at 0 ms acts from 3 ms on: the handle has moved at 4 ms and not at 3 ms.
    EXPECT_EQ(sample.X_DH.p.x() > 0.0, i > 3) << "at " << i << " ms";
    ASSERT_TRUE(device.write({{1.0 + i, 0, 0}, {0, 0, 0}}));
    if (i > 3) {
      EXPECT_EQ(device.motor_wrench().f.x(), 1.0 + (i - 4)) << "at " << i << " ms";
    }
  }
}

TEST(SimulatedDevice, SaturatesKeepingTheDirection) {
  SimulatedDevice device(plain_model(), plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  run(device, 0, 1, {{30.0, 40.0, 0.0}, {0.0, 0.0, -5.0}});
  EXPECT_LT((device.motor_wrench().f - Vec3(6.0, 8.0, 0.0)).norm(), 1e-14);
  EXPECT_LT((device.motor_wrench().t - Vec3(0.0, 0.0, -0.5)).norm(), 1e-15);
  EXPECT_EQ(device.saturated_writes(), 2);
}

TEST(SimulatedDevice, RefusesNonFiniteWrenchesAndGoesLimp) {
  SimulatedDevice device(plain_model(), plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  run(device, 0, 5, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_FALSE(device.write({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, 0, 0}}));
  DeviceSample sample;
  ASSERT_TRUE(device.read(0.006, sample));
  EXPECT_EQ(device.motor_wrench().f, Vec3(Vec3::Zero()));
}

TEST(SimulatedDevice, WithoutTorqueMotorsNoTorqueActs) {
  for (const char* name : {"touch", "omega.6"}) {
    Result<SimulatedDeviceModel> model = simulated_device_preset(name);
    ASSERT_TRUE(model);
    SimulatedDevice device(*model, *hand_model("medium"), nullptr);
    ASSERT_TRUE(device.open());
    EXPECT_FALSE(device.info().actuates_torque) << name;
    run(device, 0, 500, {{0, 0, 0}, {1.0, 2.0, 3.0}});
    EXPECT_EQ(device.motor_wrench().t, Vec3(Vec3::Zero())) << name;
    EXPECT_EQ(log_rotation(device.true_pose().R), Vec3(Vec3::Zero())) << name;
  }
}

TEST(SimulatedDevice, WatchdogCutsTheWrenchAfterThirtyMilliseconds) {
  SimulatedDevice device(plain_model(), plain_hand(), nullptr);
  ASSERT_TRUE(device.open());
  run(device, 0, 5, {{1, 0, 0}, {0, 0, 0}});
  DeviceSample sample;
  for (int i = 6; i <= 60; ++i) {
    ASSERT_TRUE(device.read(i * 0.001, sample));
    const bool cut = device.motor_wrench().f.isZero(0.0);
    if (i <= 35) {
      EXPECT_FALSE(cut) << "at " << i << " ms, written at 5 ms";
    }
    if (i >= 36) {
      EXPECT_TRUE(cut) << "at " << i << " ms, written at 5 ms";
    }
  }
  EXPECT_EQ(device.watchdog_trips(), 1);
  run(device, 61, 62, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(device.motor_wrench().f.x(), 1.0) << "a new write wakes it";
}

TEST(SimulatedDevice, APassiveWorldMakesNoEnergy) {
  // Resting hand, no wrench: from any start, for stiff and soft hands, energy never rises.
  Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    SimulatedDeviceModel model = plain_model();
    model.friction_N = trial % 2 ? 0.3 : 0.0;
    model.damping_Ns_per_m = trial % 3 ? 0.1 : 0.0;
    HandModel hand = plain_hand();
    hand.stiffness_N_per_m = std::pow(10.0, random.uniform(1.0, 7.0));
    hand.damping_Ns_per_m = trial % 5 ? random.uniform(0.0, 20.0) : 0.0;
    hand.stiffness_Nm_per_rad = 0.0;
    hand.damping_Nms_per_rad = 0.0;
    SimulatedDevice device(model, hand, nullptr);
    ASSERT_TRUE(device.open());
    const Vec3 p(random.uniform(-0.1, 0.1), 0.0, 0.05);
    const Vec3 v(0.0, random.uniform(-1.0, 1.0), 0.5);
    device.place({Mat3::Identity(), p}, {v, {0, 0, 0}});
    DeviceSample sample;
    double energy = device.energy_J();
    const double rounding = 1e-12 * energy;
    for (int i = 0; i <= 500; ++i) {
      ASSERT_TRUE(device.read(i * 0.001, sample));
      ASSERT_LE(device.energy_J(), energy + rounding) << "seed 7, trial " << trial << ", frame " << i;
      energy = device.energy_J();
    }
  }
}

TEST(SimulatedDevice, WorkOfTheWrenchIsTheEnergyGained) {
  HandModel hand = plain_hand();
  hand.damping_Ns_per_m = 0.0;
  SimulatedDevice device(plain_model(), hand, nullptr);
  ASSERT_TRUE(device.open());
  Random random(8);
  DeviceSample sample;
  double work = 0.0;
  Vec3 p = device.true_pose().p;
  Wrench F;
  for (int i = 0; i <= 1000; ++i) {
    ASSERT_TRUE(device.read(i * 0.001, sample));
    work += F.f.dot(device.true_pose().p - p);  // the force was constant meanwhile
    p = device.true_pose().p;
    EXPECT_NEAR(device.energy_J(), work, 1e-12) << "seed 8, frame " << i;
    F.f = Vec3(random.uniform(-1, 1), 0.5, 0);
    ASSERT_TRUE(device.write(F));
  }
  EXPECT_GT(work, 1e-4);
}

TEST(SimulatedDevice, StopsAtTheWorkspaceEdge) {
  SimulatedDeviceModel model = plain_model();
  model.workspace_radius_m = 0.05;
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(0.3, {Mat3::Identity(), {0.2, 0.0, 0.0}});
  SimulatedDevice device(model, plain_hand(), motion);
  ASSERT_TRUE(device.open());
  DeviceSample sample;
  for (int i = 0; i <= 600; ++i) {
    ASSERT_TRUE(device.read(i * 0.001, sample));
    EXPECT_LE(device.true_pose().p.norm(), 0.05 + 1e-15);
  }
  EXPECT_NEAR(sample.X_DH.p.x(), 0.05, 1e-12);
}

TEST(SimulatedDevice, AJumpOfTheClockIsSleptThrough) {
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(2.0, {Mat3::Identity(), {0.1, 0.0, 0.0}});
  SimulatedDevice jumping(plain_model(), plain_hand(), motion);
  SimulatedDevice steady(plain_model(), plain_hand(), motion);
  ASSERT_TRUE(jumping.open());
  ASSERT_TRUE(steady.open());
  DeviceSample a;
  DeviceSample b;
  ASSERT_TRUE(jumping.read(5.0, a));  // the first read sets the clock
  ASSERT_TRUE(jumping.read(1e9, a));
  ASSERT_TRUE(steady.read(0.0, b));
  ASSERT_TRUE(steady.read(0.1, b));
  EXPECT_EQ(a.X_DH.p, b.X_DH.p) << "a thousand substeps, no more";
  EXPECT_NEAR(jumping.slept_s(), 1e9 - 5.1, 1e-6);
  EXPECT_FALSE(jumping.read(1e8, a)) << "time does not run backwards";
  EXPECT_FALSE(a.valid);
  EXPECT_FALSE(jumping.read(std::numeric_limits<double>::quiet_NaN(), a));
}

TEST(SimulatedDevice, VelocityEstimateFollowsASteadyHand) {
  SimulatedDeviceModel model = *simulated_device_preset("sigma.7");
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(1.0, {exp_rotation({0, 0, 0.5}), {0.05, 0.0, 0.0}}, MotionProfile::kSteady);
  SimulatedDevice device(model, *hand_model("firm"), motion);
  ASSERT_TRUE(device.open());
  DeviceSample sample;
  ASSERT_TRUE(device.read(0.0, sample));
  EXPECT_FALSE(sample.has_velocity) << "one reading is no velocity";
  for (int i = 1; i <= 900; ++i) ASSERT_TRUE(device.read(i * 0.001, sample));
  ASSERT_TRUE(sample.has_velocity);
  EXPECT_NEAR(sample.V_DH.v.x(), 0.05, 2 * model.encoder_step_m / model.velocity_window_s);
  EXPECT_NEAR(sample.V_DH.w.z(), 0.5, 2 * model.encoder_step_rad / model.velocity_window_s);
}

TEST(SimulatedDevice, SameCallsSameBits) {
  const auto final_sample = [] {
    auto motion = std::make_shared<ScriptedMotion>();
    motion->turn_about(0.5, {0.01, 0, 0}, Vec3::UnitZ(), 1.0);
    SimulatedDevice device(*simulated_device_preset("premium-1.5-6dof"), *hand_model("loose"),
                           std::make_shared<TremorMotion>(motion, physiological_tremor(1e-4, 1e-3, 5)));
    EXPECT_TRUE(device.open());
    return run(device, 0, 700, {{1, 2, 3}, {0.01, 0.02, 0.03}});
  };
  const DeviceSample a = final_sample();
  const DeviceSample b = final_sample();
  EXPECT_EQ(a.X_DH.p, b.X_DH.p);
  EXPECT_EQ(a.X_DH.R, b.X_DH.R);
  EXPECT_EQ(a.V_DH.w, b.V_DH.w);
}

TEST(SimulatedDevice, PresetsOpenAndFollowEveryGrip) {
  for (const SimulatedDeviceModel& model : simulated_device_presets()) {
    for (const char* grip : {"loose", "medium", "firm"}) {
      auto motion = std::make_shared<ScriptedMotion>();
      motion->move_to(0.5, {exp_rotation({0.2, 0.1, -0.3}), {0.02, -0.01, 0.03}});
      SimulatedDevice device(model, *hand_model(grip), motion);
      ASSERT_TRUE(device.open()) << model.name;
      const DeviceSample sample = run(device, 0, 3000, {});
      const HandModel hand = *hand_model(grip);
      // It rests where friction holds it against the hand's spring.
      const double tolerance = 1e-4 + model.friction_N / hand.stiffness_N_per_m;
      const double tolerance_rad = 2e-3 + model.friction_Nm / hand.stiffness_Nm_per_rad;
      EXPECT_LT((sample.X_DH.p - motion->end_pose().p).norm(), tolerance) << model.name << " " << grip;
      EXPECT_LT(log_rotation(sample.X_DH.R * motion->end_pose().R.transpose()).norm(), tolerance_rad)
          << model.name << " " << grip;
    }
  }
}

TEST(SimulatedDevice, BadModelsDoNotOpen) {
  SimulatedDeviceModel model = plain_model();
  model.mass_kg = 0.0;
  SimulatedDevice device(model, no_hand(), nullptr);
  const Result<void> opened = device.open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message().find("bad mass"), std::string::npos);
  DeviceSample sample;
  EXPECT_FALSE(device.read(0.0, sample));
  EXPECT_FALSE(device.write({}));
}

}  // namespace
}  // namespace tactum
