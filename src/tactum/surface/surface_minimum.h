#pragma once
/// Input and output of surface_minima.h.

#include "tactum/geometry/feature.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// One local minimum, in A's frame: n points from B to A and distance = n . (p_a - p_b), as everywhere.
struct SurfaceMinimum {
  double distance = 0.0;       ///< signed [m]
  Vec3 p_a = Vec3::Zero();     ///< on A [m]
  Vec3 p_b = Vec3::Zero();     ///< on B [m]
  Vec3 normal = Vec3::Zero();  ///< n_BA_A, unit [-]
  Feature a, b;                ///< as in SurfaceTree: vertex, edge 3 t + k, or triangle
  int triangle_a = -1;         ///< the triangle that owns the feature of A, for pictures and group_of()
  int triangle_b = -1;         ///< ... and of B
  bool strict = false;         ///< the normal lies in both true cones, not only in the inflated ones
  bool round = false;          ///< of the curved surface that facets stand for
};

struct MinimaQuery {
  double max_distance = 0.0;    ///< minima up to this distance [m]
  double depth = 0.0;           ///< ... and down to minus this one [m]
  double cone_inflation = 0.0;  ///< inflation of the cones, at most 0.1 [rad]
};

/// Counted work of a query.
struct MinimaWork {
  int box_tests = 0;      ///< pairs of boxes
  int leaf_pairs = 0;     ///< pairs of leaves reached
  int feature_pairs = 0;  ///< pairs of features whose nearest points were computed
  int minima = 0;         ///< found, whether they had room or not
  bool full = false;      ///< more were found than had room: the nearest were kept
};

}  // namespace tactum::inline v0_1
