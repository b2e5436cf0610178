#include "tactum/scene/start_distance.h"

#include <algorithm>
#include <optional>

#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"
#include "tactum/contact/sweep_and_prune.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/mesh/deviation.h"
#include "tactum/repair/surface_crossings.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::inline v0_1 {
namespace {

bool could_touch(const World& world, int a, int b) {
  const Body& body_a = world.bodies[static_cast<std::size_t>(a)];
  const Body& body_b = world.bodies[static_cast<std::size_t>(b)];
  return a != b && (body_a.moves() || body_b.moves()) && body_a.no_contact_with != b &&
         body_b.no_contact_with != a;
}

double box_distance(const Aabb& a, const Aabb& b) {
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0.0).norm();
}

std::vector<Aabb> boxes_at_start(const World& world) {
  std::vector<Aabb> boxes;
  for (const Body& body : world.bodies) boxes.push_back(box_at_start(body));
  return boxes;
}

/// The depth of the deepest pair of pieces [m].
double depth_of_pieces(const Part& a, const Part& b, const Pose& X_AB) {
  constexpr std::size_t kMostEdgePairs = 100'000;  // of a search for the least depth: a millisecond
  double deepest = 0.0;
  for_each_pair_within(a.hierarchy, b.hierarchy, X_AB, 0.0, [&](int i, int k) {
    const Polytope& piece_a = a.pieces[static_cast<std::size_t>(i)];
    const Polytope& piece_b = b.pieces[static_cast<std::size_t>(k)];
    PairCache cache{};
    double distance = closest_features(piece_a, piece_b, X_AB, cache).distance;
    if (distance < 0.0 && piece_a.edges.size() * piece_b.edges.size() <= kMostEdgePairs)
      distance = penetration_exhaustive(piece_a, piece_b, X_AB).distance;
    deepest = std::max(deepest, -distance);
    return true;
  });
  return deepest;
}

/// Whether every edge has two triangles that agree about outside: only then has a surface an inside.
bool closed(const TriangleMesh& mesh) {
  bool all = true;
  for_each_edge(sorted_half_edges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    all = all && last - first == 2 && first->forward != (first + 1)->forward;
  });
  return all;
}

/// How deep points are inside a closed surface.
class DepthInside {
 public:
  explicit DepthInside(const TriangleMesh& mesh)
      : surface_(mesh.triangles.size(), 0), crossings_(mesh, surface_), surface_points_(mesh) {}

  double at(const Vec3& point) {
    return crossings_.windings(point).empty() ? 0.0 : surface_points_.distance(point, nearest_);
  }

 private:
  std::vector<int> surface_;  // all triangles are of one
  SurfaceCrossings crossings_;
  NearestOnMesh surface_points_;
  int nearest_ = 0;  ///< triangle of the last answer
};

/// Corners, middles of sides and centres of the triangles that are in the box of another mesh, in its frame;
/// every n-th of them where there are many.
std::vector<Vec3> points_in_box(const TriangleMesh& mesh, const Pose& X, const Aabb& box) {
  constexpr std::size_t kMostPoints = 4000;
  std::vector<Vec3> points;
  const auto add = [&](const Vec3& point) {
    const Vec3 there = X * point;
    if ((there - box.min).minCoeff() >= 0.0 && (box.max - there).minCoeff() >= 0.0) points.push_back(there);
  };
  for (const Vec3& vertex : mesh.vertices) add(vertex);
  for (const Triangle& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(triangle[k % 3])];
    };
    add((corner(0) + corner(1) + corner(2)) / 3.0);
    for (std::size_t k = 0; k < 3; ++k) add(0.5 * (corner(k) + corner(k + 1)));
  }
  const std::size_t stride = points.size() / kMostPoints + 1;
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
  return some;
}

/// How deep the points of B's surface are inside A's [m].
double depth_of_points(const TriangleMesh& a, const TriangleMesh& b, const Pose& X_AB) {
  Aabb box;
  for (const Vec3& vertex : a.vertices) box.extend(vertex);
  const std::vector<Vec3> points = points_in_box(b, X_AB, box);
  if (points.empty() || !closed(a)) return 0.0;
  DepthInside inside(a);
  double deepest = 0.0;
  for (const Vec3& point : points) deepest = std::max(deepest, inside.at(point));
  return deepest;
}

double depth_of(const Body& a, const Body& b) {
  const Pose X_AB = relative_pose(a.X_WB, b.X_WB);
  if (!a.part->is_surface() && !b.part->is_surface()) return depth_of_pieces(*a.part, *b.part, X_AB);
  const TriangleMesh& mesh_a = a.part->surface;
  const TriangleMesh& mesh_b = b.part->surface;
  return std::max(depth_of_points(mesh_a, mesh_b, X_AB), depth_of_points(mesh_b, mesh_a, X_AB.inverse()));
}

}  // namespace

Aabb box_at_start(const Body& body) {
  Aabb box;
  for (const Vec3& vertex : body.part->surface.vertices) box.extend(body.X_WB * vertex);
  return box;
}

std::vector<BodyOverlap> overlaps_at_start(const World& world, double margin_m) {
  std::vector<BodyOverlap> overlaps;
  const SweepAndPrune sweep(boxes_at_start(world));
  for (const SweepAndPrune::Pair& near : sweep.pairs()) {
    if (!could_touch(world, near.a, near.b)) continue;
    const double depth = depth_of(world.bodies[static_cast<std::size_t>(near.a)],
                                  world.bodies[static_cast<std::size_t>(near.b)]);
    if (depth > margin_m) overlaps.push_back({near.a, near.b, depth});
  }
  std::sort(overlaps.begin(), overlaps.end(), [](const BodyOverlap& x, const BodyOverlap& y) {
    if (x.depth_m != y.depth_m) return x.depth_m > y.depth_m;
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  return overlaps;
}

NearestBody nearest_at_start(const World& world, int body) {
  const Body& what = world.bodies[static_cast<std::size_t>(body)];
  const std::vector<Aabb> boxes = boxes_at_start(world);
  std::vector<NearestBody> others;
  for (int b = 0; b < static_cast<int>(world.bodies.size()); ++b)
    if (could_touch(world, body, b))
      others.push_back(
          {b, box_distance(boxes[static_cast<std::size_t>(body)], boxes[static_cast<std::size_t>(b)])});
  std::stable_sort(others.begin(), others.end(),
                   [](const NearestBody& x, const NearestBody& y) { return x.distance_m < y.distance_m; });
  NearestBody nearest;
  if (others.empty()) return nearest;
  const Surface surface(what.part->surface);
  for (const NearestBody& other : others) {
    if (other.distance_m >= nearest.distance_m) break;
    const Body& there = world.bodies[static_cast<std::size_t>(other.body)];
    SurfacePairCache cache;
    const double distance =
        surface_distance(surface, Surface(there.part->surface), relative_pose(what.X_WB, there.X_WB), cache,
                         TouchingPairs::kFirst)
            .distance;
    if (distance < nearest.distance_m) nearest = {other.body, distance};
  }
  return nearest;
}

NearestBody nearest_to(const World& world, const Vec3& p_W) {
  NearestBody nearest;
  for (int b = 0; b < static_cast<int>(world.bodies.size()); ++b) {
    const Body& body = world.bodies[static_cast<std::size_t>(b)];
    if (!body.moves()) continue;
    const double distance = box_distance(box_at_start(body), Aabb{p_W, p_W});
    if (distance < nearest.distance_m) nearest = {b, distance};
  }
  return nearest;
}

}  // namespace tactum::inline v0_1
