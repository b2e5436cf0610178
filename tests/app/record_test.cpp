/// tactum feel --record, replay and export, as their users call them: also with a program that is killed and
/// a disk that is full.

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "app/program.h"

namespace tactum::record_test {
namespace {

using testing::content;
using testing::ended;
using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;

std::string program() {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  return "'" + (folder / "tactum").string() + "'";
}

std::string hash_of(const ProgramRun& run) {
  const std::size_t at = run.out.find("frames' hash");
  return at == std::string::npos ? "" : run.out.substr(at, run.out.find('\n', at) - at);
}

int occurrences(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The lines of a table without its head.
std::vector<std::string> rows_of(const std::string& path) {
  std::istringstream text(content(path));
  std::vector<std::string> rows;
  for (std::string line; std::getline(text, line);)
    if (!line.starts_with("#")) rows.push_back(line);
  return rows;
}

TEST(Record, ReplaysToTheBitAndChangesNothing) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  const ProgramRun run = run_tactum("feel gears --virtual-clock --updates 1500 --record " + path);
  ASSERT_TRUE(ended(run)) << run.err;
  EXPECT_NE(run.out.find("1500 frames in " + path), std::string::npos) << run.out;
  EXPECT_EQ(hash_of(run), hash_of(run_tactum("feel gears --virtual-clock --updates 1500")));
  const ProgramRun replayed = run_tactum("replay " + path + " --verify");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_NE(replayed.out.find("all 1500 frames are the same to the bit"), std::string::npos) << replayed.out;
  const ProgramRun other = run_tactum("replay " + path + " --verify --response penalty");
  EXPECT_EQ(other.exit_code, 2) << other.err;
  EXPECT_NE(other.out.find("is the first that differs: stage"), std::string::npos) << other.out;
}

TEST(Record, InRealTimeAsWell) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  const ProgramRun run = run_tactum("feel block-on-plate --updates 300 --record " + path);
  ASSERT_TRUE(ended(run)) << run.err;
  const ProgramRun replayed = run_tactum("replay " + path + " --verify");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err << replayed.out;
}

TEST(Record, TheTableIsThatOfTheTrace) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap", trace = folder / "trace.csv", table = folder / "table.csv";
  const ProgramRun run = run_tactum("feel block-on-plate --virtual-clock --updates 900 --record " + path +
                                    " --trace-bodies --trace " + trace);
  ASSERT_TRUE(ended(run)) << run.err;
  const ProgramRun exported = run_tactum("export " + path + " --csv " + table);
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  const std::vector<std::string> rows = rows_of(table);
  EXPECT_EQ(rows.size(), 901u);
  EXPECT_EQ(rows, rows_of(trace));
  const std::string text = content(table);
  for (const char* part :
       {"# scene: block-on-plate\n", "# rate_Hz: 1000\n", "# setting response = constraint\n",
        "# column sent_fx_N: after safety: what the device was sent\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST(Record, AKilledProgramLeavesWhatItHadWritten) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  const int times = std::getenv("TACTUM_FULL") == nullptr ? 10 : 200;
  std::mt19937 random(7);
  int with_frames = 0;
  for (int i = 0; i < times; ++i) {
    std::filesystem::remove(path);
    const double after_s = std::uniform_real_distribution(0.05, 1.5)(random);
    std::ostringstream command;
    command << "timeout -s KILL " << after_s << " " << program()
            << " feel block-on-plate --virtual-clock --updates 1000000 --record " << path
            << " >/dev/null 2>/dev/null";
    ASSERT_NE(std::system(command.str().c_str()), 0);  // it does not come to its end
    if (!std::filesystem::exists(path)) continue;      // it had not begun
    const ProgramRun replayed = run_tactum("replay " + path + " --verify");
    if (replayed.exit_code == 1) {  // the head was not yet whole
      EXPECT_NE(replayed.err.find("the file was cut"), std::string::npos) << replayed.err;
      continue;
    }
    EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;
    EXPECT_EQ(replayed.out.find("is the first that differs"), std::string::npos) << replayed.out;
    EXPECT_NE(replayed.err.find("The recording has no end"), std::string::npos) << replayed.err;
    if (replayed.out.find("all 0 frames") == std::string::npos) ++with_frames;
  }
  EXPECT_GT(with_frames, 0);
}

TEST(Record, AFullDiskIsToldOnceAndTheRunGoesOn) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  const std::string feel = " feel block-on-plate --virtual-clock --updates 6000";
  // The largest file that the program may write has 400 blocks of 512 bytes.
  const std::string command = "sh -c \"ulimit -f 400; exec " + program() + feel + " --record " + path + " >" +
                              (folder / "out") + " 2>" + (folder / "err") + "\"";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_TRUE(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 2) << content(folder / "err");
  const ProgramRun run{0, content(folder / "out"), content(folder / "err")};
  EXPECT_EQ(occurrences(run.err, "the run goes on, and is not recorded any more"), 1) << run.err;
  EXPECT_EQ(hash_of(run), hash_of(run_tactum(feel)));
  const ProgramRun replayed = run_tactum("replay " + path + " --verify");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err << replayed.out;
  EXPECT_EQ(replayed.out.find("all 0 frames"), std::string::npos) << replayed.out;
}

/// A disk of its own that is too small: what was written before it was full is replayed.
TEST(Record, ADiskThatFillsUpEndsTheRecordingAndNotTheRun) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "disk");
  const std::string disk = folder / "disk";
  const std::string own =
      "unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=400k none " + disk;
  if (std::system((own + "' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "no disk of its own can be made here";
  const std::string feel = " feel block-on-plate --virtual-clock --updates 8000";
  const std::string run_and_replay = own + " && " + program() + feel + " --record " + disk + "/run.mcap >" +
                                     (folder / "out") + " 2>" + (folder / "err") + "; " + program() +
                                     " replay " + disk + "/run.mcap --verify >" + (folder / "replayed") +
                                     " 2>&1; echo $? >" + (folder / "code") + "'";
  std::string command = run_and_replay;  // the program's name is in quotes of its own
  for (std::size_t at = 0; (at = command.find(program(), at)) != std::string::npos;)
    command.replace(at, program().size(), program().substr(1, program().size() - 2));
  ASSERT_EQ(std::system(command.c_str()), 0);
  const ProgramRun run{0, content(folder / "out"), content(folder / "err")};
  EXPECT_EQ(occurrences(run.err, "the run goes on, and is not recorded any more"), 1) << run.err;
  EXPECT_NE(run.err.find("No space left on device"), std::string::npos) << run.err;
  EXPECT_EQ(hash_of(run), hash_of(run_tactum(feel)));
  EXPECT_EQ(content(folder / "code"), "0\n") << content(folder / "replayed");
  EXPECT_NE(content(folder / "replayed").find("frames are the same to the bit"), std::string::npos);
  EXPECT_EQ(content(folder / "replayed").find("all 0 frames"), std::string::npos);
}

TEST(Record, AFileThatIsRemovedMeanwhileIsToldOnceAndTheRunGoesOn) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  const std::string feel = " feel block-on-plate --virtual-clock --updates 30000";
  const std::string command = program() + feel + " --record " + path + " >" + (folder / "out") + " 2>" +
                              (folder / "err") + " & while [ $(stat -c %s " + path +
                              " 2>/dev/null || echo 0) -lt 50000 ]; do sleep 0.01; done; rm " + path +
                              "; wait $!";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_TRUE(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 2) << content(folder / "err");
  const ProgramRun run{0, content(folder / "out"), content(folder / "err")};
  EXPECT_EQ(occurrences(run.err, "the run goes on, and is not recorded any more"), 1) << run.err;
  EXPECT_EQ(hash_of(run), hash_of(run_tactum(feel)));
}

TEST(Record, IsReplayedFromAnySecond) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap";
  ASSERT_TRUE(ended(run_tactum("feel gears --virtual-clock --updates 3500 --record " + path)));
  const ProgramRun late = run_tactum("replay " + path + " --verify --from 2.7");
  EXPECT_EQ(late.exit_code, 0) << late.err;
  EXPECT_NE(late.out.find("begins at frame 2000, 2.000 s after the start"), std::string::npos) << late.out;
  EXPECT_NE(late.out.find("all 1500 frames are the same to the bit"), std::string::npos) << late.out;
  const ProgramRun beyond = run_tactum("replay " + path + " --from 7");
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_NE(beyond.err.find("ends before that time"), std::string::npos) << beyond.err;
  const ProgramRun other = run_tactum("replay " + path + " --verify --from 2.7 --response penalty");
  EXPECT_NE(other.out.find("begins at frame 0"), std::string::npos) << other.out;
}

