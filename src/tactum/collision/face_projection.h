#pragma once
/// Points and faces of a piece in the two coordinates of a plane of a contact patch.

#include "tactum/collision/contact.h"
#include "tactum/collision/planar_patch.h"
#include "tactum/geometry/polytope.h"
#include "tactum/math/two.h"

namespace tactum::inline v0_1 {

/// Two coordinates of the points of a piece's frame: (r1, r2) . (p - origin) scale, side by side. The scale
/// is kept by itself, so that its latency overlaps the rest. All numbers are separate: in a copy of a vector
/// just written the processor would wait for them.
struct Projection {
  double origin_x, origin_y, origin_z;
  Two x, y, z;  ///< the components of r1 and r2
  Two scale;

  Projection(const Vec3& from, Two ex, Two ey, Two ez, Two by = both(1.0)) noexcept
      : origin_x(from.x()), origin_y(from.y()), origin_z(from.z()), x(ex), y(ey), z(ez), scale(by) {}

  Vec2 flat(const Vec3& p) const noexcept {
    return vec2((x * both(p.x() - origin_x) + y * both(p.y() - origin_y) + z * both(p.z() - origin_z)) *
                scale);
  }
};

/// A height over the plane, linear along it.
struct Height {
  double at_origin = 0.0;
  Vec2 slope = Vec2::Zero();
  double operator()(const Vec2& x) const noexcept { return at_origin + slope.dot(x); }
};

/// The outline of a face, counter-clockwise in the plane: B's faces look along n, A's against it.
/// `plane` is of P's frame.
inline void face_outline(const Projection& plane, const Polytope& P, int face_index, bool on_a,
                         PatchPolygon& loop) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const bool all = face.count <= kPatchCorners;
  const int stride = all ? 1 : (face.count + kPatchCorners - 1) / kPatchCorners;
  const int step = on_a ? -stride : stride;
  const int first = face.first + (on_a ? face.count - 1 : 0);
  const int* const corners = P.face_vertices.data();
  const Vec3* const vertices = P.vertices.data();
  const Projection flat = plane;  // a local copy, which stays in registers while corners are stored
  const int count = all ? face.count : (face.count + stride - 1) / stride;
  loop.fill(static_cast<std::size_t>(count),
            [&](std::size_t i) { return flat.flat(vertices[corners[first + step * static_cast<int>(i)]]); });
}

}  // namespace tactum::inline v0_1
