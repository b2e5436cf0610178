#include "viewer/server/shape_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "tactum/geometry/mesh_edges.h"

namespace tactum {
namespace {

constexpr double kAside = 0.001;     // of the part's size: how far beyond a face points are tested
constexpr double kSamePlace = 1e-9;  // of the part's size

bool contains(const Polytope& piece, const Vec3& point) {
  return std::all_of(piece.faces.begin(), piece.faces.end(),
                     [&](const Polytope::Face& face) { return face.normal.dot(point) < face.offset; });
}

/// Whether another piece than `own` fills the place.
bool filled_by_another(const Part& part, const std::vector<Aabb>& boxes, std::size_t own, const Vec3& point) {
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    if (i == own || (point.array() < boxes[i].min.array()).any() ||
        (point.array() > boxes[i].max.array()).any())
      continue;
    if (contains(part.pieces[i], point)) return true;
  }
  return false;
}

std::vector<Aabb> boxes_of(const Part& part) {
  std::vector<Aabb> boxes;
  for (const Polytope& piece : part.pieces) boxes.push_back(bounds(piece.vertices));
  return boxes;
}

/// The pieces whose boxes come as near to the box of an edge as that.
std::vector<const Polytope*> pieces_near(const Part& part, const std::vector<Aabb>& boxes, const Aabb& edge,
                                         double distance) {
  std::vector<const Polytope*> near;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if ((edge.max.array() > boxes[i].min.array() - distance).all() &&
        (edge.min.array() < boxes[i].max.array() + distance).all())
      near.push_back(&part.pieces[i]);
  return near;
}

/// Where along the edge, from 0 at its tail to 1 at its head, a piece begins or ends: what fills the turn
/// about the edge is the same between two of these.
std::vector<double> changes_along(const std::vector<const Polytope*>& pieces, const Vec3& tail,
                                  const Vec3& head, double aside) {
  const Vec3 along = head - tail;
  std::vector<double> changes{0.0, 1.0};
  for (const Polytope* piece : pieces) {
    double from = 0.0, to = 1.0;
    for (const Polytope::Face& face : piece->faces) {
      const double rise = face.normal.dot(along);
      const double room = face.offset + aside - face.normal.dot(tail);
      if (std::abs(rise) < aside) {  // the edge lies along the face
        if (room < 0.0) to = -1.0;
        continue;
      }
      // Where the edge meets the face itself, not the one `aside` of it.
      const double at = (room - aside) / rise;
      (rise > 0.0 ? to : from) = rise > 0.0 ? std::min(to, at) : std::max(from, at);
    }
    if (from < to) changes.insert(changes.end(), {from, to});
  }
  std::sort(changes.begin(), changes.end());
  const double least = std::min(0.5, 2.0 * aside / along.norm());  // shorter parts are not judged
  const auto same = [least](double a, double b) { return b - a < least; };
  changes.erase(std::unique(changes.begin(), changes.end(), same), changes.end());
  changes.back() = 1.0;
  return changes;
}

/// Which part of the turn about an edge the pieces fill, `aside` from it [rad]: for a box's edge a right
/// angle. `u` and `w` span the plane square to the edge.
double filled_turn(const std::vector<const Polytope*>& pieces, const Vec3& middle, const Vec3& u,
                   const Vec3& w, double aside) {
  constexpr int kDirections = 64;
  int filled = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * kPi * (k + 0.5) / kDirections;
    const Vec3 point = middle + aside * (std::cos(angle) * u + std::sin(angle) * w);
    filled += std::any_of(pieces.begin(), pieces.end(),
                          [&](const Polytope* piece) { return contains(*piece, point); })
                  ? 1
                  : 0;
  }
  return 2.0 * kPi * filled / kDirections;
}

/// The parts of an edge about which the pieces fill less or more than half a turn; neighbours of one kind are
/// one. `across` is square to the edge.
std::vector<DrawnEdge> bends_of(const std::vector<const Polytope*>& pieces, const Vec3& tail,
                                const Vec3& head, const Vec3& across, double aside) {
  const Vec3 along = head - tail;
  const Vec3 up = across.cross(along.normalized());
  const std::vector<double> changes = changes_along(pieces, tail, head, aside);
  std::vector<DrawnEdge> bends;
  double end = -1.0;  // of the last one
  for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
    const Vec3 middle = tail + 0.5 * (changes[i] + changes[i + 1]) * along;
    const double filled = filled_turn(pieces, middle, across, up, aside);
    const bool sharp = filled < kPi - kDrawnBend_rad;
    if (!sharp && (filled <= kPi + kDrawnBend_rad || filled >= 2.0 * kPi - kDrawnBend_rad)) continue;
    const EdgeKind kind = sharp ? EdgeKind::kSharp : EdgeKind::kReflex;
    const Vec3 head_here = tail + changes[i + 1] * along;
    if (end == changes[i] && bends.back().kind == kind)
      bends.back().head = head_here;
    else
      bends.push_back({tail + changes[i] * along, head_here, kind});
    end = changes[i + 1];
  }
  return bends;
}

