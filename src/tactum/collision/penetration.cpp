#include "tactum/collision/penetration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tactum/collision/manifold.h"
#include "tactum/collision/minkowski_walk.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

/// Pairs of edges up to which a cold start looks at every separating axis: 10 ns each.
constexpr std::size_t kSmallEdgePairs = 4096;

bool small_pair(const PairView& pair) noexcept {
  return pair.A.edges.size() * pair.B.edges.size() <= kSmallEdgePairs;
}

/// Calls `visit(facet)` for every facet of the Minkowski difference.
template <class Visit>
void for_every_facet(const PairView& pair, const Visit& visit) noexcept {
  int vertex = 0;
  for (std::size_t f = 0; f < pair.A.faces.size(); ++f) {
    const MinkowskiFacet facet = facet_of_face(pair, true, static_cast<int>(f), vertex);
    vertex = facet.b.index;
    visit(facet);
  }
  vertex = 0;
  for (std::size_t f = 0; f < pair.B.faces.size(); ++f) {
    const MinkowskiFacet facet = facet_of_face(pair, false, static_cast<int>(f), vertex);
    vertex = facet.a.index;
    visit(facet);
  }
  for (std::size_t i = 0; i < pair.A.edges.size(); ++i)
    for (std::size_t j = 0; j < pair.B.edges.size(); ++j)
      if (const auto facet = facet_of_edges(pair, static_cast<int>(i), static_cast<int>(j))) visit(*facet);
}

/// Where faces or edges of both pieces lie in the support planes, several facets of the difference make one,
/// and the walk may end beside the foot. Then the features of the support vertices `a`, `b` are clipped
/// against each other. False when they do not meet.
bool witness_on_plane(const PairView& pair, int a, int b, PairDistance& result) noexcept {
  PairDistance supports = result;
  supports.a = {Kind::kVertex, a};
  supports.b = {Kind::kVertex, b};
  supports.p_a = pair.vertex_a(a);
  supports.p_b = pair.vertex_b(b);
  Manifold patch;
  contact_manifold_within(pair.A, pair.B, pair.X_AB, supports, result.distance + pair.size,
                          tolerances::kSamePlane, patch);
  Vec3 p_a = Vec3::Zero();
  Vec3 p_b = Vec3::Zero();
  for (const ContactPoint& point : patch.points) {
    p_a += point.p_a * point.weight;
    p_b += point.p_b * point.weight;
  }
  if ((p_a - p_b - result.normal * result.distance).norm() > tolerances::kCertificate * pair.size)
    return false;
  result.p_b = p_b;
  result.p_a = p_b + result.normal * result.distance;
  result.a = patch.a;
  result.b = patch.b;
  return true;
}

/// The answer a walk stands for, its depth by true supports.
PairDistance answer(const PairView& pair, const MinkowskiWalk& walk, int steps) noexcept {
  PairDistance result;
  int a = vertex_of(pair.A, walk.facet.a);
  int b = vertex_of(pair.B, walk.facet.b);
  result.normal = walk.facet.n;
  result.distance = pair.separation(walk.facet.n, a, b);
  result.a = walk.facet.a;
  result.b = walk.facet.b;
  result.p_b = walk.p_b;
  result.p_a = walk.p_b + walk.facet.n * result.distance;
  result.steps = steps;
  const double tolerance = tolerances::kCertificate * pair.size;
  const bool real = std::abs(result.distance + walk.facet.height) <= tolerance;
  result.stop = Stop::kBounded;
  if (real && walk.outside <= tolerance) result.stop = Stop::kCertified;
  if (real && walk.outside > tolerance && witness_on_plane(pair, a, b, result)) result.stop = Stop::kFallback;
  return result;
}

/// Keeps the shallowest of several walks; of equals, one that is certified.
class Shallowest {
 public:
  explicit Shallowest(const PairView& pair) noexcept : pair_(pair) {}

  void from(const MinkowskiFacet& seed) noexcept { take(walk_to_foot(pair_, seed)); }

  void take(const MinkowskiWalk& walk) noexcept {
    steps_ += walk.steps;
    const PairDistance next = answer(pair_, walk, 0);
    const double slack = tolerances::kCertificate * pair_.size;
    const bool better = next.certified() == best_.certified() ? next.distance > best_.distance
                        : next.certified()                    ? next.distance > best_.distance - slack
                                                              : next.distance > best_.distance + slack;
    if (!any_ || better) best_ = next;
    any_ = true;
  }
  bool any() const noexcept { return any_; }
  PairDistance best() const noexcept {
    PairDistance result = best_;
    result.steps = steps_;
    return result;
  }

 private:
  const PairView& pair_;
  PairDistance best_;
  bool any_ = false;
  int steps_ = 0;
};

/// The facet of the cached features, if the pair of kinds makes one and (for edges) their arcs still cross.
std::optional<MinkowskiFacet> cached_facet(const PairView& pair, const PairCache& cache) noexcept {
  if (!valid_feature(pair.A, cache.a) || !valid_feature(pair.B, cache.b)) return std::nullopt;
  if (cache.a.kind == Kind::kFace)
    return facet_of_face(pair, true, cache.a.index, vertex_of(pair.B, cache.b));
  if (cache.b.kind == Kind::kFace)
    return facet_of_face(pair, false, cache.b.index, vertex_of(pair.A, cache.a));
  if (cache.a.kind == Kind::kEdge && cache.b.kind == Kind::kEdge)
    return facet_of_edges(pair, cache.a.index, cache.b.index);
  return std::nullopt;
}

