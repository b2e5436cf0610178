#include "tactum/telemetry/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tactum/base/random.h"

namespace tactum {
namespace {

/// A long-tailed sample, as frame times are.
std::vector<std::int64_t> frame_times(std::uint64_t seed, int count) {
  Random random(seed);
  std::vector<std::int64_t> times;
  for (int i = 0; i < count; ++i)
    times.push_back(static_cast<std::int64_t>(40.0 * std::exp(std::pow(random.unit(), 4.0) * 14.0)));
  return times;
}

TEST(DurationHistogram, QuantilesAreThoseOfTheSortedSample) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto times = frame_times(seed, 1 + static_cast<int>(seed * seed * 37));
    DurationHistogram histogram;
    for (const auto time : times) histogram.add(time);
    auto sorted = times;
    std::sort(sorted.begin(), sorted.end());
    for (const double q : {0.0, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      // The definition, word for word: the smallest time that at least ceil(q n) do not exceed.
      std::int64_t exact = sorted.back();
      for (const auto candidate : sorted) {
        const auto within = std::upper_bound(sorted.begin(), sorted.end(), candidate) - sorted.begin();
        if (static_cast<double>(within) >= std::ceil(q * static_cast<double>(sorted.size()))) {
          exact = candidate;
          break;
        }
      }
      EXPECT_NEAR(histogram.quantile_ns(q), static_cast<double>(exact),
                  DurationHistogram::kRelativeError * static_cast<double>(exact) + 0.5)
          << "seed " << seed << " q " << q;
      if (q == 0.99) {
        EXPECT_EQ(summary_of(times).p99_ns, static_cast<double>(exact)) << "seed " << seed;
      }
    }
    double sum = 0.0;
    for (const auto time : times) sum += static_cast<double>(time);
    EXPECT_NEAR(histogram.mean_ns(), sum / static_cast<double>(times.size()), 1e-9 * sum);
    EXPECT_EQ(histogram.summary().max_ns, static_cast<double>(sorted.back()));
    EXPECT_EQ(histogram.count(), times.size());
  }
}

TEST(DurationHistogram, EveryMagnitudeKeepsItsRelativeError) {
  for (std::int64_t time = 0; time < (std::int64_t{1} << 40); time = time + 1 + time / 97) {
    DurationHistogram histogram;
    histogram.add(time - 1);
    histogram.add(time);
    histogram.add(time + 1 + time);
    EXPECT_NEAR(histogram.quantile_ns(0.5), static_cast<double>(time),
                DurationHistogram::kRelativeError * static_cast<double>(time))
        << time;
    time += time / 11;
  }
}

TEST(DurationHistogram, OutlandishDurationsDoNoHarm) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.summary().max_ns, 0.0);
  EXPECT_EQ(histogram.quantile_ns(0.5), 0.0);
  histogram.add(-5);
  histogram.add(std::int64_t{1} << 50);
  EXPECT_EQ(histogram.quantile_ns(0.0), 0.0);
  EXPECT_EQ(histogram.summary().max_ns, std::ldexp(1.0, 50));
}

TEST(DurationHistogram, MergedIsTheSameAsAddedTogether) {
  DurationHistogram together, first, second, none;
  for (const auto time : frame_times(31, 999)) {
    together.add(time);
    (time % 3 == 0 ? first : second).add(time);
  }
  first.merge(second);
  first.merge(none);
  none.merge(first);
  for (const double q : {0.0, 0.5, 0.99, 1.0}) {
    EXPECT_EQ(first.quantile_ns(q), together.quantile_ns(q));
    EXPECT_EQ(none.quantile_ns(q), together.quantile_ns(q));
  }
  EXPECT_EQ(first.mean_ns(), together.mean_ns());
  first.clear();
  EXPECT_EQ(first.count(), 0u);
  EXPECT_EQ(first.quantile_ns(1.0), 0.0);
}

TEST(MinimumOfReplays, KeepsTheFastestOfEachFrame) {
  MinimumOfReplays replays(4);
  const std::int64_t times[3][3] = {{10, 200, 30}, {100, 20, 30}, {11, 21, 300}};
  for (const auto& replay : times)
    for (std::size_t frame = 0; frame < 3; ++frame) replays.add(frame, replay[frame]);
  replays.add(4, 1);  // no such frame
  const Summary summary = replays.summary();
  EXPECT_EQ(summary.count, 3u);  // the fourth frame was never recorded
  EXPECT_EQ(summary.max_ns, 30.0);
  EXPECT_EQ(summary.mean_ns, 20.0);
  EXPECT_EQ(summary.p50_ns, 20.0);
  EXPECT_EQ(replays.at_ns(0), 10.0);
}

TEST(Table, ColumnsLineUp) {
  const StageSummary stages[] = {{"closest features", {12499, 71.6, 70.0, 99.0, 200.0, 343.0}},
                                 {"all", {12499, 178922.0, 1.0, 2.0, 3.0, 343000.0}}};
  std::istringstream lines(table_of(stages));
  std::string line;
  std::vector<std::string> all;
  while (std::getline(lines, line)) all.push_back(line);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].size(), all[1].size());
  EXPECT_EQ(all[1].size(), all[2].size());
  EXPECT_NE(all[2].find("178.922"), std::string::npos);
  EXPECT_NE(all[2].find("343.000"), std::string::npos);
}

}  // namespace
}  // namespace tactum
