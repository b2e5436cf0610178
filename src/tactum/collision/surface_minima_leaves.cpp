#include "tactum/collision/surface_minima_leaves.h"

#include <algorithm>

namespace tactum::lanes {
namespace {

constexpr float kNowhere = 1e18F;  // where lanes without a feature are put

void put(SurfaceTree::Lanes3& lanes, std::size_t lane, const Vec3& v) noexcept {
  lanes[0][lane] = static_cast<float>(v.x());
  lanes[1][lane] = static_cast<float>(v.y());
  lanes[2][lane] = static_cast<float>(v.z());
}
/// Calls put(lane, triangle's corners, first corner) for the features there are; the others are put nowhere.
template <class Put>
void for_each_feature(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, Put&& put_one) noexcept {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::int32_t corner = leaf.corner[lane];
    if (corner < 0) break;
    put_one(lane, tree.triangle(corner / 3), std::size_t(corner) % 3);
  }
}

void put_nowhere(const SurfaceTree::Leaf& leaf, SurfaceTree::Lanes3& lanes) noexcept {
  for (std::size_t lane = kLanes; lane > 0 && leaf.corner[lane - 1] < 0; --lane) {
    for (SurfaceTree::Lanes& axis : lanes) axis[lane - 1] = kNowhere;
  }
}

/// A test of four lanes, twice.
template <class Test>
std::uint32_t both_halves(Test&& test) noexcept {
  return bits(test(std::size_t(0))) | bits(test(std::size_t(4))) << 4u;
}

/// Whether points r from the starts of lines along w are within `reach` of the lines.
Int4 near_line(const Vector4& r, const Vector4& w, Float4 reach) noexcept {
  const Vector4 off = cross(r, w);
  return dot(off, off) <= reach * reach * dot(w, w);
}

void turn(SurfaceTree::Lanes3& v, const Frame& frame) noexcept {
  for (std::size_t first = 0; first < kLanes; first += 4) {
    const Vector4 from = load(v, first);
    store({dot(all(frame.R[0]), from), dot(all(frame.R[1]), from), dot(all(frame.R[2]), from)}, v, first);
  }
}

/// Segments, told from the box's center, by their middles and halves.
Int4 in_box(const Vector4& middle, const Vector4& half, const Box& box, const Bounds& q) noexcept {
  const Pad pad = pad_of(box.cone, q);
  Int4 fine = {-1, -1, -1, -1};
  for (std::size_t i = 0; i < 2; ++i) {
    fine &= absolute(dot(middle, all(box.axis[i]))) <=
            box.half[i] + pad.side + absolute(dot(half, all(box.axis[i])));
  }
  const Float4 height = dot(middle, all(box.axis[2]));
  const Float4 thick = box.half[2] + absolute(dot(half, all(box.axis[2])));
  return fine & (height <= thick + pad.above) & (-height <= thick + pad.below);
}

}  // namespace

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Vertices& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  put_nowhere(leaf, lanes.point);
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t k) {
    put(lanes.point, lane, tree.vertex(t[k]) - from);
  });
}

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Edges& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  put_nowhere(leaf, lanes.point);
  put_nowhere(leaf, lanes.along);
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t k) {
    const Vec3& p = tree.vertex(t[k]);
    put(lanes.point, lane, p - from);
    put(lanes.along, lane, tree.vertex(t[(k + 1) % 3]) - p);
  });
}

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Faces& lanes) noexcept {
  const Vec3 from = tree.center() + middle;
  put_nowhere(leaf, lanes.normal);
  for (SurfaceTree::Lanes3& corner : lanes.corner) put_nowhere(leaf, corner);
  for_each_feature(tree, leaf, [&](std::size_t lane, const Triangle& t, std::size_t) {
    for (std::size_t i = 0; i < 3; ++i) put(lanes.corner[i], lane, tree.vertex(t[i]) - from);
    const Three& normal = tree.normal(leaf.corner[lane] / 3);
    for (std::size_t i = 0; i < 3; ++i) lanes.normal[i][lane] = normal[i];
  });
}

