/// Sweeps: values by their paths, the grid, and the journal of runs.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "app/program.h"
#include "app/sweep/sweep_journal.h"
#include "app/sweep/sweep_table.h"
#include "tactum/scene/scene_file.h"

namespace tactum::sweep_test {
namespace {

using testing::content;
using testing::ScratchFolder;

const char* const kBlock = R"(schema = 1
gravity_m_per_s2 = [0, 0, -9.8]
[[body]]
name = "plate"
part = { box = { size_m = [0.1, 0.1, 0.01] } }
joint = { kind = "fixed" }
[[body]]
name = "block"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0, 0, 0.05]
[tool]
body = "block"
[hand]
[[hand.step]]
offset_m = [0, 0, -0.01]
duration_s = 0.1
)";

Result<SceneDescription> described(const Result<std::string>& text) {
  if (!text) return text.error();
  return parse_description(*text, "block", "block.toml", {});
}

TEST(Sweep, PutsAValueWhereItsPathLeads) {
  for (const char* path : {"body[1].pos_m[2]", "body[block].pos_m[2]"}) {
    const Result<SceneDescription> scene = described(with_value(kBlock, path, 1.0 / 3.0));
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(scene->bodies[1].X_OP.p.z(), 1.0 / 3.0) << path;  // to the bit
  }
  // A section that the scene does not have is made.
  const Result<SceneDescription> made = described(with_value(kBlock, "constraint.max_step_m", 0.00037));
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->settings.frame.constraint.max_step_m, 0.00037);
  const Result<SceneDescription> word = described(with_value(kBlock, "response", std::string("penalty")));
  ASSERT_TRUE(word) << word.error().message();
  EXPECT_EQ(word->settings.frame.response, ResponseModel::kPenalty);
}

TEST(Sweep, NumbersKeepTheirBits) {
  double number = 1.0;
  for (int i = 0; i < 200; ++i) {
    number = std::fmod(number * 16807.0 + 0.1, 97.0);
    const Result<SceneDescription> scene =
        described(with_value(kBlock, "body[block].pos_m[0]", number / 1000.0));
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(scene->bodies[1].X_OP.p.x(), number / 1000.0);
  }
}

TEST(Sweep, APathThatLeadsNowhereIsASentence) {
  for (const char* path : {"body[3].pos_m[0]", "body[blok].pos_m[0]", "body[0].pos_m[7]", "schema.x",
                           "body.x", "[0]", "a..b", "body[", "body[].x", "", "a."}) {
    const Result<std::string> text = with_value(kBlock, path, 1.0);
    ASSERT_FALSE(text) << path << *text;
    EXPECT_NE(text.error().message().find("path of the sweep"), std::string::npos) << text.error().message();
  }
}

SweepPlan a_plan() {
  SweepPlan plan;
  plan.axes = {{"a", {"x"}, {SweepValue(1.0), SweepValue(2.0)}},
               {"b", {"y"}, {SweepValue(std::string("one")), SweepValue(true), SweepValue(std::int64_t{3})}}};
  plan.hash = 77;
  return plan;
}

TEST(Sweep, TheLastAxisChangesFirst) {
  const SweepPlan plan = a_plan();
  EXPECT_EQ(plan.runs(), 6u);
  EXPECT_EQ(plan.places(0), (std::vector<std::size_t>{0, 0}));
  EXPECT_EQ(plan.places(1), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(plan.places(5), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(values_of(plan, 4), "a = 2, b = true");
  EXPECT_EQ(number_of(plan.axes[1], 0), 0.0);
  EXPECT_EQ(number_of(plan.axes[1], 2), 3.0);
}

SweepResult a_result(std::uint64_t run) {
  SweepResult result;
  result.run = run;
  result.hash = 0xfedcba9876543210u;
  for (std::size_t i = 0; i < result.numbers.size(); ++i)
    result.numbers[i] = static_cast<double>(run + i) / 3.0;
  result.numbers[1] = std::numeric_limits<double>::quiet_NaN();
  result.numbers[2] = -0.0;
  result.error = run == 3 ? "it could\nnot be" : "";
  return result;
}

TEST(Sweep, ALineOfTheJournalHoldsEveryBit) {
  const SweepResult result = a_result(3);
  const std::string line = result_line(result);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const std::optional<SweepResult> back = result_of_line(line);
  ASSERT_TRUE(back);
  EXPECT_EQ(result_line(*back), line);
  EXPECT_EQ(back->error, "it could not be");
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string wrong = line;
    wrong[i] = static_cast<char>(wrong[i] ^ 1);
    EXPECT_FALSE(result_of_line(wrong)) << i;
    EXPECT_FALSE(result_of_line(line.substr(0, i))) << i;
  }
}

TEST(Sweep, AJournalThatWasCutAnywhereGoesOn) {
  const ScratchFolder folder;
  const SweepPlan plan = a_plan();
  const std::string path = folder / "journal";
  {
    Result<SweepJournal> journal = SweepJournal::open(path, plan);
    ASSERT_TRUE(journal) << journal.error().message();
    for (const std::uint64_t run : {4u, 1u, 3u}) ASSERT_TRUE(journal->add(a_result(run)));
  }
  const std::string whole = content(path);
  for (std::size_t size = 0; size <= whole.size(); size += 7) {
    testing::write(path, whole.substr(0, size));
    std::size_t kept = 0;
    {
      Result<SweepJournal> journal = SweepJournal::open(path, plan);
      ASSERT_TRUE(journal) << size << journal.error().message();
      kept = journal->done().size();
      for (const std::uint64_t run : journal->pending(plan)) ASSERT_TRUE(journal->add(a_result(run)));
    }
    EXPECT_LE(kept, 3u);
    Result<SweepJournal> again = SweepJournal::open(path, plan);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->pending(plan).empty()) << size;
  }
  SweepPlan other = plan;
  other.hash = 78;
  const Result<SweepJournal> refused = SweepJournal::open(path, other);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("another sweep"), std::string::npos);
}

