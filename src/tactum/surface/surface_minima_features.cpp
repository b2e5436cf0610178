#include "tactum/surface/surface_minima_features.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

Feature vertex_of(const SurfaceTree& tree, std::int32_t corner) noexcept {
  return {FeatureKind::kVertex, tree.vertex_at(corner)};
}
Feature edge_of(std::int32_t corner) noexcept { return {FeatureKind::kEdge, corner}; }
Feature face_of(std::int32_t corner) noexcept { return {FeatureKind::kFace, corner / 3}; }

InCone worst(InCone x, InCone y) noexcept { return x < y ? x : y; }

bool in_order(const SurfaceMinimum& x, const SurfaceMinimum& y) noexcept {
  const auto number = [](const Feature& f) {
    return std::uint64_t(f.kind) << 32 | static_cast<std::uint32_t>(f.index);
  };
  if (number(x.a) != number(y.a)) return number(x.a) < number(y.a);
  if (number(x.b) != number(y.b)) return number(x.b) < number(y.b);
  return std::lexicographical_compare(x.p_a.begin(), x.p_a.end(), y.p_a.begin(), y.p_a.end());
}

bool nearer(const SurfaceMinimum& x, const SurfaceMinimum& y) noexcept {
  return x.distance < y.distance || (x.distance == y.distance && in_order(x, y));
}

}  // namespace

FeatureComparison::FeatureComparison(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                                     const MinimaQuery& query, std::vector<SurfaceMinimum>& minima) noexcept
    : a_{a, true, Mat3::Identity(), Vec3::Zero()},
      b_{b, false, X_AB.R, X_AB.p},
      query_(query),
      minima_(minima),
      max_distance_(query.max_distance),
      touching_(tolerances::kTouching * std::max(a.size(), b.size())),
      inflation_sq_(query.cone_inflation * query.cone_inflation),
      parallel_sq_(std::max(inflation_sq_, tolerances::kParallelSine * tolerances::kParallelSine)) {
  minima_.clear();
}

Vec3 FeatureComparison::Side::normal(std::int32_t corner) const noexcept {
  const Vec3 from = point(corner, 0);
  return (point(corner, 1) - from).cross(point(corner, 2) - from).normalized();
}

FeatureComparison::Edge FeatureComparison::edge(const Side& side, std::int32_t corner) noexcept {
  const Vec3 from = side.point(corner, 0);
  return {corner, from, side.point(corner, 1) - from};
}

void FeatureComparison::vertex_face(bool swapped, std::int32_t vertex_corner,
                                    std::int32_t face_corner) noexcept {
  ++work.feature_pairs;
  const Side& of_face = side(!swapped);
  const Side& of_vertex = side(swapped);
  const Vec3 point = of_vertex.point(vertex_corner, 0);
  const std::array<Vec3, 3> face = {of_face.point(face_corner, 0), of_face.point(face_corner, 1),
                                    of_face.point(face_corner, 2)};
  const Vec3 normal = (face[1] - face[0]).cross(face[2] - face[0]).normalized();
  const double height = normal.dot(point - face[0]);
  if (!in_range(height)) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 along = face[(k + 1) % 3] - face[k];
    const double inside = along.cross(point - face[k]).dot(normal);
    if (!(inside >= -tolerances::kTouching * along.squaredNorm())) return;
  }
  const InCone cone = in_vertex_cone(of_vertex, vertex_corner, -normal);
  if (cone == InCone::kOutside) return;
  const Vec3 foot = point - height * normal;
  const Feature vertex = vertex_of(of_vertex.tree, vertex_corner);
  if (swapped) {
    take({foot, point, -normal, height, face_of(face_corner), vertex, cone}, face_corner / 3,
         vertex_corner / 3);
  } else {
    take({point, foot, normal, height, vertex, face_of(face_corner), cone}, vertex_corner / 3,
         face_corner / 3);
  }
}

void FeatureComparison::vertex_edge(bool swapped, std::int32_t vertex_corner,
                                    std::int32_t edge_corner) noexcept {
  ++work.feature_pairs;
  const Edge line = edge(side(!swapped), edge_corner);
  const Vec3 point = side(swapped).point(vertex_corner, 0);
  const double t = line.along.dot(point - line.from) / line.along.squaredNorm();
  if (!(t >= 0.0 && t <= 1.0)) return;
  const Vec3 foot = line.from + t * line.along;
  const double distance = (point - foot).norm();
  if (!(distance <= max_distance_ && distance > touching_)) return;
  const Vec3 n = (point - foot) / distance;
  InCone cone = in_edge_cone(side(!swapped), line, n);
  if (cone != InCone::kOutside) cone = worst(cone, in_vertex_cone(side(swapped), vertex_corner, -n));
  if (cone == InCone::kOutside) return;
  const Feature corner = vertex_of(side(swapped).tree, vertex_corner);
  if (swapped) {
    take({foot, point, -n, distance, edge_of(edge_corner), corner, cone}, edge_corner / 3, vertex_corner / 3);
  } else {
    take({point, foot, n, distance, corner, edge_of(edge_corner), cone}, vertex_corner / 3, edge_corner / 3);
  }
}

