#include "tactum/collision/penetration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tactum/collision/manifold.h"
#include "tactum/collision/minkowski_walk.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

/// Pairs of edges up to which a cold start tries every separating axis: 10 ns each.
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
  MinkowskiFacet facet;
  for (std::size_t i = 0; i < pair.A.edges.size(); ++i)
    for (std::size_t j = 0; j < pair.B.edges.size(); ++j)
      if (facet_of_edges(pair, static_cast<int>(i), static_cast<int>(j), facet)) visit(facet);
}

/// Where faces or edges of both pieces lie in the support planes, several facets of the difference are one,
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

/// The answer of a walk, its depth by true supports.
PairDistance answer(const PairView& pair, const MinkowskiWalk& walk, int steps) noexcept {
  PairDistance result;
  result.normal = walk.facet.n;
  result.a = walk.facet.a;
  result.b = walk.facet.b;
  result.p_b = walk.p_b;
  result.steps = steps;
  const double tolerance = tolerances::kCertificate * pair.size;
  if (walk.arrived(pair)) {
    result.distance = -walk.facet.height;
    result.p_a = walk.p_b + walk.facet.n * result.distance;
    result.stop = Stop::kCertified;
    return result;
  }
  int a = vertex_of(pair.A, walk.facet.a);
  int b = vertex_of(pair.B, walk.facet.b);
  result.distance = pair.separation(walk.facet.n, a, b);
  result.p_a = walk.p_b + walk.facet.n * result.distance;
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
    const double tolerance = tolerances::kCertificate * pair_.size;
    const bool better = next.certified() == best_.certified() ? next.distance > best_.distance
                        : next.certified()                    ? next.distance > best_.distance - tolerance
                                                              : next.distance > best_.distance + tolerance;
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

/// The facet of features of the last frame: false when their kinds make none, or (of edges) their arcs no
/// longer cross.
bool facet_again(const PairView& pair, const FeaturePair& last, MinkowskiFacet& facet) noexcept {
  const Feature& a = last.a;
  const Feature& b = last.b;
  if (!valid_feature(pair.A, a) || !valid_feature(pair.B, b)) return false;
  if (a.kind == Kind::kFace) {
    facet = facet_of_face(pair, true, a.index, vertex_of(pair.B, b));
  } else if (b.kind == Kind::kFace) {
    facet = facet_of_face(pair, false, b.index, vertex_of(pair.A, a));
  } else {
    return a.kind == Kind::kEdge && b.kind == Kind::kEdge && facet_of_edges(pair, a.index, b.index, facet);
  }
  return true;
}

Vec3 line_of_centers(const PairView& pair) noexcept {
  const Vec3 n = pair.A.extent.center - pair.X_AB * pair.B.extent.center;
  return n.isZero() ? Vec3::UnitX() : n;
}

/// Of the 26 directions to the sides, edges and corners of a cube.
constexpr int kDirections = 26;
Vec3 direction_around(int i) noexcept {
  if (i >= kDirections / 2) ++i;  // not the middle
  return {static_cast<double>(i % 3 - 1), static_cast<double>(i / 3 % 3 - 1), static_cast<double>(i / 9 - 1)};
}

/// Walks from the line of centres and from the shallowest facets near 26 directions all around: three of
/// them, and more until one ends certified.
void from_many_directions(const PairView& pair, Shallowest& shallowest) noexcept {
  constexpr int kWalked = 8;
  shallowest.from(facet_near(pair, line_of_centers(pair)));
  std::array<MinkowskiFacet, kDirections> seeds;
  for (int i = 0; i < kDirections; ++i)
    seeds[static_cast<std::size_t>(i)] = facet_near(pair, direction_around(i));
  std::sort(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.height < b.height; });
  int walked = 0;
  for (const MinkowskiFacet& seed : seeds)
    if (walked++ < kWalked || !shallowest.best().certified()) shallowest.from(seed);
}

/// Tries every facet: the walk from the shallowest finds witness points inside its features, or they are
/// inside those of another facet as shallow.
void from_every_facet(const PairView& pair, Shallowest& shallowest) noexcept {
  MinkowskiFacet best;
  best.height = std::numeric_limits<double>::infinity();
  for_every_facet(pair, [&](const MinkowskiFacet& facet) {
    if (facet.height < best.height) best = facet;
  });
  if (best.a.index < 0) return;
  const MinkowskiWalk walk = walk_to_foot(pair, best);
  shallowest.take(walk);
  if (shallowest.best().certified()) return;
  const double level = best.height + tolerances::kCertificate * pair.size;
  for_every_facet(pair, [&](const MinkowskiFacet& facet) {
    if (facet.height <= level) shallowest.take(stand_on(pair, facet));
  });
}

