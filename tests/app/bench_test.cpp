#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "app/program.h"
#include "bench/pairs.h"

namespace tactum::bench_test {
namespace {

using testing::ProgramRun;
using testing::run_bench;
using testing::ScratchFolder;
using Json = nlohmann::json;

/// The rows of a quick run, each with the keys that every bench writes and times in order.
Json quick_rows(const std::string& arguments) {
  const ScratchFolder folder;
  const ProgramRun run = run_bench(arguments + " --quick --replays 1 --json " + (folder / "rows.json"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("fastest of 1 replays"), std::string::npos);
  EXPECT_NE(run.out.find("% of the queries had too few of those"), std::string::npos);
  const Json rows = Json::parse(testing::content(folder / "rows.json"));
  EXPECT_GT(rows.size(), 0u);
  for (const Json& row : rows) {
    for (const char* key : {"shape_a", "shape_b", "regime", "engine"}) EXPECT_TRUE(row.at(key).is_string());
    for (const char* key : {"vertices", "missed", "frames"}) EXPECT_TRUE(row.at(key).is_number_integer());
    for (const char* key : {"median_ns", "p99_ns", "p999_ns", "max_ns", "shared_core", "max_error_m"})
      EXPECT_TRUE(row.at(key).is_number());
    EXPECT_LE(row["median_ns"], row["p99_ns"]);
    EXPECT_LE(row["p99_ns"], row["p999_ns"]);
    EXPECT_LE(row["p999_ns"], row["max_ns"]);
  }
  return rows;
}

bool ours(const Json& row) { return row.at("engine") == "tactum"; }

TEST(BenchCommand, PairsAnswerEveryQueryRightAndThePeersAnswerToo) {
  std::set<std::string> engines;
  std::set<std::string> regimes;
  for (const Json& row : quick_rows("pairs")) {
    engines.insert(row["engine"]);
    regimes.insert(row["regime"]);
    if (!ours(row)) continue;
    EXPECT_EQ(row["missed"], 0) << row;
    EXPECT_EQ(row["frames"], 200) << row;
    if (row["regime"] != "shallow") {
      EXPECT_LE(row["max_error_m"].get<double>(), 1e-9) << row;
    }
    EXPECT_GE(row["steps_max"].get<double>(), row["steps_mean"].get<double>());
  }
  EXPECT_EQ(regimes, (std::set<std::string>{"near", "touching", "shallow", "far", "cold"}));
  const std::vector<std::string> built_in = bench::engine_names();
  EXPECT_EQ(engines, std::set<std::string>(built_in.begin(), built_in.end()));
  if (built_in.size() == 1) GTEST_SKIP() << "built without FCL, libccd, Bullet and ODE: no peers to measure";
}

TEST(BenchCommand, PairsTakeOnlyWhatIsAskedForAndDrawIt) {
  const ScratchFolder folder;
  const std::string outputs = " --svg " + (folder / "plot.svg") + " --markdown " + (folder / "page.md");
  const Json rows =
      quick_rows("pairs --engines tactum --regimes near,far --shapes box/box,needle/plate" + outputs);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["shape_a"], "box");
  EXPECT_EQ(rows[2]["shape_b"], "plate");
  EXPECT_EQ(testing::content(folder / "plot.svg").rfind("<svg", 0), 0u);
  EXPECT_EQ(testing::content(folder / "page.md").rfind("| pair |", 0), 0u);
  EXPECT_EQ(run_bench("pairs --shapes teapot/teapot").exit_code, 2);
  EXPECT_EQ(run_bench("pairs --engines abacus").exit_code, 2);
}

TEST(BenchCommand, PenetrationCountsTheDepthsThatAreNotTheSmallest) {
  std::set<std::string> regimes;
  for (const Json& row : quick_rows("penetration --shapes box/box,needle/plate")) {
    regimes.insert(row["regime"]);
    if (!ours(row)) continue;
    EXPECT_EQ(row["missed"], 0) << row;
    EXPECT_EQ(row["depths_checked"], 200) << row;  // small pieces: all
    EXPECT_LE(row["depths_wrong"], row["depths_checked"]);
  }
  EXPECT_EQ(regimes, (std::set<std::string>{"deep", "shallow"}));
  for (const Json& row : quick_rows("penetration --shapes box/box --engines tactum --regimes deep"))
    EXPECT_EQ(row["regime"], "deep");
}

TEST(BenchCommand, ManifoldTellsHowFarThePatchMoves) {
  for (const Json& row : quick_rows("manifold --shapes box/box,prism64/prism64")) {
    EXPECT_EQ(row["missed"], 0) << row;
    EXPECT_GT(row["centroid_max_m"].get<double>(), 0.0);
    EXPECT_GT(row["pressure_max_m"].get<double>(), 0.0);
    if (row["regime"] == "sliding") {
      EXPECT_LT(row["centroid_max_m"].get<double>(), 0.1e-3) << row;
    }
  }
}

TEST(BenchCommand, ImpactsAreNeverLate) {
  for (const Json& row : quick_rows("impact --shapes box/box,sphere642/sphere642")) {
    EXPECT_EQ(row["missed"], 0) << row;
    EXPECT_GT(row["hits"], 0);
    EXPECT_EQ(row["disagreements"], 0);
    EXPECT_LE(row["late_s"].get<double>(), 1e-12) << row;      // [s]
    EXPECT_LE(row["max_error_m"].get<double>(), 1e-7) << row;  // [m]
  }
}

}  // namespace
}  // namespace tactum::bench_test