void turn(Vertices& lanes, const Frame& frame) noexcept { turn(lanes.point, frame); }

void turn(Edges& lanes, const Frame& frame) noexcept {
  turn(lanes.point, frame);
  turn(lanes.along, frame);
}

std::uint32_t near_box(const Vertices& lanes, const Three& off, const Box& box, const Bounds& q) noexcept {
  return both_halves([&](std::size_t first) {
    return in_box(load(lanes.point, first) + all(off), {all(0.0F), all(0.0F), all(0.0F)}, box, q);
  });
}

std::uint32_t near_box(const Edges& lanes, const Three& off, const Box& box, const Bounds& q) noexcept {
  return both_halves([&](std::size_t first) {
    const Vector4 along = load(lanes.along, first);
    const Vector4 half = {0.5F * along.x, 0.5F * along.y, 0.5F * along.z};
    return in_box(load(lanes.point, first) + all(off) + half, half, box, q);
  });
}

std::uint32_t near_vertex(const Three& point, const Vertices& lanes, const Bounds& q) noexcept {
  return both_halves([&](std::size_t first) {
    const Vector4 r = all(point) - load(lanes.point, first);
    return Int4(dot(r, r) <= all(q.reach * q.reach));
  });
}

std::uint32_t near_vertex(const Three& point, const Edges& lanes, const Bounds& q) noexcept {
  return both_halves([&](std::size_t first) {
    const Vector4 w = load(lanes.along, first);
    const Vector4 r = all(point) - load(lanes.point, first);
    const Float4 at = dot(r, w);
    const Float4 pad = q.grown * at_most(w);
    return (at >= -pad) & (at <= dot(w, w) + pad) & near_line(r, w, all(q.reach));
  });
}

std::uint32_t near_vertex(const Three& point, const Faces& lanes, const Bounds& q) noexcept {
  return both_halves([&](std::size_t first) {
    const Vector4 n = load(lanes.normal, first);
    const std::array<Vector4, 3> corner = {load(lanes.corner[0], first), load(lanes.corner[1], first),
                                           load(lanes.corner[2], first)};
    const Float4 height = dot(all(point) - corner[0], n);
    Int4 fine = (height <= q.reach) & (height >= -q.depth);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector4 inward = cross(n, corner[(k + 1) % 3] - corner[k]);
      fine &= dot(inward, all(point) - corner[k]) >= -q.grown * at_most(inward);
    }
    return fine;
  });
}

std::uint32_t near_edge(const Three& point, const Three& along, const Edges& lanes,
                        const Bounds& q) noexcept {
  // Below this sine single precision cannot tell where lines come nearest; their distance alone is asked.
  const float parallel = std::max(1.01F * q.slack, 0.01F);
  return both_halves([&](std::size_t first) {
    const Vector4 u = all(along);
    const Vector4 w = load(lanes.along, first);
    const Vector4 r = load(lanes.point, first) - all(point);
    const Vector4 c = cross(u, w);
    const Float4 sine_sq = dot(c, c);
    const Float4 height = dot(r, c);
    const Int4 together = (sine_sq <= parallel * parallel * dot(u, u) * dot(w, w)) &
                          near_line(r, u, q.far + parallel * at_most(w));
    const Int4 level = height * height <= q.far * q.far * sine_sq;
    if (bits(level) == 0) return together;
    const Float4 on_u = dot(cross(r, w), c);
    const Float4 on_w = dot(cross(r, u), c);
    const Float4 length = q.grown * at_most(c);
    const Float4 pad_u = length * at_most(w);
    const Float4 pad_w = length * at_most(u);
    return Int4(together | (level & (on_u >= -pad_u) & (on_u <= sine_sq + pad_u) & (on_w >= -pad_w) &
                            (on_w <= sine_sq + pad_w)));
  });
}

}  // namespace tactum::lanes
