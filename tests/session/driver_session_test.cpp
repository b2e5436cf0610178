// A session on the drivers of real devices, with their stand-ins: what they are sent is what the simulated
// device is sent in the same motion.

#include <gtest/gtest.h>

#include <algorithm>

#include "support/effort.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"
#include "taped_device.h"

namespace tactum::driver_session_test {

Scene gears() {
  Result<SceneDescription> description = describe_scene("gears");
  EXPECT_TRUE(description);
  Result<Scene> scene = build_scene(*description);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

void run(std::unique_ptr<Device> device, std::uint64_t frames) {
  Result<std::unique_ptr<Session>> session = Session::open_with(gears(), std::move(device));
  ASSERT_TRUE(session) << session.error().message();
  const Result<VirtualRun> ran = (*session)->run_virtual(frames, nullptr);
  ASSERT_TRUE(ran) << ran.error().message();
  EXPECT_EQ(ran->failed_reads, 0u);
  EXPECT_EQ(ran->failed_writes, 0u);
}

class DriverSession : public ::testing::TestWithParam<StageMaker> {};

TEST_P(DriverSession, TheWrenchesOfTheGearsAreThoseOfTheSimulatedDeviceToTheBit) {
  const std::uint64_t frames = testing::full_run() ? 10'000 : 4'000;
  const std::unique_ptr<DriverStage> stage = GetParam().make();
  DeviceInfo info;
  {
    const Result<std::unique_ptr<Device>> device = stage->connect();
    ASSERT_TRUE(device) << device.error().message();
    info = (*device)->info();
  }
  const Result<SimulatedDeviceModel> model = simulated_device_preset("sigma.7");
  const Result<HandModel> hand = hand_model("medium");
  ASSERT_TRUE(model && hand);
  Tape tape;
  run(std::make_unique<TapedDevice>(std::make_unique<SimulatedDevice>(*model, *hand, gears().hand), info,
                                    *stage, tape),
      frames);
  ASSERT_GE(tape.measured.size(), frames);

  Result<std::unique_ptr<Device>> device = stage->connect();
  ASSERT_TRUE(device) << device.error().message();
  run(std::make_unique<SteppedDevice>(std::move(*device), *stage, tape), frames);

  const std::vector<SentWrench> commands = stage->commands();
  const std::size_t before = stage->commands_before();
  ASSERT_GE(commands.size(), frames);
  double strongest_N = 0.0, strongest_Nm = 0.0;
  for (std::size_t i = 0; i + before < frames; ++i) {
    ASSERT_EQ(commands[i + before], stage->as_sent(tape.wrenches[i])) << "frame " << i;
    strongest_N = std::max(strongest_N, tape.wrenches[i].f.norm());
    strongest_Nm = std::max(strongest_Nm, tape.wrenches[i].t.norm());
  }
  // The gear is held at its centre: what is felt is torque, where the device has one.
  EXPECT_GT(info.actuates_torque ? strongest_Nm : strongest_N, 0.001) << "the gears were felt";
  const std::vector<std::string> broken = stage->broken_rules();
  EXPECT_TRUE(broken.empty()) << broken.front();
}

INSTANTIATE_TEST_SUITE_P(EveryDriver, DriverSession, ::testing::ValuesIn(every_stage()),
                         [](const ::testing::TestParamInfo<StageMaker>& info) { return info.param.name; });

}  // namespace tactum::driver_session_test
