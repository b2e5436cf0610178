#include "tactum/geometry/true_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/polygon_clip.h"

namespace tactum::inline v0_1 {
namespace {

/// Touching intervals and areas count when they are longer, or wider, than this many times the noise.
constexpr double kLongerThanNoise = 4.0;

class TrueSurfaceBuilder {
 public:
  TrueSurfaceBuilder(const std::vector<Polytope>& pieces, double noise)
      : pieces_(pieces), noise_(noise), sets_(number_features()) {
    touching_.resize(static_cast<std::size_t>(features_));
    covered_.assign(static_cast<std::size_t>(features_), 0.0);
  }

  /// Finds the features of piece i that piece k touches and covers.
  void touch(int i, int k) {
    const Polytope& P = pieces_[i];
    const Polytope& K = pieces_[k];
    for (int v = 0; v < P.counts[0]; ++v)
      if (inside(P.vertices[v], K)) touching_[first_[i][0] + v].push_back(k);
    for (int e = 0; e < P.counts[1]; ++e)
      if (runs_along(P, e, K)) touching_[edge(i, e)].push_back(k);
    for (int f = 0; f < P.counts[2]; ++f) {
      if (const double area = covered_area(P, f, K); area > 0.0) {
        touching_[face(i, f)].push_back(k);
        covered_[face(i, f)] += area;
      }
    }
  }

  /// Joins the features that are one across pieces i and k. To be called when all have been through touch().
  void join(int i, int k) {
    const Polytope& P = pieces_[i];
    const Polytope& K = pieces_[k];
    for (int e = 0; e < P.counts[1]; ++e)
      for (int other = 0; other < K.counts[1]; ++other)
        if (in_line(P, e, K, other)) sets_.join(edge(i, e), edge(k, other));
    for (int f = 0; f < P.counts[2]; ++f)
      for (int other = 0; other < K.counts[2]; ++other)
        if (in_plane(P, f, K, other) && open_area(i, f) > 0.0 && open_area(k, other) > 0.0 &&
            meet_along(P, f, K, other))
          sets_.join(face(i, f), face(k, other));
  }

  TrueSurface result() {
    TrueSurface out;
    out.first = first_;
    out.touching_first.push_back(0);
    for (std::vector<int>& pieces : touching_) {
      std::sort(pieces.begin(), pieces.end());
      out.touching.insert(out.touching.end(), pieces.begin(), pieces.end());
      out.touching_first.push_back(static_cast<int>(out.touching.size()));
    }
    out.group.assign(touching_.size(), -1);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Polytope& P = pieces_[i];
      const int piece = static_cast<int>(i);
      for (int e = 0; e < P.counts[1]; ++e) out.group[edge(piece, e)] = sets_.find(edge(piece, e));
      for (int f = 0; f < P.counts[2]; ++f) {
        const double open = open_area(piece, f);
        out.exposed_area += open;
        if (open > 0.0) out.group[face(piece, f)] = sets_.find(face(piece, f));
      }
    }
    list_members(out);
    return out;
  }

 private:
  /// A set's number is that of one of its features, so there are no more groups than features.
  void list_members(TrueSurface& out) const {
    out.members_first.assign(out.group.size() + 1, 0);
    for (const int group : out.group)
      if (group >= 0) ++out.members_first[group + 1];
    std::partial_sum(out.members_first.begin(), out.members_first.end(), out.members_first.begin());
    out.members.resize(static_cast<std::size_t>(out.members_first.back()));
    std::vector<int> next = out.members_first;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (std::size_t kind = 1; kind < 3; ++kind)
        for (int index = 0; index < pieces_[i].counts[kind]; ++index)
          if (const int group = out.group[first_[i][kind] + index]; group >= 0)
            out.members[next[group]++] = {static_cast<int>(i), index};
  }

  int number_features() {
    for (const Polytope& piece : pieces_) {
      std::array<int, 3>& first = first_.emplace_back();
      for (std::size_t kind = 0; kind < 3; ++kind) {
        first[kind] = features_;
        features_ += piece.counts[kind];
      }
    }
    return features_;
  }
  int edge(int piece, int e) const { return first_[piece][1] + e; }
  int face(int piece, int f) const { return first_[piece][2] + f; }

  /// The exposed area of face f; zero when it is narrower than the noise [m^2].
  double open_area(int piece, int f) const {
    const Polytope& P = pieces_[piece];
    const std::vector<Vec3> corners = face_corners(P, f);
    const double open = polygon_area(corners, P.faces[f].normal) - covered_[face(piece, f)];
    return open > noise_ * length_around(corners) ? open : 0.0;
  }

  static double length_around(const std::vector<Vec3>& corners) {
    double around = 0.0;
    for (std::size_t c = 0; c < corners.size(); ++c)
      around += (corners[(c + 1) % corners.size()] - corners[c]).norm();
    return around;
  }

  bool inside(const Vec3& p, const Polytope& K) const {
    return std::all_of(K.faces.begin(), K.faces.end(), [&](const Polytope::Face& plane) {
      return plane.normal.dot(p) <= plane.offset + noise_;
    });
  }

