// A session on a real device's driver, with a stand-in for the maker's library.

#include <gtest/gtest.h>

#include "standins/standin_dhd.h"
#include "support/standin_files.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/drivers/force_dimension.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::driver_session_test {

constexpr std::uint64_t kFrames = 4000;

/// What passed between a loop and a device.
struct Tape {
  std::vector<DeviceSample> samples;
  std::vector<Wrench> wrenches;
};

/// A simulated device in a hand, which says that it can what another device can.
class TapedDevice final : public Device {
 public:
  TapedDevice(std::unique_ptr<Device> simulated, const DeviceInfo& info, Tape& tape)
      : simulated_(std::move(simulated)), info_(info), tape_(tape) {}
  Result<void> open() override { return simulated_->open(); }
  void close() noexcept override { simulated_->close(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    const bool good = simulated_->read(now_s, sample);
    tape_.samples.push_back(sample);
    return good;
  }
  bool write(const Wrench& F_D) noexcept override {
    tape_.wrenches.push_back(F_D);
    return simulated_->write(F_D);
  }

 private:
  std::unique_ptr<Device> simulated_;
  DeviceInfo info_;
  Tape& tape_;
};

Scene gears() {
  Result<SceneDescription> description = describe_scene("gears");
  EXPECT_TRUE(description);
  Result<Scene> scene = build_scene(*description);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

void run(std::unique_ptr<Device> device) {
  Result<std::unique_ptr<Session>> session = Session::open_with(gears(), std::move(device));
  ASSERT_TRUE(session) << session.error().message();
  const Result<VirtualRun> ran = (*session)->run_virtual(kFrames, nullptr);
  ASSERT_TRUE(ran) << ran.error().message();
  EXPECT_EQ(ran->failed_reads, 0u);
  EXPECT_EQ(ran->failed_writes, 0u);
}

standin::DhdSample in_dhd(const DeviceSample& sample) {
  standin::DhdSample there;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    there.p[at] = sample.X_DH.p[i];
    there.v[at] = sample.V_DH.v[i];
    there.w[at] = sample.V_DH.w[i];
    for (int j = 0; j < 3; ++j) there.frame[3 * at + static_cast<std::size_t>(j)] = sample.X_DH.R(i, j);
  }
  there.buttons = sample.buttons;
  return there;
}

TEST(DriverSession, TheWrenchesOfTheGearsAreThoseOfTheSimulatedDeviceToTheBit) {
  const LoadedStandin loaded("standin_dhd");
  const SetVariable library("TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd"));
  standin::DhdDevice& standin = *loaded.function<standin::DhdDevice*()>("standin_dhd_device")();
  standin.old_firmware = true;  // no watchdog: the run is on the virtual clock
  const auto connect = [] { return ForceDimensionDevice::connect({.serial = "", .stale_after_s = 3600.0}); };

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
  run(std::make_unique<TapedDevice>(std::make_unique<SimulatedDevice>(*model, *hand, gears().hand), info,
                                    tape));
  ASSERT_GE(tape.samples.size(), kFrames);

  for (const DeviceSample& sample : tape.samples) standin.script.push_back(in_dhd(sample));
  standin.reads = 0;
  standin.commands.clear();
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  run(std::move(*device));

  // One zero before forces are on, then a wrench a frame.
  ASSERT_GT(standin.commands.size(), kFrames);
  double strongest_Nm = 0.0;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const Wrench& F = tape.wrenches[i];
    const std::array<double, 7> sent{F.f.x(), F.f.y(), F.f.z(), F.t.x(), F.t.y(), F.t.z(), 0.0};
    ASSERT_EQ(standin.commands[i + 1], sent) << "frame " << i;
    strongest_Nm = std::max(strongest_Nm, F.t.norm());
  }
  EXPECT_GT(strongest_Nm, 0.001) << "the gears were felt";
  EXPECT_TRUE(standin.broken_rules.empty()) << standin.broken_rules.front();
}

}  // namespace tactum::driver_session_test
