#include "tactum/geometry/revolution.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Fewer corners are those of a prism.
constexpr int kLeastCorners = 8;
/// Second moments about two directions square to an axis differ by no more than this fraction.
constexpr double kEven = 1e3 * tolerances::kCoplanarMeshOffset;

/// A corner, seen from the axis.
struct Corner {
  double along = 0.0, radius = 0.0, angle = 0.0;  // [m, m, rad]
  std::int32_t vertex = -1;
};

/// Corners [first, last) of a list, by angle: they may be a circle.
struct Candidate {
  Index first = 0, last = 0;
  std::int32_t number = -1;  // once it is known to be one
};

class CircleSearch {
 public:
  CircleSearch(const TriangleMesh& mesh, const Vec3& center, const Vec3& axis, double noise_m,
               double crease_rad)
      : mesh_(mesh), center_(center), axis_(axis), noise_(noise_m), crease_(crease_rad) {}

  Revolution run() {
    list_corners();
    split();
    look_at_sides();
    Revolution found;
    found.center = center_;
    found.axis = axis_;
    for (Candidate& candidate : candidates_)
      if (is_circle(candidate)) add(candidate, found);
    if (found.circles.empty()) return {};
    found.circle_of.assign(mesh_.vertices.size(), -1);
    for (const Candidate& candidate : candidates_)
      for (Index i = candidate.first; i < candidate.last && candidate.number >= 0; ++i)
        found.circle_of[Index(corners_[i].vertex)] = candidate.number;
    join_cylinders(found);
    return found;
  }

 private:
  void list_corners() {
    const Vec3 u = axis_.unitOrthogonal();
    const Vec3 v = axis_.cross(u);
    for (const Vec3& vertex : mesh_.vertices) {
      const Vec3 p = vertex - center_;
      const double x = u.dot(p);
      const double y = v.dot(p);
      corners_.push_back(
          {axis_.dot(p), std::sqrt(x * x + y * y), std::atan2(y, x), std::int32_t(corners_.size())});
    }
  }
  /// Sorts corners [first, last) by one of their numbers, and calls `part` with each run of equal ones.
  template <class Part>
  void for_each_run(Index first, Index last, double Corner::*number, const Part& part) {
    const auto at = [&](Index i) { return corners_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(first), at(last), [&](const Corner& p, const Corner& q) {
      return p.*number < q.*number || (p.*number == q.*number && p.vertex < q.vertex);
    });
    for (Index from = first; from < last;) {
      Index to = from + 1;
      while (to < last && corners_[to].*number - corners_[to - 1].*number <= noise_) ++to;
      part(from, to);
      from = to;
    }
  }
  void split() {
    for_each_run(0, corners_.size(), &Corner::along, [&](Index from, Index to) {
      for_each_run(from, to, &Corner::radius, [&](Index first, Index last) {
        if (last - first < kLeastCorners || corners_[first].radius <= noise_) return;
        std::sort(corners_.begin() + static_cast<std::ptrdiff_t>(first),
                  corners_.begin() + static_cast<std::ptrdiff_t>(last),
                  [](const Corner& p, const Corner& q) { return p.angle < q.angle; });
        candidates_.push_back({first, last});
      });
    });
    candidate_of_.assign(mesh_.vertices.size(), -1);
    rank_.assign(mesh_.vertices.size(), 0);
    for (Index c = 0; c < candidates_.size(); ++c) {
      for (Index i = candidates_[c].first; i < candidates_[c].last; ++i) {
        candidate_of_[Index(corners_[i].vertex)] = std::int32_t(c);
        rank_[Index(corners_[i].vertex)] = i;
      }
    }
    outward_.assign(corners_.size(), 0);
    inward_.assign(candidates_.size(), 0);
  }
  /// Marks the sides of candidates, by their first corner, that have a facet outward, and the candidates that
  /// have one toward the axis.
  void look_at_sides() {
    for (const Triangle& t : mesh_.triangles) {
      const auto p = [&](Index corner) -> const Vec3& { return mesh_.vertices[Index(t[corner])]; };
      const Vec3 n = (p(1) - p(0)).cross(p(2) - p(0)).normalized();
      for (Index k = 0; k < 3; ++k) {
        const auto from = Index(t[k]);
        const auto to = Index(t[(k + 1) % 3]);
        const std::int32_t c = candidate_of_[from];
        if (c < 0 || c != candidate_of_[to]) continue;
        const Vec3 middle = 0.5 * (mesh_.vertices[from] + mesh_.vertices[to]) - center_;
        const double leans = n.dot((middle - axis_ * axis_.dot(middle)).normalized());
        if (leans < -tolerances::kCoplanarMeshOffset) inward_[Index(c)] = 1;
        if (!(leans > tolerances::kCoplanarMeshOffset)) continue;
        const Candidate& candidate = candidates_[Index(c)];
        const Index low = std::min(rank_[from], rank_[to]);
        const Index high = std::max(rank_[from], rank_[to]);
        if (high == low + 1) outward_[low] = 1;
        if (low == candidate.first && high == candidate.last - 1) outward_[high] = 1;
      }
    }
  }
  /// The angle from a corner of a candidate to the next.
  double step_from(const Candidate& candidate, Index i) const {
    return i + 1 < candidate.last ? corners_[i + 1].angle - corners_[i].angle
                                  : corners_[candidate.first].angle + 2.0 * kPi - corners_[i].angle;
  }
  bool is_circle(const Candidate& candidate) const {
    if (inward_[Index(candidate_of_[Index(corners_[candidate.first].vertex)])] != 0) return false;
    for (Index i = candidate.first; i < candidate.last; ++i)
      if (outward_[i] == 0 || !(step_from(candidate, i) < crease_)) return false;
    return true;
  }
  void add(Candidate& candidate, Revolution& found) const {
    candidate.number = std::int32_t(found.circles.size());
    Revolution::Circle circle;
    double step = 0.0;
    for (Index i = candidate.first; i < candidate.last; ++i) {
      circle.radius_m = std::max(circle.radius_m, corners_[i].radius);
      step = std::max(step, step_from(candidate, i));
    }
    circle.along_m = circle.from_m = circle.to_m = corners_[candidate.first].along;
    circle.first_vertex = corners_[candidate.first].vertex;
    found.circles.push_back(circle);
    found.bulge_m = std::max(found.bulge_m, circle.radius_m * (1.0 - std::cos(0.5 * step)));
  }
  /// Gives circles of one radius with a facet between them the stretch of both.
  void join_cylinders(Revolution& found) const {
    const std::vector<Revolution::Circle> alone = found.circles;
    for (const Triangle& t : mesh_.triangles) {
      for (Index k = 0; k < 3; ++k) {
        const std::int32_t one = found.circle_of[Index(t[k])];
        const std::int32_t other = found.circle_of[Index(t[(k + 1) % 3])];
        if (one < 0 || other < 0 || one == other) continue;
        Revolution::Circle& p = found.circles[Index(one)];
        Revolution::Circle& q = found.circles[Index(other)];
        if (std::abs(p.radius_m - q.radius_m) > noise_) continue;
        for (Revolution::Circle* circle : {&p, &q}) {
          circle->from_m = std::min({circle->from_m, alone[Index(one)].along_m, alone[Index(other)].along_m});
          circle->to_m = std::max({circle->to_m, alone[Index(one)].along_m, alone[Index(other)].along_m});
        }
      }
    }
  }

