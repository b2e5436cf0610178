#pragma once
/// Boxes of a surface_tree.h in the other tree's frame.

#include "tactum/collision/surface_minima_lanes.h"
#include "tactum/math/pose.h"

namespace tactum::lanes {

/// The pose of one tree's center in the other's, in single precision.
struct Frame {
  std::array<Three, 3> R;
  Three p;
  explicit Frame(const Pose& X) noexcept;
  Three turned(const Three& v) const noexcept {
    return {R[0][0] * v[0] + R[0][1] * v[1] + R[0][2] * v[2],
            R[1][0] * v[0] + R[1][1] * v[1] + R[1][2] * v[2],
            R[2][0] * v[0] + R[2][1] * v[1] + R[2][2] * v[2]};
  }
  Three moved(const Three& v) const noexcept {
    const Three t = turned(v);
    return {t[0] + p[0], t[1] + p[1], t[2] + p[2]};
  }
};

/// A lane of a node, in its own tree's frame or the other's.
Box box_of(const SurfaceTree::Node& node, std::size_t lane, const Bounds& q) noexcept;
Box box_of(const SurfaceTree::Node& node, std::size_t lane, const Bounds& q, const Frame& frame) noexcept;

}  // namespace tactum::lanes
