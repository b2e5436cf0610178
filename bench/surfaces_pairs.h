#pragma once
/// The pairs of surfaces that are measured, with their motions.

#include <optional>

#include "bench/surfaces.h"

namespace tactum::bench {

struct SurfacePair {
  TriangleMesh a, b;
  std::vector<Pose> X_AB;
};

struct SurfacePairEntry {
  std::string name;
  double tolerance_m;
  bool large;  ///< left out of quick runs
  /// Nothing when the data is not there.
  std::optional<SurfacePair> (*make)(const SurfacesOptions& options);
};

const std::vector<SurfacePairEntry>& surface_pairs();

}  // namespace tactum::bench
