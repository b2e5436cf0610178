#include "bench/report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/program.h"
#include "bench/pairs_plot.h"
#include "bench/svg.h"

namespace tactum::bench::report_test {
namespace {

Row row(const std::string& engine, double median_ns, double error_m, int missed) {
  Row made;
  made.shape_a = made.shape_b = "box";
  made.vertices = 8;
  made.regime = "near";
  made.engine = engine;
  made.frames = 100;
  made.median_ns = median_ns;
  made.p999_ns = 2.0 * median_ns;
  made.max_error_m = error_m;
  made.missed = missed;
  return made;
}

const std::vector<Row> kRows = {row("tactum", 50.0, 0.0, 0), row("quick", 100.0, 0.0, 1),
                                row("rough", 200.0, 2e-6, 0), row("good", 1000.0, 1e-7, 0),
                                row("slow", 3000.0, 0.0, 0)};

TEST(Report, RatiosAreToTheFastestPeerThatIsAccurate) {
  const Table table = against_peers(kRows);
  const std::vector<std::string>& cells = table.rows.at(1);
  EXPECT_EQ(cells[9], "good");
  EXPECT_EQ(cells[12], "20");
}

TEST(Report, MarkdownReplacesOnlyWhatStandsBetweenItsMarks) {
  const testing::ScratchFolder folder;
  const std::string page = folder / "page.md";
  testing::write(page, "before\n\n<!-- pairs -->\nold\n<!-- end pairs -->\n\nafter\n");
  ASSERT_TRUE(write_between_marks(page, "pairs", "| new |\n"));
  EXPECT_EQ(testing::content(page), "before\n\n<!-- pairs -->\n\n| new |\n\n<!-- end pairs -->\n\nafter\n");
  const std::string fresh = folder / "fresh.md";
  ASSERT_TRUE(write_between_marks(fresh, "pairs", "| new |\n"));
  EXPECT_EQ(testing::content(fresh), "| new |\n");
  EXPECT_FALSE(write_between_marks(folder / "no/such/folder.md", "pairs", ""));
}

TEST(Report, LengthsAndTimesInUnitsOfTheirSize) {
  EXPECT_EQ(length_text(0.0), "0");
  EXPECT_EQ(length_text(2.5e-9), "2.5 nm");
  EXPECT_EQ(length_text(2.5e-6), "2.5 µm");
  EXPECT_EQ(length_text(2.5e-3), "2.5 mm");
  EXPECT_EQ(time_text(42.4), "42 ns");
  EXPECT_EQ(time_text(4240.0), "4.24 µs");
  EXPECT_EQ(time_text(4.24e6), "4.24 ms");
}

TEST(Plot, ScalesAreLogarithmic) {
  const LogScale scale = {10.0, 1000.0, 0.0, 200.0};
  EXPECT_NEAR(scale(10.0), 0.0, 1e-12);
  EXPECT_NEAR(scale(100.0), 100.0, 1e-12);
  EXPECT_NEAR(scale(1000.0), 200.0, 1e-12);
}

TEST(Plot, NamesEveryEngineAndMarksTheInaccurate) {
  const std::string svg = pairs_plot(kRows);
  for (const Row& one : kRows) EXPECT_NE(svg.find(">" + one.engine + " "), std::string::npos) << one.engine;
  std::size_t hollow = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1))
    if (svg.compare(svg.find("fill=", at), 11, "fill=\"#fff\"") == 0) ++hollow;
  EXPECT_EQ(hollow, 3u);  // quick, rough, and the legend's
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

}  // namespace
}  // namespace tactum::bench::report_test
