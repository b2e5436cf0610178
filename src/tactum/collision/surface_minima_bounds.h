#pragma once
/// Which of the eight boxes of a node may hold an end of a minimum whose other end is in a given box.

#include "tactum/collision/surface_minima_lanes.h"
#include "tactum/math/pose.h"

namespace tactum::lanes {

/// What every quick test needs of the query, grown so that rounding loses nothing.
struct Bounds {
  float reach, depth, far;  ///< far: the larger of the two [m]
  float slack;              ///< of one cone [rad]
  float grown;              ///< by which lengths are grown [m]
};

/// The pose of one tree's centre in the other's, in single precision.
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

/// How far the other end of a minimum may be from a box or a feature, along its axes: a minimum is as long as
/// the reach along a direction in both cones, so within narrow ones it hardly leans to the side, and it never
/// starts behind the surface by more than the depth.
struct Pad {
  float side;          ///< along the first two axes [m]
  float above, below;  ///< before and behind the surface [m]
};
Pad pad_of(float cone, const Bounds& q) noexcept;

/// One lane of a node, in its own tree's frame or the other's.
struct Box {
  Three center;
  std::array<Three, 3> axis;
  Three half;
  float cone;
};
Box box_of(const SurfaceTree::Node& node, std::size_t lane) noexcept;
Box moved(const Box& box, const Frame& frame) noexcept;

/// A bit for each lane whose cones face those of the box, and whose box overlaps the other along the axes of
/// either when padded.
std::uint32_t facing(const Box& box, const SurfaceTree::Node& node, const Bounds& q) noexcept;

}  // namespace tactum::lanes