TEST(Record, IsBisectedAgainstSettingsAndRecordings) {
  const ScratchFolder folder;
  const std::string path = folder / "run.mcap", other = folder / "other.mcap",
                    settings = folder / "soft.toml";
  testing::write(settings, "[settings]\ncoupling.stiffness_N_per_m = 300\n");
  const std::string feel = "feel block-on-plate --virtual-clock --updates 1200 --record ";
  ASSERT_TRUE(ended(run_tactum(feel + path)));
  ASSERT_TRUE(ended(run_tactum(feel + other + " --settings " + settings)));
  const ProgramRun by_settings = run_tactum("replay " + path + " --bisect " + settings);
  EXPECT_EQ(by_settings.exit_code, 2) << by_settings.err;
  EXPECT_NE(by_settings.out.find("is the first that differs: stage \"response\""), std::string::npos)
      << by_settings.out;
  EXPECT_NE(
      by_settings.out.find("setting coupling.stiffness_N_per_m was 600 and is 300; this one alone: frame"),
      std::string::npos)
      << by_settings.out;
  const ProgramRun by_recording = run_tactum("replay " + path + " --bisect " + other);
  EXPECT_EQ(by_recording.exit_code, 2) << by_recording.err;
  EXPECT_NE(by_recording.out.find("the file \"settings.toml\" is another"), std::string::npos)
      << by_recording.out;
  EXPECT_NE(by_recording.out.find("is the first that differs"), std::string::npos) << by_recording.out;
  EXPECT_EQ(run_tactum("replay " + path + " --bisect " + path).exit_code, 0);
}

