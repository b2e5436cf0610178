#include "tactum/drivers/haply.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "standins/standin_haply.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/registry.h"

namespace tactum::haply_test {

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

class HaplyLoop : public ::testing::Test {
 protected:
  HaplyOptions options() {
    Result<HaplyOptions> named = haply_options("");
    named->stale_after_s = 3600.0;
    return *named;
  }
  std::unique_ptr<Device> opened() {
    Result<std::unique_ptr<Device>> device = HaplyDevice::connect(options());
    EXPECT_TRUE(device) << device.error().message();
    if (!device) return nullptr;
    const Result<void> open = (*device)->open();
    EXPECT_TRUE(open) << open.error().message();
    return open ? std::move(*device) : nullptr;
  }
  template <class Seen>
  bool reads_until(Device& device, Seen seen) {
    return comes_true([&] { return device.read(now_s += 0.001, sample) && seen(sample); });
  }
  /// A force along each axis arrives at the motors.
  bool pushes(Device& device) {
    return device.write({{1, -2, 0.5}, {0, 0, 0}}) && comes_true([this] {
             return service.motors() == standin::Triple{-2, -1, 0.5};
           });
  }

  standin::HaplyService service;
  SetVariable place{"TACTUM_HAPLY_SERVICE", service.place()};
  DeviceSample sample;
  double now_s = 0.0;
};

const auto off = [](const DeviceSample& now) { return !now.motors_on; };
const auto on = [](const DeviceSample& now) { return now.motors_on; };

TEST_F(HaplyLoop, TellsWhatTheDeviceIsAndWhichServiceHasIt) {
  Result<std::unique_ptr<Device>> device = make_device("haply:049D", {});
  ASSERT_TRUE(device) << device.error().message();
  const DeviceInfo info = (*device)->info();
  EXPECT_EQ(info.name, "haply inverse3, service 3.5.2 of port " + std::to_string(service.port()));
  EXPECT_EQ(info.serial, "049D");
  EXPECT_EQ(info.workspace_radius_m, 0.10);
  EXPECT_TRUE(info.actuates_force);
  EXPECT_FALSE(info.actuates_torque || info.senses_rotation) << "there is no grip";
  EXPECT_EQ(service.locked()->messages, 0) << "nothing is asked of it before it is opened";
  device->reset();  // the stand-in serves one at a time
  const Result<std::unique_ptr<Device>> other = make_device("haply:" + service.place() + "/1234", {});
  ASSERT_FALSE(other);
  EXPECT_TRUE(holds(other.error().message(), "1234") && holds(other.error().message(), "049D"))
      << other.error().message();
}

TEST_F(HaplyLoop, SpeaksAsTheVersionDoes) {
  struct Service {
    const char* version;
    bool takes_vector;
  };
  for (const Service& kind : {Service{"3.4.1", false}, Service{"3.5.0", true}, Service{"3.10.0", true},
                              Service{"4.0", true}, Service{"", true}}) {
    service.locked()->version = kind.version;
    service.locked()->takes_vector = kind.takes_vector;
    service.locked()->takes_values = !kind.takes_vector;
    HaplyOptions asked = options();
    asked.other_http_port = asked.port;
    Result<std::unique_ptr<Device>> device = HaplyDevice::connect(asked);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE((*device)->open());
    EXPECT_TRUE(pushes(**device)) << kind.version;
    EXPECT_EQ(holds((*device)->info().name, "unknown version"), std::string(kind.version).empty());
  }
}

TEST_F(HaplyLoop, TheVersionMayBeAtAnotherPort) {
  service.locked()->version = "";
  standin::HaplyService other;
  other.locked()->version = "3.1.0";
  HaplyOptions asked = options();
  asked.other_http_port = other.port();
  const Result<std::unique_ptr<Device>> device = HaplyDevice::connect(asked);
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_TRUE(holds((*device)->info().name, "service 3.1.0 of port " + std::to_string(other.port())))
      << (*device)->info().name;
}

TEST_F(HaplyLoop, OriginAxesAndFiltersAreSetBeforeAForceIsSent) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_EQ(service.locked()->profile, "tactum");
  EXPECT_EQ(service.locked()->preset, "arm_front_centered");
  EXPECT_EQ(service.locked()->basis, "XYZ");
  EXPECT_NEAR(service.locked()->gate_gain, 0.3, 1e-6);
  EXPECT_EQ(service.locked()->damping, 0.0);
  EXPECT_TRUE(pushes(*device));
  const std::vector<standin::Triple> commands = service.locked()->commands;
  for (const standin::Triple& F : commands)
    EXPECT_TRUE(F == standin::Triple{} || F == (standin::Triple{-2, -1, 0.5}));
}

