/// How often the tracked depth is not the smallest where a hand keeps coarse pieces as deep in each other as
/// two fifths: minima lie far apart there, and the lowest may be one that was not there a moment ago.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "bench/motion.h"
#include "bench/shapes.h"
#include "support/effort.h"
#include "tactum/collision/penetration.h"

namespace tactum::bench::deep_overlap_test {
namespace {

TEST(DeepOverlap, FewDepthsOfCoarsePiecesAreNotTheSmallest) {
  constexpr int kFrames =
      testing::kSanitized ? 1000 : 20000;  // fewer are no measure, but find faults of memory
  constexpr int kLongest = 20;             // frames in a row
  const std::uint64_t seed = 7;
  for (const char* name : {"box", "prism16"}) {
    const Shape& piece = shape(name);
    const Recording recording = record_deep(piece, piece, kFrames, seed);
    PairCache cache;
    int missed = 0;
    int row = 0;
    int longest = 0;
    for (const Pose& X : recording.poses) {
      const double depth = -penetration_depth(piece.polytope, piece.polytope, X, cache).distance;
      const double least = -penetration_exhaustive(piece.polytope, piece.polytope, X).distance;
      EXPECT_GE(depth, least - 1e-9) << "less than the least depth is no depth";
      row = depth > least + 1e-6 ? row + 1 : 0;
      missed += row > 0 ? 1 : 0;
      longest = std::max(longest, row);
    }
    std::printf("  %s: %.3f %% missed, %d frames in a row at most\n", name, 100.0 * missed / kFrames,
                longest);
    if (testing::kSanitized) continue;
    EXPECT_LE(missed, 0.003 * kFrames) << name << ", seed " << seed;
    EXPECT_LE(longest, kLongest) << name << ", seed " << seed;
  }
}

}  // namespace
}  // namespace tactum::bench::deep_overlap_test
