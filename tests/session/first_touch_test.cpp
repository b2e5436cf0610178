// The guided first touch, with a simulated device whose hand does what it is asked, wired right and wrong.

#include "tactum/session/first_touch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "support/effort.h"
#include "tactum/devices/hand_model.h"
#include "tactum/session/rehearsal.h"

namespace tactum::first_touch_test {
namespace {

SimulatedDeviceModel preset(const std::string& name) { return *simulated_device_preset(name); }

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

/// A device between the guide and the rehearsed one: other axes, cut lines, and a look at all that is sent.
class Wired final : public Device {
 public:
  explicit Wired(const SimulatedDeviceModel& model) : inner(model, *hand_model("medium")) {}

  Result<void> open() override { return inner.open(); }
  void close() noexcept override {
    closed = true;
    inner.close();
  }
  const DeviceInfo& info() const noexcept override { return inner.info(); }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    if (unplugged) return sample.valid = false;
    const bool good = inner.read(now_s, sample);
    sample.X_DH.p = read_as * sample.X_DH.p;
    sample.motors_on = !off;
    if (claimed >= 0.0) {
      sample.has_delivered = true;
      sample.F_D_delivered = last * claimed;
    }
    return good;
  }
  bool write(const Wrench& F_D) noexcept override {
    ++writes;
    EXPECT_LE(F_D.f.norm(), info().max_force_N * (1.0 + 1e-12));
    EXPECT_LE(F_D.t.norm(), info().max_torque_Nm * (1.0 + 1e-12));
    largest_N = std::max(largest_N, F_D.f.norm());
    last = F_D;
    if (unplugged) return false;
    return inner.write({write_as * F_D.f, F_D.t});
  }

  RehearsedDevice inner;
  Mat3 read_as = Mat3::Identity(), write_as = Mat3::Identity();
  bool unplugged = false, off = false, closed = false;
  double claimed = -1.0;  // the share of the wrench that the device says it exerts
  long writes = 0;
  double largest_N = 0.0;
  Wrench last;
};

/// Goes on at once, unless it is told to do something else.
class Obedient final : public TouchPerson {
 public:
  explicit Obedient(Wired& device) : device_(device) {}

  void report(const std::string& sentence) override { reported += sentence + "\n"; }
  void ask(const TouchRequest& request) override {
    ++asked;
    since_ = 0;
    TouchRequest done = request;
    if (never_lets_go && done.task == TouchTask::kRelease) done.task = TouchTask::kHoldStill;
    device_.inner.obey(done);
    says_go_on_ = true;
  }
  Word heard() override {
    if (says_go_on_) {
      says_go_on_ = false;
      return Word::kGoOn;
    }
    ++since_;
    if (asked == at_question && since_ == after_frames) then();
    return asked == stops_at && since_ == after_frames ? Word::kStop : Word::kNothing;
  }

  std::string reported;
  int asked = 0;
  bool never_lets_go = false;
  int at_question = -1, stops_at = -1;
  int after_frames = 900;
  std::function<void()> then = [] {};

 private:
  Wired& device_;
  bool says_go_on_ = false;
  int since_ = 0;
};

struct Trial {
  explicit Trial(const SimulatedDeviceModel& model) : device(model), person(device) {}
  TouchReport run() { return first_touch(device, {}, person, clock); }
  void expect_zero_and_closed() const {
    EXPECT_TRUE(device.last.f.isZero(0.0) && device.last.t.isZero(0.0));
    EXPECT_TRUE(device.closed);
  }

