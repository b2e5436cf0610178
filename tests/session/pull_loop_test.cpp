// A loop of 4 kHz that pulls a Force Dimension device, with its stand-in: how much of its quarter of a
// millisecond a frame takes, in the scenes of the paper. The times are printed and not judged.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "support/effort.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"
#include "tactum/telemetry/statistics.h"
#include "taped_device.h"

namespace tactum::pull_loop_test {

constexpr double kRate_Hz = 4000.0;

double clock_ns() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Times a frame from before the driver's read to after its write; what the stand-in is given lies before.
class TimedDevice final : public SteppedDevice {
 public:
  TimedDevice(std::unique_ptr<Device> inner, DriverStage& stage, const Tape& tape, MinimumOfReplays& least)
      : SteppedDevice(std::move(inner), stage, tape), least_(least) {}
  bool read(double now_s, DeviceSample& sample) noexcept override {
    frame_ = measure(now_s);
    began_ns_ = clock_ns();
    return inner_->read(now_s, sample);
  }
  bool write(const Wrench& F_D) noexcept override {
    const bool taken = Within::write(F_D);
    if (began_ns_ > 0.0) least_.add(frame_, static_cast<std::int64_t>(clock_ns() - began_ns_));
    return taken;
  }

 private:
  MinimumOfReplays& least_;
  std::size_t frame_ = 0;
  double began_ns_ = 0.0;
};

Scene built(const char* name) {
  Result<SceneDescription> description = describe_scene(name);
  EXPECT_TRUE(description) << name;
  Result<Scene> scene = build_scene(*description);
  EXPECT_TRUE(scene) << name;
  return std::move(*scene);
}

bool runs(const char* name, std::unique_ptr<Device> device, std::uint64_t frames) {
  Result<std::unique_ptr<Session>> session = Session::open_with(built(name), std::move(device), kRate_Hz);
  EXPECT_TRUE(session) << (session ? "" : session.error().message());
  if (!session) return false;
  const Result<VirtualRun> ran = (*session)->run_virtual(frames, nullptr);
  EXPECT_TRUE(ran && ran->failed_reads == 0 && ran->failed_writes == 0) << name;
  return static_cast<bool>(ran);
}

class PullLoop : public ::testing::TestWithParam<const char*> {};

TEST_P(PullLoop, TakesItsShareOfAQuarterMillisecondAndSendsTheSameInEveryReplay) {
  const char* name = GetParam();
  const std::unique_ptr<DriverStage> stage = every_stage().front().make();
  const Scene scene = built(name);
  const double duration_s = testing::full_run() ? scene.hand->duration_s() : testing::effort(1.0, 0.1);
  const auto frames = static_cast<std::uint64_t>(duration_s * kRate_Hz);
  const int replays = testing::full_run() ? 7 : 2;

  Result<std::unique_ptr<Device>> asked = stage->connect();
  ASSERT_TRUE(asked) << asked.error().message();
  const DeviceInfo info = (*asked)->info();
  asked->reset();
  const Result<SimulatedDeviceModel> model = simulated_device_preset("sigma.7");
  const Result<HandModel> hand = hand_model("medium");
  ASSERT_TRUE(model && hand);
  Tape tape;
  ASSERT_TRUE(runs(name,
                   std::make_unique<TapedDevice>(std::make_unique<SimulatedDevice>(*model, *hand, scene.hand),
                                                 info, *stage, tape),
                   frames));

  MinimumOfReplays least(frames);
  for (int replay = 0; replay < replays; ++replay) {
    Result<std::unique_ptr<Device>> device = stage->connect();
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE(runs(name, std::make_unique<TimedDevice>(std::move(*device), *stage, tape, least), frames));
    const std::vector<SentWrench> commands = stage->commands();
    ASSERT_GE(commands.size(), frames);
    for (std::size_t i = 0; i < frames; ++i)
      ASSERT_EQ(commands[i], stage->as_sent(tape.wrenches[i])) << "replay " << replay << ", frame " << i;
  }
  const Summary took = least.summary();
  const auto share = [](double time_ns) { return 100.0 * time_ns * kRate_Hz / 1e9; };
  int over = 0;
  for (std::size_t i = 0; i < frames; ++i)
    if (least.at_ns(i) > 1e9 / kRate_Hz) ++over;
  std::printf(
      "%-15s %6llu frames, least of %d replays: mean %5.1f us (%4.1f %%), p99 %5.1f us (%4.1f %%), "
      "max %6.1f us (%5.1f %% of 250 us), %d over\n",
      name, static_cast<unsigned long long>(took.count), replays, took.mean_ns / 1e3, share(took.mean_ns),
      took.p99_ns / 1e3, share(took.p99_ns), took.max_ns / 1e3, share(took.max_ns), over);
  const std::vector<std::string> broken = stage->broken_rules();
  EXPECT_TRUE(broken.empty()) << broken.front();
}

INSTANTIATE_TEST_SUITE_P(ScenesOfThePaper, PullLoop,
                         ::testing::Values("gears", "gears-rim", "peg-in-hole", "moving-objects"),
                         [](const ::testing::TestParamInfo<const char*>& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace tactum::pull_loop_test
