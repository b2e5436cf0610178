/// Faults played into a running loop with real contact force: the output of the safety stage and the motors'
/// wrench are judged sample by sample. The table of docs/safety.md, row by row.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>

#include "support/add_body.h"
#include "support/faulty_device.h"
#include "support/pressed_block.h"
#include "tactum/base/random.h"
#include "tactum/loop/loop_thread.h"
#include "tactum/math/screw.h"

namespace tactum::safety_faults_test {
namespace {

using namespace safety_flag;

constexpr double kPeriod_s = 0.001;
constexpr double kRounding = 1 + 1e-12;
constexpr double kPressed_m = 0.008;
constexpr double kTremor_m = 30e-6;  // of a hand that rests on something
constexpr double kFaultFrom_s = 1.5, kFaultTo_s = 1.8;
constexpr double kSame =
    0.1;  // the handle's friction and a block that has crept leave a force this much apart
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One millisecond.
struct Moment {
  double now_s = 0.0;
  bool framed = false;  // false: the loop's thread was stalled
  Wrench sent;          // by the frame
  Wrench motors;        // the wrench that the hand has felt so far
  std::uint32_t safety = 0;
};

struct Change {
  double at_s;
  std::function<void(World&, FrameSettings&, FrameState&)> make;
};

/// A block pressed onto a plate by a simulated hand, and everything that may go wrong with it.
struct Experiment {
  World world = block_over_plate();
  FrameSettings settings;
  std::vector<FaultSpan> faults;
  std::vector<Change> changes;                // by time
  double stall_from_s = -1, stall_to_s = -1;  // no frame runs
  double max_still_s = 0.0;
  double tremor_m = 0.0;
  std::string device = "premium-1.5-6dof";
  bool rubs = true;  // the device has its friction
  DeviceInfo info;   // of the run

  std::vector<Moment> run(double seconds) {
    Result<SimulatedDeviceModel> model = simulated_device_preset(device);
    if (!rubs) model->friction_N = model->friction_Nm = 0.0;
    std::shared_ptr<const HandMotion> hand = pressing_hand(kPressed_m);
    if (tremor_m > 0.0)
      hand = std::make_shared<TremorMotion>(hand, physiological_tremor(tremor_m, tremor_m / 0.05, 7));
    SimulatedDevice handle(*model, *hand_model("medium"), hand);
    FaultyDevice broken(handle, faults);
    broken.info().max_still_s = max_still_s;
    info = broken.info();
    settings.tool.body = 0;
    settings.safety = safety_limits(info);
    FrameState state(world, settings);
    FrameReport report;
    DeviceSample sample;
    FrameTick tick;
    EXPECT_TRUE(broken.open());
    std::vector<Moment> moments;
    auto change = changes.begin();
    double last_frame_s = 0.0;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kPeriod_s)); ++i) {
      Moment moment;
      moment.now_s = tick.now_s = i * kPeriod_s;
      if (tick.now_s >= stall_from_s && tick.now_s < stall_to_s) {
        DeviceSample unseen;  // the hand and the device go on without reads
        handle.read(tick.now_s, unseen);
        moment.motors = handle.motor_wrench();
        moments.push_back(moment);
        continue;
      }
      for (; change != changes.end() && change->at_s <= tick.now_s; ++change)
        change->make(world, settings, state);
      tick.late = tick.now_s - last_frame_s > kPeriod_s + LoopSettings{}.late_limit_s;
      last_frame_s = tick.now_s;
      broken.read(tick.now_s, sample);
      moment.framed = true;
      moment.motors = handle.motor_wrench();
      moment.sent = haptic_frame(world, settings, sample, tick, state, report);
      moment.safety = report.safety;
      tick.refused = !broken.write(moment.sent);
      ++tick.index;
      moments.push_back(moment);
    }
    return moments;
  }
};

