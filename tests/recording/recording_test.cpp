/// Recordings of whole runs: what is in them, and that they are the same frames again.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "app/program.h"
#include "support/effort.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/recording/bisect.h"
#include "tactum/recording/export_csv.h"
#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/mcap_writer.h"
#include "tactum/recording/recorder.h"
#include "tactum/recording/recording_tape.h"
#include "tactum/recording/replay.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::recording_test {
namespace {

using testing::content;
using testing::ScratchFolder;

/// Asks for settings at certain frames, and waits for the writer.
class Asking final : public LoopObserver {
 public:
  Asking(Session& session, const Recorder* recorder, bool asks)
      : session_(session), recorder_(recorder), asks_(asks) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    if (recorder_ != nullptr) recorder_->wait_for_room();
    if (!asks_ || record.tick.index % 100 != 50) return true;
    SessionCommand command;
    command.kind = SessionCommand::Kind::kSet;
    command.setting = setting_called("coupling.stiffness_N_per_m");
    command.value = 300.0 + static_cast<double>(record.tick.index);
    EXPECT_TRUE(session_.ask(command));
    return true;
  }

 private:
  Session& session_;
  const Recorder* recorder_;
  bool asks_;
};

struct Ran {
  std::uint64_t hash = 0;
  std::uint64_t frames = 0, dropped = 0;
};

/// Runs a scene, and records it where a path is given.
Ran run(const SceneDescription& description, const std::string& path, std::uint64_t frames, bool asks = false,
        ResponseModel response = ResponseModel::kConstraint, double snapshot_every_s = 1.0) {
  Result<Scene> scene = build_scene(description);
  EXPECT_TRUE(scene) << scene.error().message();
  scene->settings.response = response;
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  EXPECT_TRUE(session);
  std::unique_ptr<Recorder> recorder;
  if (!path.empty()) {
    Result<std::unique_ptr<Recorder>> opened = Recorder::open(
        {.path = path, .version = "of a test", .snapshot_every_s = snapshot_every_s}, description, **session);
    EXPECT_TRUE(opened) << opened.error().message();
    recorder = std::move(*opened);
  }
  Asking observer(**session, recorder.get(), asks);
  EXPECT_TRUE((*session)->run_virtual(frames, &observer));
  Ran ran{(*session)->record().hash()};
  if (!recorder) return ran;
  recorder->finish();
  EXPECT_FALSE(recorder->trouble());
  ran.frames = recorder->frames();
  ran.dropped = recorder->dropped();
  return ran;
}

SceneDescription scene_called(const std::string& name) {
  Result<SceneDescription> scene = describe_scene(name);
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

Result<ReplayResult> replay_bytes(const std::string& bytes, const ReplayOptions& options = {}) {
  return replay(McapBytes(bytes), "run.mcap", options);
}

/// Copies a recording, with an attachment changed and all checksums as they must be.
class Copying final : public McapVisitor {
 public:
  Copying(const std::string& path, std::string edited) : edited_(std::move(edited)) {
    auto opened = McapWriter::open(path, "", "a test");
    EXPECT_TRUE(opened);
    writer_ = std::move(*opened);
  }
  ~Copying() override { writer_->close(); }
  Result<void> attachment(mcap::Attachment attachment, std::uint64_t) override {
    if (attachment.name == edited_) attachment.data += " ";
    writer_->add_attachment(attachment);
    return {};
  }
  Result<void> message(const McapMessage& message) override {
    if (!channels_.contains(message.channel.topic)) {
      const std::uint16_t schema =
          message.schema == nullptr ? std::uint16_t{0} : writer_->add_schema(*message.schema);
      mcap::Channel channel = message.channel;
      channel.schema = schema;
      channels_[message.channel.topic] = writer_->add_channel(channel);
    }
    writer_->add_message(channels_[message.channel.topic], message.time_ns, message.data);
    return {};
  }

 private:
  std::string edited_;
  std::unique_ptr<McapWriter> writer_;
  std::map<std::string, std::uint16_t> channels_;
};

TEST(Recording, IsTheSameFramesAgainAndChangesNone) {
  const ScratchFolder folder;
  constexpr unsigned kFrames = testing::effort(700u, 150u);
  for (const char* name : {"block-on-plate", "gears", "moving-objects", "gears-pick", "dipole-field"})
    for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
      SCOPED_TRACE(name);
      const SceneDescription scene = scene_called(name);
      const Ran recorded = run(scene, folder / "run.mcap", kFrames, false, response);
      EXPECT_EQ(recorded.hash, run(scene, "", kFrames, false, response).hash);
      EXPECT_EQ(recorded.frames, kFrames);
      EXPECT_EQ(recorded.dropped, 0u);
      const Result<ReplayResult> replayed = replay_bytes(content(folder / "run.mcap"));
      ASSERT_TRUE(replayed) << replayed.error().message();
      EXPECT_TRUE(replayed->end.complete);
      EXPECT_EQ(replayed->same, kFrames);
      EXPECT_FALSE(replayed->difference) << sentence_of(*replayed->difference);
      EXPECT_FALSE(replayed->gap);
    }
}

