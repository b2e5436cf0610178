/// Recordings of scenes with several hands: what every hand did and felt is in them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "app/program.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/recording/bisect.h"
#include "tactum/recording/export_csv.h"
#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/mcap_writer.h"
#include "tactum/recording/recorder.h"
#include "tactum/recording/recording_tape.h"
#include "tactum/recording/replay.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::recorded_hands_test {
namespace {

using testing::content;
using testing::ScratchFolder;

constexpr std::uint64_t kFrames = 1600;

/// Keeps what the session says of the second hand, and asks for a softer coupling on the way.
class SecondHand final : public LoopObserver {
 public:
  SecondHand(Session& session, const Recorder* recorder, bool asks)
      : session_(session), recorder_(recorder), asks_(asks) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    reports.push_back(session_.state().other_reports.front());
    if (recorder_ != nullptr) recorder_->wait_for_room();
    if (!asks_ || record.tick.index != 700) return true;
    SessionCommand command;
    command.kind = SessionCommand::Kind::kSet;
    command.setting = setting_called("coupling.stiffness_N_per_m");
    command.value = 350.0;
    EXPECT_TRUE(session_.ask(command));
    return true;
  }
  std::vector<HandReport> reports;

 private:
  Session& session_;
  const Recorder* recorder_;
  bool asks_;
};

/// Runs the scene of two hands, and records it where a path is given.
std::vector<HandReport> run(const std::string& path, bool asks) {
  const Result<SceneDescription> description = describe_scene("peg-two-hands");
  EXPECT_TRUE(description);
  Result<std::unique_ptr<Session>> session = Session::open(*description, {});
  EXPECT_TRUE(session) << session.error().message();
  EXPECT_EQ((*session)->hands(), 2u);
  std::unique_ptr<Recorder> recorder;
  if (!path.empty()) {
    Result<std::unique_ptr<Recorder>> opened = Recorder::open(
        {.path = path, .version = "of a test", .snapshot_every_s = 0.2}, *description, **session);
    EXPECT_TRUE(opened) << opened.error().message();
    recorder = std::move(*opened);
  }
  SecondHand observer(**session, recorder.get(), asks);
  EXPECT_TRUE((*session)->run_virtual(kFrames, &observer));
  if (recorder) {
    recorder->finish();
    EXPECT_FALSE(recorder->trouble());
    EXPECT_EQ(recorder->dropped(), 0u);
  }
  return std::move(observer.reports);
}

/// Copies a recording, with one message changed and all checksums as they must be.
class Changing final : public McapVisitor {
 public:
  using Change = std::function<bool(const std::string& topic, std::string& data)>;  ///< whether it is kept
  Changing(const std::string& path, Change change) : change_(std::move(change)) {
    auto opened = McapWriter::open(path, "", "a test");
    EXPECT_TRUE(opened);
    writer_ = std::move(*opened);
  }
  ~Changing() override { writer_->close(); }
  Result<void> attachment(mcap::Attachment attachment, std::uint64_t) override {
    writer_->add_attachment(attachment);
    return {};
  }
  Result<void> message(const McapMessage& message) override {
    const std::string& topic = message.channel.topic;
    if (!channels_.contains(topic)) {
      mcap::Channel channel = message.channel;
      channel.schema = message.schema == nullptr ? std::uint16_t{0} : writer_->add_schema(*message.schema);
      channels_[topic] = writer_->add_channel(channel);
    }
    std::string data(message.data);
    if (change_(topic, data)) writer_->add_message(channels_[topic], message.time_ns, data);
    return {};
  }

 private:
  Change change_;
  std::unique_ptr<McapWriter> writer_;
  std::map<std::string, std::uint16_t> channels_;
};

Result<ReplayResult> replay_changed(const std::string& whole, const ScratchFolder& folder,
                                    const Changing::Change& change) {
  {
    Changing changing(folder / "changed.mcap", change);
    EXPECT_TRUE(read_mcap(McapBytes(whole), "run.mcap", changing).complete);
  }
  return replay(McapBytes(content(folder / "changed.mcap")), "changed.mcap", {});
}

TEST(RecordedHands, AreTheSameFramesAgainFromTheStartAndFromEverySnapshot) {
  const ScratchFolder folder;
  for (const bool asks : {false, true}) {
    const std::vector<HandReport> felt = run(folder / "run.mcap", asks);
    const std::vector<HandReport> alone = run("", asks);
    ASSERT_EQ(felt.size(), alone.size());
    for (std::size_t i = 0; i < felt.size(); ++i) ASSERT_EQ(felt[i].shown.f, alone[i].shown.f) << i;
    const std::string whole = content(folder / "run.mcap");
    const Result<ReplayResult> replayed = replay(McapBytes(whole), "run.mcap", {});
    ASSERT_TRUE(replayed) << replayed.error().message();
    EXPECT_EQ(replayed->same, kFrames);
    EXPECT_FALSE(replayed->difference) << sentence_of(*replayed->difference);
    EXPECT_GE(replayed->states, 5u);
    for (const double from_s : {0.5, 0.9, 1.3}) {  // before the command, and behind it
      ReplayOptions options;
      options.from_s = from_s;
      const Result<ReplayResult> late = replay(McapBytes(whole), "run.mcap", options);
      ASSERT_TRUE(late) << late.error().message();
      EXPECT_GT(late->first, 0u);
      EXPECT_EQ(late->same, kFrames - late->first);
      EXPECT_FALSE(late->difference) << sentence_of(*late->difference);
    }
  }
}

