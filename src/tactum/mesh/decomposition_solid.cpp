#include "tactum/mesh/decomposition_solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/coplanar_groups.h"
#include "tactum/geometry/mesh_edges.h"

namespace tactum::inline v0_1::detail {
namespace {

/// A side with its face, under the name of its edge.
struct NamedSide {
  int low = 0, high = 0, face = 0;
  bool forward = false;
};

std::vector<NamedSide> named_sides(const Solid& solid) {
  std::vector<NamedSide> named;
  for (std::size_t f = 0; f < solid.size(); ++f)
    for (const SolidSide& side : solid[f].sides)
      named.push_back(
          {std::min(side[0], side[1]), std::max(side[0], side[1]), static_cast<int>(f), side[0] < side[1]});
  std::sort(named.begin(), named.end(), [](const NamedSide& a, const NamedSide& b) {
    return std::tie(a.low, a.high, a.forward, a.face) < std::tie(b.low, b.high, b.forward, b.face);
  });
  return named;
}

/// Through the solid from `left`, which runs along `along`, to `right`, which runs against it.
double wedge_between(const SolidFace& left, const SolidFace& right, const Vec3& along) {
  const Vec3 from = left.normal.cross(along);
  const Vec3 to = along.cross(right.normal);
  const double angle = std::atan2(-left.normal.dot(to), from.dot(to));
  return angle < 0.0 ? angle + 2.0 * kPi : angle;
}

/// Triangles lower than the noise have no plane of their own: they join the face beyond their longest side.
void give_slivers_away(const TriangleMesh& mesh, double noise, std::vector<int>& groups) {
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  std::vector<std::array<int, 3>> across(mesh.triangles.size(), {-1, -1, -1});
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return;
    across[first[0].triangle][first[0].corner] = first[1].triangle;
    across[first[1].triangle][first[1].corner] = first[0].triangle;
  });
  std::vector<int> longest(mesh.triangles.size(), -1);  // of slivers: the neighbour
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    int corner = 0;
    double most = 0.0;
    for (int k = 0; k < 3; ++k)
      if (const double length = (mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]]).norm(); length > most) {
        most = length;
        corner = k;
      }
    const double area =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
    if (area < noise * most) longest[i] = across[i][corner];
  }
  for (std::size_t i = 0; i < longest.size(); ++i) {
    int at = static_cast<int>(i);
    for (std::size_t step = 0; step < longest.size() && longest[at] >= 0; ++step) {
      if (longest[longest[at]] == at) break;  // two slivers back to back
      at = longest[at];
    }
    groups[i] = groups[at];
  }
}

struct Loop {
  std::vector<int> corners;
  double area = 0.0;  ///< negative: a hole
};

/// A face's own plane, for loops.
struct Flat {
  Vec3 u, v;
  explicit Flat(const Vec3& n) : u(any_orthogonal(n)), v(n.cross(u)) {}
  Vec2 operator()(const Vec3& p) const { return {u.dot(p), v.dot(p)}; }
};

/// Of the sides that leave, the one that turns most to the left: it bounds the same patch of the face.
std::size_t leftmost(const std::vector<Vec3>& corners, const Flat& flat, int from, int at,
                     const std::vector<int>& leaving) {
  const Vec2 back = flat(corners[from] - corners[at]);
  std::size_t best = 0;
  double least = 3.0 * kPi;
  for (std::size_t i = 0; i < leaving.size(); ++i) {
    const Vec2 out = flat(corners[leaving[i]] - corners[at]);
    double wedge = std::atan2(out.x() * back.y() - out.y() * back.x(), out.dot(back));
    if (wedge <= 0.0) wedge += 2.0 * kPi;
    if (wedge < least) {
      least = wedge;
      best = i;
    }
  }
  return best;
}

