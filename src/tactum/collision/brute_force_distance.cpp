#include "tactum/collision/brute_force_distance.h"

#include <limits>

#include "tactum/collision/segments.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

struct Nearest {
  PairDistance& x;
  double gap_sq = std::numeric_limits<double>::infinity();

  void take(const Feature& a, const Feature& b, const Vec3& p_a, const Vec3& p_b) noexcept {
    const double next = (p_a - p_b).squaredNorm();
    if (next >= gap_sq) return;
    gap_sq = next;
    x.a = a;
    x.b = b;
    x.p_a = p_a;
    x.p_b = p_b;
  }
};

Feature along_edge(const Polytope& P, int e, double s) noexcept {
  const Polytope::Edge& edge = P.edges[e];
  if (s <= 0.0) return {Kind::kVertex, edge.tail};
  return s >= edge.length ? Feature{Kind::kVertex, edge.head} : Feature{Kind::kEdge, e};
}

/// The vertex of P over the face of Q, when its foot is inside: the foot, in Q's frame.
bool foot_on_face(const Polytope& Q, int face_index, const Vec3& p, Vec3& foot) noexcept {
  if (!in_column(Q, face_index, p)) return false;
  const Polytope::Face& face = Q.faces[face_index];
  foot = p - face.normal * (face.normal.dot(p) - face.offset);
  return true;
}

}  // namespace

void brute_force_distance(const PairView& pair, PairDistance& x) noexcept {
  Nearest nearest{x};
  const int faces_a = static_cast<int>(pair.A.faces.size());
  const int faces_b = static_cast<int>(pair.B.faces.size());
  const int edges_a = static_cast<int>(pair.A.edges.size());
  const int edges_b = static_cast<int>(pair.B.edges.size());
  Vec3 foot;
  for (int f = 0; f < faces_a; ++f)
    for (int v = 0; v < static_cast<int>(pair.B.vertices.size()); ++v)
      if (const Vec3 p = pair.vertex_b(v); foot_on_face(pair.A, f, p, foot))
        nearest.take({Kind::kFace, f}, {Kind::kVertex, v}, foot, p);
  for (int f = 0; f < faces_b; ++f)
    for (int v = 0; v < static_cast<int>(pair.A.vertices.size()); ++v)
      if (foot_on_face(pair.B, f, pair.X_BA * pair.vertex_a(v), foot))
        nearest.take({Kind::kVertex, v}, {Kind::kFace, f}, pair.vertex_a(v), pair.X_AB * foot);
  for (int j = 0; j < edges_b; ++j) {
    const Polytope::Edge& eb = pair.B.edges[j];
    const Vec3 b0 = pair.vertex_b(eb.tail);
    const Vec3 w = pair.X_AB.R * eb.direction;
    for (int i = 0; i < edges_a; ++i) {
      const Polytope::Edge& ea = pair.A.edges[i];
      const Vec3& a0 = pair.vertex_a(ea.tail);
      const SegmentPair at =
          nearest_on_segments(ea.direction, ea.length, w, eb.length, b0 - a0, ea.direction.cross(w));
      nearest.take(along_edge(pair.A, i, at.s), along_edge(pair.B, j, at.t), a0 + ea.direction * at.s,
                   b0 + w * at.t);
    }
  }
}

}  // namespace tactum::inline v0_1