Vec3 line_of_centers(const PairView& pair) noexcept {
  const Vec3 n = pair.A.center - pair.X_AB * pair.B.center;
  return n.isZero() ? Vec3::UnitX() : n;
}

/// Walks from the line of centres and from the shallowest facets near 26 directions all around: three of
/// them, and more until one ends certified.
void from_many_directions(const PairView& pair, Shallowest& shallowest) noexcept {
  constexpr int kWalked = 8;
  shallowest.from(facet_near(pair, line_of_centers(pair)));
  std::array<MinkowskiFacet, 26> seeds;
  std::size_t count = 0;
  for (int i = 0; i < 27; ++i) {
    const Vec3 n(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!n.isZero()) seeds[count++] = facet_near(pair, n);
  }
  std::sort(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.height < b.height; });
  int walked = 0;
  for (const MinkowskiFacet& seed : seeds)
    if (walked++ < kWalked || !shallowest.best().certified()) shallowest.from(seed);
}

/// Every facet that `allowed(n)` lets pass: the walk from the shallowest finds witness points inside its
/// features, or they are inside those of another facet as shallow.
template <class Allowed>
void from_every_facet(const PairView& pair, Shallowest& shallowest, const Allowed& allowed) noexcept {
  MinkowskiFacet best;
  best.height = std::numeric_limits<double>::infinity();
  for_every_facet(pair, [&](const MinkowskiFacet& facet) {
    if (facet.height < best.height && allowed(facet.n)) best = facet;
  });
  if (best.a.index < 0) return;
  const MinkowskiWalk walk = walk_to_foot(pair, best);
  if (allowed(walk.facet.n)) shallowest.take(walk);
  if (shallowest.any() && shallowest.best().certified()) return;
  const double level = best.height + tolerances::kCertificate * pair.size;
  for_every_facet(pair, [&](const MinkowskiFacet& facet) {
    if (facet.height <= level && allowed(facet.n)) shallowest.take(stand_on(pair, facet));
  });
}

void remember(const PairDistance& result, PairCache& cache) noexcept {
  cache.a = result.a;
  cache.b = result.b;
  cache.normal_A = result.normal;
}

}  // namespace

PairDistance penetration_depth(const Polytope& A, const Polytope& B, const Pose& X_AB,
                               PairCache& cache) noexcept {
  const PairView pair(A, B, X_AB);
  Shallowest shallowest(pair);
  if (!cache.normal_A.isZero()) {
    const auto facet = cached_facet(pair, cache);
    shallowest.from(facet ? *facet : facet_near(pair, cache.normal_A));
    shallowest.from(facet_near(pair, line_of_centers(pair)));
  }
  if (!shallowest.any() || !shallowest.best().certified()) {
    if (small_pair(pair)) {
      from_every_facet(pair, shallowest, [](const Vec3&) { return true; });
    } else {
      from_many_directions(pair, shallowest);
    }
  }
  const PairDistance result = shallowest.best();
  remember(result, cache);
  return result;
}

PairDistance penetration_exhaustive(const Polytope& A, const Polytope& B, const Pose& X_AB) noexcept {
  const PairView pair(A, B, X_AB);
  Shallowest shallowest(pair);
  from_every_facet(pair, shallowest, [](const Vec3&) { return true; });
  return shallowest.best();
}

PairDistance penetration_one_sided(const Polytope& A, const Polytope& B, const Pose& X_AB,
                                   const OneSided& sides, PairCache& cache) noexcept {
  const PairView pair(A, B, X_AB);
  const auto allowed = [&](const Vec3& n) {
    return (!sides.outward_a || n.dot(*sides.outward_a) <= 0.0) &&
           (!sides.outward_b || (pair.X_BA.R * n).dot(*sides.outward_b) >= 0.0);
  };
  Shallowest shallowest(pair);
  const auto take = [&](const MinkowskiFacet& seed) {
    const MinkowskiWalk walk = walk_to_foot(pair, seed);
    if (allowed(walk.facet.n)) shallowest.take(walk);
  };
  if (const auto facet = cached_facet(pair, cache)) take(*facet);
  if (small_pair(pair)) {
    from_every_facet(pair, shallowest, allowed);
  } else {
    take(facet_near(pair, line_of_centers(pair)));
  }
  if (!shallowest.any()) {  // the surface's own normal
    if (sides.outward_a) shallowest.from(facet_near(pair, -*sides.outward_a));
    if (sides.outward_b) shallowest.from(facet_near(pair, X_AB.R * *sides.outward_b));
    if (!shallowest.any()) shallowest.from(facet_near(pair, line_of_centers(pair)));
  }
  const PairDistance result = shallowest.best();
  remember(result, cache);
  return result;
}

PairDistance depth_along(const Polytope& A, const Polytope& B, const Pose& X_AB,
                         const Vec3& direction) noexcept {
  const PairView pair(A, B, X_AB);
  const MinkowskiWalk walk = walk_along_ray(pair, facet_near(pair, direction), direction);
  PairDistance result = answer(pair, walk, walk.steps);
  const double across = walk.facet.n.dot(direction);
  const double length = across > 0.0 ? walk.facet.height / across : 0.0;
  if (!result.certified() || length <= 0.0) {
    result.stop = result.certified() ? Stop::kCertified : Stop::kBounded;
    result.distance = 0.0;
    return result;
  }
  result.distance = -length;
  result.p_a = walk.p_a;
  result.p_b = walk.p_b;
  return result;
}

}  // namespace tactum
