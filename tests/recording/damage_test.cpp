/// What was changed in a recording is named with its place: a scene, a setting, a part, or a single byte.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "app/program.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/recording/mcap_format.h"
#include "tactum/recording/mcap_writer.h"
#include "tactum/recording/recorder.h"
#include "tactum/recording/replay.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"

namespace tactum::recording_damage_test {
namespace {

using testing::content;
using testing::ScratchFolder;

/// Waits for the writer, so that every snapshot finds its room.
class Waiting final : public LoopObserver {
 public:
  explicit Waiting(const Recorder& recorder) : recorder_(recorder) {}
  bool after_frame(const FrameRecord&) noexcept override {
    recorder_.wait_for_room();
    return true;
  }

 private:
  const Recorder& recorder_;
};

/// The recording of a small cube from a file, pressed onto a plate, with settings from another file.
std::string recorded_cube(const ScratchFolder& folder, std::uint64_t frames = 300) {
  testing::write(folder / "cube.obj",
                 "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                 "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  testing::write(folder / "cube.toml",
                 "schema = 1\ndescription = \"a cube from a file\"\n"
                 "[[body]]\nname = \"cube\"\npart = { mesh = \"cube.obj\", scale = 0.02 }\n"
                 "[tool]\nbody = \"cube\"\n[[hand.step]]\noffset_m = [0.01, 0, 0]\nduration_s = 0.2\n");
  testing::write(folder / "soft.toml", "[settings]\ncoupling.stiffness_N_per_m = 300\n");
  Result<SceneDescription> scene = read_description_file(folder / "cube.toml");
  EXPECT_TRUE(scene) << scene.error().message();
  EXPECT_TRUE(change_settings(folder / "soft.toml", *scene));
  Result<std::unique_ptr<Session>> session = Session::open(*scene, {});
  EXPECT_TRUE(session) << session.error().message();
  Result<std::unique_ptr<Recorder>> recorder = Recorder::open(
      {.path = folder / "run.mcap", .version = "of a test", .snapshot_every_s = 0.1}, *scene, **session);
  EXPECT_TRUE(recorder) << recorder.error().message();
  Waiting waiting(**recorder);
  EXPECT_TRUE((*session)->run_virtual(frames, &waiting));
  (*recorder)->finish();
  EXPECT_EQ((*recorder)->dropped(), 0u);
  return content(folder / "run.mcap");
}

/// Copies a recording with changes, and all checksums as they must be.
class Editing final : public McapVisitor {
 public:
  std::function<void(mcap::Attachment&)> edit_file = [](mcap::Attachment&) {};
  std::function<void(const std::string& topic, std::string& data)> edit_message = [](const std::string&,
                                                                                     std::string&) {};

  std::string edited(const std::string& whole, const ScratchFolder& folder) {
    auto opened = McapWriter::open(folder / "edited.mcap", "", "a test");
    EXPECT_TRUE(opened);
    writer_ = std::move(*opened);
    EXPECT_TRUE(read_mcap(McapBytes(whole), "run.mcap", *this).complete);
    writer_->close();
    return content(folder / "edited.mcap");
  }

 private:
  Result<void> attachment(mcap::Attachment attachment, std::uint64_t) override {
    edit_file(attachment);
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
    edit_message(topic, data);
    writer_->add_message(channels_[topic], message.time_ns, data);
    return {};
  }

  std::unique_ptr<McapWriter> writer_;
  std::map<std::string, std::uint16_t> channels_;
};

Result<ReplayResult> replay_of(const std::string& bytes) { return replay(McapBytes(bytes), "run.mcap", {}); }

TEST(RecordingDamage, ACopyWithoutAChangeIsTheSame) {
  const ScratchFolder folder;
  const Result<ReplayResult> replayed = replay_of(Editing().edited(recorded_cube(folder), folder));
  ASSERT_TRUE(replayed) << replayed.error().message();
  EXPECT_EQ(replayed->same, 300u);
  EXPECT_FALSE(replayed->difference) << sentence_of(*replayed->difference);
}

TEST(RecordingDamage, AnEditedSceneSettingsFileOrPartIsNamedWithItsByte) {
  const ScratchFolder folder;
  const std::string whole = recorded_cube(folder);
  for (const char* file : {"scene.toml", "settings.toml", "files/0/cube.obj"}) {
    Editing editing;
    bool found = false;
    editing.edit_file = [&](mcap::Attachment& attachment) {
      if (attachment.name != file) return;
      found = true;
      attachment.data.back() = '\t';  // white space for white space: nothing else tells that it was edited
    };
    const std::string edited = editing.edited(whole, folder);
    EXPECT_TRUE(found) << file;
    const Result<ReplayResult> replayed = replay_of(edited);
    ASSERT_FALSE(replayed) << file;
    const std::string message = replayed.error().message();
    EXPECT_NE(message.find(std::string("\"") + file + "\" is not the file that was recorded"),
              std::string::npos)
        << message;
    const std::size_t place =
        edited.find(file) - 29;  // head of the record, two times, and a length before it
    EXPECT_NE(replayed.error().where.find("byte " + std::to_string(place)), std::string::npos) << message;
  }
}

TEST(RecordingDamage, AnEditedSettingOfTheHeadIsNamed) {
  const ScratchFolder folder;
  Editing editing;
  editing.edit_message = [](const std::string& topic, std::string& data) {
    const std::string key = "\"coupling.stiffness_N_per_m\":";
    const std::size_t at = topic == recording::kRun ? data.find(key) : std::string::npos;
    if (at != std::string::npos) data.replace(at + key.size(), 5, "450.0");
  };
  const Result<ReplayResult> replayed = replay_of(editing.edited(recorded_cube(folder), folder));
  ASSERT_TRUE(replayed) << replayed.error().message();
  ASSERT_EQ(replayed->notes.size(), 1u);
  EXPECT_EQ(replayed->notes[0], "coupling.stiffness_N_per_m is 300 in the scene and was 450 at the start");
  ASSERT_TRUE(replayed->difference);
  EXPECT_FALSE(replayed->difference->field.empty());
}

TEST(RecordingDamage, AnEditedSettingOrByteOfASnapshotIsNamed) {
  const ScratchFolder folder;
  const std::string whole = recorded_cube(folder);
  const int setting = setting_called("coupling.stiffness_N_per_m");
  for (const bool state : {false, true}) {
    Editing editing;
    std::string bytes;
    editing.edit_message = [&](const std::string& topic, std::string& data) {
      RecordedSnapshot snapshot;
      if (topic != recording::kSnapshot || !recording::read_snapshot_message(data, snapshot)) return;
      if (snapshot.index != 200) return;
      bytes = std::string(snapshot.state);
      char& last_of_safety = bytes[bytes.size() - 1 - sizeof(std::uint64_t)];  // behind it: no other hand
      if (state)
        last_of_safety = static_cast<char>(last_of_safety ^ 1);
      else
        snapshot.settings[static_cast<std::size_t>(setting)] = 450.0;
      snapshot.state = bytes;
      data = recording::snapshot_message(snapshot);
    };
    const Result<ReplayResult> replayed = replay_of(editing.edited(whole, folder));
    ASSERT_FALSE(bytes.empty());
    ASSERT_TRUE(replayed) << replayed.error().message();
    ASSERT_TRUE(replayed->difference);
    EXPECT_EQ(replayed->difference->frame, 200u);
    const std::string sentence = sentence_of(*replayed->difference);
    const char* expected =
        state ? "of \"safety\"" : "the setting coupling.stiffness_N_per_m, which was 450 and is 300";
    EXPECT_NE(sentence.find(expected), std::string::npos) << sentence;
  }
}

struct FoundRecord {
  mcap::Op op;
  std::size_t place = 0, size = 0;  ///< of the whole record
};

std::vector<FoundRecord> records_of(const std::string& whole) {
  std::vector<FoundRecord> records;
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHead < whole.size();) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 8; ++i)
      length |= std::uint64_t{static_cast<unsigned char>(whole[at + 1 + i])} << (8 * i);
    records.push_back({static_cast<mcap::Op>(whole[at]), at, mcap::kRecordHead + length});
    at += records.back().size;
  }
  return records;
}

