#pragma once
/// The true distances that answers are judged by. For pieces that are apart, a proof that does not depend on
/// how the answer was found: two points that lie on the pieces (in the convex hull of the named feature's
/// corners, by plain arithmetic) bound the distance from above, the gap between support planes over *all*
/// vertices, by a plain scan, bounds it from below. Where the two bounds meet, that is the distance.
///
/// For overlapping pieces the gap over all vertices across any normal bounds the signed distance from below;
/// the truth is the greatest of them. Small pairs: all separating axes in long double (tests/oracles). Larger
/// ones: all facets of the Minkowski difference on some frames, on the others the best of what a warm and a
/// cold search give.

#include <vector>

#include "bench/motion.h"

namespace tactum::bench {

/// The signed distance is in [low, high], if proved; else low is the best that is known.
struct Truth {
  double low = 0.0, high = 0.0;  ///< [m]
  bool proved = false;
  /// How far off a value is, at least [m].
  double error_of(double distance) const;
};

/// `edge_pairs`: how many the exhaustive search may try in all, at 10 ns each.
std::vector<Truth> truths(const Shape& a, const Shape& b, const Recording& recording,
                          double edge_pairs = 1e8);

/// min_A n.a - max_B n.b over every vertex.
double scanned_gap(const Polytope& A, const Polytope& B, const Pose& X_AB, const Vec3& n_A);

}  // namespace tactum::bench
