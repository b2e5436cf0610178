#include "tactum/collision/surface_minima_bounds.h"

#include <algorithm>

namespace tactum::lanes {
namespace {

constexpr float kRightAngle = 1.57F;  // a little less

Pad pad_of(float cone, const Bounds& q) noexcept {
  const float width = cone + q.slack;
  const bool leans = width < kRightAngle;
  return {std::min(width, 1.0F) * q.far, leans ? q.reach : q.far, leans ? q.depth : q.far};
}

Three at(const Lanes3& v, std::size_t lane) noexcept { return {v[0][lane], v[1][lane], v[2][lane]}; }

Three cross(const Three& a, const Three& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

Frame::Frame(const Pose& X) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) R[i][j] = static_cast<float>(X.R(int(i), int(j)));
    p[i] = static_cast<float>(X.p[int(i)]);
  }
}

Box box_of(const SurfaceTree::Node& node, std::size_t lane, const Bounds& q) noexcept {
  const Three up = at(node.up, lane);
  const Three along = at(node.along, lane);
  const float cone = node.cone[lane];
  return {at(node.center, lane), {along, cross(up, along), up}, at(node.half, lane), cone, pad_of(cone, q)};
}

Box box_of(const SurfaceTree::Node& node, std::size_t lane, const Bounds& q, const Frame& frame) noexcept {
  const Three up = frame.turned(at(node.up, lane));
  const Three along = frame.turned(at(node.along, lane));
  const float cone = node.cone[lane];
  return {frame.moved(at(node.center, lane)),
          {along, cross(up, along), up},
          at(node.half, lane),
          cone,
          pad_of(cone, q)};
}

}  // namespace tactum::lanes
