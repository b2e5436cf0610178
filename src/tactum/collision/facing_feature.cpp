#include "tactum/collision/facing_feature.h"

#include <cmath>

#include "tactum/collision/pair_view.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

/// Calls visit(face) for the faces that hold feature `f`.
template <class Visit>
void for_faces_at(const Polytope& P, const Feature& f, const Visit& visit) noexcept {
  if (f.kind == Kind::kFace) return visit(f.index);
  if (f.kind == Kind::kEdge) {
    visit(P.edges[f.index].left);
    visit(P.edges[f.index].right);
    return;
  }
  for (const Polytope::Ray& ray : P.rays_at(f.index)) {
    const Polytope::Edge& edge = P.edges[ray.edge];
    visit(edge.tail == f.index ? edge.left : edge.right);
  }
}

/// Of the edges at feature `f`, that bound `face`, the one most square to `outward`; its slope in `slope`.
int level_edge(const Polytope& P, const Feature& f, int face, const Vec3& outward, double& slope) noexcept {
  if (f.kind == Kind::kEdge) {
    slope = std::abs(P.edges[f.index].direction.dot(outward));
    return f.index;
  }
  int best = -1;
  slope = 2.0;
  for (const Polytope::Ray& ray : P.rays_at(f.index)) {
    if (P.edges[ray.edge].left != face && P.edges[ray.edge].right != face) continue;
    if (const double rise = std::abs(ray.direction.dot(outward)); rise < slope) {
      slope = rise;
      best = ray.edge;
    }
  }
  return best;
}

}  // namespace

Facing facing_feature(const Polytope& P, const Feature& f, const Vec3& outward, double angle) noexcept {
  constexpr double kSmall = 0.01;  // a squared sine below which the cosine has lost too many of its digits
  int face = -1;
  double lean = 9.0;  // squared sines
  double next = 9.0;
  for_faces_at(P, f, [&](int candidate) {
    const Vec3& normal = P.faces[candidate].normal;
    const double cosine = normal.dot(outward);
    double sine_sq = cosine > 0.0 ? 1.0 - cosine * cosine : 4.0;
    if (sine_sq < kSmall) sine_sq = normal.cross(outward).squaredNorm();
    if (sine_sq < lean) {
      next = lean;
      lean = sine_sq;
      face = candidate;
    } else {
      next = std::min(next, sine_sq);
    }
  });
  Facing facing;
  facing.feature = {Kind::kFace, face};
  if (f.kind == Kind::kFace) {
    // Square to the normal; where it is not (an answer that is none of the queries'), a point.
    if (lean >= angle * angle) facing.feature = {Kind::kVertex, vertex_of(P, f)};
    return facing;
  }
  // Nearly level and alone: both shares of the face are one, whatever its edges do.
  if (lean <= 0.25 * angle * angle && next >= 9.0 * lean) return facing;
  lean = std::sqrt(lean);
  next = std::sqrt(next);
  double slope = 0.0;
  facing.edge = level_edge(P, f, face, outward, slope);
  // An edge shrinks at a quarter of the angle: where two edges of a leaning face slope alike, both are points
  // by then.
  facing.along_share = share_kept(slope, 0.25 * angle);
  const double lead = next > lean ? 2.0 * (next - lean) / (next + lean) : 0.0;
  facing.face_share = share_kept(lean, angle) * std::min(1.0, lead);
  if (facing.face_share > 0.0) return facing;
  facing.feature = facing.along_share > 0.0 ? Feature{Kind::kEdge, facing.edge} : f;
  return facing;
}

}  // namespace tactum