TEST(Recording, CommandsAreReplayedAtTheirFrames) {
  const ScratchFolder folder;
  const SceneDescription scene = scene_called("block-on-plate");
  const Ran asked = run(scene, folder / "run.mcap", 1500, true);
  EXPECT_NE(asked.hash, run(scene, "", 1500).hash);  // the commands count
  const Result<ReplayResult> replayed = replay_bytes(content(folder / "run.mcap"));
  ASSERT_TRUE(replayed);
  EXPECT_EQ(replayed->same, 1500u);
}

TEST(Recording, IsReplayedFromEverySnapshot) {
  const ScratchFolder folder;
  const std::vector<const char*> scenes = {"block-on-plate", "gears",        "moving-objects",
                                           "gears-pick",     "dipole-field", "dominoes"};
  for (const char* name : testing::sampled(scenes, 3))
    for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
      SCOPED_TRACE(name);
      run(scene_called(name), folder / "run.mcap", 600, true, response, 0.04);
      const std::string whole = content(folder / "run.mcap");
      const auto tape = RecordingTape::open(McapBytes(whole), "run.mcap");
      ASSERT_TRUE(tape) << tape.error().message();
      const std::vector<TapeSnapshot>& snapshots = (*tape)->snapshots();
      ASSERT_GE(snapshots.size(), 5u);
      for (std::size_t i = 0; i < snapshots.size(); i += testing::effort<std::size_t>(1, 5)) {
        const std::uint64_t first = snapshots[i].index;
        ReplayOptions options;
        options.from_s = (static_cast<double>(first) + 0.5) * (*tape)->head().dt_s;
        const Result<ReplayResult> replayed = replay_bytes(whole, options);
        ASSERT_TRUE(replayed) << replayed.error().message();
        EXPECT_EQ(replayed->first, first);
        EXPECT_EQ(replayed->same, 600u - first);
        EXPECT_EQ(replayed->states, snapshots.size() - 1 - i);
        ASSERT_FALSE(replayed->difference) << "from " << first << ": " << sentence_of(*replayed->difference);
      }
    }
}

TEST(Recording, ThatWasCutAnywhereIsReplayedAsFarAsItGoes) {
  const ScratchFolder folder;
  run(scene_called("block-on-plate"), folder / "run.mcap", 900);
  const std::string whole = content(folder / "run.mcap");
  std::uint64_t most = 0;
  for (std::size_t part = 1; part < 24; ++part) {
    const std::size_t size = whole.size() * part / 24 + part;
    const Result<ReplayResult> replayed = replay_bytes(whole.substr(0, size));
    if (!replayed) continue;  // the head is not whole
    EXPECT_FALSE(replayed->end.complete);
    EXPECT_TRUE(replayed->end.cut);
    EXPECT_EQ(replayed->same, replayed->frames);
    most = std::max(most, replayed->frames);
  }
  EXPECT_GT(most, 300u);
  EXPECT_FALSE(replay_bytes(whole.substr(0, 20)));
}

TEST(Recording, AnEditedSceneIsNamed) {
  const ScratchFolder folder;
  run(scene_called("block-on-plate"), folder / "run.mcap", 20);
  const std::string whole = content(folder / "run.mcap");
  for (const char* edited : {"", "scene.toml"}) {
    {
      Copying copying(folder / "copy.mcap", edited);
      EXPECT_TRUE(read_mcap(McapBytes(whole), "run.mcap", copying).complete);
    }
    const Result<ReplayResult> replayed = replay_bytes(content(folder / "copy.mcap"));
    if (*edited == '\0') {
      ASSERT_TRUE(replayed) << replayed.error().message();
      EXPECT_EQ(replayed->same, 20u);
      continue;
    }
    ASSERT_FALSE(replayed);
    EXPECT_NE(replayed.error().message().find("\"scene.toml\" is not the file that was recorded"),
              std::string::npos)
        << replayed.error().message();
    EXPECT_NE(replayed.error().where.find("byte"), std::string::npos);
  }
}