  /// Whether more than a point of a segment is in K.
  bool runs_along(const Vec3& p, const Vec3& q, const Polytope& K) const {
    double low = 0.0;
    double high = 1.0;
    for (const Polytope::Face& plane : K.faces) {
      const double at_p = plane.normal.dot(p) - plane.offset - noise_;
      const double at_q = plane.normal.dot(q) - plane.offset - noise_;
      if (at_p > 0.0 && at_q > 0.0) return false;
      if (at_p > 0.0) low = std::max(low, at_p / (at_p - at_q));
      if (at_q > 0.0) high = std::min(high, at_p / (at_p - at_q));
    }
    return (high - low) * (q - p).norm() > kLongerThanNoise * noise_;
  }
  bool runs_along(const Polytope& P, int e, const Polytope& K) const {
    return runs_along(P.vertices[P.edges[e].tail], P.vertices[P.edges[e].head], K);
  }

  /// The part of face f that is in K, where K rises above the face.
  double covered_area(const Polytope& P, int f, const Polytope& K) const {
    const Vec3& normal = P.faces[f].normal;
    const Vec3& highest = K.vertices[support_vertex(K, normal)];
    if (normal.dot(highest) <= P.faces[f].offset + kLongerThanNoise * noise_) return 0.0;
    std::vector<Vec3> polygon = face_corners(P, f);
    for (const Polytope::Face& plane : K.faces) {
      // The opposite wall may stand off by the noise; all else cuts exactly.
      const bool opposite =
          plane.normal.dot(normal) < 0.0 && plane.normal.cross(normal).norm() < tolerances::kCoplanarMeshSine;
      keep_below(polygon, plane.normal, plane.offset + (opposite ? kLongerThanNoise * noise_ : 0.0));
      if (polygon.empty()) return 0.0;
    }
    const double area = polygon_area(polygon, normal);
    return area > noise_ * length_around(polygon) ? area : 0.0;
  }

  bool in_plane(const Polytope& P, int f, const Polytope& K, int other) const {
    const Polytope::Face& a = P.faces[f];
    const Polytope::Face& b = K.faces[other];
    if (a.normal.dot(b.normal) < 0.0 || a.normal.cross(b.normal).norm() > tolerances::kCoplanarMeshSine)
      return false;
    const Vec3& p = K.vertices[K.face_vertices[b.first]];
    return std::abs(a.normal.dot(p) - a.offset) <= kLongerThanNoise * noise_;
  }
  /// Whether the faces, in one plane, have a stretch of border in common.
  bool meet_along(const Polytope& P, int f, const Polytope& K, int other) const {
    const Polytope::Face& a = P.faces[f];
    const Polytope::Face& b = K.faces[other];
    for (int i = 0; i < a.count; ++i)
      for (int j = 0; j < b.count; ++j) {
        const Polytope::Edge& e = P.edges[P.sides[a.first + i].edge];
        const Polytope::Edge& o = K.edges[K.sides[b.first + j].edge];
        if (shared_length(P, e, K, o) > kLongerThanNoise * noise_) return true;
      }
    return false;
  }

  /// Whether two edges lie in one line and meet or overlap.
  bool in_line(const Polytope& P, int e, const Polytope& K, int other) const {
    return shared_length(P, P.edges[e], K, K.edges[other]) >= -kLongerThanNoise * noise_;
  }
  /// How far two edges in one line overlap; below zero: how far they are apart. -1e300: not in one line.
  double shared_length(const Polytope& P, const Polytope::Edge& a, const Polytope& K,
                       const Polytope::Edge& b) const {
    constexpr double kNone = -1e300;
    if (a.direction.cross(b.direction).norm() > tolerances::kCoplanarMeshSine) return kNone;
    const Vec3 to_tail = K.vertices[b.tail] - P.vertices[a.tail];
    if (to_tail.cross(a.direction).norm() > kLongerThanNoise * noise_) return kNone;
    const double tail = to_tail.dot(a.direction);
    const double head = (K.vertices[b.head] - P.vertices[a.tail]).dot(a.direction);
    return std::min(a.length, std::max(tail, head)) - std::max(0.0, std::min(tail, head));
  }

  const std::vector<Polytope>& pieces_;
  double noise_;
  int features_ = 0;
  std::vector<std::array<int, 3>> first_;
  DisjointSets sets_;
  std::vector<std::vector<int>> touching_;
  std::vector<double> covered_;
};

}  // namespace

TrueSurface true_surface(const std::vector<Polytope>& pieces, const Bvh& hierarchy, double noise) {
  std::vector<std::pair<int, int>> near;
  for_each_pair_within(hierarchy, hierarchy, Pose{}, noise, [&](int i, int k) {
    if (i != k) near.emplace_back(i, k);
    return true;
  });
  if (near.empty()) return {};
  std::sort(near.begin(), near.end());
  TrueSurfaceBuilder builder(pieces, noise);
  for (const auto& [i, k] : near) builder.touch(i, k);
  for (const auto& [i, k] : near)
    if (i < k) builder.join(i, k);
  return builder.result();
}

}  // namespace tactum::inline v0_1
