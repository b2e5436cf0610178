#include "tactum/loop/safety.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tactum/base/random.h"

namespace tactum::safety_test {
namespace {

using namespace safety_flag;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1 + 1e-12;

DeviceInfo plain_info() {
  DeviceInfo info;
  info.max_force_N = 8.0;
  info.max_torque_Nm = 0.2;
  return info;
}

SafetyInput good_input(const Wrench& wanted) {
  SafetyInput input;
  input.wanted = wanted;
  input.sample_valid = true;
  return input;
}

/// The stage with its state, and the conditions of every frame checked on each call.
struct Stage {
  SafetyLimits limits = safety_limits(plain_info());
  SafetyState state;
  std::uint32_t flags = 0;

  Wrench frame(const SafetyInput& input) {
    const Wrench before = state.sent;
    flags = 0;
    const Wrench F = safe_wrench(limits, state, input, flags);
    EXPECT_TRUE(F.finite());
    EXPECT_LE(F.f.norm(), limits.max_force_N * kRounding);
    EXPECT_LE(F.t.norm(), limits.max_torque_Nm * kRounding);
    const bool dropped = (flags & (kFaults | kStopped)) != 0;
    if (dropped) {
      EXPECT_EQ(F.f.norm() + F.t.norm(), 0.0);
    } else {
      EXPECT_LE((F.f - before.f).norm(), limits.max_force_slew_N_per_s * input.period_s * kRounding);
      EXPECT_LE((F.t - before.t).norm(), limits.max_torque_slew_Nm_per_s * input.period_s * kRounding);
    }
    return F;
  }
  /// Runs until the start ramp is over.
  void start(const Wrench& wanted) {
    for (int i = 0; i < 600; ++i) frame(good_input(wanted));
    EXPECT_EQ(flags & kStarting, 0u);
  }
};

TEST(Safety, PassesAQuietWrenchUntouchedAfterTheStartRamp) {
  Stage stage;
  const Wrench wanted{{1, 2, -3}, {0.01, 0, 0.02}};
  const int ramp_frames = static_cast<int>(std::lround(stage.limits.start_ramp_s / 0.001));
  for (int i = 1; i < ramp_frames; ++i) {
    const Wrench F = stage.frame(good_input(wanted));
    EXPECT_NEAR(F.f.x(), 1.0 * i / ramp_frames, 1e-12) << "frame " << i;
    EXPECT_NE(stage.flags & kStarting, 0u);
  }
  stage.start(wanted);
  const Wrench F = stage.frame(good_input(wanted));
  EXPECT_EQ(F.f, wanted.f);
  EXPECT_EQ(F.t, wanted.t);
  EXPECT_EQ(stage.flags, 0u);
}

TEST(Safety, LimitsMagnitudesKeepingTheDirection) {
  Stage stage;
  const Wrench wanted{{300, 400, 0}, {0, -7, 0}};
  stage.start(wanted);
  const Wrench F = stage.frame(good_input(wanted));
  EXPECT_LT((F.f - Vec3(4.8, 6.4, 0)).norm(), 1e-14);
  EXPECT_LT((F.t - Vec3(0, -0.2, 0)).norm(), 1e-15);
  EXPECT_EQ(stage.flags, kForceLimited | kTorqueLimited);
}

TEST(Safety, SlewLimitSpreadsAFullStepOverFiveFrames) {
  Stage stage;
  stage.start({});
  int frames = 0;
  while (stage.frame(good_input({{8, 0, 0}, {0, 0, 0}})).f.x() < 8.0) {
    EXPECT_EQ(stage.flags, kForceSlewed);
    ASSERT_LT(++frames, 100);
  }
  EXPECT_LE(std::abs(frames - 4), 1) << "5 ms to full scale";
}

TEST(Safety, EveryFaultDropsToZeroAtOnceAndComesBackByTheRamp) {
  const Wrench wanted{{4, 0, 0}, {0, 0.1, 0}};
  const auto with = [&](auto change) {
    SafetyInput input = good_input(wanted);
    change(input);
    return input;
  };
  const struct {
    SafetyInput input;
    std::uint32_t flag;
  } cases[] = {
      {with([](SafetyInput& i) { i.wanted.f.y() = kNaN; }), kNonFiniteWrench},
      {with([](SafetyInput& i) { i.wanted.t.z() = kInfinity; }), kNonFiniteWrench},
      {with([](SafetyInput& i) { i.period_s = kNaN; }), kNonFiniteWrench},
      {with([](SafetyInput& i) { i.X_DH.p.x() = kNaN; }), kImplausiblePose},
      {with([](SafetyInput& i) { i.X_DH.R(1, 2) = kInfinity; }), kImplausiblePose},
      {with([](SafetyInput& i) { i.sample_age_s = 0.0201; }), kStaleSample},
      {with([](SafetyInput& i) { i.sample_age_s = kNaN; }), kStaleSample},
      {with([](SafetyInput& i) { i.sample_age_s = -1.0; }), kStaleSample},
      {with([](SafetyInput& i) { i.late = true; }), kMissedDeadline},
  };
  for (const auto& fault : cases) {
    Stage stage;
    stage.start(wanted);
    EXPECT_EQ(stage.frame(good_input(wanted)).f.x(), 4.0);
    const Wrench dropped = stage.frame(fault.input);
    EXPECT_EQ(stage.flags, fault.flag) << safety_flag_names(stage.flags);
    EXPECT_EQ(dropped.f.norm() + dropped.t.norm(), 0.0);
    const Wrench back = stage.frame(good_input(wanted));
    EXPECT_NEAR(back.f.x(), 4.0 * 0.001 / stage.limits.start_ramp_s, 1e-12) << "from zero, slowly";
  }
}

/// Reads may fail for less than 5 ms, at any rate.
TEST(Safety, AFewFailedReadsAreBorneMoreAreAFault) {
  for (const int rate_Hz : {500, 1000, 2000, 4000, 10000}) {
    SCOPED_TRACE(rate_Hz);
    Stage stage;
    const Wrench wanted{{4, 0, 0}, {0, 0, 0}};
    stage.start(wanted);
    SafetyInput good = good_input(wanted);
    good.period_s = 1.0 / rate_Hz;
    SafetyInput failed = good;
    failed.sample_valid = false;
    const int borne = int(std::ceil(0.005 * rate_Hz - 0.001)) - 1;
    for (int run = 0; run < 2; ++run) {
      for (int i = 1; i <= borne; ++i) EXPECT_EQ(stage.frame(failed).f.x(), 4.0) << "failed read " << i;
      stage.frame(good);  // a good one starts the time anew
    }
    for (int i = 1; i <= borne; ++i) EXPECT_EQ(stage.frame(failed).f.x(), 4.0);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(stage.frame(failed).f.x(), 0.0);
      EXPECT_EQ(stage.flags, kReadsFailing);
    }
  }
}

TEST(Safety, StopRampsToZeroWithinItsTimeAndCanBeTakenBack) {
  Stage stage;
  const Wrench wanted{{8, 0, 0}, {0, 0, -0.2}};
  stage.start(wanted);
  SafetyInput stopping = good_input(wanted);
  stopping.stop = true;
  const int frames = static_cast<int>(std::ceil(stage.limits.stop_ramp_s / 0.001));
  double last = 8.0;
  for (int i = 1; i <= frames + 1; ++i) {
    const Wrench F = stage.frame(stopping);
    EXPECT_LE(F.f.x(), last);
    EXPECT_LE(last - F.f.x(), 8.0 * 0.001 / stage.limits.stop_ramp_s * kRounding + 1e-12) << "no drop";
    last = F.f.x();
    EXPECT_NE(stage.flags & kStopping, 0u);
  }
  EXPECT_EQ(last, 0.0);
  EXPECT_NE(stage.flags & kStopped, 0u);
  stage.start(wanted);
  EXPECT_EQ(stage.frame(good_input(wanted)).f.x(), 8.0);
}

TEST(Safety, StopEndsInTimeEvenUnderATinySlewLimit) {
  Stage stage;
  const Wrench wanted{{8, 0, 0}, {0, 0, 0}};
  stage.start(wanted);
  SafetySettings settings;
  settings.max_force_slew_N_per_s = 1.0;
  stage.limits = tightened(stage.limits, settings);
  SafetyInput stopping = good_input(wanted);
  stopping.stop = true;
  const int frames = static_cast<int>(std::ceil(stage.limits.stop_ramp_s / 0.001)) + 1;
  for (int i = 0; i < frames; ++i) stage.frame(stopping);
  EXPECT_EQ(stage.state.sent.f.norm(), 0.0);
}

TEST(Safety, NoRandomInputGetsPastTheLimits) {
  // Wild wrenches, bursts of every fault, changing periods: Stage::frame checks each frame.
  Random random(61);
  Stage stage;
  for (int i = 0; i < 100000; ++i) {
    const double size = std::pow(10.0, random.uniform(-3.0, 3.0));
    Wrench wanted;
    for (int k = 0; k < 3; ++k) wanted.f[k] = random.uniform(-size, size);
    for (int k = 0; k < 3; ++k) wanted.t[k] = random.uniform(-size, size);
    if (random.index(500) == 0) wanted.f[random.index(3)] = random.index(2) ? kNaN : 1e308;
    SafetyInput input = good_input(wanted);
    input.period_s = random.index(10) ? 0.001 : random.uniform(0.0, 0.01);
    input.sample_valid = random.index(5) != 0;
    input.late = random.index(1000) == 0;
    input.stop = (i / 2000) % 5 == 4;
    if (random.index(1000) == 0) input.sample_age_s = 1.0;
    stage.frame(input);
    ASSERT_FALSE(HasFailure()) << "seed 61, frame " << i << ": " << safety_flag_names(stage.flags);
  }
}

TEST(Safety, SettingsOnlyTighten) {
  const SafetyLimits device = safety_limits(plain_info());
  SafetySettings loose;
  loose.max_force_N = 1000;
  loose.max_torque_Nm = kNaN;
  loose.max_force_slew_N_per_s = kInfinity;
  loose.start_ramp_s = -1;
  loose.stop_ramp_s = 60;
  const SafetyLimits same = tightened(device, loose);
  EXPECT_EQ(same.max_force_N, device.max_force_N);
  EXPECT_EQ(same.max_torque_Nm, device.max_torque_Nm);
  EXPECT_EQ(same.max_force_slew_N_per_s, device.max_force_slew_N_per_s);
  EXPECT_EQ(same.start_ramp_s, device.start_ramp_s);
  EXPECT_EQ(same.stop_ramp_s, device.stop_ramp_s);
  SafetySettings tight;
  tight.max_force_N = 2;
  tight.max_torque_Nm = -3;
  tight.start_ramp_s = 2;
  tight.stop_ramp_s = 0.01;
  const SafetyLimits less = tightened(device, tight);
  EXPECT_EQ(less.max_force_N, 2);
  EXPECT_EQ(less.max_torque_Nm, 0);
  EXPECT_EQ(less.start_ramp_s, 2);
  EXPECT_EQ(less.stop_ramp_s, 0.01);
}

TEST(Safety, ADeviceWithoutTorqueIsNeverSentOne) {
  DeviceInfo info = plain_info();
  info.max_torque_Nm = 0.0;
  Stage stage;
  stage.limits = safety_limits(info);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(stage.frame(good_input({{1, 0, 0}, {1, 1, 1}})).t.norm(), 0.0);
}

}  // namespace
}  // namespace tactum::safety_test
