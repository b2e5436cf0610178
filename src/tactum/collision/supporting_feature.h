#pragma once
/// The feature of a piece that takes part in a contact patch, and to which degree: the largest one at the
/// closest point that is square to the normal within an angle; as it leans toward that angle, a smaller part
/// of it is kept.

#include <algorithm>

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The fraction of the patch that is kept when a feature leans by `lean` out of `most`: all up to half, then
/// less, to none.
inline double lean_falloff(double lean, double most) noexcept {
  return std::clamp(2.0 * (most - lean) / most, 0.0, 1.0);
}

/// The feature of one piece that takes part, and how its leaning shrinks the patch: a face toward its edge,
/// and where that leans too much itself, toward the nearest point.
struct SupportingFeature {
  Feature feature;
  int edge = -1;             ///< the edge a leaning face shrinks to; -1: none, the face does not lean
  double face_share = 1.0;   ///< fraction of its rise from that edge that is kept
  double along_share = 1.0;  ///< fraction of the rise along that edge that is kept
};

/// The largest feature at `f` square to `outward` (unit, P's frame) within `angle` [rad]. Beside a face that
/// leans as little the patch shrinks too, so that rolling from one face to the next passes through their
/// edge. Cost: the edges at `f`.
SupportingFeature supporting_feature(const Polytope& P, const Feature& f, const Vec3& outward,
                                     double angle) noexcept;

}  // namespace tactum::inline v0_1
