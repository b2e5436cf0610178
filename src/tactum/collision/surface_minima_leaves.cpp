#include "tactum/collision/surface_minima_leaves.h"

#include <cmath>

namespace tactum::lanes {
namespace {

constexpr float kNowhere = 1e18F;  // where lanes without a feature are put

void put(Lanes3& lanes, std::size_t lane, const Vec3& v) noexcept {
  lanes[0][lane] = static_cast<float>(v.x());
  lanes[1][lane] = static_cast<float>(v.y());
  lanes[2][lane] = static_cast<float>(v.z());
}
void put_all(Lanes3& lanes, float value) noexcept {
  for (Lanes& axis : lanes) axis.fill(value);
}

/// Calls put_one(lane, triangle's corners, first corner) for the features there are.
template <class Put>
void for_each_feature(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, Put&& put_one) noexcept {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::int32_t corner = leaf.corner[lane];
    if (corner < 0) break;
    put_one(lane, tree.triangle(corner / 3), std::size_t(corner) % 3);
  }
}
bool partly_filled(const SurfaceTree::Leaf& leaf) noexcept { return leaf.corner[kLanes - 1] < 0; }

float dot_at(const Lanes3& a, const Lanes3& b, std::size_t i) noexcept {
  return a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
}

/// The planes of faces with these corners and normals.
void put_planes(const std::array<Lanes3, 3>& corner, const Bounds& q, Faces& lanes) noexcept {
  for (std::size_t i = 0; i < kLanes; ++i) lanes.level[i] = dot_at(lanes.normal, corner[0], i);
  const Lanes3& n = lanes.normal;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes3& from = corner[k];
    const Lanes3& to = corner[(k + 1) % 3];
    Lanes3& inward = lanes.inward[k];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Three side = {to[0][i] - from[0][i], to[1][i] - from[1][i], to[2][i] - from[2][i]};
      inward[0][i] = n[1][i] * side[2] - n[2][i] * side[1];
      inward[1][i] = n[2][i] * side[0] - n[0][i] * side[2];
      inward[2][i] = n[0][i] * side[1] - n[1][i] * side[0];
      const float length = std::abs(inward[0][i]) + std::abs(inward[1][i]) + std::abs(inward[2][i]);
      lanes.limit[k][i] = dot_at(inward, from, i) - q.grown * length;
    }
  }
}

void turn(Lanes3& v, const Frame& frame) noexcept {
  const auto& R = frame.R;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Three from = {v[0][i], v[1][i], v[2][i]};
    for (std::size_t k = 0; k < 3; ++k) v[k][i] = R[k][0] * from[0] + R[k][1] * from[1] + R[k][2] * from[2];
  }
}

}  // namespace

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               const Bounds& /*q*/, Vertices& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  if (partly_filled(leaf)) put_all(lanes.point, kNowhere);
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t k) {
    put(lanes.point, lane, tree.vertex(t[k]) - from);
  });
}

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               const Bounds& /*q*/, Edges& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  if (partly_filled(leaf)) {
    put_all(lanes.point, kNowhere);
    put_all(lanes.along, kNowhere);
  }
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t k) {
    const Vec3& p = tree.vertex(t[k]);
    put(lanes.point, lane, p - from);
    put(lanes.along, lane, tree.vertex(t[(k + 1) % 3]) - p);
  });
}

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle, const Bounds& q,
               Faces& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  std::array<Lanes3, 3> corner{};
  if (partly_filled(leaf)) put_all(lanes.normal, 0.0F);
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t) {
    for (std::size_t i = 0; i < 3; ++i) put(corner[i], lane, tree.vertex(t[i]) - from);
    const Three& normal = tree.normal(leaf.corner[lane] / 3);
    for (std::size_t i = 0; i < 3; ++i) lanes.normal[i][lane] = normal[i];
  });
  put_planes(corner, q, lanes);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (leaf.corner[lane] < 0) lanes.level[lane] = kNowhere;
  }
}

void turn(Vertices& lanes, const Frame& frame) noexcept { turn(lanes.point, frame); }

void turn(Edges& lanes, const Frame& frame) noexcept {
  turn(lanes.point, frame);
  turn(lanes.along, frame);
}

void turn(Faces& lanes, const Frame& frame) noexcept {
  turn(lanes.normal, frame);
  for (Lanes3& inward : lanes.inward) turn(inward, frame);
}

}  // namespace tactum::lanes
