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

}  // namespace
}  // namespace tactum::sweep_test