/// Two hands that press their blocks onto each other, the upper one `first` or the lower one.
std::string two_hands(bool upper_first, double up_m) {
  const auto hand = [up_m](bool upper, const std::string& table) {
    return "[" + table + "]\ngrip = \"firm\"\nstep = [{ offset_m = [0, 0, " +
           std::to_string(upper ? -0.004 : up_m) + "], duration_s = 0.15 }, { hold_s = 0.05 }]\n";
  };
  const std::string body[] = {"body = \"lower\"\n", "body = \"upper\"\n"};
  return R"(schema = 1
[[body]]
name = "lower"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
[[body]]
name = "upper"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0, 0, 0.023]
[[tool]]
)" + body[upper_first] +
         hand(upper_first, "hand") + "[[tool]]\n" + body[!upper_first] + hand(!upper_first, "tool.hand");
}

SweepPlan swept(const ScratchFolder& folder, const std::string& source) {
  testing::write(folder / "sweep.toml", "schema = 1\n" + source + R"(
duration_s = 0.2
jam = { force_N = 0.5, speed_m_per_s = 0.02 }
[[axis]]
name = "stiffness_N_per_m"
path = "coupling.stiffness_N_per_m"
values = [400.0]
)");
  Result<SweepPlan> plan = read_sweep(folder / "sweep.toml");
  EXPECT_TRUE(plan) << plan.error().message();
  return plan ? std::move(*plan) : SweepPlan{};
}

/// The numbers of a run are those of all hands: they do not depend on which hand is the first.
TEST(Sweep, TwoHandsMayBeSwapped) {
  const ScratchFolder folder;
  for (const double up_m : {0.0, 0.001, 0.002, 0.004, 0.006}) {
    SweepResult results[2];
    for (const bool upper_first : {false, true}) {
      testing::write(folder / "two.toml", two_hands(upper_first, up_m));
      results[upper_first] = run_of_sweep(swept(folder, "scene = \"two.toml\""), 0);
      ASSERT_EQ(results[upper_first].error, "");
    }
    for (std::size_t i = 0; i < kSweepMetrics.size(); ++i) {
      const double a = results[0].numbers[i], b = results[1].numbers[i];
      if (std::string(kSweepMetrics[i].name).starts_with("jam_p") || std::isnan(a))
        continue;  // a hand's place
      EXPECT_NEAR(a, b, 0.01 * std::abs(a) + 1e-4) << kSweepMetrics[i].name << " " << up_m;
    }
    EXPECT_GT(results[0].numbers[2], 0.05) << "they do press";
  }
}

/// A recording of two hands gives the run that was recorded, to the bit.
TEST(Sweep, ARecordingOfTwoHandsIsPlayed) {
  const ScratchFolder folder;
  testing::write(folder / "two.toml", "coupling.stiffness_N_per_m = 400.0\n" + two_hands(true, 0.004));
  const testing::ProgramRun run = testing::run_tactum("feel " + (folder / "two.toml") +
                                                      " --virtual-clock --record " + (folder / "two.mcap"));
  ASSERT_LE(run.exit_code, 2) << run.err;
  const SweepResult recorded = run_of_sweep(swept(folder, "recording = \"two.mcap\""), 0);
  const SweepResult scene = run_of_sweep(swept(folder, "scene = \"two.toml\""), 0);
  ASSERT_EQ(recorded.error, "");
  EXPECT_EQ(recorded.hash, scene.hash);
  for (std::size_t i = 0; i < kSweepMetrics.size(); ++i)
    if (!std::isnan(scene.numbers[i])) {
      EXPECT_EQ(recorded.numbers[i], scene.numbers[i]) << kSweepMetrics[i].name;
    }
}

}  // namespace
}  // namespace tactum::sweep_test
