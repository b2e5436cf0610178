#include "tactum/collision/surface_minima_features.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

Feature vertex_of(const SurfaceTree& tree, std::int32_t corner) noexcept {
  return {FeatureKind::kVertex, tree.vertex_at(corner)};
}
Feature edge_of(std::int32_t corner) noexcept { return {FeatureKind::kEdge, corner}; }
Feature face_of(std::int32_t corner) noexcept { return {FeatureKind::kFace, corner / 3}; }

InCone worst(InCone x, InCone y) noexcept { return x < y ? x : y; }

bool in_order(const SurfaceMinimum& x, const SurfaceMinimum& y) noexcept {
  const auto key = [](const SurfaceMinimum& m) {
    return std::tie(m.a.kind, m.a.index, m.b.kind, m.b.index, m.p_a.x(), m.p_a.y(), m.p_a.z());
  };
  return key(x) < key(y);
}

bool nearer(const SurfaceMinimum& x, const SurfaceMinimum& y) noexcept {
  return x.distance < y.distance || (x.distance == y.distance && in_order(x, y));
}

}  // namespace

FeatureComparison::FeatureComparison(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                                     const MinimaQuery& query, std::vector<SurfaceMinimum>& minima) noexcept
    : a_{a, Mat3::Identity(), Vec3::Zero()},
      b_{b, X_AB.R, X_AB.p},
      query_(query),
      minima_(minima),
      touching_(tolerances::kTouching * std::max(a.size(), b.size())),
      slack_sq_(query.cone_slack * query.cone_slack),
      parallel_sq_(std::max(slack_sq_, tolerances::kParallelSine * tolerances::kParallelSine)) {
  minima_.clear();
}

FeatureComparison::Placed FeatureComparison::placed(const Side& side, std::int32_t corner) const noexcept {
  const Triangle& t = side.tree.triangle(corner / 3);
  const std::size_t k = std::size_t(corner) % 3;
  Placed placed;
  placed.corner = corner;
  placed.point = {side.told(t[k]), side.told(t[(k + 1) % 3]), side.told(t[(k + 2) % 3])};
  placed.normal = (placed.point[1] - placed.point[0]).cross(placed.point[2] - placed.point[0]).normalized();
  return placed;
}

void FeatureComparison::vertex_face(bool swapped, std::int32_t vertex_corner,
                                    std::int32_t face_corner) noexcept {
  ++work.feature_pairs;
  const Placed face = placed(side(!swapped), face_corner);
  const int vertex_index = side(swapped).tree.vertex_at(vertex_corner);
  const Vec3 point = side(swapped).told(vertex_index);
  const double height = face.normal.dot(point - face.point[0]);
  if (!in_range(height)) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 along = face.point[(k + 1) % 3] - face.point[k];
    const double inside = along.cross(point - face.point[k]).dot(face.normal);
    if (!(inside >= -tolerances::kTouching * along.squaredNorm())) return;
  }
  const InCone cone = in_vertex_cone(side(swapped), placed(side(swapped), vertex_corner), -face.normal);
  if (cone == InCone::kOutside) return;
  const Vec3 foot = point - height * face.normal;
  const Feature vertex = vertex_of(side(swapped).tree, vertex_corner);
  if (swapped) {
    take({foot, point, -face.normal, height, face_of(face_corner), vertex, cone}, face.triangle(),
         vertex_corner / 3);
  } else {
    take({point, foot, face.normal, height, vertex, face_of(face_corner), cone}, vertex_corner / 3,
         face.triangle());
  }
}

void FeatureComparison::vertex_edge(bool swapped, std::int32_t vertex_corner,
                                    std::int32_t edge_corner) noexcept {
  ++work.feature_pairs;
  const Placed edge = placed(side(!swapped), edge_corner);
  const Placed vertex = placed(side(swapped), vertex_corner);
  const Vec3 along = edge.point[1] - edge.point[0];
  const double t = along.dot(vertex.point[0] - edge.point[0]) / along.squaredNorm();
  if (!(t >= 0.0 && t <= 1.0)) return;
  const Vec3 foot = edge.point[0] + t * along;
  const double distance = (vertex.point[0] - foot).norm();
  if (!(distance <= query_.reach && distance > touching_)) return;
  const Vec3 n = (vertex.point[0] - foot) / distance;
  InCone cone = in_edge_cone(side(!swapped), edge, n);
  if (cone != InCone::kOutside) cone = worst(cone, in_vertex_cone(side(swapped), vertex, -n));
  if (cone == InCone::kOutside) return;
  const Feature corner = vertex_of(side(swapped).tree, vertex_corner);
  if (swapped) {
    take({foot, vertex.point[0], -n, distance, edge_of(edge_corner), corner, cone}, edge.triangle(),
         vertex.triangle());
  } else {
    take({vertex.point[0], foot, n, distance, corner, edge_of(edge_corner), cone}, vertex.triangle(),
         edge.triangle());
  }
}

void FeatureComparison::vertex_vertex(std::int32_t a_corner, std::int32_t b_corner) noexcept {
  ++work.feature_pairs;
  const Placed a = placed(a_, a_corner);
  const Placed b = placed(b_, b_corner);
  const double distance = (a.point[0] - b.point[0]).norm();
  if (!(distance <= query_.reach && distance > touching_)) return;
  const Vec3 n = (a.point[0] - b.point[0]) / distance;
  InCone cone = in_vertex_cone(b_, b, n);
  if (cone != InCone::kOutside) cone = worst(cone, in_vertex_cone(a_, a, -n));
  if (cone == InCone::kOutside) return;
  take(
      {a.point[0], b.point[0], n, distance, vertex_of(a_.tree, a_corner), vertex_of(b_.tree, b_corner), cone},
      a.triangle(), b.triangle());
}

