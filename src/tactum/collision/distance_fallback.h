#pragma once
/// The methods that closest_features uses when its walk proves nothing, or the pieces overlapped in the last
/// frame. They are rarely needed under motion, and stand apart so that the frequent path stays short.

#include "tactum/collision/feature_walk.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// An answer is certified when its error bound is at most this [m].
inline double certificate(const PiecePair& pair) noexcept { return tolerances::kCertificate * pair.size; }

/// Tries the slower methods of docs/algorithms/closest_features.md in turn, from a walk that ended with
/// `first` at the features and points of `at`.
PairDistance resolve_uncertified(const PairView& pair, PairCache& cache, const FeatureWalk& first,
                                 const PairDistance& at) noexcept;

/// For pieces that overlapped in the last frame: true, with their depth in `x`, when they are proved to
/// overlap still.
bool still_inside(const PairView& pair, PairCache& cache, PairDistance& x) noexcept;

}  // namespace tactum::inline v0_1
