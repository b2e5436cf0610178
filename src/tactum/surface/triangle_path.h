#pragma once
/// Two triangles of which one moves: whether they stay apart, quickly, and how far exactly. Used by
/// surface_path.h for the pairs that its tests of eight leave.

#include <algorithm>
#include <cmath>

#include "tactum/math/path_search.h"
#include "tactum/math/relative_motion.h"
#include "tactum/surface/triangle_pair.h"

namespace tactum::inline v0_1 {

/// What becomes of triangles that touch or cross at the start of a motion.
enum class StartContact {
  kStays,   ///< they touch, and come no nearer
  kNearer,  ///< they touch, and may come nearer
  kCrossed  ///< they have crossed already
};

/// Two triangles, of which that of B moves (path_search.h).
class TrianglePairPath {
 public:
  TrianglePairPath(const TrianglePoints& a, const TrianglePoints& b_B, const RelativeMotion& motion,
                   double touching) noexcept
      : a_(a), b_B_(b_B), motion_(motion), touching_(touching) {}

  TrianglePoints b_at(double s) const noexcept {
    const Pose X_AB = motion_.at(s);
    return {X_AB * b_B_[0], X_AB * b_B_[1], X_AB * b_B_[2]};
  }
  Vec3 direction(double s) noexcept {
    const TrianglePoints b = b_at(s);
    const PointPair nearest = triangle_distance(a_, b);
    if (nearest.distance_sq <= touching_ * touching_ || triangles_cross(a_, b)) return Vec3::Zero();
    return (nearest.p_a - nearest.p_b) / std::sqrt(nearest.distance_sq);
  }
  double gap(const Vec3& n, double s) const noexcept { return gap(n, b_at(s)); }
  double gap(const Vec3& n, const TrianglePoints& b) const noexcept {
    return std::min({n.dot(a_[0]), n.dot(a_[1]), n.dot(a_[2])}) -
           std::max({n.dot(b[0]), n.dot(b[1]), n.dot(b[2])});
  }
  Vec3 turned(const Vec3& n, double from, double to) const noexcept {
    return rotated(motion_.at(to).R, rotated_back(motion_.at(from).R, n));
  }
  double turn() const noexcept { return motion_.by.w.norm(); }
  double curving(const Vec3& n) const noexcept {
    const TrianglePoints b = b_at(0.0);
    return std::max(
        {motion_.curving(n, b[0], 0.0), motion_.curving(n, b[1], 0.0), motion_.curving(n, b[2], 0.0)});
  }
  /// Of triangles that touch or cross at the start. They come no nearer where they do not along a direction
  /// that parts them and stays with either of the two.
  StartContact start_contact() const noexcept {
    const TrianglePoints from = b_at(0.0);
    const TrianglePoints to = b_at(1.0);
    bool touch = false;
    const auto parts = [&](Vec3 n) {
      const double length = n.norm();
      if (!(length > 0.0)) return false;
      n /= length;
      for (const double sign : {1.0, -1.0}) {
        const double start = gap(sign * n, from);
        if (start < -touching_) continue;
        touch = true;
        if (gap(sign * n, to) >= start || gap(turned(sign * n, 0.0, 1.0), to) >= start) return true;
      }
      return false;
    };
    if (parts(normal_of(a_)) || parts(normal_of(from))) return StartContact::kStays;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (parts((a_[(i + 1) % 3] - a_[i]).cross(from[(k + 1) % 3] - from[k]))) return StartContact::kStays;
    return touch ? StartContact::kNearer : StartContact::kCrossed;
  }
  static Vec3 normal_of(const TrianglePoints& t) noexcept { return (t[1] - t[0]).cross(t[2] - t[0]); }

 private:
  const TrianglePoints& a_;
  const TrianglePoints& b_B_;
  const RelativeMotion& motion_;
  double touching_;
};

/// A triangle of either surface in A's frame, at the start and at the end, in double precision.
struct PathTriangle {
  int number = -1;
  TrianglePoints own;   ///< in its own frame
  TrianglePoints from;  ///< in A's frame at the start
  TrianglePoints to;    ///< ... and at the end
  double arm = 0.0;     ///< a bound of the distance from the pivot [m]
};

/// Whether a direction shows that a triangle and the six corners of another, at the start and at the end, are
/// farther apart than the turn can take the other from the lines between them: that of the point of their
/// difference nearest to the origin, as far as it is known [Gilbert 1966].
class QuickPath {
 public:
  QuickPath(const PathTriangle& a, const PathTriangle& b, const RelativeMotion& motion) noexcept
      : a_(a),
        b_(b),
        w_(motion.by.w),
        sag_(motion.by.w.norm() > kHardlyTurns ? motion.by.w.norm() * b.arm / 8.0 : 0.0) {}

  bool parted() const noexcept {
    // Surfaces that face each other are parted along a normal, if by any direction.
    Vec3 x;
    const Vec3 n_a = TrianglePairPath::normal_of(a_.from).normalized();
    const Vec3 n_b = TrianglePairPath::normal_of(b_.from).normalized();
    for (const Vec3& n : {Vec3(-n_a), n_b, n_a, Vec3(-n_b), Vec3(n_b - n_a)})
      if (along(n, x)) return true;
    if (sag_ == 0.0 && by_turning_face()) return true;
    for (int step = 0; step < kDirections; ++step) {
      Vec3 nearest;
      if (along(x, nearest)) return true;
      const Vec3 direction = nearest - x;
      const double share = std::min(1.0, -x.dot(direction) / direction.squaredNorm());
      if (!(share > 0.0)) break;
      x += share * direction;
    }
    const PointPair nearest = triangle_distance(a_.from, b_.from);
    return along(nearest.p_a - nearest.p_b, x);
  }

 private:
  static constexpr int kDirections = 5;  // more lead nowhere: the nearest points are sought then

  /// Whether the plane of B's triangle, which turns with it, keeps A's corners on one side at both ends.
  bool by_turning_face() const noexcept {
    double low[2];
    double high[2];
    for (std::size_t end = 0; end < 2; ++end) {
      const TrianglePoints& b = end == 0 ? b_.from : b_.to;
      const Vec3 n = TrianglePairPath::normal_of(b);
      const double h[] = {n.dot(a_.from[0] - b[0]), n.dot(a_.from[1] - b[0]), n.dot(a_.from[2] - b[0])};
      low[end] = std::min({h[0], h[1], h[2]});
      high[end] = std::max({h[0], h[1], h[2]});
    }
    return (low[0] > 0.0 && low[1] > 0.0) || (high[0] < 0.0 && high[1] < 0.0);
  }
  /// Whether they are farther apart along n; and the point of the difference that is lowest along it.
  bool along(const Vec3& n, Vec3& lowest) const noexcept {
    const Vec3* of_a = &a_.from[0];
    double low = n.dot(*of_a);
    for (std::size_t i = 1; i < 3; ++i) {
      const double h = n.dot(a_.from[i]);
      if (h < low) of_a = &a_.from[i], low = h;
    }
    const Vec3* of_b = &b_.from[0];
    double high = n.dot(*of_b);
    for (const TrianglePoints* corners : {&b_.from, &b_.to}) {
      for (const Vec3& corner : *corners) {
        const double h = n.dot(corner);
        if (h > high) of_b = &corner, high = h;
      }
    }
    lowest = *of_a - *of_b;
    return low > high && low - high > sag_ * n.cross(w_).norm();
  }

  const PathTriangle& a_;
  const PathTriangle& b_;
  const Vec3& w_;
  double sag_;
};

}  // namespace tactum::inline v0_1