/// The conditions of every frame in any case: limits; no step above the slew but to zero; and after a fault
/// never more than the start ramp allows.
void expect_safe(const std::vector<Moment>& moments, const SafetyLimits& limits,
                 bool motors_reported = true) {
  Moment last;
  double fault_s = -1.0;  // of the last one; the loop's start is like one
  double last_fault_s = fault_s;
  for (const Moment& now : moments) {
    const std::string where = "at " + std::to_string(now.now_s) + " s: " + safety_flag_names(now.safety);
    ASSERT_TRUE(now.sent.finite()) << where;
    ASSERT_TRUE(now.motors.finite()) << where;
    ASSERT_LE(now.motors.f.norm(), limits.max_force_N * kRounding) << where;
    ASSERT_LE(now.motors.t.norm(), limits.max_torque_Nm * kRounding) << where;
    const double force_step = limits.max_force_slew_N_per_s * kPeriod_s * kRounding;
    const double torque_step = limits.max_torque_slew_Nm_per_s * kPeriod_s * kRounding;
    if (motors_reported && !is_zero(now.motors)) {
      ASSERT_LE((now.motors.f - last.motors.f).norm(), force_step) << where;
      ASSERT_LE((now.motors.t - last.motors.t).norm(), torque_step) << where;
    }
    if (now.framed) {
      ASSERT_LE(now.sent.f.norm(), limits.max_force_N * kRounding) << where;
      ASSERT_LE(now.sent.t.norm(), limits.max_torque_Nm * kRounding) << where;
      if (now.safety & kFaults) {
        ASSERT_TRUE(is_zero(now.sent)) << where;
        last_fault_s = now.now_s;
      } else {
        ASSERT_LE((now.sent.f - last.sent.f).norm(), force_step) << where;
        ASSERT_LE((now.sent.t - last.sent.t).norm(), torque_step) << where;
        const double since = (now.now_s - std::max(0.0, last_fault_s) + kPeriod_s) / limits.start_ramp_s;
        ASSERT_LE(now.sent.f.norm(), limits.max_force_N * std::min(1.0, since) * kRounding) << where;
      }
      last.sent = now.sent;
    }
    last.motors = now.motors;
  }
}

const Moment& at(const std::vector<Moment>& moments, double time_s) {
  return moments[static_cast<std::size_t>(std::lround(time_s / kPeriod_s))];
}

/// The frames from a time on until the first with an exactly zero wrench, itself not counted; the time in
/// milliseconds that the hand is still pushed.
int frames_until_zero(const std::vector<Moment>& moments, double from_s) {
  int frames = 0;
  for (auto moment = &at(moments, from_s); !is_zero(moment->sent); ++moment) ++frames;
  return frames;
}

std::uint32_t faults_between(const std::vector<Moment>& moments, double from_s, double to_s) {
  std::uint32_t flags = 0;
  for (const Moment& now : moments)
    if (now.now_s >= from_s && now.now_s < to_s) flags |= now.safety & kFaults;
  return flags;
}

struct Row {
  Fault fault;
  std::uint32_t flag;  // that is reported
  int pushed_ms;       // frames until the wrench is zero
};

class DeviceFault : public ::testing::TestWithParam<Row> {};