void FeatureComparison::edge_edge(std::int32_t a_corner, std::int32_t b_corner) noexcept {
  ++work.feature_pairs;
  const Placed a = placed(a_, a_corner);
  const Placed b = placed(b_, b_corner);
  const Vec3 u = a.point[1] - a.point[0];
  const Vec3 w = b.point[1] - b.point[0];
  const Vec3 r = b.point[0] - a.point[0];
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
  take_edges(a, b, a.point[0] + s * u, b.point[0] + t * w, n, -r.dot(n));
}

/// The ends of what two nearly parallel edges share.
void FeatureComparison::parallel_edges(const Placed& a, const Placed& b) noexcept {
  const Vec3& p = a.point[0];
  const Vec3& q = b.point[0];
  const Vec3 u = a.point[1] - p;
  const Vec3 w = b.point[1] - q;
  const double from = u.dot(q - p) / u.squaredNorm();
  const double to = u.dot(q + w - p) / u.squaredNorm();
  const double first = std::max(0.0, std::min(from, to));
  const double last = std::min(1.0, std::max(from, to));
  if (!(first <= last)) return;
  for (const double s : {first, last}) {
    const Vec3 p_a = p + s * u;
    const Vec3 p_b = q + std::clamp(w.dot(p_a - q) / w.squaredNorm(), 0.0, 1.0) * w;
    const double length = (p_a - p_b).norm();
    // Where they touch, the faces beside them tell the normals.
    if (length > touching_) take_edges(a, b, p_a, p_b, (p_a - p_b) / length, length);
    if (last == first) return;
  }
}

void FeatureComparison::take_edges(const Placed& a, const Placed& b, const Vec3& p_a, const Vec3& p_b,
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
  return value * value <= slack_sq_ * length_sq ? InCone::kInflated : InCone::kOutside;
}

/// u is unit and square to the edge.
InCone FeatureComparison::in_edge_cone(const Side& side, const Placed& edge, const Vec3& u) const noexcept {
  InCone cone = InCone::kStrict;
  if (side.tree.narrow_edge(edge.corner)) cone = falls_away(-edge.normal.dot(u), 1.0);
  const Vec3 along = edge.point[1] - edge.point[0];
  // What counts is a face's direction square to the edge: e . u needs no more, its length does.
  const auto face_falls = [&](const Vec3& e) {
    const double value = e.dot(u);
    return value <= 0.0 ? InCone::kStrict
                        : falls_away(value, e.cross(along).squaredNorm() / along.squaredNorm());
  };
  if (cone != InCone::kOutside) cone = worst(cone, face_falls(edge.point[2] - edge.point[0]));
  if (cone == InCone::kOutside) return cone;
  const std::int32_t beyond = side.tree.beyond(edge.corner);
  if (beyond == SurfaceTree::kWall) return worst(cone, falls_away(-edge.normal.dot(u), 1.0));
  return worst(cone, face_falls(side.told(beyond) - edge.point[0]));
}

InCone FeatureComparison::in_vertex_cone(const Side& side, const Placed& vertex,
                                         const Vec3& u) const noexcept {
  InCone cone = InCone::kStrict;
  if (side.tree.narrow_vertex(vertex.corner)) cone = falls_away(-vertex.normal.dot(u), 1.0);
  if (cone == InCone::kOutside) return cone;
  const SurfaceTree& tree = side.tree;
  const int index = tree.vertex_at(vertex.corner);
  const Vec3& p = tree.vertex(index);
  const Vec3 direction = rotated_back(side.R, u);
  for (std::int32_t w : tree.around(index)) {
    if (w >= 0) {
      const Vec3 e = tree.vertex(w) - p;
      cone = worst(cone, falls_away(e.dot(direction), e.squaredNorm()));
    } else {
      const Triangle& t = tree.triangle(~w);
      const Vec3 wall = (tree.vertex(t[2]) - tree.vertex(t[0])).cross(tree.vertex(t[1]) - tree.vertex(t[0]));
      cone = worst(cone, falls_away(wall.dot(direction), wall.squaredNorm()));
    }
    if (cone == InCone::kOutside) break;
  }
  return cone;
}

void FeatureComparison::take(const Touch& touch, int triangle_a, int triangle_b) noexcept {
  ++work.minima;
  const SurfaceMinimum minimum = {touch.distance, touch.p_a,  touch.p_b,
                                  touch.normal,   touch.a,    touch.b,
                                  triangle_a,     triangle_b, touch.cone == InCone::kStrict};
  if (minima_.size() < minima_.capacity()) {
    minima_.push_back(minimum);
    return;
  }
  // Full: a heap with the farthest on top, which gives way to what is nearer.
  if (!work.full) std::make_heap(minima_.begin(), minima_.end(), nearer);
  work.full = true;
  if (minima_.empty() || !nearer(minimum, minima_.front())) return;
  std::pop_heap(minima_.begin(), minima_.end(), nearer);
  minima_.back() = minimum;
  std::push_heap(minima_.begin(), minima_.end(), nearer);
}

void FeatureComparison::finish() noexcept { std::sort(minima_.begin(), minima_.end(), in_order); }

}  // namespace tactum