/// In every kind of record, at its middle and its last byte: the record is named, or the checksum that is
/// over it, with the byte of either.
TEST(RecordingDamage, AFlippedByteIsNamedWithItsRecord) {
  const ScratchFolder folder;
  const std::string whole = recorded_cube(folder);
  const std::vector<FoundRecord> records = records_of(whole);
  ASSERT_EQ(records.back().op, mcap::Op::kFooter);
  const auto end = std::find_if(records.begin(), records.end(),
                                [](const FoundRecord& record) { return record.op == mcap::Op::kDataEnd; });
  ASSERT_NE(end, records.end());
  std::set<mcap::Op> seen;
  for (const FoundRecord& record : records)
    for (const std::size_t in_it :
         {mcap::kRecordHead + (record.size - mcap::kRecordHead) / 2, record.size - 1}) {
      std::string bytes = whole;
      bytes[record.place + in_it] = static_cast<char>(bytes[record.place + in_it] ^ 0x10);
      const Result<ReplayResult> replayed = replay_of(bytes);
      ASSERT_TRUE(!replayed || !replayed->end.complete) << record.place + in_it;
      const Error error = replayed ? *replayed->end.wrong : replayed.error();
      const bool in_summary = record.place > end->place;
      const bool itself =
          !in_summary && (record.op == mcap::Op::kAttachment || record.op == mcap::Op::kChunk ||
                          record.op == mcap::Op::kMessageIndex);
      const FoundRecord& named = itself ? record : in_summary ? records.back() : *end;
      const std::string of = std::string(" of a ") + mcap::name_of(named.op) + " record";
      EXPECT_NE(error.message().find(of), std::string::npos) << of << ": " << error.message();
      EXPECT_NE(error.where.find("byte " + std::to_string(named.place)), std::string::npos)
          << record.place << ": " << error.message();
      seen.insert(record.op);
    }
  for (const mcap::Op op :
       {mcap::Op::kHeader, mcap::Op::kAttachment, mcap::Op::kChunk, mcap::Op::kMessageIndex,
        mcap::Op::kMetadata, mcap::Op::kDataEnd, mcap::Op::kFooter})
    EXPECT_TRUE(seen.contains(op)) << mcap::name_of(op);
}

}  // namespace
}  // namespace tactum::recording_damage_test
