#include "tactum/geometry/hull.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <numeric>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/bvh.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

struct Hull {
  std::vector<Triangle> triangles;  // indices into the points, counter-clockwise from outside
};

/// The part of Qhull's state that must be freed however we leave.
struct QhullSession {
  qhT state{};
  std::FILE* log = nullptr;
  QhullSession() {
    log = std::tmpfile();
    qh_zero(&state, log);
  }
  ~QhullSession() {
    qh_freeqhull(&state, !qh_ALL);
    int left = 0;
    int total = 0;
    qh_memfreeshort(&state, &left, &total);
    if (log) std::fclose(log);
  }
  QhullSession(const QhullSession&) = delete;
  QhullSession& operator=(const QhullSession&) = delete;

  std::string first_line() const {
    if (!log) return "no message";
    std::rewind(log);
    char text[200] = "no message";
    if (!std::fgets(text, sizeof text, log)) return "no message";
    std::string line(text);
    while (!line.empty() && line.back() == '\n') line.pop_back();
    return line;
  }
};

Result<Hull> triangulated_hull(const std::vector<Vec3>& points) {
  std::vector<coordT> coordinates;
  coordinates.reserve(points.size() * 3);
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  QhullSession session;
  qhT* qh = &session.state;
  char options[] = "qhull Qt";
  const int status = qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options,
                                  nullptr, session.log);
  if (status != 0)
    return Error{"the convex hull failed", session.first_line(), "points that span a volume", ""};

  Hull hull;
  for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next) {
    Triangle corners{};
    int count = 0;
    for (void** item = &facet->vertices->e[0].p; *item; ++item) {
      const auto* vertex = static_cast<const vertexT*>(*item);
      if (count < 3) corners[Index(count)] = qh_pointid(qh, vertex->point);
      ++count;
    }
    if (count != 3) return Error{"the convex hull failed", "a facet that is no triangle", "triangles", ""};
    if (facet->toporient ^ qh_ORIENTclock) std::swap(corners[1], corners[2]);
    hull.triangles.push_back(corners);
  }
  return hull;
}

struct FacetPlane {
  Vec3 normal = Vec3::Zero();
  double offset = 0.0;
  double area = 0.0;
};

FacetPlane plane_of(const std::vector<Vec3>& points, const Triangle& t) {
  const Vec3& a = points[Index(t[0])];
  const Vec3 cross = (points[Index(t[1])] - a).cross(points[Index(t[2])] - a);
  const double length = cross.norm();
  if (length == 0.0) return {};
  return {cross / length, cross.dot(a) / length, 0.5 * length};
}

/// Groups triangles into planar facets, grown from the largest triangle left over the neighbours whose
/// corners all lie in the first one's plane, so that error cannot creep along a chain of slightly bent
/// neighbours.
std::vector<int> facet_of_triangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                    double height) {
  std::map<std::pair<int, int>, int> triangle_at;
  for (Index t = 0; t < triangles.size(); ++t)
    for (Index i = 0; i < 3; ++i)
      triangle_at[{triangles[t][i], triangles[t][(i + 1) % 3]}] = static_cast<int>(t);

  std::vector<FacetPlane> planes;
  for (const Triangle& t : triangles) planes.push_back(plane_of(points, t));
  std::vector<int> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return planes[Index(a)].area > planes[Index(b)].area; });

  std::vector<int> facet(triangles.size(), -1);
  int facets = 0;
  std::vector<int> stack;
  for (int seed : order) {
    if (facet[Index(seed)] >= 0) continue;
    const FacetPlane& plane = planes[Index(seed)];
    facet[Index(seed)] = facets;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const Triangle& t = triangles[Index(stack.back())];
      stack.pop_back();
      for (Index i = 0; i < 3; ++i) {
        const auto twin = triangle_at.find({t[(i + 1) % 3], t[i]});
        if (twin == triangle_at.end() || facet[Index(twin->second)] >= 0) continue;
        const Triangle& next = triangles[Index(twin->second)];
        const bool planar = std::all_of(next.begin(), next.end(), [&](int v) {
          return std::abs(plane.normal.dot(points[Index(v)]) - plane.offset) <= height;
        });
        if (!planar) continue;
        facet[Index(twin->second)] = facets;
        stack.push_back(twin->second);
      }
    }
    ++facets;
  }
  return facet;
}

