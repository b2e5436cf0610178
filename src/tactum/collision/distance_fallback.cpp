#include "tactum/collision/distance_fallback.h"

#include <cmath>
#include <limits>

#include "tactum/collision/brute_force_distance.h"
#include "tactum/collision/overlap.h"
#include "tactum/collision/penetration.h"
#include "tactum/collision/support_distance.h"
#include "tactum/collision/vclip.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

/// Distance and normal from the features, with the error bound from the support planes.
struct Judged {
  PairDistance answer = {};
  int support_a = 0, support_b = 0;
};

/// The common perpendicular of two edges, from B to A. Their cones give the sign when the points coincide.
Vec3 edges_normal(const PairView& pair, const PairDistance& at, const Vec3& d, double gap) noexcept {
  const Polytope::Edge& ea = pair.A.edges[at.a.index];
  const Polytope::Edge& eb = pair.B.edges[at.b.index];
  const Vec3 c = ea.direction.cross(pair.X_AB.R * eb.direction);
  const double sine = c.norm();
  if (sine * pair.size <= gap) return d / gap;  // the difference has more digits than the cross product
  if (sine < tolerances::kParallelSine) return Vec3::Zero();
  double side = c.dot(d);
  if (gap < tolerances::kTouching * pair.size) {
    const Vec3 out_a = pair.A.sides[ea.left_slot].normal + pair.A.sides[ea.right_slot].normal;
    const Vec3 out_b = pair.B.sides[eb.left_slot].normal + pair.B.sides[eb.right_slot].normal;
    side = c.dot(pair.X_AB.R * out_b - out_a);
  }
  return side < 0.0 ? Vec3(-c / sine) : Vec3(c / sine);
}

/// The normal of the closest features; zero when only the walk on the Minkowski difference can determine it.
Vec3 features_normal(const PairView& pair, const PairDistance& at) noexcept {
  if (at.a.kind == Kind::kFace) return -pair.A.faces[at.a.index].normal;
  if (at.b.kind == Kind::kFace) return pair.X_AB.R * pair.B.faces[at.b.index].normal;
  const Vec3 d = at.p_a - at.p_b;
  const double gap = d.norm();
  if (at.a.kind == Kind::kEdge && at.b.kind == Kind::kEdge) return edges_normal(pair, at, d, gap);
  return gap > tolerances::kTouching * pair.size ? Vec3(d / gap) : Vec3::Zero();
}

/// The one of the two faces of a flat piece that looks along `outward`.
Feature facing_side(const Polytope& P, Feature f, const Vec3& outward) noexcept {
  if (P.flat && f.kind == Kind::kFace && P.faces[f.index].normal.dot(outward) < 0.0) f.index = 1 - f.index;
  return f;
}

Judged judge(const PairView& pair, const PairDistance& at, const Vec3& normal) noexcept {
  Judged judged;
  PairDistance& x = judged.answer;
  x.normal = normal;
  x.p_a = at.p_a;
  x.p_b = at.p_b;
  x.a = facing_side(pair.A, at.a, -normal);
  x.b = facing_side(pair.B, at.b, pair.X_BA.R * normal);
  x.distance = normal.dot(at.p_a - at.p_b);
  judged.support_a = vertex_of(pair.A, at.a);
  judged.support_b = vertex_of(pair.B, at.b);
  x.error_bound = std::numeric_limits<double>::infinity();
  if (normal.isZero()) return judged;
  const double gap = pair.separation(normal, judged.support_a, judged.support_b);
  // The error includes the points' whole distance, and how far they are off one normal.
  const Vec3 d = at.p_a - at.p_b;
  const double over = d.norm() - gap;
  // No points lie below the lower bound: these are not known, or the planes are lost in rounding.
  if (over >= -certificate(pair)) x.error_bound = std::max(over, (d - normal * x.distance).norm());
  return judged;
}

/// The nearest normal inside the normal cones of both features, by projecting on their half-spaces in turn.
/// It corrects a normal whose direction is lost in rounding over a very small gap.
Vec3 inside_cones(const PairView& pair, const Feature& fa, const Feature& fb, Vec3 n) noexcept {
  const auto project = [](const Polytope& P, const Feature& f, Vec3& outward) {
    if (f.kind == Kind::kVertex) {
      for (const Polytope::Ray& ray : P.rays_at(f.index))
        if (const double up = ray.direction.dot(outward); up > 0.0) outward -= ray.direction * up;
    } else if (f.kind == Kind::kEdge) {
      const Polytope::Edge& edge = P.edges[f.index];
      outward -= edge.direction * edge.direction.dot(outward);
      for (int slot : {edge.left_slot, edge.right_slot})
        if (const double in = P.sides[slot].normal.dot(outward); in < 0.0)
          outward -= P.sides[slot].normal * in;
    }
  };
  for (int round = 0; round < 16; ++round) {
    Vec3 outward = -n;
    project(pair.A, fa, outward);
    Vec3 outward_B = pair.X_BA.R * -outward;
    project(pair.B, fb, outward_B);
    n = (pair.X_AB.R * outward_B).normalized();
  }
  return n;
}

/// The query while it tries its slower methods.
class Query {
 public:
  Query(const PairView& pair, PairCache& cache) noexcept : pair_(pair), cache_(cache) {}

