// A session on the Virtuose's driver, whose library calls it, with the stand-in for that library.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "standins/standin_virtuose.h"
#include "support/standin_files.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/drivers/virtuose.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::virtuose_session_test {

constexpr std::uint64_t kVirtuoseFrames = 4000;

/// What the library tells of a handle: pose and speed, rounded to float.
struct Report {
  std::array<float, 7> pose{};
  std::array<float, 6> speed{};
};

Report report_of(const DeviceSample& sample) {
  const Eigen::Quaterniond q(sample.X_DH.R);
  Report report;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    report.pose[i] = static_cast<float>(sample.X_DH.p[axis]);
    report.pose[3 + i] = static_cast<float>(q.vec()[axis]);
    report.speed[i] = static_cast<float>(sample.V_DH.v[axis]);
    report.speed[3 + i] = static_cast<float>(sample.V_DH.w[axis]);
  }
  report.pose[6] = static_cast<float>(q.w());
  return report;
}

void put_into(const Report& report, DeviceSample& sample) {
  const auto& [x, y, z, qx, qy, qz, qw] = report.pose;
  sample.X_DH.p = {x, y, z};
  sample.X_DH.R = Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix();
  sample.V_DH = {{report.speed[0], report.speed[1], report.speed[2]},
                 {report.speed[3], report.speed[4], report.speed[5]}};
  sample.has_velocity = true;
}

struct Tape {
  std::vector<Report> reports;
  std::vector<Wrench> wrenches;
};

/// A device within another one, which does something about a read and a write.
class Within : public Device {
 public:
  Within(std::unique_ptr<Device> inner, DeviceInfo info) : inner_(std::move(inner)), info_(std::move(info)) {}
  Result<void> open() override { return inner_->open(); }
  void close() noexcept override { inner_->close(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool write(const Wrench& F_D) noexcept override { return inner_->write(F_D); }

 protected:
  std::unique_ptr<Device> inner_;

 private:
  DeviceInfo info_;
};

/// A simulated device in a hand, which says that it can what a Virtuose can and is read through floats.
class TapedDevice final : public Within {
 public:
  TapedDevice(std::unique_ptr<Device> inner, const DeviceInfo& info, Tape& tape)
      : Within(std::move(inner), info), tape_(tape) {}
  bool read(double now_s, DeviceSample& sample) noexcept override {
    const bool good = inner_->read(now_s, sample);
    tape_.reports.push_back(report_of(sample));
    put_into(tape_.reports.back(), sample);
    return good;
  }
  bool write(const Wrench& F_D) noexcept override {
    tape_.wrenches.push_back(F_D);
    return Within::write(F_D);
  }

 private:
  Tape& tape_;
};

/// The driver, whose library calls it once before every read, with the taped handle. A tick sends what was
/// written in the frame before.
class SteppedDevice final : public Within {
 public:
  SteppedDevice(std::unique_ptr<Device> inner, const Tape& tape, standin::VirtuoseDevice& standin,
                void (*tick)())
      : Within(std::move(inner), DeviceInfo{}), tape_(tape), standin_(standin), tick_(tick) {}
  const DeviceInfo& info() const noexcept override { return inner_->info(); }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    if (reads_ == 0) {
      tick_();  // from now on by hand
      const std::lock_guard<std::mutex> lock(standin_.mutex);
      standin_.commands.clear();
    }
    {
      const std::lock_guard<std::mutex> lock(standin_.mutex);
      const Report& now = tape_.reports[std::min(reads_++, tape_.reports.size() - 1)];
      standin_.pose = now.pose;
      standin_.speed = now.speed;
    }
    tick_();
    return inner_->read(now_s, sample);
  }

 private:
  const Tape& tape_;
  standin::VirtuoseDevice& standin_;
  void (*tick_)();
  std::size_t reads_ = 0;
};

Scene gears_scene() {
  Result<SceneDescription> description = describe_scene("gears");
  EXPECT_TRUE(description);
  Result<Scene> scene = build_scene(*description);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

void run_gears(std::unique_ptr<Device> device) {
  Result<std::unique_ptr<Session>> session = Session::open_with(gears_scene(), std::move(device));
  ASSERT_TRUE(session) << session.error().message();
  const Result<VirtualRun> ran = (*session)->run_virtual(kVirtuoseFrames, nullptr);
  ASSERT_TRUE(ran) << ran.error().message();
  EXPECT_EQ(ran->failed_reads, 0u);
  EXPECT_EQ(ran->failed_writes, 0u);
}

TEST(VirtuoseSession, TheWrenchesOfTheGearsAreThoseOfTheSimulatedDeviceRoundedToFloat) {
  const LoadedStandin loaded("standin_virtuose");
  const SetVariable library("TACTUM_VIRTUOSE_LIBRARY", standin_file("standin_virtuose"));
  standin::VirtuoseDevice& standin =
      *loaded.function<standin::VirtuoseDevice*()>("standin_virtuose_device")();
  standin.pose = {0, 0, 0, 0, 0, 0, 1};  // where it is opened is the origin
  const auto connect = [] {
    return VirtuoseDevice::connect({.host = "", .stale_after_s = 3600.0, .relays_s = 0.0});
  };
  DeviceInfo info;
  {
    const Result<std::unique_ptr<Device>> device = connect();
    ASSERT_TRUE(device) << device.error().message();
    info = (*device)->info();
  }
  const Result<SimulatedDeviceModel> model = simulated_device_preset("sigma.7");
  const Result<HandModel> hand = hand_model("medium");
  ASSERT_TRUE(model && hand);
  Tape tape;
  run_gears(std::make_unique<TapedDevice>(
      std::make_unique<SimulatedDevice>(*model, *hand, gears_scene().hand), info, tape));

  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  run_gears(std::make_unique<SteppedDevice>(std::move(*device), tape, standin,
                                            loaded.function<void()>("standin_virtuose_tick")));

  // The first tick sends the zero of the start, each later one the wrench of the frame before.
  ASSERT_GE(tape.wrenches.size(), kVirtuoseFrames);
  ASSERT_GE(standin.commands.size(), kVirtuoseFrames);
  double strongest_Nm = 0.0;
  for (std::size_t i = 0; i + 1 < kVirtuoseFrames; ++i) {
    const Wrench& F = tape.wrenches[i];
    const auto rounded = [](double part) { return static_cast<float>(part); };
    const std::array<float, 6> sent{rounded(F.f.x()), rounded(F.f.y()), rounded(F.f.z()),
                                    rounded(F.t.x()), rounded(F.t.y()), rounded(F.t.z())};
    ASSERT_EQ(standin.commands[i + 1], sent) << "frame " << i;
    strongest_Nm = std::max(strongest_Nm, F.t.norm());
  }
  EXPECT_GT(strongest_Nm, 0.001) << "the gears were felt";
  EXPECT_TRUE(standin.broken_rules.empty()) << standin.broken_rules.front();
}

}  // namespace tactum::virtuose_session_test