/// The report of the second hand is in the file to the bit, and its samples move it.
TEST(RecordedHands, AreInTheFileWithEverythingTheyFelt) {
  const ScratchFolder folder;
  const std::vector<HandReport> felt = run(folder / "run.mcap", false);
  const std::string whole = content(folder / "run.mcap");
  const McapBytes source(whole);
  const auto tape = RecordingTape::open(source, "run.mcap");
  ASSERT_TRUE(tape) << tape.error().message();
  ASSERT_EQ((*tape)->head().other_devices.size(), 1u);
  EXPECT_EQ((*tape)->head().other_devices[0].name, (*tape)->head().device.name);
  std::vector<double> numbers(hand_numbers().size());
  double moved_m = 0.0;
  for (const HandReport& report : felt) {
    const Result<const TapeFrame*> frame = (*tape)->next();
    ASSERT_TRUE(frame && *frame != nullptr);
    ASSERT_EQ((*frame)->others.size(), 1u);
    put_hand_report(report, numbers.data());
    ASSERT_EQ((*frame)->others[0].report, numbers);
    const DeviceSample &first = (*frame)->input.sample, &second = (*frame)->others[0].sample;
    moved_m = std::max(moved_m, (first.X_DH.p - second.X_DH.p).norm());
  }
  EXPECT_GT(moved_m, 0.001) << "the hands do not do the same";
}

TEST(RecordedHands, HaveColumnsOfTheirOwnInTheTable) {
  const ScratchFolder folder;
  const std::vector<HandReport> felt = run(folder / "run.mcap", false);
  const std::string whole = content(folder / "run.mcap"), table = folder / "run.csv";
  std::FILE* out = std::fopen(table.c_str(), "w");
  ASSERT_NE(out, nullptr);
  const Result<CsvExport> exported = export_csv(McapBytes(whole), "run.mcap", out);
  std::fclose(out);
  ASSERT_TRUE(exported);
  EXPECT_EQ(exported->rows, kFrames);
  const std::string text = content(table);
  EXPECT_NE(text.find("# device of hand 2: "), std::string::npos);
  EXPECT_NE(text.find(",h2_sent_fx_N,"), std::string::npos);
  EXPECT_NE(text.find("# column h2_energy_stored_J: of hand 2: "), std::string::npos);
  EXPECT_EQ(text.find("h3_"), std::string::npos);
}

TEST(RecordedHands, AChangedSampleOfTheSecondHandIsNamed) {
  const ScratchFolder folder;
  run(folder / "run.mcap", false);
  const std::string whole = content(folder / "run.mcap");
  const auto of_frame = [](const std::string& topic, const std::string& data, RecordedHand& hand) {
    return topic == recording::kHand && recording::read_hand(data, hand) && hand.index == 900;
  };
  const Result<ReplayResult> moved =
      replay_changed(whole, folder, [&](const std::string& topic, std::string& data) {
        RecordedHand hand;
        if (of_frame(topic, data, hand)) {
          hand.sample.X_DH.p.x() += 1e-4;
          data = recording::hand_message(hand);
        }
        return true;
      });
  ASSERT_TRUE(moved && moved->difference);
  EXPECT_EQ(moved->difference->frame, 900u);
  const std::string changed = content(folder / "changed.mcap");
  const Result<Bisection> bisected =
      bisect_recordings(McapBytes(whole), "run.mcap", McapBytes(changed), "changed.mcap");
  ASSERT_TRUE(bisected && bisected->difference);
  EXPECT_EQ(bisected->difference->frame, 900u);
  EXPECT_EQ(bisected->difference->stage, "input");
  EXPECT_EQ(bisected->difference->field, "h2_p_DH_m");

  const Result<ReplayResult> reported =
      replay_changed(whole, folder, [&](const std::string& topic, std::string& data) {
        RecordedHand hand;
        if (of_frame(topic, data, hand)) {
          hand.report[static_cast<std::size_t>(
              std::find_if(hand_numbers().begin(), hand_numbers().end(),
                           [](const ReportNumber& number) { return number.name == "shown_fx_N"; }) -
              hand_numbers().begin())] += 1.0;
          data = recording::hand_message(hand);
        }
        return true;
      });
  ASSERT_TRUE(reported && reported->difference);
  EXPECT_EQ(reported->difference->frame, 900u);
  EXPECT_EQ(reported->difference->field, "h2_shown_fx_N");

  const Result<ReplayResult> lacking =
      replay_changed(whole, folder, [&](const std::string& topic, std::string& data) {
        RecordedHand hand;
        return !of_frame(topic, data, hand);
      });
  ASSERT_FALSE(lacking);
  EXPECT_NE(lacking.error().message().find("frame 900 lacks what came from a hand"), std::string::npos)
      << lacking.error().message();
}

}  // namespace
}  // namespace tactum::recorded_hands_test
