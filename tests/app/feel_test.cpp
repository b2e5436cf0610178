#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "app/program.h"

namespace tactum::feel_test {
namespace {

using testing::ended;
using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;
using Json = nlohmann::json;

TEST(FeelCommand, TheSummaryForMachinesHasItsKeys) {
  const ProgramRun run = run_tactum("feel gears --virtual-clock --updates 3000 --json -");
  ASSERT_TRUE(ended(run)) << run.err;
  const Json summary = Json::parse(run.out);
  EXPECT_EQ(summary["frames"], 3000);
  for (const char* key : {"penetrating_frames", "max_penetration_m", "max_force_N", "max_force_step_N"})
    EXPECT_TRUE(summary[key].is_number()) << key;
  for (const char* key : {"mean", "p50", "p99", "p999", "max"})
    EXPECT_GT(summary["frame_us"][key], 0.0) << key;
  EXPECT_EQ(summary["stages_us"].size(), 6u);
  EXPECT_EQ(summary["frame_hash"].get<std::string>().size(), 16u);
  EXPECT_TRUE(summary["goal_met"].is_boolean());
  EXPECT_GT(summary["colliding_frames"], 1000);
}

TEST(FeelCommand, ATraceHasARowForEachFrame) {
  const ScratchFolder folder;
  const std::string path = folder / "run.csv";
  const ProgramRun run =
      run_tactum("feel block-on-plate --virtual-clock --updates 1500 --trace-bodies --trace " + path);
  ASSERT_TRUE(ended(run)) << run.err;
  EXPECT_NE(run.out.find("1500 frames in " + path), std::string::npos) << run.out;
  std::ifstream file(path);
  std::string line, head, names;
  while (std::getline(file, line) && line.starts_with("#")) head += line + "\n";
  names = line;
  for (const char* part :
       {"# scene: block-on-plate\n", "# frames: 1500\n", "# rate_Hz: 1000\n", "# date: 20",
        "# setting coupling.stiffness_N_per_m = 600\n", "# setting response = constraint\n"})
    EXPECT_NE(head.find(part), std::string::npos) << part << head;
  for (const char* name : {"time_s,", ",hand_qw,", ",sent_fx_N,", ",energy_balance_J,", ",block_vx_m_per_s,"})
    EXPECT_NE(names.find(name), std::string::npos) << name;
  int rows = 0;
  const auto commas = std::count(names.begin(), names.end(), ',');
  for (; std::getline(file, line); ++rows) ASSERT_EQ(std::count(line.begin(), line.end(), ','), commas);
  EXPECT_EQ(rows, 1500);
  const ProgramRun live = run_tactum("feel block-on-plate --updates 200 --trace " + path);
  EXPECT_TRUE(ended(live)) << live.err;
  EXPECT_NE(live.out.find("frames in " + path), std::string::npos) << live.out;
}

TEST(FeelCommand, ATraceThatCannotBeWrittenIsAnError) {
  const ProgramRun folder =
      run_tactum("feel block-on-plate --virtual-clock --updates 10 --trace /nowhere/run.csv");
  EXPECT_NE(folder.exit_code, 0);
  EXPECT_NE(folder.err.find("cannot write the trace"), std::string::npos) << folder.err;
  const ProgramRun ending = run_tactum("feel block-on-plate --virtual-clock --updates 10 --trace run.txt");
  EXPECT_NE(ending.exit_code, 0);
  EXPECT_NE(ending.err.find(".csv"), std::string::npos) << ending.err;
}

TEST(FeelCommand, TheSameTwiceAndADurationInsteadOfUpdates) {
  const ProgramRun updates = run_tactum("feel block-on-plate --virtual-clock --updates 2000 --json -");
  const ProgramRun duration = run_tactum("feel block-on-plate --virtual-clock --duration 2 --json -");
  ASSERT_TRUE(ended(updates)) << updates.err;
  ASSERT_TRUE(ended(duration)) << duration.err;
  EXPECT_EQ(Json::parse(updates.out)["frame_hash"], Json::parse(duration.out)["frame_hash"]);
}

TEST(FeelCommand, ReplaysAreTheSameRunAndTimeItsFramesByTheirFastest) {
  const std::string feel = "feel block-on-plate --virtual-clock --updates 2000 --json -";
  const ProgramRun once = run_tactum(feel);
  const ProgramRun thrice = run_tactum(feel + " --replays 3");
  ASSERT_TRUE(ended(thrice)) << thrice.err;
  const Json one = Json::parse(once.out);
  const Json three = Json::parse(thrice.out);
  EXPECT_EQ(one["replays"], 1);
  EXPECT_EQ(three["replays"], 3);
  EXPECT_EQ(one["frames"], three["frames"]);
  EXPECT_EQ(one["frame_hash"], three["frame_hash"]);
  EXPECT_GT(three["frame_us"]["p50"], 0.0);
  EXPECT_NE(run_tactum("feel block-on-plate --updates 100 --replays 3").exit_code, 0) << "live";
}

TEST(FeelCommand, EveryGripAndSimulatedDeviceRuns) {
  for (const char* grip : {"loose", "medium", "firm"}) {
    const ProgramRun run =
        run_tactum(std::string("feel gears --virtual-clock --updates 1500 --json - --hand ") + grip);
    ASSERT_TRUE(ended(run)) << run.err;
    EXPECT_EQ(Json::parse(run.out)["non_finite_frames"], 0);
  }
  for (const char* device : {"touch", "omega.6", "sigma.7", "virtuose-6d"}) {
    const ProgramRun run = run_tactum(
        std::string("feel block-on-plate --virtual-clock --updates 3000 --json - --device simulated:") +
        device);
    ASSERT_TRUE(ended(run)) << run.err;
    EXPECT_GT(Json::parse(run.out)["max_force_N"], 0.1) << device;
  }
}

TEST(FeelCommand, TheResponseCanBeChosen) {
  // Pressed into the plate the published springs let the block enter; by default nothing is entered.
  const std::string feel = "feel block-on-plate --virtual-clock --updates 3000 --json -";
  const ProgramRun plain = run_tactum(feel);
  const ProgramRun constraint = run_tactum(feel + " --response constraint");
  const ProgramRun penalty = run_tactum(feel + " --response penalty");
  ASSERT_TRUE(ended(penalty)) << penalty.err;
  EXPECT_NE(penalty.err.find("response penalty"), std::string::npos) << penalty.err;
  EXPECT_GT(Json::parse(penalty.out)["penetrating_frames"], 100);
  EXPECT_EQ(Json::parse(constraint.out)["penetrating_frames"], 0);
  EXPECT_EQ(Json::parse(plain.out)["frame_hash"], Json::parse(constraint.out)["frame_hash"]);
  EXPECT_EQ(run_tactum(feel + " --response rubber").exit_code, 2);
}

/// Of surfaces the referee says in how many frames bodies overlapped, of pieces the gaps do; the line for a
/// person and the summary for machines have one number.
TEST(FeelCommand, TheVerdictOnOverlapsIsOneAndHasItsJudge) {
  struct Judging {
    const char* run;
    const char* judge;
    int judged;
  };
  for (const auto& [what, judge, judged] :
       {Judging{"gears-involute --updates 230", "the referee", 6},
        {"gears-involute --updates 230 --referee", "the referee", 230},
        {"gears-involute --updates 201 --response penalty", "the referee", 5},
        {"block-on-plate --updates 2000 --response penalty", "the gaps at the ends of steps", 2000},
        {"block-on-plate --updates 2000 --response penalty --referee", "the referee", 2000}}) {
    const ProgramRun run = run_tactum(std::string("feel --virtual-clock --json - ") + what);
    ASSERT_TRUE(ended(run)) << run.err;
    const Json summary = Json::parse(run.out);
    EXPECT_EQ(summary["penetrating_judge"], judge) << what;
    EXPECT_EQ(summary["penetrating_judged_frames"], judged) << what;
    const std::string verdict = "penetrating in " + summary["penetrating_frames"].dump() + " of " +
                                std::to_string(judged) + " frames judged by " + judge;
    EXPECT_NE(run.err.find(verdict), std::string::npos) << verdict << '\n' << run.err;
    if (std::string(what).starts_with("block")) {
      EXPECT_GT(summary["penetrating_frames"], 100) << what;
    }
  }
}

/// Scenes whose hand goes 80 mm, or turns by a radian, in `duration_s`.
std::string free_block(const char* response, const char* motion, double duration_s) {
  return std::string("schema = 1\nresponse = \"") + response +
         "\"\n[[body]]\nname = \"block\"\npart = { box = { size_m = [0.04, 0.03, 0.02] } }\n" +
         "[tool]\nbody = \"block\"\ngrasp = \"centre\"\n[workspace]\nscale = 1\n" +
         "[hand]\n[[hand.step]]\nhold_s = 0.2\n[[hand.step]]\n" + motion +
         "\nduration_s = " + std::to_string(duration_s) + "\n";
}

TEST(FeelCommand, AHandThatThePartCannotFollowIsToldWithTheSetting) {
  const ScratchFolder folder;
  const char* const there = "offset_m = [0.08, 0, 0]";
  const char* const round = "rpy_deg = [0, 0, 60]";
  struct Case {
    const char* response;
    const char* motion;
    double duration_s;
    const char* setting;  // empty: nothing is said
  };
  for (const Case& c : {Case{"constraint", there, 0.02, "raise constraint.max_step_m"},
                        Case{"constraint", round, 0.01, "raise constraint.max_turn_deg"},
                        Case{"penalty", there, 0.02, "raise penalty.max_step_m"},
                        Case{"constraint", there, 0.5, ""}, Case{"penalty", there, 0.5, ""}}) {
    testing::write(folder / "scene.toml", free_block(c.response, c.motion, c.duration_s));
    const ProgramRun run =
        run_tactum("feel " + (folder / "scene.toml") + " --hand firm --virtual-clock --updates 900 --json -");
    ASSERT_TRUE(ended(run)) << run.err;
    const Json summary = Json::parse(run.out);
    const std::string notes = summary["notes"].dump();
    if (*c.setting == '\0') {
      EXPECT_EQ(summary["lagging_frames"], 0);
      EXPECT_EQ(notes, "[]");
    } else {
      EXPECT_GT(summary["lagging_frames"], 0);
      EXPECT_NE(notes.find(c.setting), std::string::npos) << notes;
      EXPECT_NE(run.err.find(c.setting), std::string::npos) << "printed: " << run.err;
    }
  }
}

TEST(FeelCommand, InterruptedItEndsCleanlyWithItsSummary) {
  const ScratchFolder folder;
  const std::string said = folder / "said";
  const std::string json = folder / "summary.json";
  const ProgramRun run = run_tactum("feel gears --duration 600 --json " + json + " >" + said +
                                    " & tactum=$!; while kill -0 $tactum && ! [ -s " + said +
                                    " ]; do sleep 0.1; done; sleep 0.5; kill -INT $tactum; wait $tactum");
  EXPECT_TRUE(ended(run)) << run.err;
  EXPECT_LT(Json::parse(testing::content(json))["frames"], 300'000);
  EXPECT_NE(testing::content(said).find("driven turned by"), std::string::npos);
}

TEST(FeelCommand, WhatIsNotThereIsNamedWithWhatThereIs) {
  const ProgramRun scene = run_tactum("feel nowhere");
  EXPECT_EQ(scene.exit_code, 1);
  EXPECT_NE(scene.err.find("gears-rim"), std::string::npos) << scene.err;
  const ProgramRun device = run_tactum("feel gears --device spoon");
  EXPECT_EQ(device.exit_code, 1);
  EXPECT_NE(device.err.find("simulated:omega.6"), std::string::npos) << device.err;
  EXPECT_EQ(run_tactum("feel gears --updates minus").exit_code, 2);
  EXPECT_EQ(run_tactum("").exit_code, 2);
}

TEST(BenchCommand, Table1HasThePublishedRowsAndKeys) {
  const ScratchFolder folder;
  const ProgramRun run = run_tactum("bench table1 --updates 1500 --replays 2 --json " + (folder / "t.json"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("0.178922"), std::string::npos);  // published average
  EXPECT_NE(run.out.find("10870"), std::string::npos);     // published collisions
  const Json table = Json::parse(testing::content(folder / "t.json"));
  for (const char* key : {"updates", "average_us", "worst_us", "worst_us_min_of_replays", "collision_tests",
                          "collision_average_us", "nbody_tests", "nbody_average_us", "exact_tests",
                          "exact_average_us", "collisions", "response_average_us", "missed_deadlines"})
    EXPECT_TRUE(table[key].is_number()) << key;
  EXPECT_EQ(table["updates"], 1500);
  EXPECT_LE(table["worst_us_min_of_replays"], table["worst_us"]);
  EXPECT_GT(table["exact_tests"], 1500);
}

TEST(ScenesCommand, ListsThem) {
  const ProgramRun run = run_tactum("scenes");
  EXPECT_EQ(run.exit_code, 0);
  for (const char* scene : {"gears", "gears-rim", "peg-in-hole", "peg-file", "block-on-plate"})
    EXPECT_NE(run.out.find(scene), std::string::npos) << scene;
  EXPECT_EQ(run_tactum("devices").exit_code, 0);
}

}  // namespace
}  // namespace tactum::feel_test
