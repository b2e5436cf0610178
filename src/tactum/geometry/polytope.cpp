#include "tactum/geometry/polytope.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Normal by Newell's sum, which weighs every corner, and offset by the mean corner.
void set_plane(Polytope& P, Polytope::Face& face) {
  Vec3 normal = Vec3::Zero();
  Vec3 mean = Vec3::Zero();
  const Vec3 origin = P.vertices[Index(P.face_vertices[Index(face.first)])];
  for (int i = 0; i < face.count; ++i) {
    const Vec3 a = P.vertices[Index(P.face_vertices[Index(face.first + i)])] - origin;
    const Vec3 b = P.vertices[Index(P.face_vertices[Index(face.first + (i + 1) % face.count)])] - origin;
    normal += a.cross(b);
    mean += a;
  }
  face.normal = normal.normalized();
  face.offset = face.normal.dot(origin) + face.normal.dot(mean) / face.count;
}

bool build_edges(Polytope& P, const char** why) {
  std::map<std::pair<int, int>, int> edge_of;  // (tail, head) -> edge
  for (Index f = 0; f < P.faces.size(); ++f) {
    const Polytope::Face& face = P.faces[f];
    for (int i = 0; i < face.count; ++i) {
      const int slot = face.first + i;
      const int a = P.face_vertices[Index(slot)];
      const int b = P.face_vertices[Index(face.first + (i + 1) % face.count)];
      const auto twin = edge_of.find({b, a});
      if (twin != edge_of.end()) {
        Polytope::Edge& edge = P.edges[Index(twin->second)];
        if (edge.right >= 0) return *why = "an edge has more than two faces", false;
        edge.right = static_cast<int>(f);
        edge.right_slot = slot;
        continue;
      }
      Polytope::Edge edge;
      edge.tail = a;
      edge.head = b;
      edge.left = static_cast<int>(f);
      edge.left_slot = slot;
      edge.right = -1;
      const Vec3 along = P.vertices[Index(b)] - P.vertices[Index(a)];
      edge.length = along.norm();
      edge.direction = along / edge.length;
      if (!edge_of.emplace(std::pair{a, b}, static_cast<int>(P.edges.size())).second)
        return *why = "two faces run along an edge in the same direction", false;
      P.edges.push_back(edge);
    }
  }
  for (const Polytope::Edge& edge : P.edges)
    if (edge.right < 0) return *why = "an edge has only one face", false;
  return true;
}

void build_rays(Polytope& P) {
  P.ray_first.assign(P.vertices.size() + 1, 0);
  for (const Polytope::Edge& edge : P.edges) {
    ++P.ray_first[Index(edge.tail) + 1];
    ++P.ray_first[Index(edge.head) + 1];
  }
  for (Index v = 0; v < P.vertices.size(); ++v) P.ray_first[v + 1] += P.ray_first[v];
  P.rays.resize(P.edges.size() * 2);
  std::vector<int> next(P.ray_first.begin(), P.ray_first.end() - 1);
  for (Index e = 0; e < P.edges.size(); ++e) {
    const Polytope::Edge& edge = P.edges[e];
    P.rays[Index(next[Index(edge.tail)]++)] = {edge.direction, static_cast<int>(e), edge.head};
    P.rays[Index(next[Index(edge.head)]++)] = {-edge.direction, static_cast<int>(e), edge.tail};
  }
}

void build_sides(Polytope& P) {
  P.sides.resize(P.face_vertices.size());
  for (Index e = 0; e < P.edges.size(); ++e) {
    const Polytope::Edge& edge = P.edges[e];
    const Vec3& tail = P.vertices[Index(edge.tail)];
    const Polytope::Face& left = P.faces[Index(edge.left)];
    const Polytope::Face& right = P.faces[Index(edge.right)];
    const Vec3 from_left = edge.direction.cross(left.normal).normalized();
    const Vec3 from_right = -edge.direction.cross(right.normal).normalized();
    P.sides[Index(edge.left_slot)] = {from_left,  from_left.dot(tail), static_cast<int>(e),
                                      edge.right, right.first,         right.count};
    P.sides[Index(edge.right_slot)] = {from_right, from_right.dot(tail), static_cast<int>(e),
                                       edge.left,  left.first,           left.count};
  }
}

/// Whether all corners are square; of four it is enough to test three: the product measures how far normals
/// of sides are from square.
bool has_square_corners(const Polytope& P, const Polytope::Face& face) {
  if (face.count != 4) return false;
  const auto square_at = [&](int slot) {
    const Vec3& before = P.sides[Index(face.first + slot)].normal;
    const Vec3& after = P.sides[Index(face.first + slot + 1)].normal;
    return std::abs(before.dot(after)) < tolerances::kCoplanar;
  };
  return square_at(0) && square_at(1) && square_at(2);
}