void remember(const PairDistance& result, PairCache& cache) noexcept {
  cache.a = result.a;
  cache.b = result.b;
  cache.normal_A = result.normal;
}

/// The warm query: the last frame's minimum is followed, and beside it a search for a better one costs a few
/// facets a frame. Walks are kept in the cache from frame to frame: the candidate minima, which are the best
/// other minima known, and the explorer, a walk that began in one of many directions.
class Tracker {
 public:
  Tracker(const PairView& pair, PairCache& cache) noexcept
      : pair_(pair),
        cache_(cache),
        last_(last_facet()),
        current_(walk_to_foot(pair, last_)),
        steps_(current_.steps) {}

  PairDistance run() noexcept {
    forget(features(current_.facet));
    const bool moved_on = !same({cache_.a, cache_.b}, features(current_.facet));
    const std::uint32_t frame = cache_.turn++;
    const bool looks = frame % kLook == 0;
    const bool candidates_are_due = looks && frame / kLook % kDue == kDue - 1;
    if (moved_on) {  // a long frame already: it stores the minimum it left and does not start the explorer
      keep_last();
    } else if (looks && !candidates_are_due) {
      explore();
    }
    watch(lower_candidate(), candidates_are_due);
    if (looks) watch(upper_candidate(), candidates_are_due);
    if (lower_candidate().empty() ||
        (candidates_are_due && height(upper_candidate()) < height(lower_candidate())))
      std::swap(lower_candidate(), upper_candidate());
    return answer(pair_, current_, steps_);
  }

 private:
  // These divide the work of the search among its calls; they are no times, and so are not in seconds.
  static constexpr std::uint32_t kLook = 3;  ///< one frame in so many searches
  static constexpr std::uint32_t kDue = 4;   ///< one of so many of those is for the candidates
  static constexpr int kMoves = 2;           ///< facets that a walk goes on in its frame

  static bool same(const FeaturePair& f, const FeaturePair& g) noexcept { return f.a == g.a && f.b == g.b; }
  static FeaturePair features(const MinkowskiFacet& f) noexcept { return {f.a, f.b}; }
  double height(const FeaturePair& of) const noexcept {
    MinkowskiFacet facet;
    return facet_again(pair_, of, facet) ? facet.height : std::numeric_limits<double>::infinity();
  }
  bool lower(const MinkowskiFacet& facet) const noexcept {
    return facet.height < current_.facet.height - tolerances::kCoplanar * pair_.scale;
  }

  /// The facet tracked in the last frame; where its features form no facet any more, one near its normal.
  MinkowskiFacet last_facet() const noexcept {
    MinkowskiFacet facet;
    if (!facet_again(pair_, {cache_.a, cache_.b}, facet)) facet = facet_near(pair_, cache_.normal_A);
    return facet;
  }

  /// Stores the last frame's minimum as a candidate, where it is still one: left for a lower one behind its
  /// border, it may soon be the lower one again.
  void keep_last() noexcept {
    if (current_.facet.height < last_.height && stand_on(pair_, last_).arrived(pair_))
      keep(features(last_), last_.height);
  }

  /// Whether it is so far from the origin that a walk from there to a lower minimum would be long.
  bool far(const MinkowskiFacet& facet) const noexcept {
    constexpr double kFar = 8.0;  // depths
    return facet.height > kFar * current_.facet.height;
  }

  /// Starts the explorer, or lets it walk on, end, or wait for its next turn. While it is far it delays
  /// starts from nearer, so its time is bounded.
  void explore() noexcept {
    constexpr std::uint32_t kPatience = 4;  // turns
    if (cache_.explorer.empty() && !start_explorer()) return;
    const MinkowskiWalk walk = go_on(cache_.explorer);
    cache_.explorer = {};
    if (lower(walk.facet)) {
      take(walk);
    } else if (walk.settled) {
      keep(features(walk.facet), walk.facet.height);
    } else if (++cache_.explorer_turns <= kPatience || !far(walk.facet)) {
      cache_.explorer = features(walk.facet);
    }
  }

