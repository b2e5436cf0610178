#pragma once
/// Two convex pieces and their relative pose, as the input of every query of this folder: B's pose in A, its
/// inverse, and the lengths that tolerances are relative to. Both live for one query.
///
///   separation(n) = min_A n.a - max_B n.b     the gap between the two support planes across n (unit, from
///                                             B to A): a rigorous lower bound on the signed distance,
///                                             whatever n is.

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The input of a walk.
struct PiecePair {
  const Polytope& A;
  const Polytope& B;
  const Pose& X_AB;
  double size;   ///< size of the larger piece, to which certificates are relative [m]
  double scale;  ///< size of the numbers that are added up, to which rounding is relative [m]

  PiecePair(const Polytope& a, const Polytope& b, const Pose& x) noexcept
      : A(a),
        B(b),
        X_AB(x),
        size(std::max(a.extent.size, b.extent.size)),
        scale(x.p.lpNorm<1>() + a.extent.magnitude + b.extent.magnitude) {}
};

/// The input of the longer queries: the inverse as well.
struct PairView : PiecePair {
  Pose X_BA;

  PairView(const Polytope& a, const Polytope& b, const Pose& x) noexcept : PairView(PiecePair(a, b, x)) {}
  explicit PairView(const PiecePair& pair) noexcept : PiecePair(pair), X_BA(pair.X_AB.inverse()) {}

  const Vec3& vertex_a(int v) const noexcept { return A.vertices[v]; }
  /// Vertex of B, in A.
  Vec3 vertex_b(int v) const noexcept { return X_AB * B.vertices[v]; }

  /// The gap across `n`; `a` and `b` are vertices to climb from, and become the supports.
  double separation(const Vec3& n, int& a, int& b) const noexcept {
    a = support_vertex(A, -n, a);
    b = support_vertex(B, X_BA.R * n, b);
    return n.dot(vertex_a(a) - vertex_b(b));
  }
};

/// A pose for which there is no answer: not finite, or so far off that squares of lengths are not.
inline bool is_invalid_pose(const Pose& X) noexcept {
  return !X.R.allFinite() || !std::isfinite(X.p.squaredNorm());
}

/// The answer for such a pose: the distance is not a number, and nothing is proved.
inline PairDistance invalid_result() noexcept {
  PairDistance x;
  x.distance = std::numeric_limits<double>::quiet_NaN();
  x.error_bound = std::numeric_limits<double>::infinity();
  x.a = x.b = {FeatureKind::kVertex, 0};
  return x;
}

/// Some vertex of a feature.
inline int vertex_of(const Polytope& P, const Feature& f) noexcept {
  switch (f.kind) {
    case FeatureKind::kVertex:
      return f.index;
    case FeatureKind::kEdge:
      return P.edges[f.index].tail;
    case FeatureKind::kFace:
      return P.face_vertices[P.faces[f.index].first];
  }
  return 0;
}

/// Some face at a feature.
inline int face_of(const Polytope& P, const Feature& f) noexcept {
  switch (f.kind) {
    case FeatureKind::kVertex:
      return P.edges[P.rays_at(f.index)[0].edge].left;
    case FeatureKind::kEdge:
      return P.edges[f.index].left;
    case FeatureKind::kFace:
      return f.index;
  }
  return 0;
}

/// Whether the feature exists on `P`. A cache may come from another pair of pieces.
inline bool valid_feature(const Polytope& P, const Feature& f) noexcept {
  return f.index >= 0 && f.index < P.counts[static_cast<std::size_t>(f.kind)];
}

/// Whether `point` (P's frame) is over the face, above or below it.
inline bool in_column(const Polytope& P, int face_index, const Vec3& point) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  for (int slot = face.first; slot < face.first + face.count; ++slot)
    if (P.sides[slot].normal.dot(point) > P.sides[slot].offset) return false;
  return true;
}

}  // namespace tactum::inline v0_1
