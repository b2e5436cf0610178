#pragma once
/// A binary tree of boxes over the pieces of a part, in the part's frame, and the walk over two of them.
///
///   node i holds a box around all below it; an inner node's children are i + 1 and nodes[i].second;
///   a leaf holds order[first .. first + count).
///
/// Split by surface area over 16 bins per axis, by the median where that does not divide the items or the
/// tree gets too deep; so the depth is at most 64 and the walks keep fixed stacks. Building: n log n. Walks:
/// noexcept, no allocation.

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

class Bvh {
 public:
  static constexpr int kMaxDepth = 64;

  struct Node {
    Vec3 center = Vec3::Zero();  ///< of the box [m]
    Vec3 half = Vec3::Zero();    ///< half its sides [m]
    std::int32_t second =
        0;  ///< inner: the second child (the first is the next node); leaf: first place in order
    std::int32_t count = 0;  ///< 0 for inner nodes, number of items for leaves

    bool leaf() const noexcept { return count > 0; }
  };

  Bvh() = default;
  /// Builds the tree over boxes that are not empty. Deterministic; the same for any number of threads.
  explicit Bvh(const std::vector<Aabb>& boxes, int leaf_size = 1, int threads = 1);

  const std::vector<Node>& nodes() const noexcept { return nodes_; }
  /// The items in leaf order.
  const std::vector<std::int32_t>& order() const noexcept { return order_; }
  bool empty() const noexcept { return nodes_.empty(); }

 private:
  std::vector<Node> nodes_;
  std::vector<std::int32_t> order_;
};

/// B's boxes in A's frame: the rotation and its absolute values, grown so that rounding separates nothing.
struct BoxPairFrame {
  Pose X_AB;
  Mat3 abs_R = Mat3::Identity();
  explicit BoxPairFrame(const Pose& X) noexcept : X_AB(X) {
    abs_R = X.R.cwiseAbs();
    abs_R.array() += tolerances::kBoxMargin;
  }
};

/// The squared distance of A's box from B's bounding box in A's axes [m^2], and the other way round; `t`
/// leads from A's centre to B's, in A's axes.
inline double squared_gap_in_a(const BoxPairFrame& frame, const Bvh::Node& a, const Bvh::Node& b,
                               const Vec3& t) noexcept {
  return (t.cwiseAbs() - a.half - frame.abs_R * b.half).cwiseMax(0.0).squaredNorm();
}
inline double squared_gap_in_b(const BoxPairFrame& frame, const Bvh::Node& a, const Bvh::Node& b,
                               const Vec3& t) noexcept {
  const Vec3 t_B = frame.X_AB.R.transpose() * t;
  return (t_B.cwiseAbs() - b.half - frame.abs_R.transpose() * a.half).cwiseMax(0.0).squaredNorm();
}

/// A lower bound of the distance of two boxes [m]: each box's distance from the other's bounding box in its
/// own axes, the larger of the two; zero when neither axis separates them.
inline double box_gap(const BoxPairFrame& frame, const Bvh::Node& a, const Bvh::Node& b) noexcept {
  const Vec3 t = frame.X_AB * b.center - a.center;
  return std::sqrt(std::max(squared_gap_in_a(frame, a, b, t), squared_gap_in_b(frame, a, b, t)));
}

/// Whether some cross product of edges separates the boxes by more than `tolerance`. To be called after
/// their own axes have been tried.
inline bool parted_by_edges(const BoxPairFrame& frame, const Bvh::Node& a, const Bvh::Node& b, const Vec3& t,
                            double tolerance) noexcept {
  const Mat3& R = frame.X_AB.R;
  const Mat3& abs_R = frame.abs_R;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      const double extent = a.half[i1] * abs_R(i2, j) + a.half[i2] * abs_R(i1, j) +
                            b.half[j1] * abs_R(i, j2) + b.half[j2] * abs_R(i, j1);
      // The axis is no longer than one, so the tolerance is counted in full or more.
      if (std::abs(t[i2] * R(i1, j) - t[i1] * R(i2, j)) > extent + tolerance) return true;
    }
  }
  return false;
}

/// Whether the boxes may come within `tolerance` [m]; never false when they do.
inline bool boxes_within(const BoxPairFrame& frame, const Bvh::Node& a, const Bvh::Node& b,
                         double tolerance) noexcept {
  const double squared = tolerance * tolerance;
  const Vec3 t = frame.X_AB * b.center - a.center;
  return squared_gap_in_a(frame, a, b, t) <= squared && squared_gap_in_b(frame, a, b, t) <= squared &&
         !parted_by_edges(frame, a, b, t, tolerance);
}

/// Calls visit(item_a, item_b) for every pair of items whose leaf boxes may be within `tolerance` [m] at
/// X_AB: all pairs that are, and some that are not. The visitor returns false to stop. Returns false when
/// stopped.
template <class Visitor>
bool for_each_pair_within(const Bvh& bvh_a, const Bvh& bvh_b, const Pose& X_AB, double tolerance,
                          Visitor&& visit) noexcept {
  if (bvh_a.empty() || bvh_b.empty()) return true;
  const BoxPairFrame frame(X_AB);
  struct Pair {
    std::int32_t a, b;
  };
  // Each step takes one pair and puts two, one level further down; filled as far as it is used.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  std::array<Pair, 2 * Bvh::kMaxDepth + 2> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Pair pair = stack[--size];
    const Bvh::Node& a = bvh_a.nodes()[static_cast<std::size_t>(pair.a)];
    const Bvh::Node& b = bvh_b.nodes()[static_cast<std::size_t>(pair.b)];
    if (!boxes_within(frame, a, b, tolerance)) continue;
    if (a.leaf() && b.leaf()) {
      for (std::int32_t i = a.second; i < a.second + a.count; ++i) {
        for (std::int32_t k = b.second; k < b.second + b.count; ++k) {
          if (!visit(bvh_a.order()[static_cast<std::size_t>(i)], bvh_b.order()[static_cast<std::size_t>(k)]))
            return false;
        }
      }
    } else if (b.leaf() || (!a.leaf() && a.half.squaredNorm() >= b.half.squaredNorm())) {
      stack[size++] = {a.second, pair.b};
      stack[size++] = {pair.a + 1, pair.b};
    } else {
      stack[size++] = {pair.a, b.second};
      stack[size++] = {pair.a, pair.b + 1};
    }
  }
  return true;
}

}  // namespace tactum::inline v0_1