  /// From a first walk, which ended at `at` and did not prove itself.
  PairDistance run(const FeatureWalk& first, const PairDistance& at) noexcept {
    if (walked(first, at) || on_planes() || by_supports() || by_brute_force()) return result_;
    return done(best_.answer, Stop::kBounded);
  }

 private:
  /// Judges the walk, and walks again from the supports with a wider crossing tolerance. True when certified
  /// or overlapping.
  bool walked(FeatureWalk walk, PairDistance at) noexcept {
    double crossing_tolerance = tolerances::kVoronoiTolerance * pair_.scale;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      steps_ += walk.steps;
      if (walk.end == FeatureWalkEnd::kOverlap) return overlapping();
      if (walk.end == FeatureWalkEnd::kBehind) return by_supports();
      const bool straight = attempt == 0 && walk.end == FeatureWalkEnd::kClosest;
      if (certified(at, straight ? Stop::kCertified : Stop::kFallback)) return true;
      crossing_tolerance *= kWiderTolerance;
      walk = feature_walk(pair_, {Kind::kVertex, last_.support_a}, {Kind::kVertex, last_.support_b},
                          crossing_tolerance, at);
    }
    return false;
  }

  /// Judges the points `at`, with their features' normal or that normal corrected.
  bool certified(const PairDistance& at, Stop stop) noexcept {
    last_ = judge(pair_, at, features_normal(pair_, at));
    if (last_.answer.error_bound > certificate(pair_) && std::isfinite(last_.answer.error_bound)) {
      const Judged healed = judge(pair_, at, inside_cones(pair_, at.a, at.b, last_.answer.normal));
      if (healed.answer.error_bound < last_.answer.error_bound) last_ = healed;
    }
    const double gap = (at.p_a - at.p_b).norm();
    if (gap < least_gap_) {
      least_gap_ = gap;
      best_ = last_;
    }
    if (last_.answer.error_bound > certificate(pair_)) return false;
    done(last_.answer, stop);
    return true;
  }

  /// A common point was found.
  bool overlapping() noexcept {
    result_ = penetration_depth(pair_.A, pair_.B, pair_.X_AB, cache_);
    result_.steps += steps_;
    cache_.overlap.known = true;
    return true;
  }

  /// The method that cannot cycle, and then a walk from its answer for the last digits.
  bool by_supports() noexcept {
    PairDistance at;
    const FeatureWalk supports = closest_by_supports(pair_, cache_.overlap, at);
    steps_ += supports.steps;
    if (supports.end == FeatureWalkEnd::kOverlap) return overlapping();
    PairDistance polished;
    const FeatureWalk walk =
        feature_walk(pair_, at.a, at.b, tolerances::kVoronoiTolerance * pair_.scale, polished);
    steps_ += walk.steps;
    if (walk.end == FeatureWalkEnd::kOverlap) return overlapping();
    if (walk.end == FeatureWalkEnd::kClosest && certified(polished, Stop::kFallback)) return true;
    return certified(at, Stop::kFallback) || on_planes();
  }

  bool by_brute_force() noexcept {
    if (pair_.A.edges.size() * pair_.B.edges.size() > kSmallEdgePairs) return false;
    PairDistance at;
    brute_force_distance(pair_, at);
    return certified(at, Stop::kFallback) || on_planes();
  }

  /// A facet of the Minkowski difference gives the normal where the points' difference cannot. Its witness
  /// points lie on the pieces, so a certified answer that is not below zero proves itself; below zero the
  /// proof needs points of both that coincide.
  bool on_planes() noexcept {
    PairCache cache = cache_;
    const PairDistance planes = penetration_depth(pair_.A, pair_.B, pair_.X_AB, cache);
    steps_ += planes.steps;
    const double tolerance = certificate(pair_);
    if (!planes.certified() || (planes.distance < -tolerance && least_gap_ > tolerance)) return false;
    done(planes, Stop::kFallback);
    return true;
  }

  const PairDistance& done(const PairDistance& answer, Stop stop) noexcept {
    result_ = answer;
    result_.stop = stop;
    result_.steps = steps_;
    cache_.a = result_.a;
    cache_.b = result_.b;
    cache_.normal_A = result_.normal;
    cache_.overlap = {};
    return result_;
  }

  static constexpr int kAttempts = 4;
  static constexpr double kWiderTolerance = 32.0;
  static constexpr std::size_t kSmallEdgePairs = 4096;  ///< brute force is used up to here: 40 us

  const PairView& pair_;
  PairCache& cache_;
  Judged last_, best_{invalid_result()};
  double least_gap_ = std::numeric_limits<double>::infinity();
  PairDistance result_;
  int steps_ = 0;
};

}  // namespace

PairDistance resolve_uncertified(const PairView& pair, PairCache& cache, const FeatureWalk& first,
                                 const PairDistance& at) noexcept {
  if (is_invalid_pose(pair.X_AB)) return invalid_result();
  return Query(pair, cache).run(first, at);
}

bool still_inside(const PairView& pair, PairCache& cache, PairDistance& x) noexcept {
  x = tracked_depth(pair, cache);
  return x.certified() && (overlap_by_facet(pair, x) || overlap_by_vertices(pair, cache.overlap));
}

}  // namespace tactum::inline v0_1