/// The closed walks along the sides of a face; false when one does not close.
bool trace_loops(const std::vector<Vec3>& corners, const SolidFace& face, std::vector<Loop>& loops) {
  const Flat flat(face.normal);
  std::map<int, std::vector<int>> leaving;
  for (const SolidSide& side : face.sides) leaving[side[0]].push_back(side[1]);
  const auto walk = [&](int start) {
    Loop loop;
    int from = start;
    int at = leaving[start].back();
    leaving[start].pop_back();
    loop.corners.push_back(start);
    while (at != start) {
      std::vector<int>& out = leaving[at];
      if (out.empty()) return false;
      const std::size_t chosen = leftmost(corners, flat, from, at, out);
      loop.corners.push_back(at);
      from = at;
      at = out[chosen];
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    for (std::size_t i = 0; i < loop.corners.size(); ++i) {
      const Vec2 p = flat(corners[loop.corners[i]] - corners[start]);
      const Vec2 q = flat(corners[loop.corners[(i + 1) % loop.corners.size()]] - corners[start]);
      loop.area += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    loops.push_back(std::move(loop));
    return true;
  };
  // Where outlines touch, a walk must pass, not start.
  std::vector<int> starts;
  for (const SolidSide& side : face.sides)
    if (leaving[side[0]].size() == 1) starts.push_back(side[0]);
  for (const SolidSide& side : face.sides) starts.push_back(side[0]);
  for (int start : starts)
    if (!leaving[start].empty() && !walk(start)) return false;
  return true;
}

bool encloses(const std::vector<Vec3>& corners, const Flat& flat, const Loop& outline, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.corners.size(); ++i) {
    const Vec2 a = flat(corners[outline.corners[i]]);
    const Vec2 b = flat(corners[outline.corners[(i + 1) % outline.corners.size()]]);
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

/// Appends the face as faces of one outline each, holes with the smallest outline around them.
bool append_patches(const std::vector<Vec3>& corners, const SolidFace& face, Solid& out) {
  std::vector<Loop> loops;
  if (!trace_loops(corners, face, loops)) return false;
  const auto add = [](SolidFace& patch, const Loop& loop) {
    for (std::size_t i = 0; i < loop.corners.size(); ++i)
      patch.sides.push_back({loop.corners[i], loop.corners[(i + 1) % loop.corners.size()]});
  };
  const Flat flat(face.normal);
  const std::size_t first = out.size();
  std::vector<const Loop*> outline;
  for (const Loop& loop : loops) {
    if (loop.area <= 0.0) continue;
    out.push_back({face.normal, face.offset, face.error_bound, {}});
    add(out.back(), loop);
    outline.push_back(&loop);
  }
  for (const Loop& loop : loops) {
    if (loop.area > 0.0) continue;
    const Vec2 inside = flat(0.5 * (corners[loop.corners[0]] + corners[loop.corners[1]]));
    std::size_t owner = outline.size();
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (!encloses(corners, flat, *outline[i], inside)) continue;
      if (owner == outline.size() || outline[i]->area < outline[owner]->area) owner = i;
    }
    if (owner == outline.size()) {
      if (outline.empty()) return false;
      owner = 0;  // a hole along the outline, by rounding outside it
    }
    add(out[first + owner], loop);
  }
  return true;
}

/// Whether the faces wind round p: the solid angle they fill [Oosterom and Strackee 1983].
bool inside(const std::vector<Vec3>& corners, const Solid& solid, const Vec3& p) {
  double halves = 0.0;
  for (const SolidFace& face : solid) {
    const Vec3 a = corners[face.sides[0][0]] - p;
    for (const SolidSide& side : face.sides) {
      const Vec3 b = corners[side[0]] - p;
      const Vec3 c = corners[side[1]] - p;
      const double beside =
          a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() + c.dot(a) * b.norm();
      halves += std::atan2(a.dot(b.cross(c)), beside);
    }
  }
  return halves > kPi;
}

}  // namespace

std::string place(const Vec3& p) { return fmt::format("({:.6g} {:.6g} {:.6g})", p.x(), p.y(), p.z()); }

Result<Solid> solid_of_mesh(const TriangleMesh& mesh, double noise) {
  std::vector<int> groups = coplanar_groups(mesh);
  give_slivers_away(mesh, noise, groups);
  Solid solid(groups.empty() ? 0
                             : 1 + static_cast<std::size_t>(*std::max_element(groups.begin(), groups.end())));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3& a = mesh.vertices[t[0]];
    solid[groups[i]].normal += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
  }
  std::string open;
  for_each_edge(sorted_half_edges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2 || first[0].forward == first[1].forward) {
      open = place(mesh.vertices[first->low]);
      return;
    }
    const int a = groups[first[0].triangle];
    const int b = groups[first[1].triangle];
    if (a == b) return;
    for (const HalfEdge* side : {first, first + 1})
      solid[groups[side->triangle]].sides.push_back(side->forward ? SolidSide{side->low, side->high}
                                                                  : SolidSide{side->high, side->low});
  });
  if (!open.empty()) return Error{"the surface bounds no solid", "an open edge at " + open, "none", ""};
  std::erase_if(solid, [](const SolidFace& face) { return face.sides.empty(); });
  for (SolidFace& face : solid) {
    const double twice_area = face.normal.norm();
    face.normal /= twice_area;
    double longest = 0.0;
    for (const SolidSide& side : face.sides) {
      face.offset += face.normal.dot(mesh.vertices[side[0]]);
      longest = std::max(longest, (mesh.vertices[side[0]] - mesh.vertices[face.sides[0][0]]).norm());
    }
    face.error_bound = std::max(tolerances::kCoplanarMeshSine, noise * longest / twice_area);
    face.offset /= static_cast<double>(face.sides.size());
  }
  const Result<std::vector<SolidEdge>> edges = edges_of(mesh.vertices, solid);
  if (!edges) return edges.error();
  for (const SolidEdge& edge : *edges)
    if (edge.wedge < tolerances::kCoplanarMeshSine || edge.wedge > 2.0 * kPi - tolerances::kCoplanarMeshSine)
      return Error{"the surface bounds no solid",
                   "two faces folded onto each other at " + place(mesh.vertices[edge.tail]),
                   "some thickness everywhere", ""};
  return solid;
}