void FeatureComparison::vertex_vertex(std::int32_t a_corner, std::int32_t b_corner) noexcept {
  ++work.feature_pairs;
  const Vec3 p_a = a_.point(a_corner, 0);
  const Vec3 p_b = b_.point(b_corner, 0);
  const double distance = (p_a - p_b).norm();
  if (!(distance <= max_distance_ && distance > touching_)) return;
  const Vec3 n = (p_a - p_b) / distance;
  InCone cone = in_vertex_cone(b_, b_corner, n);
  if (cone != InCone::kOutside) cone = worst(cone, in_vertex_cone(a_, a_corner, -n));
  if (cone == InCone::kOutside) return;
  take({p_a, p_b, n, distance, vertex_of(a_.tree, a_corner), vertex_of(b_.tree, b_corner), cone},
       a_corner / 3, b_corner / 3);
}

void FeatureComparison::edge_edge(std::int32_t a_corner, std::int32_t b_corner) noexcept {
  ++work.feature_pairs;
  const Edge a = edge(a_, a_corner);
  const Edge b = edge(b_, b_corner);
  const Vec3& u = a.along;
  const Vec3& w = b.along;
  const Vec3 r = b.from - a.from;
  const Vec3 c = u.cross(w);
  const double sine_sq = c.squaredNorm();
  const double lengths_sq = u.squaredNorm() * w.squaredNorm();
  if (sine_sq <= parallel_sq_ * lengths_sq) parallel_edges(a, b);
  if (sine_sq <= tolerances::kParallelSine * tolerances::kParallelSine * lengths_sq) return;
  const double s = r.cross(w).dot(c) / sine_sq;
  const double t = r.cross(u).dot(c) / sine_sq;
  constexpr double kEnd = tolerances::kTouching;
  if (!(s >= -kEnd && s <= 1.0 + kEnd && t >= -kEnd && t <= 1.0 + kEnd)) return;
  const Vec3 n = c / std::sqrt(sine_sq);
  take_edges(a, b, a.from + s * u, b.from + t * w, n, -r.dot(n));
}

/// The ends of the interval that two nearly parallel edges have in common.
void FeatureComparison::parallel_edges(const Edge& a, const Edge& b) noexcept {
  const Vec3& p = a.from;
  const Vec3& q = b.from;
  const Vec3& u = a.along;
  const Vec3& w = b.along;
  const double from = u.dot(q - p) / u.squaredNorm();
  const double to = u.dot(q + w - p) / u.squaredNorm();
  const double first = std::max(0.0, std::min(from, to));
  const double last = std::min(1.0, std::max(from, to));
  if (!(first <= last)) return;
  for (const double s : {first, last}) {
    const Vec3 p_a = p + s * u;
    const Vec3 p_b = q + std::clamp(w.dot(p_a - q) / w.squaredNorm(), 0.0, 1.0) * w;
    const double length = (p_a - p_b).norm();
    // Where they touch, the faces beside them give the normals.
    if (length > touching_) take_edges(a, b, p_a, p_b, (p_a - p_b) / length, length);
    if (last == first) return;
  }
}

void FeatureComparison::take_edges(const Edge& a, const Edge& b, const Vec3& p_a, const Vec3& p_b,
                                   const Vec3& n, double distance) noexcept {
  for (const double sign : {1.0, -1.0}) {
    if (!in_range(sign * distance)) continue;
    InCone cone = in_edge_cone(b_, b, sign * n);
    if (cone != InCone::kOutside) cone = worst(cone, in_edge_cone(a_, a, -sign * n));
    if (cone == InCone::kOutside) continue;
    take({p_a, p_b, sign * n, sign * distance, edge_of(a.corner), edge_of(b.corner), cone}, a.triangle(),
         b.triangle());
    return;
  }
}

InCone FeatureComparison::falls_away(double value, double length_sq) const noexcept {
  if (value <= 0.0) return InCone::kStrict;
  constexpr double kRounding = tolerances::kSameNormal * tolerances::kSameNormal;
  if (value * value <= kRounding * length_sq) return InCone::kStrict;
  return value * value <= inflation_sq_ * length_sq ? InCone::kInflated : InCone::kOutside;
}

