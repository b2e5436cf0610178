#include "tactum/collision/closest_features.h"

#include <cmath>

#include "tactum/collision/distance_fallback.h"
#include "tactum/collision/vclip_steps.h"

namespace tactum::inline v0_1 {
namespace {

/// The vertices farthest along the line of centres: near the closest features of pieces that were not tracked
/// before. A climb reaches them faster than a walk, whose every step is a pair.
[[gnu::noinline]] FeaturePair first_seed(const PiecePair& pair) noexcept {
  Vec3 toward_b = pair.X_AB * pair.B.extent.center - pair.A.extent.center;
  if (toward_b.isZero()) toward_b = Vec3::UnitX();
  return {vclip::vertex(support_vertex(pair.A, toward_b)),
          vclip::vertex(support_vertex(pair.B, -rotated_back(pair.X_AB.R, toward_b)))};
}

}  // namespace

/// Flattened: the walk's first step is most of the query, and its numbers stay in registers. Every path
/// returns `x`: an answer copied right after it was written waits for its parts.
[[gnu::flatten]] PairDistance closest_features(const Polytope& A, const Polytope& B, const Pose& X_AB,
                                               PairCache& cache) noexcept {
  const PiecePair pair(A, B, X_AB);
  PairDistance x;
  if (cache.overlap.known && still_inside(PairView(pair), cache, x)) return x;
  const bool tracked = valid_feature(A, cache.a) && valid_feature(B, cache.b);
  const FeaturePair seed = tracked ? FeaturePair{cache.a, cache.b} : first_seed(pair);
  const FeatureWalk walk = vclip::walk_features(pair, seed, tolerances::kVoronoiTolerance * pair.scale, x);
  if (!(walk.error_bound <= certificate(pair) && std::abs(x.distance) < vclip::kInfinity)) {
    x = resolve_uncertified(PairView(pair), cache, walk, x);
    return x;
  }
  x.stop = Stop::kCertified;  // the walk proved it itself
  x.steps = walk.steps;
  cache.a = x.a;
  cache.b = x.b;
  cache.normal_A = x.normal;
  cache.overlap.known = false;
  return x;
}

}  // namespace tactum::inline v0_1
