#include "thin_shape.h"

#include <algorithm>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/collision/segments.h"

namespace tactum {
namespace {

/// A direction and length; of a point any direction, and no length.
struct Segment {
  Vec3 start, along;
  double length;
  Segment(const Vec3& tail, const Vec3& head) : start(tail), along(head - tail), length(along.norm()) {
    along = length > 0.0 ? Vec3(along / length) : Vec3::UnitX();
  }
};

/// The nearest pair of points found so far.
struct NearestPoints {
  Vec3 p_a = Vec3::Zero(), p_b = Vec3::Zero();
  double gap = std::numeric_limits<double>::infinity();
  int tried = 0;  ///< feature pairs

  void take(const Vec3& a, const Vec3& b) {
    ++tried;
    const double next = (a - b).norm();
    if (next < gap) {
      gap = next;
      p_a = a;
      p_b = b;
    }
  }
  void take(const Segment& a, const Segment& b) {
    const SegmentPair at =
        nearest_on_segments(a.along, a.length, b.along, b.length, b.start - a.start, a.along.cross(b.along));
    take(a.start + at.s * a.along, b.start + at.t * b.along);
  }
};

/// Of shapes that do not overlap: every edge of B against A, and A's ends against every face.
NearestPoints nearest_points(const ThinShape& A, const Polytope& B) {
  NearestPoints nearest;
  for (const Polytope::Edge& edge : B.edges)
    nearest.take(Segment(A.tail, A.head), Segment(B.vertices[static_cast<std::size_t>(edge.tail)],
                                                  B.vertices[static_cast<std::size_t>(edge.head)]));
  for (const Polytope::Face& face : B.faces) {
    for (const Vec3& end : {A.tail, A.head}) {
      const auto* const first = B.sides.data() + face.first;
      const bool is_above = std::all_of(first, first + face.count, [&](const Polytope::Side& side) {
        return side.normal.dot(end) <= side.offset;
      });
      if (is_above) nearest.take(end, end - face.normal * (face.normal.dot(end) - face.offset));
    }
  }
  return nearest;
}

/// The direction along which A has to move least to leave B, and how far.
struct Displacement {
  Vec3 normal = Vec3::Zero();
  double depth = std::numeric_limits<double>::infinity();
  int tried = 0;

  void take(const Vec3& direction, const ThinShape& A, double top_of_b) {
    ++tried;
    const double next = top_of_b - std::min(direction.dot(A.tail), direction.dot(A.head));
    if (next < depth) {
      depth = next;
      normal = direction;
    }
  }
};

double height_along(const Vec3& direction, const Polytope& B) {
  double height = -std::numeric_limits<double>::infinity();
  for (const Vec3& vertex : B.vertices) height = std::max(height, direction.dot(vertex));
  return height;
}

/// Over the normals of all facets that B - A can have: B's faces, and its edges swept along A; and over the
/// line of the nearest points, which shows shapes in one plane that are apart.
Displacement least_displacement(const ThinShape& A, const Polytope& B, const NearestPoints& nearest) {
  Displacement out;
  const Segment a(A.tail, A.head);
  if (nearest.gap > 0.0) {
    const Vec3 apart = (nearest.p_a - nearest.p_b) / nearest.gap;
    out.take(apart, A, height_along(apart, B));
  }
  for (const Polytope::Face& face : B.faces) out.take(face.normal, A, height_along(face.normal, B));
  if (a.length == 0.0) return out;
  for (const Polytope::Edge& edge : B.edges) {
    const Vec3 across = edge.direction.cross(a.along);
    if (across.norm() < tolerances::kSameArc) continue;
    for (const Vec3& normal : {Vec3(across.normalized()), Vec3(-across.normalized())})
      out.take(normal, A, height_along(normal, B));
  }
  return out;
}

/// Any unit vector square to both; where they are parallel, or zero, to the first that is not.
Vec3 square_to(const Vec3& u, const Vec3& v) {
  const Vec3 across = u.cross(v);
  if (across.norm() > tolerances::kSameArc) return across.normalized();
  return u.unitOrthogonal();
}

PairDistance answer_of(const NearestPoints& nearest, const Vec3& normal_when_touching) {
  PairDistance x;
  x.distance = nearest.gap;
  x.p_a = nearest.p_a;
  x.p_b = nearest.p_b;
  x.normal = nearest.gap > 0.0 ? Vec3((nearest.p_a - nearest.p_b) / nearest.gap) : normal_when_touching;
  x.stop = Stop::kCertified;
  x.steps = nearest.tried;
  return x;
}

}  // namespace

std::optional<ThinShape> thin_hull(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  const auto farthest_from = [&](const Vec3& from) {
    return *std::max_element(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) {
      return (p - from).squaredNorm() < (q - from).squaredNorm();
    });
  };
  const ThinShape hull{farthest_from(points.front()), farthest_from(farthest_from(points.front()))};
  const Segment line(hull.tail, hull.head);
  const double height = line.length * tolerances::kCoplanar;
  const bool is_thin = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return (p - line.start).cross(line.along).norm() <= height;
  });
  return is_thin ? std::optional(hull) : std::nullopt;
}

PairDistance thin_distance(const ThinShape& A, const Polytope& B) {
  const NearestPoints nearest = nearest_points(A, B);
  const Displacement out = least_displacement(A, B, nearest);
  if (out.depth <= 0.0) return answer_of(nearest, out.normal);
  // Moved out, A touches B where the witness points are.
  const Vec3 move = out.normal * out.depth;
  const NearestPoints touch = nearest_points({A.tail + move, A.head + move}, B);
  PairDistance x;
  x.distance = -out.depth;
  x.normal = out.normal;
  x.p_a = touch.p_a - move;
  x.p_b = touch.p_a;
  x.stop = Stop::kCertified;
  x.steps = nearest.tried + out.tried + touch.tried;
  return x;
}

PairDistance thin_distance(const ThinShape& A, const ThinShape& B) {
  const Segment a(A.tail, A.head);
  const Segment b(B.tail, B.head);
  NearestPoints nearest;
  nearest.take(a, b);
  return answer_of(nearest, square_to(a.along, b.along));
}

}  // namespace tactum
