#include "oracles/minima_referee.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "tactum/geometry/coplanar_groups.h"

namespace tactum::oracles {
namespace {

struct Edge {
  int v = 0, w = 0;
  /// Unit directions in the plane square to the edge between which its cone lies, and the angle from the
  /// first.
  Vec3 from, side;
  double width = 0.0;
};

constexpr double kThin = 1e-5;  // [rad]

struct Corner {
  int v = 0;
  std::vector<Vec3> edges;  ///< unit; they must fall away
  std::vector<Vec3> rays;   ///< unit; the extreme directions from which all edges fall away
  Vec3 outward;             ///< unit
  /// So thin a cone is that of a vertex in the middle of an edge that is straight but for rounding: either
  /// answer about it is right.
  bool thin = false;
};

struct Face {
  std::array<int, 3> v{};
  Vec3 normal;
};

double angle(const Vec3& x, const Vec3& y) { return std::atan2(x.cross(y).norm(), x.dot(y)); }

/// The mesh in A's frame with all its features.
class Features {
 public:
  Features(const TriangleMesh& mesh, const Pose& X) {
    for (const Vec3& p : mesh.vertices) points.push_back(X * p);
    const std::vector<int> group = coplanar_groups(mesh);
    std::map<std::pair<int, int>, std::vector<std::pair<int, bool>>> sides;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle& c = mesh.triangles[t];
      const Vec3 across = (points[c[1]] - points[c[0]]).cross(points[c[2]] - points[c[0]]);
      faces.push_back({c, across.normalized()});
      for (int k = 0; k < 3; ++k) {
        const int v = c[k];
        const int w = c[(k + 1) % 3];
        sides[{std::min(v, w), std::max(v, w)}].push_back({static_cast<int>(t), v < w});
      }
    }
    std::map<int, std::vector<Vec3>> walls;
    for (const auto& [ends, of] : sides) {
      const bool inner = of.size() == 2 && of[0].second != of[1].second;
      if (inner) {
        add_inner(ends.first, ends.second, of, group);
      } else {
        for (const auto& [t, forward] : of) {
          add_rim(ends.first, ends.second, t, forward);
          for (int v : {ends.first, ends.second}) walls[v].push_back(-faces[t].normal);
        }
      }
    }
    add_corners(group, walls);
  }

  std::vector<Vec3> points;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<Corner> corners;

 private:
  void add_inner(int v, int w, const std::vector<std::pair<int, bool>>& of, const std::vector<int>& group) {
    const int left = of[0].second ? of[0].first : of[1].first;  // runs v -> w
    const int right = of[0].second ? of[1].first : of[0].first;
    if (group[left] == group[right]) return;
    const Vec3 along = (points[w] - points[v]).normalized();
    const Vec3& n = faces[left].normal;
    // From the left normal, turning about the edge away from the left face.
    const Vec3 away = n.cross(-along).normalized();  // square to the edge, out of the left face
    const double turn = std::atan2(faces[right].normal.dot(away), faces[right].normal.dot(n));
    if (turn <= 0.0) return;
    edges.push_back({v, w, n, away, turn});
  }
  void add_rim(int v, int w, int t, bool forward) {
    const Vec3 along = (forward ? 1.0 : -1.0) * (points[w] - points[v]).normalized();
    const Vec3& n = faces[t].normal;
    edges.push_back({v, w, n, along.cross(n).normalized(), 0.5 * kPi});
  }
  void add_corners(const std::vector<int>& group, const std::map<int, std::vector<Vec3>>& walls) {
    std::map<int, std::vector<int>> at;
    for (std::size_t t = 0; t < faces.size(); ++t) {
      for (int v : faces[t].v) at[v].push_back(static_cast<int>(t));
    }
    for (const auto& [v, of] : at) {
      Corner corner;
      corner.v = v;
      corner.outward = Vec3::Zero();
      std::set<int> ends;
      std::set<int> groups;
      for (int t : of) {
        std::vector<int> others;
        for (int w : faces[t].v) {
          if (w != v) others.push_back(w);
        }
        ends.insert(others.begin(), others.end());
        groups.insert(group[t]);
        corner.outward +=
            faces[t].normal * angle(points[others[0]] - points[v], points[others[1]] - points[v]);
      }
      for (int w : ends) corner.edges.push_back((points[w] - points[v]).normalized());
      if (const auto wall = walls.find(v); wall != walls.end()) {
        corner.edges.insert(corner.edges.end(), wall->second.begin(), wall->second.end());
      } else if (groups.size() == 1) {
        continue;
      }
      corner.outward.normalize();
      if (has_inside(corner)) corners.push_back(corner);
    }
  }
  /// Whether the directions from which all edges fall away have an inside that is outside the surface. Their
  /// extreme ones are square to two edges.
  static bool has_inside(Corner& corner) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& e : corner.edges) {
      for (const Vec3& f : corner.edges) {
        Vec3 u = e.cross(f);
        if (u.norm() < 1e-9) continue;
        u.normalize();
        if (std::all_of(corner.edges.begin(), corner.edges.end(),
                        [&](const Vec3& g) { return g.dot(u) <= 1e-9; })) {
          middle += u;
          corner.rays.push_back(u);
        }
      }
    }
    const double length = middle.norm();
    if (length < 1e-9) return false;
    middle /= length;
    for (const Vec3& e : corner.edges) {
      if (e.dot(middle) >= -1e-9) return false;
      corner.thin = corner.thin || e.dot(middle) > -kThin;
    }
    return middle.dot(corner.outward) > 0.0;
  }
};

