#include "tactum/mesh/piece_overlap.h"

#include <algorithm>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

/// Largest gap along the normals of a's faces.
double face_separation(const Polytope& a, const Polytope& b, double enough) noexcept {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : a.faces) {
    const Vec3& lowest = b.vertices[support_vertex(b, -face.normal)];
    largest = std::max(largest, face.normal.dot(lowest) - face.offset);
    if (largest > enough) break;
  }
  return largest;
}

/// Whether the arc from a to b crosses the arc from c to d on the unit sphere.
bool arcs_cross(const Vec3& a, const Vec3& b, const Vec3& b_x_a, const Vec3& c, const Vec3& d,
                const Vec3& d_x_c) noexcept {
  const double cba = c.dot(b_x_a);
  const double dba = d.dot(b_x_a);
  const double adc = a.dot(d_x_c);
  const double bdc = b.dot(d_x_c);
  return cba * dba < 0.0 && adc * bdc < 0.0 && cba * bdc > 0.0;
}

double edge_separation(const Polytope& a, const Polytope& b, double enough) noexcept {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Polytope::Edge& ea : a.edges) {
    const Vec3& a_left = a.faces[ea.left].normal;
    const Vec3& a_right = a.faces[ea.right].normal;
    const Vec3 a_arc = a_right.cross(a_left);
    for (const Polytope::Edge& eb : b.edges) {
      const Vec3 b_left = -b.faces[eb.left].normal;
      const Vec3 b_right = -b.faces[eb.right].normal;
      if (!arcs_cross(a_left, a_right, a_arc, b_left, b_right, b_right.cross(b_left))) continue;
      Vec3 axis = ea.direction.cross(eb.direction);
      if (axis.norm() < tolerances::kParallelSine) continue;  // the faces beside them give the same
      axis.normalize();
      const Vec3& p_a = a.vertices[ea.tail];
      if (axis.dot(p_a - a.extent.center) < 0.0) axis = -axis;
      largest = std::max(largest, axis.dot(b.vertices[eb.tail] - p_a));
      if (largest > enough) return largest;
    }
  }
  return largest;
}

}  // namespace

double separation(const Polytope& a, const Polytope& b, double enough) noexcept {
  const double by_a = face_separation(a, b, enough);
  if (by_a > enough) return by_a;
  const double by_b = face_separation(b, a, enough);
  if (by_b > enough) return by_b;
  return std::max({by_a, by_b, edge_separation(a, b, enough)});
}

PieceOverlaps overlapping_pieces(const Part& part, double deeper_than) {
  PieceOverlaps out;
  if (part.pieces.size() < 2) return out;
  for_each_pair_within(part.hierarchy, part.hierarchy, Pose{}, 0.0, [&](int i, int k) {
    const Polytope& a = part.pieces[i];
    const Polytope& b = part.pieces[k];
    if (i >= k || a.flat || b.flat) return true;
    const double depth = -separation(a, b, -deeper_than);
    if (depth <= deeper_than) return true;
    ++out.pairs;
    if (depth > out.deepest) {
      out.deepest = depth;
      out.worst = {i, k};
    }
    return true;
  });
  return out;
}

}  // namespace tactum::inline v0_1