bool same_edge(const DrawnEdge& p, const DrawnEdge& q, double noise) {
  const auto ends = [&](const Vec3& a, const Vec3& b) {
    return (p.tail - a).norm() < noise && (p.head - b).norm() < noise;
  };
  return ends(q.tail, q.head) || ends(q.head, q.tail);
}

std::vector<DrawnEdge> edges_of_solids(const Part& part) {
  const std::vector<Aabb> boxes = boxes_of(part);
  const double size = bounds(part.surface.vertices).diagonal();
  const double aside = kAside * size;
  const double flattest = std::cos(kDrawnBend_rad);
  std::vector<DrawnEdge> edges, reflex;
  for (const Polytope& piece : part.pieces) {
    for (const Polytope::Edge& edge : piece.edges) {
      const Vec3& left = piece.faces[static_cast<std::size_t>(edge.left)].normal;
      const Vec3& right = piece.faces[static_cast<std::size_t>(edge.right)].normal;
      if (left.dot(right) > flattest) continue;
      const Vec3& tail = piece.vertices[static_cast<std::size_t>(edge.tail)];
      const Vec3& head = piece.vertices[static_cast<std::size_t>(edge.head)];
      for (const DrawnEdge& drawn :
           bends_of(pieces_near(part, boxes, Aabb{tail.cwiseMin(head), tail.cwiseMax(head)}, aside), tail,
                    head, (left - right).normalized(), aside)) {
        // The pieces on either side of a reflex edge may both have it.
        const bool known = drawn.kind == EdgeKind::kReflex &&
                           std::any_of(reflex.begin(), reflex.end(), [&](const DrawnEdge& other) {
                             return same_edge(drawn, other, kSamePlace * size);
                           });
        if (!known) (drawn.kind == EdgeKind::kReflex ? reflex : edges).push_back(drawn);
      }
    }
  }
  edges.insert(edges.end(), reflex.begin(), reflex.end());
  return edges;
}

/// The places of an edge's ends, whichever is the tail.
std::array<double, 6> place_of(const Vec3& tail, const Vec3& head) {
  const std::array<double, 3> a{tail.x(), tail.y(), tail.z()}, b{head.x(), head.y(), head.z()};
  const auto& [low, high] = std::minmax(a, b);
  return {low[0], low[1], low[2], high[0], high[1], high[2]};
}

/// The backs of open surfaces stand behind their fronts and have the same edges (repair/two_sided.h): of two
/// at one place the first is drawn.
std::vector<DrawnEdge> edges_of_surface(const Part& part) {
  const TriangleMesh& mesh = part.surface;
  std::set<std::array<double, 6>> drawn;
  const auto normal = [&](int triangle) { return triangle_normal(mesh, static_cast<std::size_t>(triangle)); };
  const double flattest = std::cos(kDrawnBend_rad);
  std::vector<DrawnEdge> edges;
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    const Vec3& tail = mesh.vertices[static_cast<std::size_t>(first->low)];
    const Vec3& head = mesh.vertices[static_cast<std::size_t>(first->high)];
    if (last - first != 2) {
      if (!drawn.insert(place_of(tail, head)).second) return;
      edges.push_back({tail, head, last - first == 1 ? EdgeKind::kOpen : EdgeKind::kCrowded});
      return;
    }
    const Vec3 here = normal(first[0].triangle);
    if (here.dot(normal(first[1].triangle)) > flattest || !drawn.insert(place_of(tail, head)).second) return;
    const Triangle& beyond = mesh.triangles[static_cast<std::size_t>(first[1].triangle)];
    const Vec3& far = mesh.vertices[static_cast<std::size_t>(beyond[(first[1].corner + 2) % 3])];
    edges.push_back({tail, head, here.dot(far - tail) > 0.0 ? EdgeKind::kReflex : EdgeKind::kSharp});
  });
  return edges;
}

}  // namespace

std::vector<DrawnEdge> edges_to_draw(const Part& part) {
  if (part.surface.triangles.size() > kMostDrawn) return {};
  return part.is_surface() ? edges_of_surface(part) : edges_of_solids(part);
}

std::vector<bool> covered_triangles(const Part& part) {
  std::vector<bool> covered;
  if (part.pieces.size() < 2 || part.surface.triangles.size() > kMostDrawn) {
    covered.resize(part.surface.triangles.size(), false);
    return covered;
  }
  constexpr double kTowardsCorner = 0.9;
  const std::vector<Aabb> boxes = boxes_of(part);
  const double aside = kAside * bounds(part.surface.vertices).diagonal();
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& piece = part.pieces[i];
    for (const Polytope::Face& face : piece.faces) {
      const int* loop = piece.face_vertices.data() + face.first;
      const auto corner = [&](int k) { return piece.vertices[static_cast<std::size_t>(loop[k])]; };
      for (int t = 1; t + 1 < face.count; ++t) {
        const Vec3 middle = (corner(0) + corner(t) + corner(t + 1)) / 3.0;
        bool all = true;
        for (const Vec3& towards : {middle, corner(0), corner(t), corner(t + 1)}) {
          const Vec3 point = middle + kTowardsCorner * (towards - middle) + aside * face.normal;
          all = all && filled_by_another(part, boxes, i, point);
        }
        covered.push_back(all);
      }
    }
  }
  return covered;
}

}  // namespace tactum