double edge_margin(const Edge& edge, const Vec3& u, double inflation) {
  const double at = std::atan2(u.dot(edge.side), u.dot(edge.from));
  // The middle of the arc is where both ends are as far: measure from there.
  double off = at - 0.5 * edge.width;
  if (off > kPi) off -= 2.0 * kPi;
  if (off < -kPi) off += 2.0 * kPi;
  return 0.5 * edge.width - std::abs(off) + inflation;
}

/// Sine of the angle from u to the cone of these rays: to one of them, or to the sector between two.
double sine_to_cone(const std::vector<Vec3>& rays, const Vec3& u) {
  double least = 1.0;
  for (const Vec3& r : rays) {
    if (r.dot(u) > 0.0) least = std::min(least, (u - r * r.dot(u)).norm());
    for (const Vec3& s : rays) {
      const double c = r.dot(s);
      const double det = 1.0 - c * c;
      if (det < 1e-15) continue;
      const double of_r = (r.dot(u) - c * s.dot(u)) / det;
      const double of_s = (s.dot(u) - c * r.dot(u)) / det;
      if (of_r >= 0.0 && of_s >= 0.0) least = std::min(least, (u - of_r * r - of_s * s).norm());
    }
  }
  return least;
}

double corner_margin(const Corner& corner, const Vec3& u, double inflation) {
  double inside = 1.0;
  for (const Vec3& e : corner.edges) inside = std::min(inside, -e.dot(u));
  const double margin = inside >= 0.0 ? inside + inflation : inflation - sine_to_cone(corner.rays, u);
  return std::min({margin, u.dot(corner.outward) + inflation, corner.thin ? 0.0 : 1.0});
}

/// Boxes of features in a grid of cells: which may be near another box. A feature stands in every cell its
/// box touches.
class Grid {
 public:
  Grid(std::vector<Aabb> boxes, double grown) : boxes_(std::move(boxes)), seen_(boxes_.size(), -1) {
    for (Aabb& box : boxes_) {
      box.min -= Vec3::Constant(grown);
      box.max += Vec3::Constant(grown);
      all_.extend(box.min);
      all_.extend(box.max);
    }
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      for_each_cell(boxes_[i], [&](std::vector<int>& cell) { cell.push_back(static_cast<int>(i)); });
  }
  template <class Visit>
  void for_each_near(const Aabb& box, const Visit& visit) {
    ++round_;
    for_each_cell(box, [&](const std::vector<int>& cell) {
      for (int i : cell) {
        const Aabb& other = boxes_[std::size_t(i)];
        if (seen_[std::size_t(i)] == round_ || (box.min.array() > other.max.array()).any() ||
            (box.max.array() < other.min.array()).any())
          continue;
        seen_[std::size_t(i)] = round_;
        visit(std::size_t(i));
      }
    });
  }

 private:
  static constexpr int kCells = 64;
  template <class Visit>
  void for_each_cell(const Aabb& box, const Visit& visit) {
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (int k = 0; k < 3; ++k) {
      const double per_cell = kCells / std::max(all_.max[k] - all_.min[k], 1e-300);
      low[std::size_t(k)] = std::clamp(int((box.min[k] - all_.min[k]) * per_cell), 0, kCells - 1);
      high[std::size_t(k)] = std::clamp(int((box.max[k] - all_.min[k]) * per_cell), 0, kCells - 1);
    }
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) visit(cells_[std::size_t((x * kCells + y) * kCells + z)]);
      }
    }
  }
  std::vector<Aabb> boxes_;
  std::vector<int> seen_;
  int round_ = 0;
  Aabb all_;
  std::vector<std::vector<int>> cells_{std::size_t(kCells) * kCells * kCells};
};