TEST_F(HaplyLoop, AServiceThatDoesNotTakeThemIsRefused) {
  service.locked()->takes_settings = false;
  Result<std::unique_ptr<Device>> device = HaplyDevice::connect(options());
  ASSERT_TRUE(device);
  const Result<void> open = (*device)->open();
  ASSERT_FALSE(open);
  for (const char* words :
       {"does not take our settings", "preset 'defaults'", "basis 'YXZ'", "arm_front_centered"})
    EXPECT_TRUE(holds(open.error().message(), words)) << open.error().message();
  EXPECT_TRUE(comes_true([this] { return !service.has_session(); }));
}

TEST_F(HaplyLoop, AForceThatIsScaledOnItsWayIsTold) {
  service.locked()->scale = 0.5;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, on));
  EXPECT_EQ(device->trouble(), "") << "no force, no difference";
  ASSERT_TRUE(device->write({{0, 2, 0}, {0, 0, 0}}));
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) {
    return now.has_delivered && now.F_D_delivered.f == Vec3(0, 1, 0);
  })) << sample.F_D_delivered.f.transpose();
  EXPECT_TRUE(comes_true([&device] { return device->trouble() != ""; }));
  EXPECT_TRUE(holds(device->trouble(), "1.00 N for 2.00 N")) << device->trouble();
  EXPECT_TRUE(holds(device->trouble(), "softer coupling")) << device->trouble();
}

TEST_F(HaplyLoop, AForceThatOscillatesIsCutByTheService) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  service.answer_by_hand();
  for (int n = 0; n < 3 * HaplyDevice::kOtherForTicks; ++n) {
    ASSERT_TRUE(device->write({{n % 2 == 0 ? 2.0 : -2.0, 0, 0}, {0, 0, 0}}));
    service.answer_one();
  }
  service.answer_all();
  EXPECT_GT(service.locked()->of_damper, 0);
  EXPECT_TRUE(holds(device->trouble(), "0.30 N for 2.00 N")) << device->trouble();
}

TEST_F(HaplyLoop, WithoutAReasonNothingIsTold) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  service.answer_by_hand();
  for (int n = 0; n < 3 * HaplyDevice::kOtherForTicks; ++n) {
    ASSERT_TRUE(device->write({{0.01 * n, 0, 1}, {0, 0, 0}}));
    service.answer_one();
  }
  service.answer_all();
  EXPECT_EQ(device->trouble(), "");
}

TEST_F(HaplyLoop, NotCalibratedNotReadyOrWithoutPowerItRests) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  struct State {
    bool standin::HaplyService::World::*member;
    const char* words;
  };
  using World = standin::HaplyService::World;
  for (const State& state : {State{&World::calibrated, "inkwell"}, State{&World::ready, "not ready"},
                             State{&World::powered, "no power"}}) {
    ASSERT_TRUE(reads_until(*device, on));
    service.locked().world.*state.member = false;
    ASSERT_TRUE(reads_until(*device, off));
    EXPECT_TRUE(holds(device->trouble(), state.words)) << device->trouble();
    const std::size_t sent = service.locked()->commands.size();
    device->write({{1, 0, 0}, {0, 0, 0}});
    ASSERT_TRUE(comes_true([&] { return service.locked()->commands.size() > sent + 2; }));
    EXPECT_EQ(service.locked()->commands.back(), standin::Triple{});
    service.locked().world.*state.member = true;
    EXPECT_TRUE(reads_until(*device, on));
    EXPECT_EQ(device->trouble(), "");
  }
}

TEST_F(HaplyLoop, TheSurveySaysWhatKeepsItFromBeingReady) {
  service.locked()->calibrated = false;
  const DriverSurvey survey = HaplyDevice::survey();
  ASSERT_EQ(survey.found.size(), 1u) << survey.nothing;
  EXPECT_EQ(survey.found.front().name, "haply:049D");
  EXPECT_TRUE(holds(survey.found.front().health, "inkwell")) << survey.found.front().health;
}

TEST_F(HaplyLoop, AGripThatFallsAsleepLeavesThePartAsItWas) {
  const double half = std::sqrt(0.5);
  service.locked()->has_grip = true;
  service.locked()->turn_wxyz = {half, 0, 0, half};
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_TRUE(device->info().senses_rotation);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.X_DH.R(1, 0) > 0.99; }));
  EXPECT_EQ(device->trouble(), "");
  service.locked()->has_grip = false;
  EXPECT_TRUE(comes_true([&] { return holds(device->trouble(), "grip"); })) << device->trouble();
  EXPECT_TRUE(reads_until(*device, on));
  EXPECT_GT(sample.X_DH.R(1, 0), 0.99);
}