  /// Chooses a start for the explorer, in turn from all around, from near, and, every other time, from a face
  /// beside the features that touch. Of needles and plates nearly all starts are far away, and some of those
  /// lead to the lowest minimum: only starts from near and beside must not be far. Returns true when the
  /// start is lower than the tracked minimum, and so is to be followed at once.
  bool start_explorer() noexcept {
    const std::uint32_t turn = cache_.explorer_starts++;
    const bool around = turn % 4 == 0;
    const MinkowskiFacet start = around          ? lowest_around(turn / 4)
                                 : turn % 2 == 0 ? one_near(turn / 4)
                                                 : one_beside(turn / 2);
    if (!around && far(start)) return false;
    cache_.explorer = features(start);
    cache_.explorer_turns = 0;
    return lower(start);
  }

  FeaturePair& lower_candidate() noexcept { return cache_.candidate_minima[0]; }
  FeaturePair& upper_candidate() noexcept { return cache_.candidate_minima[1]; }

  bool known(const FeaturePair& minimum) const noexcept {
    return same(minimum, features(current_.facet)) || same(minimum, cache_.candidate_minima[0]) ||
           same(minimum, cache_.candidate_minima[1]);
  }

  void forget(const FeaturePair& minimum) noexcept {
    for (FeaturePair& candidate : cache_.candidate_minima)
      if (same(candidate, minimum)) candidate = {};
  }

  /// Makes another minimum a candidate, if it is lower than one of them.
  void keep(const FeaturePair& minimum, double at) noexcept {
    if (known(minimum)) return;
    if (height(upper_candidate()) < height(lower_candidate()))
      std::swap(lower_candidate(), upper_candidate());
    if (at < height(lower_candidate())) {
      upper_candidate() = lower_candidate();
      lower_candidate() = minimum;
    } else if (at < height(upper_candidate())) {
      upper_candidate() = minimum;
    }
  }

  /// Makes a lower minimum, if it can be proved, the tracked one, and that one a candidate.
  void take(const MinkowskiWalk& walk) noexcept {
    if (!answer(pair_, walk, 0).certified()) return;
    const MinkowskiFacet last = current_.facet;
    current_ = walk;
    forget(features(walk.facet));
    keep(features(last), last.height);
  }

  /// Lets a candidate walk on when it is due, or found to be lower than the tracked minimum.
  void watch(FeaturePair& candidate, bool due) noexcept {
    if (candidate.empty() || (!due && !(height(candidate) < current_.facet.height))) return;
    const MinkowskiWalk walk = go_on(candidate);
    candidate = {};
    if (lower(walk.facet)) {
      take(walk);
    } else if (!known(features(walk.facet))) {
      candidate = features(walk.facet);
    }
  }

  /// Makes a few moves toward the nearest foot; below the tracked minimum the whole walk to a better one.
  MinkowskiWalk go_on(const FeaturePair& from) noexcept {
    MinkowskiWalk walk = walk_to_any_foot(pair_, beside(from), kMoves);
    steps_ += walk.steps;
    if (lower(walk.facet)) {
      walk = walk_to_foot(pair_, walk.facet);
      steps_ += walk.steps;
    }
    return walk;
  }

  MinkowskiFacet beside(const FeaturePair& of) const noexcept {
    MinkowskiFacet facet;
    if (facet_again(pair_, of, facet)) return facet;
    if (!valid_feature(pair_.A, of.a) || !valid_feature(pair_.B, of.b)) return current_.facet;
    // Edges that no longer cross: a face beside them.
    return facet_of_face(pair_, true, face_of(pair_.A, of.a), vertex_of(pair_.B, of.b));
  }

