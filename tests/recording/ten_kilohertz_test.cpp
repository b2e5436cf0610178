/// A loop of its own thread at 10 kHz, recorded: the writer keeps up.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <thread>

#include "app/program.h"
#include "support/effort.h"
#include "tactum/recording/recorder.h"
#include "tactum/recording/replay.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum::ten_kilohertz_test {
namespace {

/// How many frames are lost says something about the machine, too: it is always printed, and must be none
/// where the long tests are asked for, on a machine with two free cores.
TEST(RecorderThread, KeepsUpWithTheGearsAtTenKilohertz) {
  const testing::ScratchFolder folder;
  const bool full = testing::full_run();
  const std::uint64_t frames = full ? 50000 : 3000;
  Result<SceneDescription> description = describe_scene("gears");
  ASSERT_TRUE(description);
  SessionOptions options;
  options.rate_Hz = 10000.0;
  Result<std::unique_ptr<Session>> session = Session::open(*description, options);
  ASSERT_TRUE(session) << session.error().message();
  std::uint64_t dropped = 0, recorded = 0;
  {
    Result<std::unique_ptr<Recorder>> recorder =
        Recorder::open({folder / "run.mcap", "", "of a test"}, *description, **session);
    ASSERT_TRUE(recorder) << recorder.error().message();
    ASSERT_TRUE((*session)->start(frames));
    while ((*session)->loop_status().running) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    (*session)->stop();
    (*recorder)->finish();
    EXPECT_FALSE((*recorder)->trouble());
    dropped = (*recorder)->dropped();
    recorded = (*recorder)->frames();
  }
  std::printf("at 10 kHz: %llu frames recorded, %llu lost\n", static_cast<unsigned long long>(recorded),
              static_cast<unsigned long long>(dropped));
  EXPECT_GE(recorded + dropped, frames);
  if (full) {
    EXPECT_EQ(dropped, 0u);
  }
  const std::string whole = testing::content(folder / "run.mcap");
  const Result<ReplayResult> replayed = replay(McapBytes(whole), "run.mcap", {});
  ASSERT_TRUE(replayed) << replayed.error().message();
  EXPECT_EQ(replayed->same, replayed->frames);
  EXPECT_FALSE(replayed->difference) << sentence_of(*replayed->difference);
  if (dropped == 0) {
    EXPECT_EQ(replayed->frames, recorded);
  }
}

}  // namespace
}  // namespace tactum::ten_kilohertz_test