TEST(Record, APlaceThatCannotBeWrittenIsToldBeforeTheRun) {
  const ProgramRun nowhere = run_tactum("feel gears --virtual-clock --updates 5 --record /nowhere/run.mcap");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_NE(nowhere.err.find("/nowhere/run.mcap: cannot write the recording"), std::string::npos)
      << nowhere.err;
  const ProgramRun name = run_tactum("feel gears --virtual-clock --updates 5 --record run.csv");
  EXPECT_NE(name.err.find("expected a name that ends in .mcap"), std::string::npos) << name.err;
}

/// A folder on a disk that is read only: an error before anything moves, told once, with the reason.
TEST(Record, AReadOnlyFolderIsToldBeforeTheRun) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "disk");
  const std::string disk = folder / "disk";
  const std::string own = "unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o ro none " + disk;
  if (std::system((own + "' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "no disk of its own can be made here";
  const std::string quoted = program();
  const std::string command = own + " && " + quoted.substr(1, quoted.size() - 2) +
                              " feel block-on-plate --virtual-clock --updates 100 --record " + disk +
                              "/run.mcap >" + (folder / "out") + " 2>" + (folder / "err") + "; echo $? >" +
                              (folder / "code") + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(content(folder / "code"), "1\n");
  EXPECT_EQ(occurrences(content(folder / "err"), "run.mcap: cannot write the recording"), 1)
      << content(folder / "err");
  EXPECT_NE(content(folder / "err").find("Read-only file system"), std::string::npos)
      << content(folder / "err");
  EXPECT_EQ(content(folder / "out").find("frames' hash"), std::string::npos) << "it ran all the same";
}

TEST(Record, AFileThatIsNoRecordingIsASentence) {
  const ScratchFolder folder;
  testing::write(folder / "a.mcap", "no recording");
  for (const std::string& command :
       {"replay " + (folder / "a.mcap"), "export " + (folder / "a.mcap") + " --csv -",
        "replay " + (folder / "none.mcap")}) {
    const ProgramRun run = run_tactum(command);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_NE(run.err.find(".mcap"), std::string::npos) << run.err;
  }
}

/// Small runs that were recorded once: every compiler and build type must compute the same frames.
TEST(Record, OldRecordingsAreTheSameFramesToday) {
  int recordings = 0;
  for (const auto& entry : std::filesystem::directory_iterator("tests/recordings")) {
    if (entry.path().extension() != ".mcap") continue;
    const ProgramRun replayed = run_tactum("replay " + entry.path().string() + " --verify");
    EXPECT_EQ(replayed.exit_code, 0) << entry.path() << replayed.out << replayed.err;
    EXPECT_NE(replayed.out.find("frames are the same to the bit"), std::string::npos) << replayed.out;
    ++recordings;
  }
  EXPECT_GE(recordings, 3);
}

}  // namespace
}  // namespace tactum::record_test