  /// The lower of two of the directions all around.
  MinkowskiFacet lowest_around(std::uint32_t turn) const noexcept {
    constexpr std::uint32_t kLookedAt = 2;
    constexpr std::uint32_t kStride = 7;  // the next is another direction
    const std::uint32_t first =
        turn * kLookedAt + turn * kLookedAt / kDirections;  // other pairs in every round
    MinkowskiFacet lowest;
    lowest.height = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = first; i < first + kLookedAt; ++i) {
      const MinkowskiFacet facet =
          facet_toward(pair_, direction_around(static_cast<int>(i * kStride % kDirections)));
      if (facet.height < lowest.height) lowest = facet;
    }
    return lowest;
  }

  /// A start in a direction about the current normal, by the corners of an icosahedron, near, farther and
  /// far.
  MinkowskiFacet one_near(std::uint32_t turn) const noexcept {
    constexpr double kShort = 0.5257311121191336;  // corners (0, +-short, +-long) and their rotations
    constexpr double kLong = 0.85065080835204;
    constexpr std::uint32_t kCorners = 12;
    const auto corner = static_cast<int>(turn * 7 % kCorners);
    Vec3 offset;
    offset[corner % 3] = 0.0;
    offset[(corner + 1) % 3] = (corner / 3) % 2 ? kShort : -kShort;
    offset[(corner + 2) % 3] = corner / 6 ? kLong : -kLong;
    constexpr std::array<double, 3> kOffsets = {0.15, 0.3, 0.6};
    const double offset_length = kOffsets[(turn + turn / kCorners) % kOffsets.size()];
    return facet_near(pair_, current_.facet.n + offset * offset_length, vertex_of(pair_.A, current_.facet.a),
                      vertex_of(pair_.B, current_.facet.b));
  }

  /// A start at a face at a vertex that touches or at an end of an edge that does: of two edges, of one piece
  /// and the other in turn; where a face touches, of the other piece.
  MinkowskiFacet one_beside(std::uint32_t turn) const noexcept {
    const Feature& a = current_.facet.a;
    const Feature& b = current_.facet.b;
    const bool edges = a.kind == Kind::kEdge && b.kind == Kind::kEdge;
    const bool on_a = edges ? turn % 2 == 0 : b.kind == Kind::kFace;
    const Polytope& P = on_a ? pair_.A : pair_.B;
    const Feature& touching = on_a ? a : b;
    const bool at_head = edges && turn / 2 % 2 == 0;
    const int vertex = at_head ? P.edges[touching.index].head : vertex_of(P, touching);
    const auto rays = P.rays_at(vertex);
    const Polytope::Edge& edge = P.edges[rays[(edges ? turn / 4 : turn) % rays.size()].edge];
    const int face = edge.tail == vertex ? edge.left : edge.right;
    return facet_of_face(pair_, on_a, face, on_a ? vertex_of(pair_.B, b) : vertex_of(pair_.A, a));
  }

  const PairView& pair_;
  PairCache& cache_;
  const MinkowskiFacet last_;  ///< where the walk began: last_facet()
  MinkowskiWalk current_;
  int steps_;
};

}  // namespace

PairDistance tracked_depth(const PairView& pair, PairCache& cache) noexcept {
  const PairDistance result = Tracker(pair, cache).run();
  remember(result, cache);
  return result;
}

PairDistance penetration_depth(const Polytope& A, const Polytope& B, const Pose& X_AB,
                               PairCache& cache) noexcept {
  const PairView pair(A, B, X_AB);
  PairDistance x;  // every path returns it: an answer copied right after it was written waits for its parts
  if (!cache.normal_A.isZero()) {
    x = tracked_depth(pair, cache);
    if (x.certified()) return x;
  }
  if (is_invalid_pose(X_AB)) {
    x = invalid_result();
    return x;
  }
  Shallowest shallowest(pair);
  if (small_pair(pair)) {
    from_every_facet(pair, shallowest);
  } else {
    from_many_directions(pair, shallowest);
  }
  x = shallowest.best();
  remember(x, cache);
  return x;
}

PairDistance penetration_exhaustive(const Polytope& A, const Polytope& B, const Pose& X_AB) noexcept {
  const PairView pair(A, B, X_AB);
  Shallowest shallowest(pair);
  from_every_facet(pair, shallowest);
  return shallowest.best();
}

PairDistance depth_along(const Polytope& A, const Polytope& B, const Pose& X_AB,
                         const Vec3& direction) noexcept {
  if (is_invalid_pose(X_AB) || !direction.allFinite()) return invalid_result();
  const PairView pair(A, B, X_AB);
  const MinkowskiWalk walk = walk_along_ray(pair, facet_near(pair, direction), direction);
  PairDistance result = answer(pair, walk, walk.steps);
  const double across = walk.facet.n.dot(direction);
  const double length = across > 0.0 ? walk.facet.height / across : 0.0;
  if (!(across > 0.0)) result.stop = Stop::kBounded;  // a ray in the plane of pieces that are flat
  if (!result.certified() || length <= 0.0) {
    result.distance = 0.0;
    return result;
  }
  result.distance = -length;
  result.p_a = walk.p_a;
  result.p_b = walk.p_b;
  return result;
}

}  // namespace tactum::inline v0_1