TEST(Recording, OtherSettingsDifferAndTheFirstFieldIsNamed) {
  const ScratchFolder folder;
  run(scene_called("block-on-plate"), folder / "run.mcap", 1500);
  const std::string whole = content(folder / "run.mcap");
  testing::write(folder / "softer.toml", "[settings]\ncoupling.stiffness_N_per_m = 300\n");
  const Result<ReplayResult> softer =
      replay_bytes(whole, {.response = "", .settings = folder / "softer.toml"});
  ASSERT_TRUE(softer) << softer.error().message();
  ASSERT_TRUE(softer->difference);
  EXPECT_FALSE(softer->difference->field.empty());
  EXPECT_EQ(softer->difference->stage, "response");
  EXPECT_LT(softer->replayed.max_force_N, softer->recorded.max_force_N);
  const Result<ReplayResult> springs = replay_bytes(whole, {.response = "penalty"});
  ASSERT_TRUE(springs) << springs.error().message();
  EXPECT_TRUE(springs->difference);
}

/// The first frame that differs, and the setting that it comes from, of two that were changed.
TEST(Recording, IsBisectedToTheSettingThatDiffers) {
  const ScratchFolder folder;
  run(scene_called("block-on-plate"), folder / "run.mcap", 1500);
  const std::string whole = content(folder / "run.mcap");
  const McapBytes source(whole);
  // A limit that is never reached beside a coupling that is felt from the first contact on.
  testing::write(folder / "other.toml",
                 "[settings]\ncoupling.stiffness_N_per_m = 300\nsafety.max_force_N = 8\n");
  const Result<Bisection> found =
      bisect_settings(source, "run.mcap", {}, {.response = "", .settings = folder / "other.toml"});
  ASSERT_TRUE(found) << found.error().message();
  ASSERT_TRUE(found->difference);
  const Result<ReplayResult> softer =
      replay_bytes(whole, {.response = "", .settings = folder / "other.toml"});
  ASSERT_TRUE(softer && softer->difference);
  EXPECT_EQ(found->difference->frame, softer->difference->frame);
  EXPECT_EQ(found->difference->stage, softer->difference->stage);
  EXPECT_EQ(found->difference->field, softer->difference->field);
  EXPECT_EQ(found->frames, softer->same);
  ASSERT_EQ(found->settings.size(), 2u);
  for (const DifferingSetting& setting : found->settings)
    EXPECT_EQ(setting.alone.has_value(), setting.key == "coupling.stiffness_N_per_m") << setting.key;
}

TEST(Recording, OfAnotherHandDiffersInItsInput) {
  const ScratchFolder folder;
  const SceneDescription scene = scene_called("block-on-plate");
  run(scene, folder / "a.mcap", 900);
  run(scene, folder / "b.mcap", 900, true);  // the coupling is changed on the way: the hand yields otherwise
  const std::string a = content(folder / "a.mcap"), b = content(folder / "b.mcap");
  const Result<Bisection> same = bisect_recordings(McapBytes(a), "a.mcap", McapBytes(a), "a.mcap");
  ASSERT_TRUE(same);
  EXPECT_EQ(same->frames, 900u);
  EXPECT_FALSE(same->difference);
  const Result<Bisection> other = bisect_recordings(McapBytes(a), "a.mcap", McapBytes(b), "b.mcap");
  ASSERT_TRUE(other && other->difference);
  EXPECT_GE(other->difference->frame, 50u);  // that of the first command
  EXPECT_EQ(other->frames, other->difference->frame);
  EXPECT_TRUE(other->notes.empty());
}