Aabb box_of(const Features& f, const Corner& corner) { return {f.points[corner.v], f.points[corner.v]}; }
Aabb box_of(const Features& f, const Edge& edge) {
  Aabb box;
  for (int v : {edge.v, edge.w}) box.extend(f.points[v]);
  return box;
}
Aabb box_of(const Features& f, const Face& face) {
  Aabb box;
  for (int v : face.v) box.extend(f.points[v]);
  return box;
}
template <class List>
std::vector<Aabb> boxes_of(const Features& f, const List& list) {
  std::vector<Aabb> boxes;
  for (const auto& feature : list) boxes.push_back(box_of(f, feature));
  return boxes;
}

class Search {
 public:
  Search(const Features& a, const Features& b, const MinimaQuery& query, double error_bound)
      : a_(a), b_(b), query_(query), error_bound_(error_bound) {}

  std::vector<RefereeMinimum> run() {
    meet(a_, a_.corners, b_, b_.faces,
         [&](const Corner& x, const Face& y) { corner_face(a_, x, b_, y, false); });
    meet(a_, a_.corners, b_, b_.edges,
         [&](const Corner& x, const Edge& y) { corner_edge(a_, x, b_, y, false); });
    meet(a_, a_.corners, b_, b_.corners, [&](const Corner& x, const Corner& y) { corner_corner(x, y); });
    meet(b_, b_.corners, a_, a_.faces,
         [&](const Corner& x, const Face& y) { corner_face(b_, x, a_, y, true); });
    meet(b_, b_.corners, a_, a_.edges,
         [&](const Corner& x, const Edge& y) { corner_edge(b_, x, a_, y, true); });
    meet(a_, a_.edges, b_, b_.edges, [&](const Edge& x, const Edge& y) { edge_edge(x, y); });
    return std::move(found_);
  }

 private:
  /// Every pair; of large meshes every pair whose boxes are within twice the tolerance of each other.
  template <class Ones, class Others, class Compare>
  void meet(const Features& f, const Ones& ones, const Features& g, const Others& others,
            const Compare& compare) const {
    constexpr std::size_t kFew = 1 << 22;
    if (ones.size() * others.size() < kFew) {
      for (const auto& x : ones) {
        for (const auto& y : others) compare(x, y);
      }
      return;
    }
    Grid grid(boxes_of(g, others), 2.0 * std::max(query_.max_distance, query_.depth));
    for (const auto& x : ones)
      grid.for_each_near(box_of(f, x), [&](std::size_t i) { compare(x, others[i]); });
  }

  double range_margin(double distance) const {
    return std::min(query_.max_distance - distance, distance + query_.depth) / query_.max_distance;
  }
  void take(std::vector<int> x, std::vector<int> y, double distance, const Vec3& p_x, const Vec3& p_y,
            const Vec3& n, double margin, bool swapped) {
    margin = std::min(margin, range_margin(distance));
    if (margin < -error_bound_) return;
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    if (swapped) {
      found_.push_back({y, x, distance, p_y, p_x, -n, margin});
    } else {
      found_.push_back({x, y, distance, p_x, p_y, n, margin});
    }
  }

