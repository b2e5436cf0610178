#include "tactum/collision/support_distance.h"

#include <array>
#include <cmath>
#include <limits>

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

struct Corner {
  int a = 0, b = 0;
  Vec3 p_a = Vec3::Zero(), p_b = Vec3::Zero(), d = Vec3::Zero();  // d = p_a - p_b
};

struct Simplex {
  std::array<Corner, 4> corners;
  std::array<double, 4> share{};  // weights in the nearest point
  int count = 0;
};

/// The weights of the corners in the point of their affine hull nearest to the origin; false when it is
/// outside them.
bool interior_shares(const std::array<const Corner*, 4>& c, int count,
                     std::array<double, 4>& share) noexcept {
  if (count == 1) return share[0] = 1.0, true;
  const Vec3& o = c[0]->d;
  const Vec3 u = c[1]->d - o;
  if (count == 2) {
    const double t = -u.dot(o) / u.squaredNorm();
    share = {1.0 - t, t};
    return t > 0.0 && t < 1.0;
  }
  const Vec3 v = c[2]->d - o;
  const Vec3 n = u.cross(v);
  if (count == 3) {
    const double nn = n.squaredNorm();
    const double s = v.cross(o).dot(n) / nn;
    const double t = o.cross(u).dot(n) / nn;
    share = {1.0 - s - t, s, t};
    return s > 0.0 && t > 0.0 && s + t < 1.0;
  }
  const Vec3 w = c[3]->d - o;
  const double volume = n.dot(w);
  const double s = -o.dot(v.cross(w)) / volume;
  const double t = -o.dot(w.cross(u)) / volume;
  const double r = -o.dot(n) / volume;
  share = {1.0 - s - t - r, s, t, r};
  return s > 0.0 && t > 0.0 && r > 0.0 && s + t + r < 1.0;
}

/// Keeps the corners that the nearest point depends on, and returns that point.
Vec3 reduce(Simplex& simplex) noexcept {
  double least = std::numeric_limits<double>::infinity();
  int best = 1;  // where no square is finite, the first corner
  std::array<double, 4> best_share{1.0};
  Vec3 nearest = simplex.corners[0].d;
  for (int mask = 1; mask < (1 << simplex.count); ++mask) {
    std::array<const Corner*, 4> chosen{};
    int count = 0;
    for (int i = 0; i < simplex.count; ++i)
      if (mask >> i & 1) chosen[count++] = &simplex.corners[i];
    std::array<double, 4> share{};
    if (!interior_shares(chosen, count, share)) continue;
    Vec3 point = Vec3::Zero();
    if (count < 4)
      for (int i = 0; i < count; ++i) point += chosen[i]->d * share[i];
    if (point.squaredNorm() >= least) continue;
    least = point.squaredNorm();
    nearest = point;
    best = mask;
    best_share = share;
  }
  Simplex kept;
  for (int i = 0; i < simplex.count; ++i)
    if (best >> i & 1) {
      kept.share[kept.count] = best_share[kept.count];
      kept.corners[kept.count++] = simplex.corners[i];
    }
  simplex = kept;
  return nearest;
}

/// The lowest feature that holds the vertices.
Feature common_feature(const Polytope& P, std::array<int, 4> v, int count) noexcept {
  const auto among = [&](int vertex) {
    for (int i = 0; i < count; ++i)
      if (v[i] == vertex) return true;
    return false;
  };
  int different = 0;
  for (int i = 1; i < count; ++i) different += v[i] != v[0];
  if (different == 0) return {Kind::kVertex, v[0]};
  int kinds = 0;  // distinct vertices
  for (int i = 0; i < count; ++i) {
    bool seen = false;
    for (int k = 0; k < i; ++k) seen |= v[k] == v[i];
    kinds += !seen;
  }
  for (const Polytope::Ray& ray : P.rays_at(v[0]))
    if (kinds == 2 && among(ray.far)) return {Kind::kEdge, ray.edge};
  for (const Polytope::Ray& ray : P.rays_at(v[0]))
    for (int f : {P.edges[ray.edge].left, P.edges[ray.edge].right}) {
      int members = 0;
      for (int slot = P.faces[f].first; slot < P.faces[f].first + P.faces[f].count; ++slot)
        members += among(P.face_vertices[slot]);
      if (members == kinds) return {Kind::kFace, f};
    }
  return {Kind::kVertex, v[0]};
}

Corner support(const PairView& pair, const Vec3& toward, const Corner* warm) noexcept {
  Corner c;
  c.a = warm ? support_vertex(pair.A, -toward, warm->a) : support_vertex(pair.A, -toward);
  const Vec3 toward_B = pair.X_BA.R * toward;
  c.b = warm ? support_vertex(pair.B, toward_B, warm->b) : support_vertex(pair.B, toward_B);
  c.p_a = pair.vertex_a(c.a);
  c.p_b = pair.vertex_b(c.b);
  c.d = c.p_a - c.p_b;
  return c;
}

void set_answer(const PairView& pair, const Simplex& simplex, PairDistance& x) noexcept {
  x.p_a.setZero();
  x.p_b.setZero();
  std::array<int, 4> a{};
  std::array<int, 4> b{};
  for (int i = 0; i < simplex.count; ++i) {
    x.p_a += simplex.corners[i].p_a * simplex.share[i];
    x.p_b += simplex.corners[i].p_b * simplex.share[i];
    a[i] = simplex.corners[i].a;
    b[i] = simplex.corners[i].b;
  }
  x.a = common_feature(pair.A, a, simplex.count);
  x.b = common_feature(pair.B, b, simplex.count);
}

OverlapProof proof_of(const Simplex& simplex) noexcept {
  OverlapProof proof;
  proof.known = true;
  for (int i = 0; i < 4; ++i) {
    const Corner& corner = simplex.corners[std::min(i, simplex.count - 1)];
    proof.a[i] = static_cast<std::uint16_t>(corner.a);
    proof.b[i] = static_cast<std::uint16_t>(corner.b);
  }
  return proof;
}

}  // namespace

FeatureWalk closest_by_supports(const PairView& pair, OverlapProof& proof, PairDistance& x) noexcept {
  constexpr int kSteps = 100;
  Simplex simplex;
  Vec3 d = pair.A.extent.center - pair.X_AB * pair.B.extent.center;
  if (d.isZero()) d = Vec3::UnitX();
  simplex.corners[0] = support(pair, d, nullptr);
  simplex.count = 1;
  d = reduce(simplex);
  FeatureWalk walk;
  walk.end = FeatureWalkEnd::kClosest;
  for (walk.steps = 1; walk.steps < kSteps; ++walk.steps) {
    if (simplex.count == 4 || d.norm() <= tolerances::kVoronoiTolerance * pair.scale) {
      proof = proof_of(simplex);
      walk.end = FeatureWalkEnd::kOverlap;
      break;
    }
    const Corner next = support(pair, d, &simplex.corners[0]);
    bool known = false;
    for (int i = 0; i < simplex.count; ++i)
      known |= simplex.corners[i].a == next.a && simplex.corners[i].b == next.b;
    if (known || d.dot(d - next.d) <= tolerances::kVoronoiTolerance * d.squaredNorm()) break;
    const Simplex before = simplex;
    simplex.corners[simplex.count++] = next;
    const Vec3 nearer = reduce(simplex);
    if (simplex.count < 4 && nearer.squaredNorm() >= d.squaredNorm()) {  // rounding: no more progress
      simplex = before;
      break;
    }
    d = nearer;
  }
  set_answer(pair, simplex, x);
  return walk;
}

}  // namespace tactum::inline v0_1