/// Reads the run of another recorder: begun in the middle, ended, and begun again while the loop goes on.
TEST(RecorderThread, BeginsAndEndsInTheMiddleOfARun) {
  const ScratchFolder folder;
  const SceneDescription description = scene_called("gears");
  Result<std::unique_ptr<Session>> session = Session::open(description, {});
  ASSERT_TRUE(session);
  RecordSwitch through;
  (*session)->report_to(&through);
  const UserSettings settings{(*session)->scene().settings, (*session)->scene().safety};
  ASSERT_TRUE((*session)->start());
  const auto wait_for = [&](std::uint64_t frames) {
    const std::uint64_t from = (*session)->loop_status().frames;
    while ((*session)->loop_status().frames < from + frames) std::this_thread::yield();
  };
  for (const char* file : {"one.mcap", "two.mcap"}) {
    wait_for(40);
    RecorderOptions options{folder / file, "", "of a test"};
    options.midway = settings;
    options.snapshot_every_s = 0.05;
    Result<std::unique_ptr<Recorder>> recorder = Recorder::open(options, description, **session, &through);
    ASSERT_TRUE(recorder) << recorder.error().message();
    wait_for(120);
    (*recorder)->finish();
  }
  (*session)->stop();
  for (const char* file : {"one.mcap", "two.mcap"}) {
    const Result<ReplayResult> replayed = replay_bytes(content(folder / file));
    ASSERT_TRUE(replayed) << replayed.error().message();
    EXPECT_GE(replayed->first, 40u);
    EXPECT_GE(replayed->frames, 100u);
    EXPECT_EQ(replayed->same, replayed->frames);
    EXPECT_GE(replayed->states, 1u);
    EXPECT_TRUE(replayed->end.complete);
  }
}

TEST(Recording, HasItsPartsInside) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj",
                 "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                 "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  testing::write(folder / "cube.toml",
                 "schema = 1\ndescription = \"a cube from a file\"\n"
                 "[[body]]\nname = \"cube\"\npart = { mesh = \"cube.obj\", scale = 0.02 }\n"
                 "[tool]\nbody = \"cube\"\n[[hand.step]]\noffset_m = [0.01, 0, 0]\nduration_s = 0.2\n");
  {
    const Result<SceneDescription> scene = read_description_file(folder / "cube.toml");
    ASSERT_TRUE(scene) << scene.error().message();
    run(*scene, folder / "run.mcap", 200);
  }
  std::filesystem::remove(folder / "cube.obj");
  std::filesystem::remove(folder / "cube.toml");
  const Result<ReplayResult> replayed = replay_bytes(content(folder / "run.mcap"));
  ASSERT_TRUE(replayed) << replayed.error().message();
  EXPECT_EQ(replayed->same, 200u);
}

TEST(Recording, EverySingleFlippedByteIsNoticed) {
  const ScratchFolder folder;
  run(scene_called("block-on-plate"), folder / "run.mcap", 5);
  const std::string whole = content(folder / "run.mcap");
  for (std::size_t place = 0; place < whole.size(); place += 1 + whole.size() / testing::effort(300, 30)) {
    std::string bytes = whole;
    bytes[place] = static_cast<char>(bytes[place] ^ 0x10);
    const Result<ReplayResult> replayed = replay_bytes(bytes);
    if (!replayed) {
      EXPECT_NE(replayed.error().message().find("byte"), std::string::npos) << replayed.error().message();
      continue;
    }
    ASSERT_FALSE(replayed->end.complete) << place;
    EXPECT_NE(replayed->end.wrong->where.find("byte"), std::string::npos);
  }
}

TEST(RecorderThread, TakesTheFramesOfTheLoopsOwnThread) {
  const ScratchFolder folder;
  const SceneDescription description = scene_called("block-on-plate");
  Result<std::unique_ptr<Session>> session = Session::open(description, {});
  ASSERT_TRUE(session);
  {
    Result<std::unique_ptr<Recorder>> recorder =
        Recorder::open({folder / "run.mcap", "", "of a test"}, description, **session);
    ASSERT_TRUE(recorder);
    ASSERT_TRUE((*session)->start(150));
    while ((*session)->loop_status().running) std::this_thread::yield();
    (*session)->stop();
    (*recorder)->finish();
    EXPECT_EQ((*recorder)->dropped(), 0u);
  }
  const Result<ReplayResult> replayed = replay_bytes(content(folder / "run.mcap"));
  ASSERT_TRUE(replayed) << replayed.error().message();
  EXPECT_GE(replayed->frames, 150u);  // and those of the ramp
  EXPECT_EQ(replayed->same, replayed->frames);
}

TEST(Recording, ASceneMadeInCodeIsRefused) {
  const ScratchFolder folder;
  SceneDescription scene = scene_called("block-on-plate");
  scene.source.text.clear();
  Result<Scene> built = build_scene(scene);
  ASSERT_TRUE(built);
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*built), {});
  ASSERT_TRUE(session);
  EXPECT_FALSE(Recorder::open({folder / "run.mcap", "", "of a test"}, scene, **session));
}

}  // namespace
}  // namespace tactum::recording_test
