#pragma once
/// The plane a contact patch is told in, and what a face looks like over it: an outline, and a height that is
/// linear along the plane.

#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/collision/contact.h"
#include "tactum/collision/planar_patch.h"
#include "tactum/geometry/polytope.h"
#include "tactum/math/two.h"

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

/// 1 / sqrt(1 - lean), for `lean` in [0, 1). Where three terms of its series do they stand in for the
/// root and the quotient, which all that follows would wait for.
inline double grown_to_unit(double lean) noexcept {
  return lean < tolerances::kThreeTerms ? 1.0 + lean * (0.5 + lean * 0.375) : 1.0 / std::sqrt(1.0 - lean);
}

/// The contact plane's first axis goes with A's feature, so that points keep their places while it stays.
inline Tangent contact_plane(const Polytope& A, const Feature& a, const Vec3& origin,
                             const Vec3& n) noexcept {
  Tangent tangent{origin, {}, {}, n};
  if (a.kind == FeatureKind::kVertex) {
    tangent.e1 = any_orthogonal(n);
  } else {
    const int edge = a.kind == FeatureKind::kEdge ? a.index : A.sides[A.faces[a.index].first].edge;
    const Vec3& u = A.edges[edge].direction;
    const double along = n.dot(u);
    const double lean = along * along;
    // Nearly square to n already, in the answers of the queries.
    tangent.e1 = lean < 0.75 ? Vec3((u - n * along) * grown_to_unit(lean)) : any_orthogonal(n);
  }
  tangent.e2 = n.cross(tangent.e1);
  return tangent;
}

/// The outline of a face, counter-clockwise in the contact plane: B's faces look along n, A's against it.
/// `plane` is in P's frame.
inline void face_outline(const Tangent& plane, const Polytope& P, int face_index, bool on_a,
                         PatchPolygon& loop) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const bool all = face.count <= kPatchCorners;
  const int stride = all ? 1 : (face.count + kPatchCorners - 1) / kPatchCorners;
  const int step = on_a ? -stride : stride;
  const int first = face.first + (on_a ? face.count - 1 : 0);
  const int* const corners = P.face_vertices.data();
  const Vec3* const vertices = P.vertices.data();
  const Two ex = {plane.e1.x(), plane.e2.x()};
  const Two ey = {plane.e1.y(), plane.e2.y()};
  const Two ez = {plane.e1.z(), plane.e2.z()};
  // Numbers of its own, which stay in registers while corners are stored.
  const double ox = plane.origin.x();
  const double oy = plane.origin.y();
  const double oz = plane.origin.z();
  const int count = all ? face.count : (face.count + stride - 1) / stride;
  loop.fill(static_cast<std::size_t>(count), [&](std::size_t i) {
    const Vec3& p = vertices[corners[first + step * static_cast<int>(i)]];
    return vec2(ex * both(p.x() - ox) + ey * both(p.y() - oy) + ez * both(p.z() - oz));
  });
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
