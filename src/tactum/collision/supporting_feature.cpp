#include "tactum/collision/supporting_feature.h"

#include <cmath>
#include <limits>

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

/// The face most square to a direction, of those tested.
struct MostSquare {
  int face = -1;
  double lean = std::numeric_limits<double>::infinity();  ///< its angle's chord, squared
  double next = std::numeric_limits<double>::infinity();  ///< that of the second

  void look_at(const Polytope& P, int candidate, const Vec3& outward) noexcept {
    // The chord has all its digits where a cosine has none.
    const double off = (P.faces[candidate].normal - outward).squaredNorm();
    if (off < lean) {
      next = lean;
      lean = off;
      face = candidate;
    } else {
      next = std::min(next, off);
    }
  }
};

[[gnu::noinline]] MostSquare most_square_at_vertex(const Polytope& P, int vertex,
                                                   const Vec3& outward) noexcept {
  MostSquare found;
  for (const Polytope::Ray& ray : P.rays_at(vertex)) {
    const Polytope::Edge& edge = P.edges[ray.edge];
    found.look_at(P, edge.tail == vertex ? edge.left : edge.right, outward);
  }
  return found;
}

MostSquare most_square(const Polytope& P, const Feature& f, const Vec3& outward) noexcept {
  if (f.kind == Kind::kVertex) return most_square_at_vertex(P, f.index, outward);
  MostSquare found;
  if (f.kind == Kind::kFace) {
    found.look_at(P, f.index, outward);
  } else {
    found.look_at(P, P.edges[f.index].left, outward);
    found.look_at(P, P.edges[f.index].right, outward);
  }
  return found;
}

/// The edge at feature `f` and on the border of `face` that is most square to `outward`; its slope in
/// `slope`.
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

/// For a face that leans by `lean` from square, or has a neighbour that leans by little more, `next`.
[[gnu::noinline]] SupportingFeature shrunk(const Polytope& P, const Feature& f, int face, double lean,
                                           double next, const Vec3& outward, double angle) noexcept {
  SupportingFeature supporting;
  supporting.feature = {Kind::kFace, face};
  double slope = 0.0;
  supporting.edge = level_edge(P, f, face, outward, slope);
  // An edge shrinks at a quarter of the angle: where two edges of a leaning face slope equally, both are
  // points by then.
  supporting.along_share = lean_falloff(slope, 0.25 * angle);
  const double lead = next > lean ? 2.0 * (next - lean) / (next + lean) : 0.0;
  supporting.face_share = lean_falloff(lean, angle) * std::min(1.0, lead);
  if (supporting.face_share > 0.0) return supporting;
  supporting.feature = supporting.along_share > 0.0 ? Feature{Kind::kEdge, supporting.edge} : f;
  return supporting;
}

}  // namespace

SupportingFeature supporting_feature(const Polytope& P, const Feature& f, const Vec3& outward,
                                     double angle) noexcept {
  const auto [face, lean, next] = most_square(P, f, outward);
  if (f.kind == Kind::kFace) {
    // Square to the normal; where it is not (for an answer of none of the queries), a point.
    const bool square = lean < angle * angle;
    return {square ? f : Feature{Kind::kVertex, vertex_of(P, f)}};
  }
  // Nearly square and alone: both fractions of the face are one, whatever its edges are.
  if (lean <= 0.25 * angle * angle && next >= 9.0 * lean) return {{Kind::kFace, face}};
  return shrunk(P, f, face, std::sqrt(lean), std::sqrt(next), outward, angle);
}

}  // namespace tactum::inline v0_1