/// u is unit and square to the edge, to within the inflation where edges are parallel. The neighbours come
/// first: they exclude most and cost least.
InCone FeatureComparison::in_edge_cone(const Side& side, const Edge& edge, const Vec3& u) const noexcept {
  // The criterion is a face's direction square to the edge. Along it a sliver's other corner may be a hundred
  // times as far as across, so that a small tilt of u would decide.
  const double per_length_sq = 1.0 / edge.along.squaredNorm();
  const auto face_falls = [&](const Vec3& to_corner) {
    const Vec3 e = to_corner - edge.along * (to_corner.dot(edge.along) * per_length_sq);
    const double value = e.dot(u);
    return value <= 0.0 ? InCone::kStrict : falls_away(value, e.squaredNorm());
  };
  InCone cone = face_falls(side.point(edge.corner, 2) - edge.from);
  if (cone == InCone::kOutside) return cone;
  const std::int32_t beyond = side.tree.beyond(edge.corner);
  const bool wall = beyond == SurfaceTree::kWall;
  if (!wall) cone = worst(cone, face_falls(side.position(beyond) - edge.from));
  if (cone == InCone::kOutside || !(wall || side.tree.narrow_edge(edge.corner))) return cone;
  return worst(cone, falls_away(-side.normal(edge.corner).dot(u), 1.0));
}

Vec3 FeatureComparison::falling(const SurfaceTree& tree, const Vec3& p, std::int32_t w) noexcept {
  if (w >= 0) return tree.vertex(w) - p;
  const Triangle& t = tree.triangle(~w);
  return (tree.vertex(t[2]) - tree.vertex(t[0])).cross(tree.vertex(t[1]) - tree.vertex(t[0]));
}

InCone FeatureComparison::in_vertex_cone(const Side& side, std::int32_t corner,
                                         const Vec3& u) const noexcept {
  const SurfaceTree& tree = side.tree;
  const int index = tree.vertex_at(corner);
  const Vec3& p = tree.vertex(index);
  const Vec3 direction = side.is_a ? u : rotated_back(side.R, u);
  InCone cone = InCone::kStrict;
  for (std::int32_t w : tree.around(index)) {
    const Vec3 e = falling(tree, p, w);
    cone = worst(cone, falls_away(e.dot(direction), e.squaredNorm()));
    if (cone == InCone::kOutside) return cone;
  }
  if (cone == InCone::kInflated && !near_vertex_cone(tree, index, direction)) return InCone::kOutside;
  if (!tree.narrow_vertex(corner)) return cone;
  return worst(cone, falls_away(-side.normal(corner).dot(u), 1.0));
}

/// The direction of the cone that is nearest to u lies on one of its planes, or where one meets another; of
/// these u lies before one at least. Where planes meet at a sharp angle, u may be near each but far from
/// both.
bool FeatureComparison::near_vertex_cone(const SurfaceTree& tree, int vertex, const Vec3& u) const noexcept {
  const Vec3& p = tree.vertex(vertex);
  const auto around = tree.around(vertex);
  const auto in_cone = [&](const Vec3& v) {
    return std::all_of(around.begin(), around.end(), [&](std::int32_t w) {
      const Vec3 e = falling(tree, p, w);
      return e.dot(v) <= tolerances::kSameNormal * e.norm();
    });
  };
  for (std::int32_t w : around) {
    const Vec3 e = falling(tree, p, w);
    const double value = e.dot(u);
    if (value <= 0.0) continue;
    if (in_cone(u - e * (value / e.squaredNorm()))) return true;
    for (std::int32_t other : around) {
      const Vec3 ray = e.cross(falling(tree, p, other));
      const double length_sq = ray.squaredNorm();
      if (!(length_sq > 0.0)) continue;
      const double along = ray.dot(u);
      if ((u - ray * (along / length_sq)).squaredNorm() > inflation_sq_) continue;
      if (in_cone(ray * ((along < 0.0 ? -1.0 : 1.0) / std::sqrt(length_sq)))) return true;
    }
  }
  return false;
}

void FeatureComparison::take(const Touch& touch, int triangle_a, int triangle_b) noexcept {
  ++work.minima;
  if (share_ > 0.0) {
    max_distance_ = std::max(0.0, std::min(max_distance_, share_ * touch.distance));
    return;
  }
  const SurfaceMinimum minimum = {touch.distance, touch.p_a,  touch.p_b,
                                  touch.normal,   touch.a,    touch.b,
                                  triangle_a,     triangle_b, touch.cone == InCone::kStrict,
                                  false};
  if (minima_.size() < minima_.capacity()) {
    minima_.push_back(minimum);
    return;
  }
  // Full: a heap with the farthest on top, which is replaced by a nearer one.
  if (!work.full) std::make_heap(minima_.begin(), minima_.end(), nearer);
  work.full = true;
  if (minima_.empty() || !nearer(minimum, minima_.front())) return;
  std::pop_heap(minima_.begin(), minima_.end(), nearer);
  minima_.back() = minimum;
  std::push_heap(minima_.begin(), minima_.end(), nearer);
}

void FeatureComparison::finish() noexcept { std::sort(minima_.begin(), minima_.end(), in_order); }

}  // namespace tactum::inline v0_1