/// The direction through the middle of a table cell; the inverse of cell_of.
Vec3 cell_direction(int side, int row, int column) {
  const double u = (2 * column + 1 - Polytope::kTableSide) / static_cast<double>(Polytope::kTableSide);
  const double v = (2 * row + 1 - Polytope::kTableSide) / static_cast<double>(Polytope::kTableSide);
  const int axis = side / 2;
  Vec3 direction;
  direction[axis] = side % 2 ? -1.0 : 1.0;
  direction[(axis + 1) % 3] = u;
  direction[(axis + 2) % 3] = v;
  return direction;
}

int cell_of(const Vec3& direction) noexcept {
  const Vec3 a = direction.cwiseAbs();
  int axis = a.x() >= a.y() ? 0 : 1;
  if (a.z() > a[axis]) axis = 2;
  constexpr int n = Polytope::kTableSide;
  const double scale = 0.5 * n / a[axis];
  // Clamped in this order, a value that is not a number gives a cell as well.
  const auto clamped = [](double at) { return static_cast<int>(std::min(n - 1.0, std::max(0.0, at))); };
  const int column = clamped(direction[(axis + 1) % 3] * scale + 0.5 * n);
  const int row = clamped(direction[(axis + 2) % 3] * scale + 0.5 * n);
  const int side = 2 * axis + (direction[axis] < 0.0 ? 1 : 0);
  return (side * n + row) * n + column;
}

void build_direction_table(Polytope& P) {
  int vertex = 0;  // neighbouring cells have neighbouring vertices: climb on from the last
  for (int side = 0; side < 6; ++side)
    for (int row = 0; row < Polytope::kTableSide; ++row)
      for (int column = 0; column < Polytope::kTableSide; ++column) {
        vertex = support_vertex(P, cell_direction(side, row, column), vertex);
        P.direction_table[Index((side * Polytope::kTableSide + row) * Polytope::kTableSide + column)] =
            static_cast<std::uint16_t>(vertex);
      }
}

}  // namespace

int table_vertex(const Polytope& polytope, const Vec3& direction) noexcept {
  return polytope.direction_table[Index(cell_of(direction))];
}

int uphill(const Polytope& P, const Vec3& direction, int vertex, double& height) noexcept {
  // The steepest ray is selected without a branch: at a new vertex every prediction would be a guess.
  const std::span<const Polytope::Ray> rays = P.rays_at(vertex);
  const Polytope::Ray* steepest = rays.data();
  double most = 0.0;
  for (const Polytope::Ray& ray : rays) {
    const double slope = direction.dot(ray.direction);
    steepest = slope > most ? &ray : steepest;
    most = std::max(most, slope);
  }
  if (!(most > 0.0)) return vertex;
  const double higher = direction.dot(P.vertices[Index(steepest->far)]);
  if (!(higher > height)) return vertex;  // slopes may cycle by rounding, heights cannot
  height = higher;
  return steepest->far;
}

int support_vertex(const Polytope& P, const Vec3& direction, int start) noexcept {
  double height = direction.dot(P.vertices[Index(start)]);
  for (int best = start;;) {
    const int next = uphill(P, direction, best, height);
    if (next == best) return best;
    best = next;
  }
}

bool complete_polytope(Polytope& P, const char** why) {
  P.edges.clear();
  for (Polytope::Face& face : P.faces) {
    if (face.count < 3) return *why = "a face has fewer than three corners", false;
    set_plane(P, face);
  }
  if (!build_edges(P, why)) return false;
  if (P.vertices.size() + P.faces.size() != P.edges.size() + 2)
    return *why = "the faces do not close up to a sphere (V - E + F is not 2)", false;
  build_rays(P);
  for (Index v = 0; v < P.vertices.size(); ++v)
    if (P.ray_first[v] == P.ray_first[v + 1]) return *why = "a vertex is no face's corner", false;
  build_sides(P);
  for (Polytope::Face& face : P.faces) face.rectangle = has_square_corners(P, face);
  Polytope::Extent& extent = P.extent;
  extent.center.setZero();
  for (const Vec3& vertex : P.vertices) extent.center += vertex;
  extent.center /= static_cast<double>(P.vertices.size());
  extent.radius = 0.0;
  for (const Vec3& vertex : P.vertices)
    extent.radius = std::max(extent.radius, (vertex - extent.center).norm());
  extent.size = bounds(P.vertices).diagonal();
  extent.magnitude = extent.size + extent.center.lpNorm<1>();
  P.flat = P.faces.size() == 2;
  P.counts = {static_cast<int>(P.vertices.size()), static_cast<int>(P.edges.size()),
              static_cast<int>(P.faces.size())};
  build_direction_table(P);
  return true;
}

double convexity_defect(const Polytope& polytope) noexcept {
  double defect = 0.0;
  for (const Polytope::Face& face : polytope.faces)
    for (const Vec3& vertex : polytope.vertices)
      defect = std::max(defect, face.normal.dot(vertex) - face.offset);
  return defect;
}

}  // namespace tactum::inline v0_1