/// A grip that tells its orientation fifty times a second: what is read between is between, in services of
/// both spellings, and said to be so.
TEST_F(HaplyLoop, ATurnGoesOnBetweenTheReadingsOfTheGrip) {
  struct Kind {
    const char* version;
    bool takes_vector;
    double every_s, turning_rad_per_s;
  };
  for (const Kind& kind :
       {Kind{"3.5.2", true, 0.02, 2.0}, Kind{"3.4.0", false, 0.02, -1.5}, Kind{"3.5.2", true, 0.03, 1.0},
        Kind{"3.4.0", false, 0.015, 3.0}, Kind{"3.6.0", true, 0.02, -0.3}}) {
    service.locked()->has_grip = true;
    service.locked()->version = kind.version;
    service.locked()->takes_vector = kind.takes_vector;
    service.locked()->takes_values = !kind.takes_vector;
    service.locked()->grip_every_s = kind.every_s;
    service.locked()->turning_rad_per_s = kind.turning_rad_per_s;
    const std::unique_ptr<Device> device = opened();
    ASSERT_TRUE(device);
    EXPECT_TRUE(holds(device->info().rotation_fill, "interpolated between readings"));
    EXPECT_TRUE(pushes(*device)) << kind.version;
    // Whenever the service's thread and ours had some time: three times as many turns as were read.
    EXPECT_TRUE(comes_true([&] {
      const int before = service.locked()->grip_readings;
      int turns = 0;
      Mat3 last = Mat3::Zero();
      for (int n = 0; n < 100; ++n) {
        if (device->read(now_s += 0.001, sample) && sample.X_DH.R != last) ++turns;
        last = sample.X_DH.R;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      return turns > 3 * (service.locked()->grip_readings - before + 1);
    })) << kind.version;
    EXPECT_EQ(sample.V_DH.w.z() > 0.0, kind.turning_rad_per_s > 0.0);
  }
}

TEST_F(HaplyLoop, ButtonsHaveTwoNames) {
  service.locked()->has_grip = true;
  service.locked()->counts_buttons = true;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  service.locked()->buttons = {false, true, true};
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.buttons == 6u; }));
  service.locked()->counts_buttons = false;
  service.locked()->buttons = {true, false, true};
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.buttons == 5u; }));
}

TEST_F(HaplyLoop, NonsenseAndSilenceEndIt) {
  for (const char* answer :
       {"{", "[]", "null", "{\"inverse3\":[{\"device_id\":\"049D\"}]}",
        "{\"inverse3\":[{\"device_id\":\"049D\",\"state\":{\"cursor_position\":{\"x\":1e300}}}]}"}) {
    service.locked()->nonsense = "";
    const std::unique_ptr<Device> device = opened();
    ASSERT_TRUE(device);
    ASSERT_TRUE(reads_until(*device, on));
    service.locked()->nonsense = answer;
    EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); })) << answer;
    EXPECT_FALSE(device->write({}));
    EXPECT_TRUE(holds(device->trouble(), "tells no pose")) << device->trouble();
  }
  service.locked()->nonsense = "";
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  service.locked()->silent = true;
  EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); }));
  EXPECT_TRUE(comes_true([&] { return holds(device->trouble(), "does not answer"); })) << device->trouble();
}

TEST_F(HaplyLoop, WhereNoServiceOrNoDeviceIsItIsSaid) {
  service.locked()->connected = false;
  const DriverSurvey without = HaplyDevice::survey();
  EXPECT_TRUE(without.found.empty());
  EXPECT_TRUE(holds(without.nothing, "the service finds no device")) << without.nothing;
  service.locked()->begins = false;
  EXPECT_TRUE(holds(HaplyDevice::survey().nothing, "does not begin"));
  const SetVariable nobody("TACTUM_HAPLY_SERVICE", "127.0.0.1:1");
  for (const char* words :
       {"no service of Haply answers", "Connection refused", "systemctl start", "127.0.0.1:1"})
    EXPECT_TRUE(holds(HaplyDevice::survey().nothing, words)) << HaplyDevice::survey().nothing;
}

TEST(HaplyPlace, IsReadFromTheNameOrTheEnvironment) {
  const SetVariable place("TACTUM_HAPLY_SERVICE", "lab:12");
  const auto is = [](const char* argument, const char* host, int port, const char* id) {
    const Result<HaplyOptions> read = haply_options(argument);
    return read && read->host == host && read->port == port && read->id == id;
  };
  EXPECT_TRUE(is("", "lab", 12, ""));
  EXPECT_TRUE(is("049D", "lab", 12, "049D"));
  EXPECT_TRUE(is("10.0.0.1:8500", "10.0.0.1", 8500, ""));
  EXPECT_TRUE(is("10.0.0.1:8500/049D", "10.0.0.1", 8500, "049D"));
  for (const char* argument : {"lab:", "lab:0", "lab:70000", "lab:1x", ":12", "lab/049D"}) {
    const Result<HaplyOptions> read = haply_options(argument);
    ASSERT_FALSE(read) << argument;
    EXPECT_TRUE(holds(read.error().message(), "haply:HOST:PORT/ID")) << read.error().message();
  }
}

