#include "tactum/surface/surface_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

class DistanceQuery {
 public:
  DistanceQuery(const Surface& a, const Surface& b, const Pose& X_AB) noexcept
      : a_(a), b_(b), frame_(X_AB), touching_(tolerances::kTouching * std::max(a.size(), b.size())) {
    best_.distance = kNone;
  }

  SurfaceDistance run(const SurfacePairCache& cache, TouchingPairs touching) noexcept {
    if (cache.triangle_a >= 0 && cache.triangle_a < a_.count() && cache.triangle_b >= 0 &&
        cache.triangle_b < b_.count()) {
      test(cache.triangle_a, cache.triangle_b);
    }
    if (best_.triangle_a >= 0) {
      look_only_around(0.5 * (best_.p_a + best_.p_b), kNearby * std::min(a_.size(), b_.size()));
      descend();
      radius_ = kNone;
    }
    if (!a_.bvh().empty() && !b_.bvh().empty()) descend();
    if (best_.distance == 0.0) {
      best_.touching_pairs = 1;
      if (touching == TouchingPairs::kCounted) count_touching();
    }
    return best_;
  }

 private:
  static constexpr double kNone = 1e300;
  static constexpr int kDirections = 6;  // one or two mostly decide
  /// Of the smaller surface's size, about the place that was nearest last time: surfaces that have begun to
  /// cross mostly do so there, and a walk through all of two threads would find it last.
  static constexpr double kNearby = 0.02;
  struct Pair {
    std::int32_t a, b;
    double gap;       ///< lower bound of the distance [m]
    double apart_sq;  ///< of the centres [m^2]
  };

  /// Depth first, of two children the nearer one first: a short distance found early excludes most.
  void descend() noexcept {
    // Filled as far as it is used: NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    std::array<Pair, 2 * Bvh::kMaxDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0, 0.0, 0.0};
    while (size > 0 && best_.distance > 0.0) {
      const Pair pair = stack[--size];
      if (pair.gap >= best_.distance) continue;
      const Bvh::Node& a = node_a(pair.a);
      const Bvh::Node& b = node_b(pair.b);
      if (a.leaf() && b.leaf()) {
        test_leaves(a, b);
        continue;
      }
      const bool split_a = b.leaf() || (!a.leaf() && a.half.squaredNorm() >= b.half.squaredNorm());
      const Pair first = split_a ? bounded(pair.a + 1, pair.b) : bounded(pair.a, pair.b + 1);
      const Pair second = split_a ? bounded(a.second, pair.b) : bounded(pair.a, b.second);
      // Boxes that overlap are no nearer one than the other: then those go first that lie in each other
      // deeper.
      const bool first_nearer =
          first.gap != second.gap ? first.gap < second.gap : first.apart_sq <= second.apart_sq;
      const Pair& far = first_nearer ? second : first;
      const Pair& near = first_nearer ? first : second;
      if (far.gap < best_.distance) stack[size++] = far;
      if (near.gap < best_.distance) stack[size++] = near;
    }
  }

  void look_only_around(const Vec3& p_A, double radius) noexcept {
    centre_a_ = p_A;
    centre_b_ = frame_.X_AB.R.transpose() * (p_A - frame_.X_AB.p);
    radius_ = radius;
  }
  bool outside(const Bvh::Node& node, const Vec3& centre) const noexcept {
    return ((centre - node.center).cwiseAbs() - node.half).cwiseMax(0.0).squaredNorm() > radius_ * radius_;
  }

  Pair bounded(std::int32_t a, std::int32_t b) noexcept {
    ++best_.boxes_tested;
    const Bvh::Node& of_a = node_a(a);
    const Bvh::Node& of_b = node_b(b);
    if (radius_ < kNone && (outside(of_a, centre_a_) || outside(of_b, centre_b_))) return {a, b, kNone, 0.0};
    return {a, b, box_gap(frame_, of_a, of_b), (frame_.X_AB * of_b.center - of_a.center).squaredNorm()};
  }

  void test_leaves(const Bvh::Node& a, const Bvh::Node& b) noexcept {
    for (std::int32_t i = a.second; i < a.second + a.count; ++i) {
      for (std::int32_t k = b.second; k < b.second + b.count; ++k) {
        test(a_.bvh().order()[static_cast<std::size_t>(i)], b_.bvh().order()[static_cast<std::size_t>(k)]);
      }
    }
  }

  TrianglePoints moved(int triangle_b) const noexcept {
    const TrianglePoints& t = b_.triangle(triangle_b);
    return {frame_.X_AB * t[0], frame_.X_AB * t[1], frame_.X_AB * t[2]};
  }

