#pragma once
/// The plane a contact patch is told in, and what a face looks like over it: an outline, and a height that is
/// linear along the plane.

#include <cmath>

#include "tactum/collision/contact.h"
#include "tactum/collision/planar_patch.h"
#include "tactum/geometry/polytope.h"

namespace tactum {

/// The contact plane, told in the frame of either piece: coordinates x along e1, e2 and height along n, from
/// a point near the contact.
struct Tangent {
  Vec3 origin, e1, e2, n;

  Vec2 flat(const Vec3& p) const noexcept {
    const Vec3 r = p - origin;
    return {e1.dot(r), e2.dot(r)};
  }
  Vec3 point(const Vec2& x, double z) const noexcept { return origin + e1 * x.x() + e2 * x.y() + n * z; }
};

/// Height of a plane over the contact plane, linear in x.
struct Height {
  double at_origin = 0.0;
  Vec2 slope = Vec2::Zero();
  double operator()(const Vec2& x) const noexcept { return at_origin + slope.dot(x); }
};

/// The contact plane's first axis goes with A's feature, so that points keep their places while it stays.
inline Tangent contact_plane(const Polytope& A, const Feature& a, const Vec3& origin,
                             const Vec3& n) noexcept {
  Tangent tangent{origin, Vec3::Zero(), Vec3::Zero(), n};
  if (a.kind == FeatureKind::kVertex) {
    tangent.e1 = any_orthogonal(n);
  } else {
    const int edge = a.kind == FeatureKind::kEdge ? a.index : A.face_edges[A.faces[a.index].first];
    const Vec3& u = A.edges[edge].direction;
    tangent.e1 = u - n * n.dot(u);
    const double length_sq = tangent.e1.squaredNorm();
    // Nearly square to n already, in the answers of the queries.
    tangent.e1 = length_sq > 0.25 ? Vec3(tangent.e1 * (1.0 / std::sqrt(length_sq))) : any_orthogonal(n);
  }
  tangent.e2 = n.cross(tangent.e1);
  return tangent;
}

/// The outline of a face, counter-clockwise in the contact plane: B's faces look along n, A's against it.
/// `plane` is in P's frame.
inline void face_outline(const Tangent& plane, const Polytope& P, int face_index, bool on_a,
                         PatchPolygon& loop) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const int stride = (face.count + kPatchCorners - 1) / kPatchCorners;
  const int* const corners = P.face_vertices.data() + face.first;
  const Vec3* const vertices = P.vertices.data();
  loop.clear();
  if (on_a) {
    for (int i = face.count - 1; i >= 0; i -= stride) loop.push_back(plane.flat(vertices[corners[i]]));
  } else {
    for (int i = 0; i < face.count; i += stride) loop.push_back(plane.flat(vertices[corners[i]]));
  }
}

inline Height face_height(const Tangent& plane, const Polytope& P, int face_index) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const double per_up = 1.0 / face.normal.dot(plane.n);
  return {(face.offset - face.normal.dot(plane.origin)) * per_up,
          {-face.normal.dot(plane.e1) * per_up, -face.normal.dot(plane.e2) * per_up}};
}

/// How far a leaning face has risen from the line of its edge: linear, zero on the line.
struct Rise {
  Vec2 slope = Vec2::Zero();
  double offset = 0.0;
  double operator()(const Vec2& x) const noexcept { return slope.dot(x) - offset; }
};

inline Rise rise_from_edge(const Tangent& tangent, const Polytope& P, int edge, const Pose& X,
                           const Vec2& face_slope) noexcept {
  const Vec2 on_line = tangent.flat(X * P.vertices[P.edges[edge].tail]);
  const Vec2 along = (tangent.flat(X * P.vertices[P.edges[edge].head]) - on_line).normalized();
  const Vec2 across = face_slope - along * along.dot(face_slope);
  return {across, across.dot(on_line)};
}

}  // namespace tactum
