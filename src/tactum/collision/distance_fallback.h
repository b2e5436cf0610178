#pragma once
/// What closest_features does when its walk proves nothing, or the pieces overlapped in the last frame. Rare
/// under motion, and apart so that the frequent way stays short.

#include "tactum/collision/feature_walk.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// An answer is certified when its error bound is at most this [m].
inline double certificate(const PiecePair& pair) noexcept { return tolerances::kCertificate * pair.size; }

/// Climbs down the ladder of docs/algorithms/closest_features.md from a walk that ended with `first` at the
/// features and points of `at`.
PairDistance resolve_uncertified(const PairView& pair, PairCache& cache, const FeatureWalk& first,
                                 const PairDistance& at) noexcept;

/// Pieces that overlapped in the last frame: true with their depth in `x`, when that is proved to be one.
bool still_inside(const PairView& pair, PairCache& cache, PairDistance& x) noexcept;

}  // namespace tactum::inline v0_1