  /// Whether the plane of `t` keeps `other` farther away than `distance`.
  static bool plane_parts(const TrianglePoints& t, const TrianglePoints& other, double distance) noexcept {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double h0 = normal.dot(other[0] - t[0]);
    const double h1 = normal.dot(other[1] - t[0]);
    const double h2 = normal.dot(other[2] - t[0]);
    const double least = std::max(std::min({h0, h1, h2}), -std::max({h0, h1, h2}));
    return least > 0.0 && least * least > distance * distance * normal.squaredNorm();
  }

  /// Whether a direction shows the triangles to be farther apart than `distance`: that of the point of their
  /// difference nearest to the origin, as far as it is known [Gilbert 1966]. Slivers that fan out side by
  /// side lie in one plane, which separates nothing.
  static bool parted(const TrianglePoints& a, const TrianglePoints& b, double distance) noexcept {
    const auto lowest = [](const TrianglePoints& t, const Vec3& along) -> const Vec3& {
      const double h[] = {along.dot(t[0]), along.dot(t[1]), along.dot(t[2])};
      return t[static_cast<std::size_t>(std::min_element(h, h + 3) - h)];
    };
    Vec3 x = (a[0] + a[1] + a[2] - b[0] - b[1] - b[2]) / 3.0;
    for (int step = 0; step < kDirections; ++step) {
      const double near_sq = distance * distance * x.squaredNorm();
      const Vec3 lowest_of_difference = lowest(a, x) - lowest(b, -x);
      const double apart = x.dot(lowest_of_difference);
      if (apart > 0.0 && apart * apart > near_sq) return true;
      const Vec3 direction = lowest_of_difference - x;
      const double share = std::min(1.0, -x.dot(direction) / direction.squaredNorm());
      if (!(share > 0.0)) return false;
      x += share * direction;
    }
    return false;
  }

  void test(int triangle_a, int triangle_b) noexcept {
    ++best_.triangles_tested;
    const TrianglePoints& a = a_.triangle(triangle_a);
    const TrianglePoints b = moved(triangle_b);
    const double beyond = best_.distance + touching_;
    if (plane_parts(a, b, beyond) || plane_parts(b, a, beyond) || parted(a, b, beyond)) return;
    const PointPair nearest = triangle_distance(a, b);
    const double distance = std::sqrt(nearest.distance_sq);
    const bool touches = distance <= touching_ || triangles_cross(a, b);
    if (!touches && distance >= best_.distance) return;
    best_.distance = touches ? 0.0 : distance;
    best_.p_a = nearest.p_a;
    best_.p_b = nearest.p_b;
    best_.triangle_a = triangle_a;
    best_.triangle_b = triangle_b;
  }

  void count_touching() noexcept {
    best_.touching_pairs = 0;
    for_each_pair_within(a_.bvh(), b_.bvh(), frame_.X_AB, touching_, [this](int triangle_a, int triangle_b) {
      const TrianglePoints& a = a_.triangle(triangle_a);
      const TrianglePoints b = moved(triangle_b);
      if (plane_parts(a, b, touching_) || plane_parts(b, a, touching_)) return true;
      const bool touches =
          triangles_cross(a, b) || triangle_distance(a, b).distance_sq <= touching_ * touching_;
      best_.touching_pairs += touches ? 1 : 0;
      return true;
    });
  }

  const Bvh::Node& node_a(std::int32_t i) const noexcept {
    return a_.bvh().nodes()[static_cast<std::size_t>(i)];
  }
  const Bvh::Node& node_b(std::int32_t i) const noexcept {
    return b_.bvh().nodes()[static_cast<std::size_t>(i)];
  }

  const Surface& a_;
  const Surface& b_;
  BoxPairFrame frame_;
  double touching_;           ///< distances up to here are rounding [m]
  Vec3 centre_a_, centre_b_;  ///< of the region tested, in either frame [m]
  double radius_ = kNone;     ///< [m]
  SurfaceDistance best_;
};

}  // namespace

Surface::Surface(const TriangleMesh& mesh) : size_(bounds(mesh.vertices).diagonal()) {
  std::vector<Aabb> boxes;
  boxes.reserve(mesh.triangles.size());
  triangles_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    triangles_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    Aabb box;
    for (const Vec3& corner : triangles_.back()) box.extend(corner);
    boxes.push_back(box);
  }
  bvh_ = Bvh(boxes);
}

SurfaceDistance surface_distance(const Surface& a, const Surface& b, const Pose& X_AB,
                                 SurfacePairCache& cache, TouchingPairs touching) noexcept {
  const SurfaceDistance result = DistanceQuery(a, b, X_AB).run(cache, touching);
  cache = {result.triangle_a, result.triangle_b};
  return result;
}

}  // namespace tactum::inline v0_1