/// The outline of each facet as a loop of corners. Empty when an outline is not one loop.
std::vector<std::vector<int>> facet_loops(const std::vector<Triangle>& triangles,
                                          const std::vector<int>& facet) {
  std::map<std::pair<int, int>, int> facet_at;  // directed edge -> facet
  for (Index t = 0; t < triangles.size(); ++t)
    for (Index i = 0; i < 3; ++i) facet_at[{triangles[t][i], triangles[t][(i + 1) % 3]}] = facet[t];

  const int facets = 1 + *std::max_element(facet.begin(), facet.end());
  std::vector<std::map<int, int>> next(static_cast<Index>(facets));  // per facet: corner -> following corner
  for (const auto& [edge, f] : facet_at) {
    const auto twin = facet_at.find({edge.second, edge.first});
    if (twin != facet_at.end() && twin->second == f) continue;  // inside the facet
    if (!next[Index(f)].emplace(edge.first, edge.second).second) return {};
  }
  std::vector<std::vector<int>> loops;
  for (const auto& successor : next) {
    std::vector<int> loop;
    const int start = successor.begin()->first;
    for (int v = start;;) {
      loop.push_back(v);
      const auto step = successor.find(v);
      if (step == successor.end() || loop.size() > successor.size()) return {};
      v = step->second;
      if (v == start) break;
    }
    if (loop.size() != successor.size()) return {};
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Facets that lie together side by side: a walk over features of a large hull then stays in a few lines and
/// pages of memory. Vertices and edges are numbered by the facets, so they follow. Smaller hulls are in the
/// cache anyway.
std::vector<std::vector<int>> side_by_side(const std::vector<Vec3>& points,
                                           std::vector<std::vector<int>> loops) {
  constexpr Index kManyFacets = 1000;
  if (loops.size() < kManyFacets) return loops;
  std::vector<Aabb> boxes;
  for (const auto& loop : loops) {
    Aabb& box = boxes.emplace_back();
    for (int v : loop) box.extend(points[Index(v)]);
  }
  std::vector<std::vector<int>> sorted;
  const Bvh tree(boxes);
  for (std::int32_t facet : tree.order()) sorted.push_back(std::move(loops[Index(facet)]));
  return sorted;
}

/// Removes corners met by only two facets (the middle of a straight edge), then renumbers what is left.
Polytope without_false_corners(const std::vector<Vec3>& points, std::vector<std::vector<int>> loops) {
  std::map<int, int> uses;
  for (const auto& loop : loops)
    for (int v : loop) ++uses[v];
  Polytope P;
  std::map<int, int> number;
  for (auto& loop : loops) {
    if (loops.size() > 2) std::erase_if(loop, [&](int v) { return uses[v] < 3; });
    if (loop.empty()) continue;
    Polytope::Face face;
    face.first = static_cast<int>(P.face_vertices.size());
    face.count = static_cast<int>(loop.size());
    for (int v : loop) {
      const auto [at, fresh] = number.emplace(v, static_cast<int>(P.vertices.size()));
      if (fresh) P.vertices.push_back(points[Index(v)]);
      P.face_vertices.push_back(at->second);
    }
    P.faces.push_back(face);
  }
  return P;
}

struct Frame {
  Vec3 origin, x, y, normal;
  int rank = 0;  // 0 point, 1 line, 2 plane, 3 volume
};

/// The plane through the farthest points, and how many dimensions they span (heights below `height` are
/// zero).
Frame principal_frame(const std::vector<Vec3>& points, double height) {
  const auto farthest = [&](const auto& measure) {
    return *std::max_element(points.begin(), points.end(),
                             [&](const Vec3& a, const Vec3& b) { return measure(a) < measure(b); });
  };
  Frame frame;
  const Vec3 first = points.front();
  frame.origin = farthest([&](const Vec3& p) { return (p - first).squaredNorm(); });
  const Vec3 far = farthest([&](const Vec3& p) { return (p - frame.origin).squaredNorm(); }) - frame.origin;
  if (far.norm() <= height) return frame;
  frame.rank = 1;
  frame.x = far.normalized();
  const auto off_line = [&](const Vec3& p) -> Vec3 {
    const Vec3 r = p - frame.origin;
    return r - frame.x * frame.x.dot(r);
  };
  const Vec3 side = off_line(farthest([&](const Vec3& p) { return off_line(p).squaredNorm(); }));
  if (side.norm() <= height) return frame;
  frame.rank = 2;
  frame.normal = frame.x.cross(side).normalized();
  frame.y = frame.normal.cross(frame.x);
  const auto off_plane = [&](const Vec3& p) { return std::abs(frame.normal.dot(p - frame.origin)); };
  if (off_plane(farthest(off_plane)) > height) frame.rank = 3;
  return frame;
}

/// Corners of the planar hull, counter-clockwise about frame.normal, by Andrew's two chains.
std::vector<Vec3> planar_hull(const std::vector<Vec3>& points, const Frame& frame, double height) {
  struct Flat {
    double x, y;
    int index;
  };
  std::vector<Flat> flat;
  for (Index i = 0; i < points.size(); ++i) {
    const Vec3 r = points[i] - frame.origin;
    flat.push_back({frame.x.dot(r), frame.y.dot(r), static_cast<int>(i)});
  }
  std::sort(flat.begin(), flat.end(), [](const Flat& a, const Flat& b) {
    return a.x != b.x ? a.x < b.x : (a.y != b.y ? a.y < b.y : a.index < b.index);
  });
  std::vector<Flat> chain;
  const auto extend = [&](const Flat& p, Index keep) {
    while (chain.size() >= keep + 2) {
      const Flat& a = chain[chain.size() - 2];
      const Flat& b = chain.back();
      const double turn = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
      if (turn > height * std::hypot(p.x - a.x, p.y - a.y)) break;
      chain.pop_back();
    }
    chain.push_back(p);
  };
  for (const Flat& p : flat) extend(p, 0);
  const Index lower = chain.size() - 1;
  for (auto p = flat.rbegin() + 1; p != flat.rend(); ++p) extend(*p, lower);
  chain.pop_back();
  std::vector<Vec3> corners;
  for (const Flat& p : chain) corners.push_back(points[Index(p.index)]);
  return corners;
}

}  // namespace

Result<Polytope> flat_polygon(const std::vector<Vec3>& corners) {
  const int n = static_cast<int>(corners.size());
  if (n < 3) return Error{"a flat piece needs corners", fmt::format("{}", n), "at least 3", ""};
  Polytope P;
  P.vertices = corners;
  P.faces = {{.first = 0, .count = n}, {.first = n, .count = n}};
  for (int i = 0; i < n; ++i) P.face_vertices.push_back(i);
  for (int i = n - 1; i >= 0; --i) P.face_vertices.push_back(i);
  const char* why = nullptr;
  if (!complete_polytope(P, &why)) return Error{"the flat piece is not a polygon", why, "a simple loop", ""};
  if (!P.faces[0].normal.allFinite() || P.faces[0].normal.isZero())
    return Error{"the flat piece has no area", "corners on one line", "corners that span a plane", ""};
  P.faces[1].normal = -P.faces[0].normal;  // one plane, exactly
  P.faces[1].offset = -P.faces[0].offset;
  return P;
}

Result<Polytope> convex_hull(const std::vector<Vec3>& points) {
  for (Index i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      return Error{"a point of the hull is not finite", fmt::format("point {}", i), "finite coordinates", ""};
  if (points.size() < 3)
    return Error{"too few points for a hull", fmt::format("{}", points.size()), "at least 3", ""};
  const double height = bounds(points).diagonal() * tolerances::kCoplanar;
  const Frame frame = principal_frame(points, height);
  if (frame.rank < 2)
    return Error{"the points have no hull",
                 frame.rank == 0 ? "points all in one place" : "points all on one line",
                 "points that span a plane or a volume", ""};
  if (frame.rank == 2) return flat_polygon(planar_hull(points, frame, height));

  const Result<Hull> hull = triangulated_hull(points);
  if (!hull) return hull.error();
  auto loops = facet_loops(hull->triangles, facet_of_triangles(points, hull->triangles, height));
  if (loops.empty()) return Error{"the convex hull failed", "a facet whose outline is not one loop", "", ""};
  Polytope P = without_false_corners(points, side_by_side(points, std::move(loops)));
  if (P.vertices.size() > 65535)
    return Error{"the hull has too many vertices", fmt::format("{}", P.vertices.size()), "at most 65535", ""};
  const char* why = nullptr;
  if (!complete_polytope(P, &why)) return Error{"the convex hull failed", why, "a closed convex surface", ""};
  return P;
}

}  // namespace tactum::inline v0_1
