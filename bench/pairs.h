#pragma once
/// The cost of the distance of a pair of convex pieces, ours and the peers', over shapes and regimes.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure.h"
#include "bench/motion.h"

namespace tactum::bench {

struct PairsOptions {
  std::vector<std::string> shapes;   ///< pairs by name; empty: all
  std::vector<std::string> regimes;  ///< empty: all
  std::vector<std::string> engines;  ///< empty: ours and every peer
  int frames = 10000;
  int replays = 5;
  double peer_budget_s = 0.2;  ///< for each peer on each recording [s]
  double referee_s = 1.0;      ///< for the search of all depths of each recording [s]
  bool quick = false;          ///< two pairs, few frames: does it work?
};

struct PairsReport {
  std::vector<Row> rows;
  std::string how;    ///< how it was timed
  long recorded = 0;  ///< poses
  long proved = 0;    ///< ... of which the referee proved the distance
};

std::span<const Pair> distance_pairs();
std::span<const Pair> depth_pairs();
/// Those of motion.h that overlap, and deep: see record_deep.
const std::vector<Regime>& depth_regimes();
std::vector<std::string> engine_names();  ///< ours first

/// `progress` is called with each pair before it starts.
PairsReport bench_pairs(const PairsOptions& options, const std::function<void(const std::string&)>& progress);

/// The same for overlaps, with penetration_depth in place of closest_features; the referee searches for the
/// global minimum on as many frames as it can.
PairsReport bench_penetration(const PairsOptions& options,
                              const std::function<void(const std::string&)>& progress);

}  // namespace tactum::bench