TEST_P(DeviceFault, IsToldInTimeAndEndsInZeroAndComesBackSmoothly) {
  const Row& row = GetParam();
  Experiment experiment;
  experiment.faults = {{row.fault, kFaultFrom_s, kFaultTo_s, {}}};
  const std::vector<Moment> moments = experiment.run(3.2);
  expect_safe(moments, experiment.settings.safety);
  const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
  EXPECT_GT(before.norm(), 1.0) << "there was a force to take away";
  EXPECT_EQ(faults_between(moments, 0.0, kFaultFrom_s), 0u);
  EXPECT_EQ(frames_until_zero(moments, kFaultFrom_s), row.pushed_ms);
  EXPECT_EQ(faults_between(moments, kFaultFrom_s, kFaultTo_s + 2 * kPeriod_s), row.flag)
      << safety_flag_names(faults_between(moments, kFaultFrom_s, kFaultTo_s + 2 * kPeriod_s));
  // Zero until the fault is over, the very same force when the ramp is.
  for (const Moment& now : moments) {
    if (now.now_s < kFaultFrom_s + row.pushed_ms * kPeriod_s || now.now_s >= kFaultTo_s) continue;
    ASSERT_TRUE(is_zero(now.sent)) << now.now_s;
  }
  EXPECT_LT((moments.back().sent.f - before).norm(), kSame * before.norm());
  EXPECT_EQ(moments.back().safety & (kFaults | kStarting), 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Table, DeviceFault,
    ::testing::Values(Row{Fault::kReadsFail, kReadsFailing | kStaleSample, 4},
                      Row{Fault::kRepeated, kStaleSample, 19}, Row{Fault::kNotFinite, kImplausiblePose, 0},
                      Row{Fault::kZeros, kImplausiblePose, 0}, Row{Fault::kWildTime, kStaleSample, 0},
                      Row{Fault::kRefuses, kWrenchRefused, 1}, Row{Fault::kMotorsOff, kMotorsOff, 0}));

TEST(SafetyFaults, AFewLostReadsAreNotFelt) {
  Experiment experiment;
  experiment.faults = {{Fault::kReadsFail, kFaultFrom_s, kFaultFrom_s + 3.5 * kPeriod_s, {}}};
  const std::vector<Moment> moments = experiment.run(2.0);
  expect_safe(moments, experiment.settings.safety);
  const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
  EXPECT_EQ(faults_between(moments, 0.0, 2.0), 0u);
  for (double t = kFaultFrom_s; t < kFaultFrom_s + 0.02; t += kPeriod_s)
    EXPECT_LT((at(moments, t).sent.f - before).norm(), kSame * before.norm()) << t;
}

TEST(SafetyFaults, ALeapIsNotAnsweredWithABlow) {
  // Out of the plate, into it, and a turn: reported at once, in both directions.
  for (const Pose& leap : {Pose{Mat3::Identity(), {0, 0, 0.04}}, Pose{Mat3::Identity(), {0, 0, -0.008}},
                           Pose{exp_rotation({0, 0, 1.57}), Vec3::Zero()}}) {
    Experiment experiment;
    experiment.faults = {{Fault::kLeapt, kFaultFrom_s, kFaultTo_s, leap}};
    const std::vector<Moment> moments = experiment.run(3.4);
    expect_safe(moments, experiment.settings.safety);
    const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
    EXPECT_GT(before.norm(), 1.0);
    EXPECT_EQ(at(moments, kFaultFrom_s).safety, kPoseLeapt);
    EXPECT_EQ(at(moments, kFaultTo_s).safety, kPoseLeapt);
    EXPECT_EQ(faults_between(moments, kFaultFrom_s + kPeriod_s, kFaultTo_s), 0u);
    EXPECT_LT((moments.back().sent.f - before).norm(), kSame * before.norm());
  }
}

TEST(SafetyFaults, AFastHandIsNoLeap) {
  // Half a turn and 0.2 m there and back in a quarter of a second each: 1.5 m/s, 24 rad/s.
  Experiment experiment;
  auto motion = std::make_shared<ScriptedMotion>();
  for (int i = 0; i < 4; ++i)
    motion->move_to(0.25, {exp_rotation({0, 0, 3}), {0.1, 0, 0.05}})
        .move_to(0.25, {Mat3::Identity(), {-0.1, 0, 0.05}});
  SimulatedDevice device(*simulated_device_preset("virtuose-6d"), *hand_model("firm"), motion);
  SafetyState state;
  const SafetyLimits limits = safety_limits(device.info());
  ASSERT_TRUE(device.open());
  double fastest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    DeviceSample sample;
    device.read(i * kPeriod_s, sample);
    fastest = std::max(fastest, device.true_twist().v.norm());
    SafetyInput input;
    input.X_DH = sample.X_DH;
    input.sample_valid = true;
    input.now_s = i * kPeriod_s;
    std::uint32_t flags = 0;
    safe_wrench(limits, state, input, flags);
    ASSERT_EQ(flags & kFaults, 0u) << "frame " << i;
  }
  EXPECT_GT(fastest, 1.0);
}