  Wired device;
  Obedient person;
  RehearsalClock clock;
};

TEST(FirstTouch, ADeviceThatIsWiredRightPassesEveryStep) {
  for (const char* name : {"premium-1.5-6dof", "touch", "omega.6", "sigma.7", "virtuose-6d"}) {
    Trial trial(preset(name));
    const TouchReport report = trial.run();
    EXPECT_TRUE(report.passed) << name << ": " << report.ended_by << "\n" << trial.person.reported;
    EXPECT_EQ(trial.person.asked, preset(name).max_torque_Nm > 0.0 ? 17 : 13) << trial.person.reported;
    EXPECT_GT(report.largest_N, 0.8) << "the last floor is the stiff one";
    trial.expect_zero_and_closed();
  }
}

TEST(FirstTouch, DelayAndDampingAreThoseOfTheDevice) {
  const std::vector<const char*> devices = {"premium-1.5-6dof", "touch", "omega.6", "sigma.7", "virtuose-6d"};
  for (const char* name : testing::sampled(devices, 4)) {
    for (const double delay_s : {0.0, 0.002, 0.0075}) {
      SimulatedDeviceModel model = preset(name);
      model.command_delay_s = delay_s;
      for (const double more : {0.0, 1.0}) {
        model.damping_Ns_per_m = preset(name).damping_Ns_per_m + more;
        Trial trial(model);
        const TouchReport report = trial.run();
        ASSERT_TRUE(report.response) << name << " " << delay_s << " " << trial.person.reported;
        EXPECT_NEAR(report.response->delay_s, delay_s, 0.001) << name << " " << more;
        EXPECT_NEAR(report.response->damping_Ns_per_m, model.damping_Ns_per_m,
                    report.response->damping_error_Ns_per_m)
            << name << " " << delay_s;
        EXPECT_LT(report.response->damping_error_Ns_per_m, 0.11 + 0.18 * model.damping_Ns_per_m) << name;
        EXPECT_NEAR(report.response->mass_kg, model.mass_kg, 0.05 * model.mass_kg) << name;
      }
    }
  }
}

TEST(FirstTouch, TheDampingOfTurningIsThatOfTheDevice) {
  const std::vector<const char*> devices = {"premium-1.5-6dof", "sigma.7", "virtuose-6d"};
  for (const char* name : testing::sampled(devices, 3)) {
    for (const double delay_s : {0.0, 0.002, 0.0075}) {
      SimulatedDeviceModel model = preset(name);
      model.command_delay_s = delay_s;
      for (const double more : {0.0, 0.001, 0.004}) {
        model.damping_Nms_per_rad = preset(name).damping_Nms_per_rad + more;
        Trial trial(model);
        const TouchReport report = trial.run();
        ASSERT_TRUE(report.turning) << name << " " << delay_s << " " << trial.person.reported;
        EXPECT_NEAR(report.turning->damping_Nms_per_rad, model.damping_Nms_per_rad,
                    report.turning->damping_error_Nms_per_rad)
            << name << " " << delay_s;
        EXPECT_LT(report.turning->damping_error_Nms_per_rad, 1e-4 + 0.18 * model.damping_Nms_per_rad) << name;
        EXPECT_NEAR(report.turning->inertia_kg_m2, model.inertia_kg_m2, 0.05 * model.inertia_kg_m2) << name;
        EXPECT_NEAR(report.turning->friction_Nm, model.friction_Nm, 0.5 * model.friction_Nm + 1e-4) << name;
      }
    }
  }
}

TEST(FirstTouch, AFlippedAxisIsToldByNameAndNoForceFollows) {
  Trial trial(preset("sigma.7"));
  trial.device.read_as(1, 1) = -1.0;
  const TouchReport report = trial.run();
  EXPECT_FALSE(report.passed);
  EXPECT_EQ(report.ended_by, "the axis y is flipped");
  EXPECT_TRUE(holds(trial.person.reported, "a move to the right (+y) was read as one to the left (-y)"));
  EXPECT_EQ(trial.device.largest_N, 0.0);
  trial.expect_zero_and_closed();
}

TEST(FirstTouch, SwappedAxesAreToldByName) {
  Trial trial(preset("omega.6"));
  trial.device.read_as << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  const TouchReport report = trial.run();
  EXPECT_TRUE(holds(report.ended_by, "axes are swapped: to the right (+y) was read as up (+z)"))
      << report.ended_by;
  EXPECT_TRUE(holds(report.ended_by, "up (+z) was read as to the right (+y)")) << report.ended_by;
  EXPECT_EQ(trial.device.largest_N, 0.0);
}

TEST(FirstTouch, AForceThatPushesTheOtherWayIsTold) {
  Trial trial(preset("omega.6"));
  trial.device.write_as(0, 0) = -1.0;
  const TouchReport report = trial.run();
  EXPECT_FALSE(report.passed);
  EXPECT_TRUE(holds(report.ended_by, "a force toward you (+x) moved the handle away from you (-x)"))
      << report.ended_by;
  EXPECT_LE(trial.device.largest_N, 1.5 + 1e-12) << "only small forces until the signs are right";
  EXPECT_FALSE(report.response);
  trial.expect_zero_and_closed();
}

TEST(FirstTouch, AHandThatHoldsOnIsNotMeasuredAsTheHandle) {
  Trial trial(preset("omega.6"));
  trial.person.never_lets_go = true;
  const TouchReport report = trial.run();
  EXPECT_FALSE(report.passed);
  EXPECT_FALSE(report.response) << trial.person.reported;
  trial.expect_zero_and_closed();
}

TEST(FirstTouch, AnUnpluggedDeviceIsOfferedZeroInEveryStep) {
  for (int question = 1; question <= 17; ++question) {
    Trial trial(preset("sigma.7"));
    trial.person.at_question = question;
    trial.person.after_frames = question > 7 ? 650 : 30;  // in the middle of the step
    trial.person.then = [&] { trial.device.unplugged = true; };
    const TouchReport report = trial.run();
    EXPECT_FALSE(report.passed);
    EXPECT_TRUE(holds(report.ended_by, "the device is lost")) << question << ": " << report.ended_by;
    trial.expect_zero_and_closed();
  }
}

TEST(FirstTouch, StoppingLeadsToZeroInEveryStep) {
  for (int question = 1; question <= 17; ++question) {
    Trial trial(preset("sigma.7"));
    trial.person.stops_at = question;
    trial.person.after_frames = question > 7 ? 650 : 30;
    const TouchReport report = trial.run();
    EXPECT_EQ(report.ended_by, "stopped, the wrench is zero") << question;
    EXPECT_EQ(trial.person.asked, question) << "nothing is asked any more";
    trial.expect_zero_and_closed();
  }
}

TEST(FirstTouch, MotorsThatGoOffAreToldAndTheStepIsMadeAgain) {
  Trial trial(preset("sigma.7"));
  trial.person.at_question = 8;  // the soft wall
  trial.person.after_frames = 1100;
  trial.person.then = [&] { trial.device.off = true; };
  const TouchReport off = trial.run();
  EXPECT_FALSE(off.passed);
  EXPECT_TRUE(holds(off.ended_by, "led to zero at once: motors off")) << off.ended_by;
  EXPECT_EQ(trial.person.asked, 10) << "three tries";
  trial.expect_zero_and_closed();
}

/// A clock that once wakes 50 ms late.
class LateOnce final : public TouchClock {
 public:
  double now_s() noexcept override { return now_; }
  void wait_until(double time_s) noexcept override {
    now_ = std::max(now_, time_s);
    if (is_late) now_ += 0.050;
    is_late = false;
  }
  bool is_late = false;