  void corner_face(const Features& of, const Corner& corner, const Features& on, const Face& face,
                   bool swapped) {
    const Vec3& p = of.points[corner.v];
    const double height = face.normal.dot(p - on.points[face.v[0]]);
    if (range_margin(height) < -error_bound_) return;
    double margin = corner_margin(corner, -face.normal, query_.cone_inflation);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& from = on.points[face.v[k]];
      const Vec3 along = on.points[face.v[(k + 1) % 3]] - from;
      const Vec3 inward = face.normal.cross(along) / along.squaredNorm();
      margin = std::min(margin, inward.dot(p - from));
    }
    take({corner.v}, {face.v[0], face.v[1], face.v[2]}, height, p, p - height * face.normal, face.normal,
         margin, swapped);
  }

  void corner_edge(const Features& of, const Corner& corner, const Features& on, const Edge& edge,
                   bool swapped) {
    const Vec3& p = of.points[corner.v];
    const Vec3& q = on.points[edge.v];
    const Vec3 along = on.points[edge.w] - q;
    const double t = along.dot(p - q) / along.squaredNorm();
    const Vec3 foot = q + t * along;
    const double distance = (p - foot).norm();
    if (distance > 2.0 * query_.max_distance || distance < 1e-12) return;
    const Vec3 n = (p - foot) / distance;
    const double margin = std::min({t, 1.0 - t, edge_margin(edge, n, query_.cone_inflation),
                                    corner_margin(corner, -n, query_.cone_inflation)});
    take({corner.v}, {edge.v, edge.w}, distance, p, foot, n, margin, swapped);
  }

  void corner_corner(const Corner& x, const Corner& y) {
    const Vec3 off = a_.points[x.v] - b_.points[y.v];
    const double distance = off.norm();
    if (distance > 2.0 * query_.max_distance || distance < 1e-12) return;
    const Vec3 n = off / distance;
    take({x.v}, {y.v}, distance, a_.points[x.v], b_.points[y.v], n,
         std::min(corner_margin(x, -n, query_.cone_inflation), corner_margin(y, n, query_.cone_inflation)),
         false);
  }

  void edge_edge(const Edge& e, const Edge& f) {
    const Vec3& p = a_.points[e.v];
    const Vec3& q = b_.points[f.v];
    const Vec3 u = a_.points[e.w] - p;
    const Vec3 w = b_.points[f.w] - q;
    const Vec3 c = u.cross(w);
    const double sine = c.norm() / (u.norm() * w.norm());
    if (sine <= query_.cone_inflation + error_bound_) parallel(e, f, query_.cone_inflation - sine);
    if (sine < 1e-8) return;
    const Vec3 n = c.normalized();
    const double height = n.dot(p - q);
    if (std::abs(height) > 2.0 * query_.max_distance) return;
    // Where the plane through one edge along n cuts the other.
    const Vec3 through_f = w.cross(n);
    const double s = through_f.dot(q - p) / through_f.dot(u);
    const Vec3 through_e = u.cross(n);
    const double t = through_e.dot(p - q) / through_e.dot(w);
    const double on_both = std::min({s, 1.0 - s, t, 1.0 - t});
    if (on_both < -error_bound_) return;
    for (double sign : {1.0, -1.0}) {
      const double margin = std::min({on_both, edge_margin(f, sign * n, query_.cone_inflation),
                                      edge_margin(e, -sign * n, query_.cone_inflation)});
      take({e.v, e.w}, {f.v, f.w}, sign * height, p + s * u, q + t * w, sign * n, margin, false);
    }
  }

  void parallel(const Edge& e, const Edge& f, double margin) {
    const Vec3& p = a_.points[e.v];
    const Vec3 u = a_.points[e.w] - p;
    const Vec3& q = b_.points[f.v];
    const Vec3 w = b_.points[f.w] - q;
    double from = u.dot(q - p) / u.squaredNorm();
    double to = u.dot(q + w - p) / u.squaredNorm();
    if (from > to) std::swap(from, to);
    from = std::max(from, 0.0);
    to = std::min(to, 1.0);
    if (to - from < -error_bound_) return;
    for (double s : {from, to}) {
      const Vec3 p_a = p + s * u;
      const Vec3 p_b = q + std::clamp(w.dot(p_a - q) / w.squaredNorm(), 0.0, 1.0) * w;
      const double distance = (p_a - p_b).norm();
      if (distance > 2.0 * query_.max_distance || distance < 1e-12) continue;
      const Vec3 n = (p_a - p_b) / distance;
      for (double sign : {1.0, -1.0}) {
        take({e.v, e.w}, {f.v, f.w}, sign * distance, p_a, p_b, sign * n,
             std::min({margin, to - from, edge_margin(f, sign * n, query_.cone_inflation),
                       edge_margin(e, -sign * n, query_.cone_inflation)}),
             false);
      }
    }
  }

  const Features& a_;
  const Features& b_;
  const MinimaQuery& query_;
  double error_bound_;
  std::vector<RefereeMinimum> found_;
};

}  // namespace

std::vector<RefereeMinimum> every_minimum(const TriangleMesh& a, const TriangleMesh& b, const Pose& X_AB,
                                          const MinimaQuery& query, double error_bound) {
  const Features features_a(a, Pose());
  const Features features_b(b, X_AB);
  return Search(features_a, features_b, query, error_bound).run();
}

}  // namespace tactum::oracles
