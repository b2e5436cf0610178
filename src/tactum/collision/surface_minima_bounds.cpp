#include "tactum/collision/surface_minima_bounds.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::lanes {
namespace {

constexpr float kRightAngle = 1.57F;  // a little less

/// Four of the lanes, from `first` on. The most telling axes come first: mostly no lane is left before the
/// others.
std::uint32_t facing_four(const Box& box, const SurfaceTree::Node& node, std::size_t first,
                          const Bounds& q) noexcept {
  std::array<std::array<Float4, 3>, 3> R;  // axes of the box along those of the lanes
  std::array<Vector4, 3> axis;
  axis[2] = load(node.axis[2], first);
  R[2][2] = dot(all(box.axis[2]), axis[2]);
  const Float4 cone = load(&node.cone[first]);
  const Float4 sum = cone + all(box.cone + 2.0F * q.slack);
  Int4 fine = 2.0F + 2.0F * R[2][2] <= sum * sum + float(tolerances::kSingle);
  if (bits(fine) == 0) return 0;

  const Vector4 off = all(box.center) - load(node.center, first);
  const Float4 width = cone + all(q.slack);
  const Int4 leans = width < kRightAngle;
  // How far the box reaches along an axis of the lanes, and the lanes along one of the box.
  const auto box_reach = [&](std::size_t j) {
    return absolute(R[0][j]) * box.half[0] + absolute(R[1][j]) * box.half[1] +
           absolute(R[2][j]) * box.half[2] + load(&node.half[j][first]);
  };
  const auto lane_reach = [&](std::size_t i) {
    return absolute(R[i][0]) * load(&node.half[0][first]) + absolute(R[i][1]) * load(&node.half[1][first]) +
           absolute(R[i][2]) * load(&node.half[2][first]) + box.half[i];
  };
  R[0][2] = dot(all(box.axis[0]), axis[2]);
  R[1][2] = dot(all(box.axis[1]), axis[2]);
  const Float4 height = dot(off, axis[2]);
  const Float4 thick = box_reach(2);
  fine &= (height <= thick + (leans ? all(q.reach) : all(q.far))) &
          (-height <= thick + (leans ? all(q.depth) : all(q.far)));
  if (bits(fine) == 0) return 0;

  const Pad pad = pad_of(box.cone, q);
  for (std::size_t j = 0; j < 2; ++j) {
    axis[j] = load(node.axis[j], first);
    R[2][j] = dot(all(box.axis[2]), axis[j]);
  }
  const Float4 depth = dot(off, all(box.axis[2]));
  const Float4 deep = lane_reach(2);
  fine &= (-depth <= deep + pad.above) & (depth <= deep + pad.below);
  if (bits(fine) == 0) return 0;

  const Float4 side = smaller(width, all(1.0F)) * q.far;
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 2; ++i) R[i][j] = dot(all(box.axis[i]), axis[j]);
    fine &= absolute(dot(off, axis[j])) <= box_reach(j) + side;
  }
  for (std::size_t i = 0; i < 2; ++i)
    fine &= absolute(dot(off, all(box.axis[i]))) <= lane_reach(i) + pad.side;
  return bits(fine) << first;
}

}  // namespace

Frame::Frame(const Pose& X) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) R[i][j] = static_cast<float>(X.R(int(i), int(j)));
    p[i] = static_cast<float>(X.p[int(i)]);
  }
}

Pad pad_of(float cone, const Bounds& q) noexcept {
  const float width = cone + q.slack;
  const bool leans = width < kRightAngle;
  return {std::min(width, 1.0F) * q.far, leans ? q.reach : q.far, leans ? q.depth : q.far};
}

Box box_of(const SurfaceTree::Node& node, std::size_t lane) noexcept {
  const auto at = [&](const SurfaceTree::Lanes3& v) { return Three{v[0][lane], v[1][lane], v[2][lane]}; };
  return {at(node.center),
          {at(node.axis[0]), at(node.axis[1]), at(node.axis[2])},
          at(node.half),
          node.cone[lane]};
}

Box moved(const Box& box, const Frame& frame) noexcept {
  return {frame.moved(box.center),
          {frame.turned(box.axis[0]), frame.turned(box.axis[1]), frame.turned(box.axis[2])},
          box.half,
          box.cone};
}

std::uint32_t facing(const Box& box, const SurfaceTree::Node& node, const Bounds& q) noexcept {
  std::uint32_t there = 0;
  for (std::size_t k = 0; k < kLanes; ++k) there |= std::uint32_t(node.child[k] != 0) << k;
  return (facing_four(box, node, 0, q) | facing_four(box, node, 4, q)) & there;
}

}  // namespace tactum::lanes