Result<std::vector<SolidEdge>> edges_of(const std::vector<Vec3>& corners, const Solid& solid) {
  const std::vector<NamedSide> sides = named_sides(solid);
  std::vector<SolidEdge> edges;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first;
    while (last < sides.size() && sides[last].low == sides[first].low &&
           sides[last].high == sides[first].high)
      ++last;
    const std::size_t half = (last - first) / 2;  // backward sides stand first
    const bool even = (last - first) % 2 == 0 && !sides[first + half - (half > 0 ? 1 : 0)].forward &&
                      sides[first + half].forward;
    if (!even)
      return Error{"the surface bounds no solid",
                   fmt::format("an edge without partner at {}", place(corners[sides[first].low])),
                   "two faces at every edge", ""};
    const Vec3 along = (corners[sides[first].high] - corners[sides[first].low]).normalized();
    for (std::size_t f = first + half; f < last; ++f) {
      SolidEdge edge{sides[f].low, sides[f].high, sides[f].face, -1, 9.0 * kPi, false};
      for (std::size_t b = first; b < first + half; ++b) {
        double wedge = wedge_between(solid[edge.left], solid[sides[b].face], along);
        if (half > 1 && wedge < tolerances::kCoplanarMeshSine) wedge += 2.0 * kPi;
        if (wedge >= edge.wedge) continue;
        edge.wedge = wedge;
        edge.right = sides[b].face;
      }
      edge.reflex = edge.wedge > kPi + solid[edge.left].error_bound + solid[edge.right].error_bound;
      edges.push_back(edge);
    }
    first = last;
  }
  return edges;
}

Result<std::vector<Solid>> bodies_of(const std::vector<Vec3>& corners, const Solid& solid) {
  Solid patches;
  for (const SolidFace& face : solid)
    if (!append_patches(corners, face, patches))
      return Error{"a cut went wrong",
                   "an outline that does not close at " + place(corners[face.sides[0][0]]),
                   "a surface that does not cross itself", ""};
  const Result<std::vector<SolidEdge>> edges = edges_of(corners, patches);
  if (!edges) return edges.error();
  DisjointSets sets(static_cast<int>(patches.size()));
  for (const SolidEdge& edge : *edges) sets.join(edge.left, edge.right);
  std::map<int, Solid> by_root;
  for (std::size_t i = 0; i < patches.size(); ++i)
    by_root[sets.find(static_cast<int>(i))].push_back(std::move(patches[i]));
  std::vector<Solid> bodies;
  std::vector<Solid> hollows;
  for (auto& [root, body] : by_root)
    (volume_of(corners, body) > 0.0 ? bodies : hollows).push_back(std::move(body));
  for (Solid& hollow : hollows) {
    Solid* around = nullptr;
    for (Solid& body : bodies) {
      if (!inside(corners, body, corners[hollow[0].sides[0][0]])) continue;
      if (around == nullptr || volume_of(corners, body) < volume_of(corners, *around)) around = &body;
    }
    if (around == nullptr)
      return Error{"the surface bounds no solid",
                   "a hollow outside of every body at " + place(corners[hollow[0].sides[0][0]]),
                   "normals that point outward", ""};
    std::move(hollow.begin(), hollow.end(), std::back_inserter(*around));
  }
  return bodies;
}

double volume_of(const std::vector<Vec3>& corners, const Solid& solid) {
  const Vec3 origin = corners[solid[0].sides[0][0]];
  double six = 0.0;
  for (const SolidFace& face : solid) {
    const Vec3 apex = corners[face.sides[0][0]] - origin;
    for (const SolidSide& side : face.sides)
      six += apex.dot((corners[side[0]] - origin).cross(corners[side[1]] - origin));
  }
  return six / 6.0;
}

double area_of(const std::vector<Vec3>& corners, const Solid& solid) {
  double twice = 0.0;
  for (const SolidFace& face : solid) {
    const Vec3& apex = corners[face.sides[0][0]];
    Vec3 sum = Vec3::Zero();
    for (const SolidSide& side : face.sides) sum += (corners[side[0]] - apex).cross(corners[side[1]] - apex);
    twice += sum.dot(face.normal);
  }
  return 0.5 * twice;
}

std::vector<int> corners_of(const Solid& solid) {
  std::vector<int> corners;
  for (const SolidFace& face : solid)
    for (const SolidSide& side : face.sides) corners.push_back(side[0]);
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace tactum::inline v0_1::detail