TEST(SafetyFaults, ATurnIsALeapExactlyBeyondItsLimit) {
  // Limits of a thousandth of a turn to nearly half a turn in a frame, about any axis, from any orientation.
  Random random(5);
  const auto vector = [&] {
    return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  SafetyLimits limits =
      safety_limits(SimulatedDevice(*simulated_device_preset("sigma.7"), no_hand(), nullptr).info());
  for (int i = 0; i < 1000; ++i) {
    const double angle = kPi * std::pow(10.0, random.uniform(-3.0, -0.01));
    limits.max_turn_rad_per_s = angle / kPeriod_s;
    const Mat3 start = exp_rotation(kPi * vector());
    const Vec3 axis = vector().normalized();
    for (const double share : {0.1, 0.9, 0.999999, 1.000001, 1.01}) {
      SafetyState state;
      SafetyInput input;
      input.sample_valid = true;
      std::uint32_t flags = 0;
      input.X_DH.R = start;
      safe_wrench(limits, state, input, flags);
      input.X_DH.R = exp_rotation(axis * (share * angle)) * start;
      input.now_s = kPeriod_s;
      flags = 0;
      safe_wrench(limits, state, input, flags);
      ASSERT_EQ((flags & kPoseLeapt) != 0, share > 1.0) << angle << ' ' << share;
    }
  }
}

TEST(SafetyFaults, AThrownHandleIsNotDrivenOn) {
  // A handle that is not held, and a request for the full force without end.
  SimulatedDevice device(*simulated_device_preset("premium-1.5-6dof"), no_hand(), nullptr);
  ASSERT_TRUE(device.open());
  device.place({Mat3::Identity(), {-0.119, 0, 0}}, {});
  const SafetyLimits limits = safety_limits(device.info());
  SafetyState state;
  state.gain = 1.0;
  bool thrown = false;
  for (int i = 0; i < 100; ++i) {
    DeviceSample sample;
    device.read(i * kPeriod_s, sample);
    SafetyInput input;
    input.wanted.f.x() = limits.max_force_N;
    input.X_DH = sample.X_DH;
    input.sample_valid = true;
    input.now_s = i * kPeriod_s;
    std::uint32_t flags = 0;
    const Wrench sent = safe_wrench(limits, state, input, flags);
    const double speed = device.true_twist().v.norm();
    if (speed > 1.05 * limits.max_speed_m_per_s) {
      ASSERT_EQ(flags, kPoseLeapt) << i;
    }
    if (flags & kPoseLeapt) {
      thrown = true;
      ASSERT_TRUE(is_zero(sent));
      ASSERT_GT(speed, 0.95 * limits.max_speed_m_per_s);
    }
    device.write(sent);
  }
  EXPECT_TRUE(thrown);
}

TEST(SafetyFaults, AFrozenPoseIsToldFromALivingHandWhereNoFrictionHidesItsTremor) {
  Experiment experiment;
  experiment.rubs = false;
  experiment.device = "sigma.7";
  experiment.tremor_m = kTremor_m;
  experiment.max_still_s = 0.1;
  experiment.faults = {{Fault::kFrozen, kFaultFrom_s, kFaultTo_s, {}}};
  const std::vector<Moment> moments = experiment.run(3.2);
  expect_safe(moments, experiment.settings.safety);
  const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
  EXPECT_GT(before.norm(), 1.0);
  EXPECT_EQ(faults_between(moments, 0.0, kFaultFrom_s), 0u) << "no alarm from a hand that is held still";
  // The hand may have been at a turning point for some readings before.
  EXPECT_LE(frames_until_zero(moments, kFaultFrom_s), 101);
  EXPECT_GE(frames_until_zero(moments, kFaultFrom_s), 50);
  EXPECT_EQ(faults_between(moments, kFaultFrom_s, kFaultTo_s), kPoseFrozen);
  EXPECT_EQ(faults_between(moments, kFaultTo_s + kPeriod_s, 3.2), 0u);
  EXPECT_LT((moments.back().sent.f - before).norm(), kSame * before.norm());
}

TEST(SafetyFaults, FrictionHoldsAHandlePerfectlyStillAgainstTremor) {
  // Why no preset of a real device claims to know how still a hand can be.
  for (const SimulatedDeviceModel& model : simulated_device_presets()) {
    auto tremor = std::make_shared<TremorMotion>(std::make_shared<ScriptedMotion>(),
                                                 physiological_tremor(kTremor_m, kTremor_m / 0.05, 7));
    SimulatedDevice device(model, *hand_model("medium"), tremor);
    ASSERT_TRUE(device.open());
    DeviceSample sample, last;
    int still = 0, longest = 0;
    for (int i = 0; i < 5000; ++i) {
      last = sample;
      device.read(i * kPeriod_s, sample);
      still = sample.X_DH.p == last.X_DH.p && sample.X_DH.R == last.X_DH.R ? still + 1 : 0;
      longest = std::max(longest, still);
    }
    std::printf("  %-18s still for %d ms\n", model.name.c_str(), longest);
    EXPECT_GT(longest, 1000) << model.name;
  }
}

TEST(SafetyFaults, AFrozenPoseThatCannotBeToldKeepsItsForceAndNoMore) {
  Experiment experiment;  // no device says how still a hand can be: the force stays what it was
  experiment.faults = {{Fault::kFrozen, kFaultFrom_s, kFaultTo_s, {}}};
  const std::vector<Moment> moments = experiment.run(2.5);
  expect_safe(moments, experiment.settings.safety);
  EXPECT_EQ(faults_between(moments, 0.0, 2.5), 0u);
  const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
  for (double t = kFaultFrom_s; t < kFaultTo_s; t += kPeriod_s)
    EXPECT_LT((at(moments, t).sent.f - before).norm(), kSame * before.norm()) << t;
}

TEST(SafetyFaults, MotorsThatAreOffUntoldComeBackWithAStepOfAtMostThePresentForce) {
  Experiment experiment;
  experiment.faults = {{Fault::kMotorsOffMute, kFaultFrom_s, kFaultTo_s, {}}};
  const std::vector<Moment> moments = experiment.run(2.5);
  expect_safe(moments, experiment.settings.safety, false);
  EXPECT_EQ(faults_between(moments, 0.0, 2.5), 0u) << "nobody can know";
  EXPECT_TRUE(is_zero(at(moments, kFaultFrom_s + 0.1).motors));
  const Moment& back = at(moments, kFaultTo_s + kPeriod_s);
  EXPECT_EQ(back.motors.f, at(moments, kFaultTo_s).sent.f);
}

TEST(SafetyFaults, AStalledThreadLeavesTheDeviceToItsWatchdogAndRampsUpAgain) {
  Experiment experiment;
  experiment.stall_from_s = kFaultFrom_s;
  experiment.stall_to_s = kFaultTo_s;
  const std::vector<Moment> moments = experiment.run(3.2);
  expect_safe(moments, experiment.settings.safety);
  const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
  // The device holds the last wrench until its own watchdog; nothing of ours runs.
  const double watchdog_s = simulated_device_preset(experiment.device)->watchdog_s;
  EXPECT_EQ(at(moments, kFaultFrom_s + watchdog_s - 2 * kPeriod_s).motors.f, before);
  EXPECT_TRUE(is_zero(at(moments, kFaultFrom_s + watchdog_s + kPeriod_s).motors));
  EXPECT_EQ(at(moments, kFaultTo_s).safety, kMissedDeadline | kMotorsOff);
  EXPECT_EQ(faults_between(moments, kFaultTo_s + kPeriod_s, 3.2), 0u);
  EXPECT_LT((moments.back().sent.f - before).norm(), kSame * before.norm());
}

TEST(SafetyFaults, ALateFrameSendsZeroOnce) {
  Experiment experiment;
  experiment.stall_from_s = kFaultFrom_s;
  experiment.stall_to_s = kFaultFrom_s + 0.015;
  const std::vector<Moment> moments = experiment.run(2.5);
  expect_safe(moments, experiment.settings.safety);
  EXPECT_EQ(at(moments, experiment.stall_to_s).safety, kMissedDeadline);
  EXPECT_EQ(faults_between(moments, experiment.stall_to_s + kPeriod_s, 2.5), 0u);
}

struct AbsurdEdit {
  const char* name;
  std::function<void(World&, FrameSettings&, FrameState&)> make, undo;
  bool heals = true;  // undone, the world is as before; else a block may lie under the plate
};

/// `make` sets a number to something absurd, `undo` to its old value.
template <class Pick>
AbsurdEdit number(const char* name, Pick pick, double absurd, double sane, bool heals = true) {
  return {name, [=](World& w, FrameSettings& s, FrameState&) { pick(w, s) = absurd; },
          [=](World& w, FrameSettings& s, FrameState&) { pick(w, s) = sane; }, heals};
}

std::vector<AbsurdEdit> absurd_edits() {
  const FrameSettings sane;
  const auto contact = [](World&, FrameSettings& s) -> double& { return s.penalty.stiffness_N_per_m; };
  const auto spring = [](World&, FrameSettings& s) -> double& { return s.coupling.stiffness_N_per_m; };
  const auto torsion = [](World&, FrameSettings& s) -> double& { return s.coupling.stiffness_Nm_per_rad; };
  const auto damper = [](World&, FrameSettings& s) -> double& { return s.coupling.damping_Ns_per_m; };
  const auto gravity = [](World& w, FrameSettings&) -> double& { return w.gravity_W.z(); };
  const auto mass = [](World& w, FrameSettings&) -> double& { return w.bodies[2].mass_kg; };
  const auto teleport = [](const char* name, std::size_t body, const Vec3& by) {
    return AbsurdEdit{name,
                      [=](World&, FrameSettings&, FrameState& state) { state.world.X_WB[body].p += by; },
                      [=](World&, FrameSettings&, FrameState& state) {
                        if (body == 1) state.world.X_WB[body].p -= by;  // the others find their way
                      },
                      false};
  };
  return {
      teleport("the plate is put into the block", 1, {0, 0, 0.03}),
      teleport("the plate is taken away", 1, {0, 0, -1e6}),
      teleport("the held block is put a metre aside", 0, {1.0, 0, 0}),
      teleport("the held block is put nowhere", 0, {kNaN, 0, 0}),
      number("contact stiffness huge", contact, 1e15, sane.penalty.stiffness_N_per_m),
      number("contact stiffness no number", contact, kNaN, sane.penalty.stiffness_N_per_m),
      number("coupling stiffness huge", spring, 1e15, sane.coupling.stiffness_N_per_m),
      number("coupling stiffness no number", spring, kNaN, sane.coupling.stiffness_N_per_m),
      number("coupling stiffness negative", spring, -1e6, sane.coupling.stiffness_N_per_m, false),
      number("turning stiffness huge", torsion, 1e12, sane.coupling.stiffness_Nm_per_rad),
      number("damping huge", damper, 1e12, sane.coupling.damping_Ns_per_m),
      number("gravity huge", gravity, -1e12, -9.81),
      number("gravity no number", gravity, kNaN, -9.81),
      number("mass tiny", mass, 1e-300, 0.02),
      number("mass huge", mass, 1e300, 0.02),
  };
}

TEST(SafetyFaults, AbsurdEditsOfTheSceneStayWithinLimitsAndSlew) {
  for (const AbsurdEdit& edit : absurd_edits()) {
    SCOPED_TRACE(edit.name);
    Experiment experiment;
    // A free cube stands beside the block's path, so that gravity and its mass matter.
    add_body(experiment.world, {.part = experiment.world.bodies[0].part,
                                .mass_kg = 0.02,
                                .X_WP = {Mat3::Identity(), {0.0235, 0, 0.005}}});
    experiment.world.gravity_W = {0, 0, -9.81};
    experiment.changes = {{kFaultFrom_s, edit.make}, {kFaultTo_s, edit.undo}};
    const std::vector<Moment> moments = experiment.run(3.2);
    expect_safe(moments, experiment.settings.safety);
    const Vec3 before = at(moments, kFaultFrom_s - kPeriod_s).sent.f;
    EXPECT_GT(before.norm(), 1.0);
    if (edit.heals) {
      EXPECT_LT((moments.back().sent.f - before).norm(), 0.2 * before.norm()) << "it is felt again";
    }
  }
}

}  // namespace
}  // namespace tactum::safety_faults_test
