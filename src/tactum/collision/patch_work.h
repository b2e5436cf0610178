#pragma once
/// Functions common to the makers of contact patches: line_patch.cpp for intervals, area_patch.cpp for
/// polygons; manifold.cpp chooses between them.

#include <algorithm>
#include <span>

#include "tactum/collision/face_projection.h"
#include "tactum/collision/pair_view.h"
#include "tactum/collision/stretch.h"
#include "tactum/collision/supporting_feature.h"

namespace tactum::inline v0_1::detail {

/// The input of a maker. Built in place: copying vectors that have just been written makes the processor wait
/// for them.
struct PatchWork {
  const Polytope& A;
  const Polytope& B;
  const Pose& X_AB;
  const PairDistance& closest;
  double tolerance;
  double angle;
  Vec3 n_B;  ///< the normal in B's frame
  SupportingFeature a, b;
  std::span<const Stretch> others;  ///< of the same kinds as a and b
  Manifold& out;

  PatchWork(const Polytope& of_a, const Polytope& of_b, const Pose& X, const PairDistance& at, double below,
            double within, std::span<const Stretch> stretches, Manifold& patch) noexcept
      : A(of_a),
        B(of_b),
        X_AB(X),
        closest(at),
        tolerance(below),
        angle(within),
        n_B(rotated_back(X.R, at.normal)),
        a(supporting_feature(A, at.a, -at.normal, angle)),
        b(supporting_feature(B, at.b, n_B, angle)),
        others(stretches),
        out(patch) {}

  /// The identity of a point by its place: 0 to 3 of an area, 4 and 5 of a line, 6 of a point. Arms and ends
  /// stay with the features, so the places do.
  std::uint64_t name(std::uint64_t place) const noexcept { return point_id(a.feature, b.feature, place); }
};

/// Points of A and of B over each other at both ends of a segment; linear between.
struct Strip {
  Vec3 a0, a1, b0, b1;
};

/// The fraction of the gap's range that is kept as the features lean.
inline double gap_share(const PatchWork& w) noexcept {
  const auto share_of = [](const SupportingFeature& f) {
    return f.feature.kind == FeatureKind::kFace ? std::max(f.face_share, f.along_share) : f.along_share;
  };
  return std::min(share_of(w.a), share_of(w.b));
}

/// The gap above which the patch ends: the tolerance, or nearer the least gap when the features lean. For a
/// stretch (seam_settler.h) the level is that of the whole contact, whose least gap is at `closest`.
inline double cut_level(const PatchWork& w, double least_gap) noexcept {
  const double share = gap_share(w);
  least_gap = std::min(least_gap, w.closest.distance);
  return share >= 1.0 ? w.tolerance : least_gap + (w.tolerance - least_gap) * share;
}

inline void point_contact(const PatchWork& w) noexcept {
  w.out.points.clear();
  w.out.area = 0.0;
  w.out.points.push_back({w.closest.p_a, w.closest.p_b, w.closest.distance, 1.0, w.name(6)});
}

/// The patch of A's and B's edge, or of an edge of one over a face of the other: two points.
void edge_edge_contact(const PatchWork& w) noexcept;
void edge_a_face_b(const PatchWork& w) noexcept;
void face_a_edge_b(const PatchWork& w) noexcept;

/// The patch of two faces: four points; fewer where they have no common area.
void face_face_contact(const PatchWork& w) noexcept;

/// Two points on a strip: the patch of two faces without a common area.
void strip_contact(const PatchWork& w, const Strip& strip) noexcept;

}  // namespace tactum::inline v0_1::detail