  const TriangleMesh& mesh_;
  Vec3 center_, axis_;
  double noise_, crease_;
  std::vector<Corner> corners_;
  std::vector<Candidate> candidates_;
  std::vector<std::int32_t> candidate_of_;  // of each vertex
  std::vector<Index> rank_;                 // of each vertex: where it stands in corners_
  std::vector<char> outward_;               // of the side from each corner to the next
  std::vector<char> inward_;                // of each candidate
};

/// Whether corners with these second moments may be spread evenly about an axis.
bool is_even(const Mat3& moments, const Vec3& axis) {
  const Vec3 u = axis.unitOrthogonal();
  const Vec3 v = axis.cross(u);
  const double enough = kEven * moments.trace();
  return std::abs(u.dot(moments * u) - v.dot(moments * v)) < enough && std::abs(u.dot(moments * v)) < enough;
}

}  // namespace

Revolution find_revolution(const TriangleMesh& mesh, double crease_rad) {
  if (mesh.vertices.size() < 2 * kLeastCorners) return {};
  Aabb box;
  Vec3 center = Vec3::Zero();
  for (const Vec3& vertex : mesh.vertices) {
    box.extend(vertex);
    center += vertex / static_cast<double>(mesh.vertices.size());
  }
  Mat3 moments = Mat3::Zero();
  for (const Vec3& vertex : mesh.vertices)
    moments += (vertex - center) * (vertex - center).transpose() / static_cast<double>(mesh.vertices.size());
  const Mat3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(moments).eigenvectors();
  // Where all moments are equal the axes of the mesh are as good as any.
  for (const Mat3& axes : {principal, Mat3(Mat3::Identity())}) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 axis = axes.col(i);
      if (!is_even(moments, axis)) continue;
      const double noise_m = tolerances::kCoplanarMeshOffset * box.diagonal();
      Revolution found = CircleSearch(mesh, center, axis, noise_m, crease_rad).run();
      if (!found.circles.empty()) return found;
    }
  }
  return {};
}

}  // namespace tactum::inline v0_1
