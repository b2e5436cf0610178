#pragma once
/// All local minima of distance of two triangle meshes by trying every pair of features: the referee of
/// surface_minima.h. It shares no code with it: cones are determined by angles between face normals and by
/// exhaustion, not by stored polar cones.

#include <vector>

#include "tactum/surface/surface_minima.h"

namespace tactum::oracles {

struct RefereeMinimum {
  /// Sorted vertices of the feature (one, two or three).
  std::vector<int> a, b;
  double distance = 0.0;
  Vec3 p_a = Vec3::Zero(), p_b = Vec3::Zero(), normal = Vec3::Zero();
  /// By how much the weakest of the conditions holds: angles [rad], fractions of a feature, distances as
  /// fractions of the largest distance. Negative: it fails by so little that rounding may decide.
  double margin = 0.0;
};

/// Minima whose margin is above -`error_bound`.
std::vector<RefereeMinimum> every_minimum(const TriangleMesh& a, const TriangleMesh& b, const Pose& X_AB,
                                          const MinimaQuery& query, double error_bound);

}  // namespace tactum::oracles