/// In closed form: a steady turn read in every n-th sample is shown n - 1 samples late, and otherwise as it
/// was.
TEST(TurnFill, ASteadyTurnIsShownAsItWas) {
  for (const int every : {1, 2, 5, 20, 33}) {
    const Vec3 w = 1e-3 * Vec3(0.5 * every, -1.0, 2.0);  // in a sample [rad]
    const auto turned = [&w](int n) {
      return Mat3(Eigen::AngleAxisd(w.norm() * n, w.normalized()).toRotationMatrix());
    };
    TurnFill fill;
    for (int n = 0; n < 400; ++n) {
      const Mat3 shown = fill.show(turned(n - n % every));
      if (n < 3 * every) continue;
      EXPECT_NEAR((shown - turned(n - every + 1)).norm(), 0.0, 1e-12) << every << " " << n;
    }
  }
}

TEST(TurnFill, AReadingInEachSampleIsShownToTheBitAlsoAfterARest) {
  TurnFill fill;
  const auto turned = [](double angle) { return Mat3(Eigen::AngleAxisd(angle, Vec3::UnitZ())); };
  for (int n = 0; n < 300; ++n) {
    const Mat3 reading = turned(n < 200 ? 0.1 : 0.1 + 0.001 * (n - 200));
    EXPECT_EQ(fill.show(reading), reading) << n;
  }
}

/// Readings that come early or late, or after a sleep: nothing beyond them, and no step of one's size.
TEST(TurnFill, ReadingsThatComeUnevenlyMakeNoStep) {
  std::mt19937 random(34);
  for (const double step_rad : {0.01, 0.05, 0.2, 0.4, 1.0}) {
    const auto turned = [](double angle) { return Mat3(Eigen::AngleAxisd(angle, Vec3::UnitX())); };
    TurnFill fill;
    double reading = 0.0, shown = 0.0;
    for (int read = 0, n = 0; read < 60; ++read) {
      const int gap = read == 30 ? 900 : std::uniform_int_distribution<int>(15, 25)(random);
      for (int k = 0; k < gap; ++k, ++n) {
        const Mat3 R = fill.show(turned(reading));
        const double now = std::atan2(R(2, 1), R(1, 1));
        double moved = now - shown;
        moved -= 2.0 * M_PI * std::round(moved / (2.0 * M_PI));
        EXPECT_GE(moved, -1e-12);
        if (read > 2) {
          EXPECT_LE(moved, 1.7 * step_rad / 15.0) << read << " " << k;
        }
        shown = now;
      }
      double behind = reading - shown;
      behind -= 2.0 * M_PI * std::round(behind / (2.0 * M_PI));
      EXPECT_GE(behind, -1e-12) << "beyond the reading";
      reading += step_rad;
    }
  }
}

TEST(TurnRate, IsThatOfASteadyTurn) {
  TurnRate rate;
  rate.start();
  const Vec3 w(0.5, -1.0, 2.0);
  Vec3 found = Vec3::Zero();
  const auto turned = [&w](double angle_s) {
    return Mat3(Eigen::AngleAxisd(w.norm() * angle_s, w.normalized()).toRotationMatrix());
  };
  EXPECT_EQ(rate.add(turned(0.0), 10.0), Vec3::Zero()) << "nothing to compare with";
  for (int n = 1; n <= 300; ++n) found = rate.add(turned(0.001 * n), 10.0 + 0.001 * n);
  EXPECT_NEAR((found - w).norm(), 0.0, 1e-9);
  for (int n = 301; n <= 400; ++n) found = rate.add(turned(0.3), 10.0 + 0.001 * n);
  EXPECT_NEAR(found.norm(), 0.0, 1e-12) << "and zero when it has stopped";
  // A grip that tells its orientation every 20 ms: the mean is right, and no reading is far from it.
  rate.start();
  double mean = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double speed = rate.add(turned(0.02 * std::floor(n / 20.0)), 0.001 * n).norm();
    if (n < 200) continue;
    mean += speed / 800.0;
    EXPECT_LT(std::abs(speed - w.norm()), 0.5 * w.norm());
  }
  EXPECT_NEAR(mean, w.norm(), 0.02 * w.norm());
}

}  // namespace tactum::haply_test
