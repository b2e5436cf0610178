#pragma once
/// The cost of the contact patch of two pieces, and its steadiness: the displacement of its centroid in a
/// frame of a slow hand.

#include "bench/pairs.h"
#include "bench/report.h"

namespace tactum::bench {

struct ManifoldRow {
  Row row;                       ///< regime "sliding" or "rocking"; error: of the gap the patch is made for
  double centroid_p999_m = 0.0;  ///< step of the centroid by the points' weights, in a frame [m]
  double centroid_max_m = 0.0;   ///< [m]
  double pressure_max_m = 0.0;   ///< ... by weight times how far the gap is below the tolerance [m]
  double shown_max_m = 0.0;      ///< of the centroid as it is shown to a hand (steady_contact.h) [m]
};

struct ManifoldReport {
  std::vector<ManifoldRow> rows;
  std::string how;
};

std::span<const Pair> patch_pairs();
ManifoldReport bench_manifold(const PairsOptions& options,
                              const std::function<void(const std::string&)>& progress);

Table table_of(const ManifoldReport& report);
nlohmann::ordered_json to_json(const ManifoldRow& row);

}  // namespace tactum::bench
