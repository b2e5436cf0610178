#pragma once
/// The cost of the time of impact of two pieces that fly at each other, spinning, and how tight it is against
/// a dense search of the frame.

#include "bench/pairs.h"
#include "bench/report.h"

namespace tactum::bench {

struct ImpactRow {
  Row row;                ///< regime "approach"; error: gap at the time found, off the target, of the hits
  int hits = 0;           ///< frames in which the pieces meet
  int disagreements = 0;  ///< hit and miss mistaken; a miss is a mistake when the gap goes below the target
  double late_s = 0.0;    ///< found after the first contact, at most: must be none [s]
  double early_s = 0.0;   ///< found before it, at most [s]
};

struct ImpactReport {
  std::vector<ImpactRow> rows;
  std::string how;
};

std::span<const Pair> impact_pairs();
ImpactReport bench_impact(const PairsOptions& options,
                          const std::function<void(const std::string&)>& progress);

Table table_of(const ImpactReport& report);
nlohmann::ordered_json to_json(const ImpactRow& row);

}  // namespace tactum::bench
