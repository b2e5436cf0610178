// The command line says what was meant, what is absent and how a run ended.

#include <gtest/gtest.h>
#include <filesystem>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/program.h"
#include "tactum/version.h"

namespace tactum::command_line_test {
namespace {

using testing::content;
using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;
using testing::write;
using Json = nlohmann::json;

void expect_error(const std::string& arguments, int exit_code, const std::string& said) {
  const ProgramRun run = run_tactum(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << "\n" << run.err;
  EXPECT_NE(run.err.find(said), std::string::npos) << arguments << ": " << run.err << "  lacks: " << said;
}

TEST(CommandLine, VersionAndHelp) {
  const ProgramRun version = run_tactum("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, "tactum " + std::to_string(TACTUM_VERSION_MAJOR) + "." +
                             std::to_string(TACTUM_VERSION_MINOR) + "." +
                             std::to_string(TACTUM_VERSION_PATCH) + "\n");
  const ProgramRun help = run_tactum("help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("prepare"), std::string::npos) << help.out;
  for (const char* of : {"help feel", "feel --help"}) {
    const ProgramRun feel = run_tactum(of);
    EXPECT_EQ(feel.exit_code, 0);
    EXPECT_NE(feel.out.find("--virtual-clock"), std::string::npos) << of;
    EXPECT_NE(feel.out.find("2 a goal of the scene was not met"), std::string::npos) << feel.out;
  }
  EXPECT_NE(run_tactum("help bench table1").out.find("--replays"), std::string::npos);
  expect_error("help feal", 2, "expected \"feel\"");
}

TEST(CommandLine, TheNearestCommandAndOption) {
  expect_error("foo", 2, "tactum has no such command: found \"foo\", expected one of feel, replay");
  expect_error("feal gears", 2, "expected \"feel\"");
  expect_error("prepair a.stl", 2, "expected \"prepare\"");
  expect_error("bench tabel1", 2, "tactum bench has no such command: found \"tabel1\", expected \"table1\"");
  expect_error("feel gears --veiw", 2,
               "tactum feel has no such option: found \"--veiw\", expected \"--view\"");
  expect_error("feel gears --virtualclock", 2, "expected \"--virtual-clock\"");
  expect_error("scenes --jsn x", 2, "tactum scenes has no such option");
  expect_error("feel gears --response constrant", 2, "found \"constrant\", expected \"constraint\"");
}

TEST(CommandLine, TheNearestSceneDeviceAndGrip) {
  expect_error("feel geras", 1, "expected \"gears\"");
  expect_error("feel gears --device tuch", 1, "expected 'simulated:touch'");
  expect_error("feel gears --device simulated:tuch", 1, "expected 'touch'");
  expect_error("feel gears --hand frim", 1, "expected 'firm'");
  const std::string feel = "feel block-on-plate --virtual-clock --updates 300 --json - --device ";
  const ProgramRun alone = run_tactum(feel + "touch"), listed = run_tactum(feel + "simulated:touch");
  ASSERT_TRUE(testing::ended(alone)) << alone.err;
  EXPECT_EQ(Json::parse(alone.out)["frame_hash"], Json::parse(listed.out)["frame_hash"]);
}

TEST(CommandLine, NumbersThatAreNone) {
  expect_error("feel gears --duration abc", 2, "--duration: found \"abc\", expected seconds from 0.001 to");
  expect_error("feel gears --duration 5s", 2, "found \"5s\", expected seconds");
  expect_error("feel gears --updates -3", 2,
               "--updates: found \"-3\", expected a number of frames from 1 to");
  expect_error("feel gears --updates 1.5", 2, "without a fraction");
  expect_error("feel gears --virtual-clock --replays many", 2, "found \"many\", expected a number of runs");
}

TEST(CommandLine, AFileThatCannotBeWrittenIsToldBeforeTheRun) {
  const ProgramRun run = run_tactum("feel gears --virtual-clock --updates 500 --json /no/such/x.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("/no/such/x.json: cannot write the file: found No such file or directory"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.out, "") << "nothing ran";
}

const std::string kBlock =
    "schema = 1\n[[body]]\nname = \"plate\"\npart = { box = { size_m = [0.16, 0.16, 0.01] } }\n"
    "pos_m = [0, 0, -0.005]\njoint = { kind = \"fixed\" }\n[[body]]\nname = \"block\"\n"
    "part = { box = { size_m = [0.04, 0.03, 0.02] } }\n";
const std::string kTool =
    "[tool]\nbody = \"block\"\n[hand]\n[[hand.step]]\noffset_m = [0, 0, -0.009]\nduration_s = 0.2\n";
const std::string kRun = " --virtual-clock --updates 300 --json -";

TEST(CommandLine, RemarksArePrintedAndInTheJsonAndStrictMakesThemErrors) {
  const ScratchFolder folder;
  const std::string scene = folder / "overlap.toml";
  write(scene, kBlock + "pos_m = [0, 0, 0.002]\nmass_kg = 1e-9\n" + kTool);
  const ProgramRun run = run_tactum("feel " + scene + kRun);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("remark: \"plate\" and \"block\" overlap at the start"), std::string::npos)
      << run.err;
  const Json remarks = Json::parse(run.out)["remarks"];
  int warnings = 0;
  for (const Json& remark : remarks) warnings += remark["warning"].get<bool>() ? 1 : 0;
  EXPECT_EQ(warnings, 2) << remarks;
  const ProgramRun strict = run_tactum("feel " + scene + " --strict" + kRun);
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_EQ(strict.out, "");
  for (const char* said : {"overlap at the start", "lighter than air", "found 2 remarks, expected none"})
    EXPECT_NE(strict.err.find(said), std::string::npos) << strict.err;
  write(scene, kBlock + "pos_m = [0, 0, 0.015]\n" + kTool);
  const ProgramRun sound = run_tactum("feel " + scene + " --strict" + kRun);
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_EQ(sound.err.find("remark:"), std::string::npos) << sound.err;
  EXPECT_NE(sound.err.find("5 mm from the nearest body, \"plate\""), std::string::npos) << sound.err;
}

TEST(CommandLine, AGoalThatWasNotMetIsExitCode2AfterTheSummary) {
  const ScratchFolder folder;
  const std::string scene = folder / "goal.toml";
  const auto with_goal = [&](const char* direction) {
    write(scene, kBlock + "pos_m = [0, 0, 0.015]\n" + kTool +
                     "[[goal]]\nkind = \"moved\"\nbody = \"block\"\ndirection = " + direction +
                     "\nat_least_m = 0.003\n");
    return run_tactum("feel " + scene + kRun);
  };
  const ProgramRun met = with_goal("[0, 0, -1]");
  EXPECT_EQ(met.exit_code, 0) << met.err;
  EXPECT_EQ(Json::parse(met.out)["goal_met"], true);
  const ProgramRun missed = with_goal("[0, 0, 1]");
  EXPECT_EQ(missed.exit_code, 2) << missed.err;
  EXPECT_EQ(Json::parse(missed.out)["goal_met"], false);
  EXPECT_NE(missed.err.find("not met"), std::string::npos) << missed.err;
  EXPECT_NE(missed.err.find("frames' hash"), std::string::npos) << "the summary comes first: " << missed.err;
}

TEST(CommandLine, TheCouplingIsAWholeSentenceAndNoPercentage) {
  const ProgramRun run = run_tactum("feel block-on-plate --virtual-clock --updates 100");
  EXPECT_NE(run.out.find("is stable in any hand that holds the device; let go, it may buzz (limit 100 N/m"),
            std::string::npos)
      << run.out;
  EXPECT_EQ(run.out.find('%'), std::string::npos) << run.out;
}

/// A tetrahedron as STL, `size` units high.
std::string tetrahedron(double size) {
  const std::string s = std::to_string(size);
  const std::string a = "0 0 0", b = s + " 0 0", c = "0 " + s + " 0", d = "0 0 " + s;
  std::string text = "solid t\n";
  for (const auto& [p, q, r] :
       {std::tuple{a, c, b}, std::tuple{a, b, d}, std::tuple{b, c, d}, std::tuple{a, d, c}})
    text += "facet normal 0 0 0\nouter loop\nvertex " + p + "\nvertex " + q + "\nvertex " + r +
            "\nendloop\nendfacet\n";
  return text + "endsolid t\n";
}

TEST(CommandLine, MeshesAreFeltWithoutASceneFile) {
  const ScratchFolder folder;
  const std::string a = folder / "a.stl", b = folder / "b.STL", saved = folder / "saved.toml";
  write(a, tetrahedron(60));
  write(b, tetrahedron(0.02));
  const ProgramRun one = run_tactum("feel " + a + " --strict --virtual-clock --json - --save-scene " + saved);
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_NE(one.err.find("taken to be in millimetres"), std::string::npos) << one.err;
  EXPECT_NE(one.err.find("15 mm from the nearest body, \"plate\""), std::string::npos) << one.err;
  EXPECT_GT(Json::parse(one.out)["max_force_N"], 0.1) << "it was pressed onto the plate";
  const ProgramRun again = run_tactum("feel " + saved + " --strict --virtual-clock --json -");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["frame_hash"], Json::parse(one.out)["frame_hash"]);
  // The scene and its mesh can be given away together.
  const std::filesystem::path elsewhere = folder / "elsewhere";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::rename(saved, elsewhere / "saved.toml");
  std::filesystem::rename(a, elsewhere / "a.stl");
  const ProgramRun moved =
      run_tactum("feel " + (elsewhere / "saved.toml").string() + " --virtual-clock --json -");
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_EQ(Json::parse(moved.out)["frame_hash"], Json::parse(one.out)["frame_hash"]);
  // A scene that is saved elsewhere, by a path that goes up, finds its mesh too.
  const std::string beside = (elsewhere / "../other.toml").string();
  const std::string mesh = (elsewhere / "a.stl").string();
  const ProgramRun up = run_tactum("feel " + mesh + " --virtual-clock --json - --save-scene " + beside);
  ASSERT_EQ(up.exit_code, 0) << up.err;
  const ProgramRun read = run_tactum("feel " + beside + " --virtual-clock --json -");
  ASSERT_EQ(read.exit_code, 0) << read.err;
  EXPECT_EQ(Json::parse(read.out)["frame_hash"], Json::parse(one.out)["frame_hash"]);
  // A box of 60 mm below.
  const std::string box = folder / "box.obj";
  write(box,
        "v 0 0 0\nv 60 0 0\nv 0 60 0\nv 60 60 0\nv 0 0 60\nv 60 0 60\nv 0 60 60\nv 60 60 60\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  const ProgramRun two = run_tactum("feel " + box + " " + b + " --strict --virtual-clock --json -");
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_NE(two.err.find("taken to be in metres"), std::string::npos) << two.err;
  EXPECT_NE(two.err.find("5 mm from the nearest body, \"box\""), std::string::npos) << two.err;
  EXPECT_GT(Json::parse(two.out)["max_force_N"], 0.1);
  expect_error("feel " + (folder / "none.stl"), 1, "none.stl");
  expect_error("feel gears block-on-plate", 1, "two scenes at once");
  expect_error("feel gears --save-scene " + saved, 1, "--save-scene is for scenes that are made of meshes");
}

TEST(CommandLine, ScenesWhoseMeshesAreAbsentAreMarked) {
  const ScratchFolder folder;
  ::setenv("TACTUM_DATA", (folder / "empty").c_str(), 1);
  const ProgramRun absent = run_tactum("scenes");
  const ProgramRun feel = run_tactum("feel peg-file --virtual-clock");
  ::unsetenv("TACTUM_DATA");
  EXPECT_EQ(absent.exit_code, 0);
  EXPECT_NE(absent.out.find("(absent: factory/"), std::string::npos) << absent.out;
  EXPECT_NE(absent.out.find("TACTUM_DATA, see docs/real-parts.md"), std::string::npos) << absent.out;
  EXPECT_EQ(absent.out.substr(0, absent.out.find("\ngears-rim")).find("absent"), std::string::npos);
  EXPECT_EQ(feel.exit_code, 1);
  EXPECT_NE(feel.err.find("TACTUM_DATA"), std::string::npos) << feel.err;
}

/// A motion file whose hand leaps by 80 mm from one millisecond to the next.
TEST(CommandLine, FaultsThatStoppedTheForceAreToldAndNothingElse) {
  const ScratchFolder folder;
  std::string rows;
  for (int i = 0; i < 400; ++i)
    rows += std::to_string(0.001 * i) + "," + (i < 200 ? "0" : "0.05") + ",0,0,1,0,0,0\n";
  write(folder / "leap.csv", "time_s,x,y,z,qw,qx,qy,qz\n" + rows);
  const std::string feel = "feel block-on-plate --virtual-clock --updates 390 --json - --device replay:";
  const ProgramRun leap = run_tactum(feel + (folder / "leap.csv"));
  ASSERT_TRUE(testing::ended(leap)) << leap.err;
  EXPECT_EQ(Json::parse(leap.out)["safety_events"], Json::array({"pose leapt"})) << leap.out;
  EXPECT_NE(leap.err.find("safety           the wrench was zero for a while: pose leapt"), std::string::npos)
      << leap.err;
  const ProgramRun quiet = run_tactum("feel block-on-plate --virtual-clock --updates 390 --json -");
  EXPECT_EQ(Json::parse(quiet.out)["safety_events"], Json::array());
  EXPECT_EQ(quiet.err.find("\nsafety"), std::string::npos) << quiet.err;
}

}  // namespace
}  // namespace tactum::command_line_test
