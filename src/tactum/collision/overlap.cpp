#include "tactum/collision/overlap.h"

#include "tactum/collision/segments.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

bool inside_parallelogram(const PairView& pair, const Feature& a, const Feature& b, const Vec3& x) noexcept {
  const Polytope::Edge& ea = pair.A.edges[a.index];
  const Polytope::Edge& eb = pair.B.edges[b.index];
  const Vec3 w = rotated(pair.X_AB.R, eb.direction);
  const Vec3 r = pair.vertex_b(eb.tail) - x - pair.vertex_a(ea.tail);
  double s = 0.0;
  double t = 0.0;
  return nearest_on_lines(ea.direction, w, r, ea.direction.cross(w), tolerances::kParallelSine, s, t) &&
         s >= 0.0 && s <= ea.length && t >= 0.0 && t <= eb.length;
}

}  // namespace

bool overlap_by_vertices(const PairView& pair, const OverlapProof& proof) noexcept {
  std::array<Vec3, 4> d;
  for (std::size_t i = 0; i < 4; ++i) {
    if (proof.a[i] >= pair.A.counts[0] || proof.b[i] >= pair.B.counts[0]) return false;
    d[i] = pair.vertex_b(proof.b[i]) - pair.vertex_a(proof.a[i]);
  }
  // The volumes that the origin makes with three corners each: all on one side.
  const Vec3 c = d[2].cross(d[3]);
  const Vec3 e = d[0].cross(d[1]);
  const double v0 = d[1].dot(c);
  const double v1 = -d[0].dot(c);
  const double v2 = d[3].dot(e);
  const double v3 = -d[2].dot(e);
  return (v0 > 0.0 && v1 > 0.0 && v2 > 0.0 && v3 > 0.0) || (v0 < 0.0 && v1 < 0.0 && v2 < 0.0 && v3 < 0.0);
}

bool overlap_by_facet(const PairView& pair, const PairDistance& depth) noexcept {
  const Vec3 c = pair.X_AB * pair.B.extent.center - pair.A.extent.center;
  const double behind = -depth.normal.dot(c);
  if (depth.distance >= 0.0 || behind <= 0.0) return false;
  const Vec3 x = c * (depth.distance / behind);
  if (depth.a.kind == Kind::kFace && depth.b.kind == Kind::kVertex)
    return in_column(pair.A, depth.a.index, pair.vertex_b(depth.b.index) - x);
  if (depth.b.kind == Kind::kFace && depth.a.kind == Kind::kVertex)
    return in_column(pair.B, depth.b.index, pair.X_BA * (pair.vertex_a(depth.a.index) + x));
  return depth.a.kind == Kind::kEdge && depth.b.kind == Kind::kEdge &&
         inside_parallelogram(pair, depth.a, depth.b, x);
}

}  // namespace tactum::inline v0_1
