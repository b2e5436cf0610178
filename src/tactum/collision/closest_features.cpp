#include "tactum/collision/closest_features.h"

#include <cmath>
#include <limits>

#include "tactum/collision/every_feature.h"
#include "tactum/collision/penetration.h"
#include "tactum/collision/support_distance.h"
#include "tactum/collision/voronoi_march.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

/// Distance and normal as the features give them, and what the support planes say about it.
struct Judged {
  PairDistance answer;
  double doubt = 0.0;  ///< distance minus the support planes' gap [m]
  int support_a = 0, support_b = 0;
};

/// The common perpendicular of two edges, from B to A. Their cones give the sign when the points coincide.
Vec3 edges_normal(const PairView& pair, const March& march, const Vec3& d, double gap) noexcept {
  const Polytope::Edge& ea = pair.A.edges[march.a.index];
  const Polytope::Edge& eb = pair.B.edges[march.b.index];
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

/// The normal of the closest features; zero when only the penetration walk can tell it.
Vec3 features_normal(const PairView& pair, const March& march) noexcept {
  if (march.a.kind == Kind::kFace) return -pair.A.faces[march.a.index].normal;
  if (march.b.kind == Kind::kFace) return pair.X_AB.R * pair.B.faces[march.b.index].normal;
  const Vec3 d = march.p_a - march.p_b;
  const double gap = d.norm();
  if (march.a.kind == Kind::kEdge && march.b.kind == Kind::kEdge) return edges_normal(pair, march, d, gap);
  return gap > tolerances::kTouching * pair.size ? Vec3(d / gap) : Vec3::Zero();
}

/// Of the two faces of a flat piece, the one that looks along `outward`.
Feature facing_side(const Polytope& P, Feature f, const Vec3& outward) noexcept {
  if (P.flat && f.kind == Kind::kFace && P.faces[f.index].normal.dot(outward) < 0.0) f.index = 1 - f.index;
  return f;
}

Judged judge(const PairView& pair, const March& march, const Vec3& normal) noexcept {
  Judged judged;
  PairDistance& x = judged.answer;
  x.normal = normal;
  x.p_a = march.p_a;
  x.p_b = march.p_b;
  x.a = facing_side(pair.A, march.a, -normal);
  x.b = facing_side(pair.B, march.b, pair.X_BA.R * normal);
  x.distance = normal.dot(march.p_a - march.p_b);
  judged.support_a = vertex_of(pair.A, march.a);
  judged.support_b = vertex_of(pair.B, march.b);
  judged.doubt = std::numeric_limits<double>::infinity();
  if (normal.isZero()) return judged;
  const double gap = pair.separation(normal, judged.support_a, judged.support_b);
  // The points' whole distance counts, and that they lie on one normal.
  const Vec3 d = march.p_a - march.p_b;
  judged.doubt = std::max(d.norm() - gap, (d - normal * x.distance).norm());
  return judged;
}

/// The nearest normal inside the normal cones of both features, by projecting on their half-spaces in turn.
/// Heals a normal that is off by rounding over a very small gap.
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

struct Seed {
  Feature a, b;
};

Seed seed_from_table(const PairView& pair) noexcept {
  Vec3 toward_b = pair.X_AB * pair.B.center - pair.A.center;
  if (toward_b.isZero()) toward_b = Vec3::UnitX();
  return {{Kind::kVertex, table_vertex(pair.A, toward_b)},
          {Kind::kVertex, table_vertex(pair.B, -(pair.X_BA.R * toward_b))}};
}

/// The query while it climbs down its ladder.
class Query {
 public:
  Query(const PairView& pair, PairCache& cache) noexcept : pair_(pair), cache_(cache) {
    best_.doubt = std::numeric_limits<double>::infinity();
  }

  PairDistance run() noexcept {
    if (walked() || on_planes() || by_supports()) return result_;
    if (pair_.A.edges.size() * pair_.B.edges.size() <= kSmallEdgePairs &&
        (certified(closest_of_every_feature(pair_), Stop::kFallback) || on_planes()))
      return result_;
    return done(best_.answer, Stop::kBounded);
  }

 private:
  /// The walk, and again from the supports with wider slack. True when certified or overlapping.
  bool walked() noexcept {
    Seed seed{cache_.a, cache_.b};
    if (!valid_feature(pair_.A, seed.a) || !valid_feature(pair_.B, seed.b)) seed = seed_from_table(pair_);
    double slack = tolerances::kVoronoiSlack * pair_.scale;
    for (int attempt = 0; attempt < kAttempts; ++attempt, slack *= kWiderSlack) {
      const March march = voronoi_march(pair_, seed.a, seed.b, slack);
      steps_ += march.steps;
      if (march.end == MarchEnd::kOverlap) return overlapping();
      const bool straight = attempt == 0 && march.end == MarchEnd::kClosest;
      if (certified(march, straight ? Stop::kCertified : Stop::kFallback)) return true;
      seed = {{Kind::kVertex, last_.support_a}, {Kind::kVertex, last_.support_b}};
    }
    return false;
  }

  /// Judges the points of a march, with the features' normal or that normal healed.
  bool certified(const March& march, Stop stop) noexcept {
    last_ = judge(pair_, march, features_normal(pair_, march));
    if (last_.doubt > tolerance() && std::isfinite(last_.doubt)) {
      const Judged healed = judge(pair_, march, inside_cones(pair_, march.a, march.b, last_.answer.normal));
      if (healed.doubt < last_.doubt) last_ = healed;
    }
    const double gap = (march.p_a - march.p_b).norm();
    if (gap < least_gap_) {
      least_gap_ = gap;
      best_ = last_;
    }
    if (last_.doubt > tolerance()) return false;
    done(last_.answer, stop);
    return true;
  }

  /// A point of both was found.
  bool overlapping() noexcept {
    result_ = penetration_depth(pair_.A, pair_.B, pair_.X_AB, cache_);
    result_.steps += steps_;
    return true;
  }

  bool by_supports() noexcept {
    const March march = closest_by_supports(pair_);
    steps_ += march.steps;
    if (march.end == MarchEnd::kOverlap) return overlapping();
    return certified(march, Stop::kFallback) || on_planes();
  }

  /// A facet of the Minkowski difference tells the normal where the points' difference cannot. Its witness
  /// points lie on the pieces, so a certified answer that is not below zero proves itself; below zero it
  /// takes points of both that coincide.
  bool on_planes() noexcept {
    PairCache cache = cache_;
    const PairDistance planes = penetration_depth(pair_.A, pair_.B, pair_.X_AB, cache);
    steps_ += planes.steps;
    if (!planes.certified() || (planes.distance < -tolerance() && least_gap_ > tolerance())) return false;
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
    return result_;
  }

  double tolerance() const noexcept { return tolerances::kCertificate * pair_.size; }

  static constexpr int kAttempts = 4;
  static constexpr double kWiderSlack = 32.0;
  static constexpr std::size_t kSmallEdgePairs = 4096;  ///< every feature is tried up to here: 40 us

  const PairView& pair_;
  PairCache& cache_;
  Judged last_, best_;
  double least_gap_ = std::numeric_limits<double>::infinity();
  PairDistance result_;
  int steps_ = 0;
};

}  // namespace

PairDistance closest_features(const Polytope& A, const Polytope& B, const Pose& X_AB,
                              PairCache& cache) noexcept {
  const PairView pair(A, B, X_AB);
  return Query(pair, cache).run();
}

}  // namespace tactum