 private:
  double now_ = 0.0;
};

TEST(FirstTouch, AFrameThatIsLateSendsZeroAndTheStepIsMadeAgain) {
  Trial trial(preset("omega.6"));
  LateOnce clock;
  trial.person.at_question = 8;
  trial.person.after_frames = 1100;
  trial.person.then = [&] { clock.is_late = true; };
  const TouchReport report = first_touch(trial.device, {}, trial.person, clock);
  EXPECT_TRUE(report.passed) << report.ended_by;
  EXPECT_TRUE(holds(trial.person.reported, "deadline missed")) << trial.person.reported;
  EXPECT_EQ(trial.person.asked, 14);
}

TEST(FirstTouch, ADeviceThatExertsAnotherForceThanWasSentIsTold) {
  Trial good(preset("omega.6"));
  good.device.claimed = 1.0;
  EXPECT_TRUE(good.run().passed) << good.person.reported;
  Trial weak(preset("omega.6"));
  weak.device.claimed = 0.3;
  const TouchReport report = weak.run();
  EXPECT_FALSE(report.passed);
  EXPECT_TRUE(holds(report.ended_by, "it exerted 30 %")) << report.ended_by;
}

TEST(FirstTouch, WhatOnlyLeadsTheHandEndsAfterItsAxes) {
  SimulatedDeviceModel model = preset("omega.6");
  model.max_force_N = 0.0;
  Trial trial(model);
  const TouchReport report = trial.run();
  EXPECT_EQ(report.passed, !trial.device.info().actuates_force) << report.ended_by;
  EXPECT_EQ(trial.person.asked, 7);
  EXPECT_EQ(trial.device.largest_N, 0.0);
}

TEST(FirstTouch, AnObliqueMoveIsNotTakenForAnAxis) {
  EXPECT_FALSE(clear_axis({1.0, 1.0, 0.0}));
  EXPECT_FALSE(clear_axis(Vec3::Zero()));
  EXPECT_FALSE(clear_axis(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
  const auto down = clear_axis({0.1, 0.2, -1.0});
  ASSERT_TRUE(down);
  EXPECT_EQ(direction_name(*down), "down (-z)");
}

}  // namespace
}  // namespace tactum::first_touch_test
