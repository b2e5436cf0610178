#include "tactum/surface/surface_path.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/surface/kept.h"
#include "tactum/surface/surface_path_lanes.h"
#include "tactum/surface/triangle_path.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using Tree = SurfaceTree;
constexpr Index kInNode = Tree::kLanes;
constexpr int kIntervalTests = 64;  // of one pair of triangles, in stretches of the motion
constexpr Index kPathStack = 512;   // eleven levels of each, seven more pairs a level

using lanes::EightBoxes;
using lanes::EightTriangles;
using lanes::OneBox;

OneBox one_of(const EightBoxes& boxes, Index lane) noexcept {
  OneBox one;
  one.off_line = boxes.off_line[lane];
  for (Index x = 0; x < 3; ++x) {
    for (Index i = 0; i < 3; ++i) one.axis[i][x] = boxes.axis[i][x][lane];
    one.half[x] = boxes.half[x][lane];
    one.center[x] = boxes.center[x][lane];
    one.moved[x] = boxes.moved[x][lane];
  }
  return one;
}

float square_of_radius(const EightBoxes& boxes, Index lane) noexcept {
  float sum = 0.0F;
  for (const Tree::Lanes& half : boxes.half) sum += half[lane] * half[lane];
  return sum;
}

/// A pose in single precision.
struct FloatPose {
  std::array<std::array<float, 3>, 3> R;  ///< rows
  std::array<float, 3> p;

  explicit FloatPose(const Pose& X) noexcept {
    for (Index i = 0; i < 3; ++i) {
      for (Index k = 0; k < 3; ++k) R[i][k] = float(X.R(int(i), int(k)));
      p[i] = float(X.p[int(i)]);
    }
  }
  float operator()(Index i, const std::array<float, 3>& v) const noexcept {
    return R[i][0] * v[0] + R[i][1] * v[1] + R[i][2] * v[2] + p[i];
  }
};

class PathWalk {
 public:
  PathWalk(const Tree& a, const Tree& b, const RelativeMotion& motion, int most, const RiddenSteps& ridden,
           const lanes::PathKernels& kernels) noexcept
      : a_(a),
        b_(b),
        motion_(motion),
        most_(most),
        ridden_(ridden),
        kernels_(kernels),
        touching_(tolerances::kTouching * std::max(a.size(), b.size())),
        grown_(float(tolerances::kSingle * (a.size() + b.size()))),
        X_end_(motion.at(1.0)),
        start_(between_centers(motion.X_AB)),
        end_(between_centers(X_end_)),
        turn_(motion.by.w.norm()),
        float_turn_{{float(motion.by.w.x()), float(motion.by.w.y()), float(motion.by.w.z())},
                    float(motion.by.w.squaredNorm())} {}

  SurfacePath run() noexcept {
    if (a_.root(Tree::kFaces) < 0 || b_.root(Tree::kFaces) < 0) return path_;
    // Filled as far as it is used: NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    std::array<Pair, kPathStack> stack;
    Index size = 0;
    stack[size++] = {std::uint32_t(kInNode) * std::uint32_t(a_.root(Tree::kFaces)),
                     std::uint32_t(kInNode) * std::uint32_t(b_.root(Tree::kFaces))};
    while (size > 0 && path_.free > 0.0) {
      if (++path_.tests > most_ || size + kInNode > kPathStack) {  // no tree is built so deep
        path_.complete = false;
        break;
      }
      const Pair pair = stack[--size];
      const Index i = pair.a % kInNode;
      const Index k = pair.b % kInNode;
      const EightBoxes& boxes_a = boxes_of_a(pair.a / kInNode);
      const EightBoxes& boxes_b = boxes_of_b(pair.b / kInNode);
      const std::int32_t child_a = a_.nodes()[pair.a / kInNode].child[i];
      const std::int32_t child_b = b_.nodes()[pair.b / kInNode].child[k];
      if (child_a < 0 && child_b < 0) {
        test_leaves(~child_a, one_of(boxes_a, i), ~child_b, one_of(boxes_b, k));
        continue;
      }
      const bool open_a =
          child_b < 0 || (child_a >= 0 && square_of_radius(boxes_a, i) >= square_of_radius(boxes_b, k));
      const auto opened = std::uint32_t(open_a ? child_a : child_b);
      const OneBox one = open_a ? one_of(boxes_b, k) : one_of(boxes_a, i);
      const EightBoxes& eight = open_a ? boxes_of_a(opened) : boxes_of_b(opened);
      std::uint32_t bits = kernels_.boxes(eight, !open_a, one, float_turn_, grown_);
      const Tree::Corners& child = (open_a ? a_ : b_).nodes()[opened].child;
      for (; bits != 0; bits &= bits - 1) {
        const auto lane = std::uint32_t(std::countr_zero(bits));
        if (child[lane] == 0) continue;
        const std::uint32_t below = std::uint32_t(kInNode) * opened + lane;
        stack[size++] = open_a ? Pair{below, pair.b} : Pair{pair.a, below};
      }
    }
    return path_;
  }

 private:
  /// A lane of a node, as its number among all, of either tree.
  struct Pair {
    std::uint32_t a, b;
  };

  const EightBoxes& boxes_of_a(std::uint32_t node) noexcept {
    return kept_a_.get(node, [&](EightBoxes& boxes) {
      const Tree::Node& from = a_.nodes()[node];
      boxes.axis = {from.at.up, from.at.along, from.at.across};
      boxes.half = {from.half[2], from.half[0], from.half[1]};
      boxes.center = from.at.center;
      for (Tree::Lanes& x : boxes.moved) x.fill(0.0F);
      boxes.off_line.fill(0.0F);
    });
  }
  const EightBoxes& boxes_of_b(std::uint32_t node) noexcept {
    return kept_b_.get(node, [&](EightBoxes& boxes) {
      const Tree::Node& from = b_.nodes()[node];
      boxes.half = {from.half[2], from.half[0], from.half[1]};
      const Mat3& R = motion_.X_AB.R;
      const Vec3 p = motion_.X_AB * b_.center() - a_.center();
      const Vec3 from_pivot = a_.center() - motion_.pivot;
      for (Index l = 0; l < kInNode; ++l) {
        const auto put = [l](const Vec3& v, Tree::Lanes3& into) {
          for (Index x = 0; x < 3; ++x) into[x][l] = float(v[int(x)]);
        };
        const auto turned = [&](const Tree::Lanes3& v) {
          return rotated(R, Vec3(v[0][l], v[1][l], v[2][l]));
        };
        put(turned(from.at.up), boxes.axis[0]);
        put(turned(from.at.along), boxes.axis[1]);
        put(turned(from.at.across), boxes.axis[2]);
        const Vec3 center = turned(from.at.center) + p;
        put(center, boxes.center);
        const Vec3 arm = center + from_pivot;
        put(velocity_at(motion_.by, arm), boxes.moved);
        const double radius = Vec3(from.half[0][l], from.half[1][l], from.half[2][l]).norm();
        boxes.off_line[l] = float(radius + 0.5 * turn_ * (arm.norm() + radius));
      }
    });
  }

  /// From the center of B's mesh to that of A's.
  FloatPose between_centers(const Pose& X_AB) const noexcept {
    return FloatPose({X_AB.R, X_AB * b_.center() - a_.center()});
  }
  /// The triangles of a leaf: of A as they stand, `start` and `end` null, of B at both.
  static void gather(const Tree& tree, std::int32_t number, const FloatPose* start, const FloatPose* end,
                     EightTriangles& into) noexcept {
    const Vec3 center = tree.center();
    std::int32_t last = -1;
    for (Index l = 0; l < kInNode; ++l) {
      const std::int32_t corner = tree.leaves()[Index(number)][l];
      last = corner >= 0 ? corner : last;
      const Triangle& corners = tree.triangle(last / 3);
      std::array<std::array<float, 3>, 3> from;
      for (Index c = 0; c < 3; ++c) {
        const Vec3 v = tree.vertex(int(corners[c])) - center;
        const std::array<float, 3> own = {float(v.x()), float(v.y()), float(v.z())};
        for (Index x = 0; x < 3; ++x) {
          from[c][x] = start != nullptr ? (*start)(x, own) : own[x];
          into.corner[c][x][l] = from[c][x];
          into.corner[c + 3][x][l] = end != nullptr ? (*end)(x, own) : own[x];
        }
      }
      for (Index x = 0; x < 3; ++x) {
        const Index y = (x + 1) % 3;
        const Index z = (x + 2) % 3;
        into.normal[x][l] = (from[1][y] - from[0][y]) * (from[2][z] - from[0][z]) -
                            (from[1][z] - from[0][z]) * (from[2][y] - from[0][y]);
      }
      const float length =
          std::sqrt(into.normal[0][l] * into.normal[0][l] + into.normal[1][l] * into.normal[1][l] +
                    into.normal[2][l] * into.normal[2][l]);
      for (Tree::Lanes& x : into.normal) x[l] /= std::max(length, 1e-30F);
    }
  }
  /// A bit for each triangle of a leaf.
  static std::uint32_t used(const Tree& tree, std::int32_t leaf) noexcept {
    std::uint32_t bits = 0;
    for (Index l = 0; l < kInNode; ++l) bits |= (tree.leaves()[Index(leaf)][l] >= 0 ? 1U : 0U) << l;
    return bits;
  }
  PathTriangle triangle_of(const Tree& tree, bool moves, std::int32_t leaf, Index lane) const noexcept {
    PathTriangle t;
    t.number = tree.leaves()[Index(leaf)][lane] / 3;
    const Triangle& corners = tree.triangle(t.number);
    double arm_sq = 0.0;
    for (Index c = 0; c < 3; ++c) {
      t.own[c] = tree.vertex(int(corners[c]));
      t.from[c] = moves ? motion_.X_AB * t.own[c] : t.own[c];
      t.to[c] = moves ? X_end_ * t.own[c] : t.own[c];
      arm_sq = std::max(arm_sq, (t.from[c] - motion_.pivot).squaredNorm());
    }
    t.arm = std::sqrt(arm_sq);
    return t;
  }

  /// Where a box may come, along its own axes.
  lanes::BoxRange range_of(const OneBox& box) const noexcept {
    lanes::BoxRange range{};
    const float off_line = grown_ + float(turn_) * box.off_line;
    for (Index i = 0; i < 3; ++i) {
      const float moved =
          box.axis[i][0] * box.moved[0] + box.axis[i][1] * box.moved[1] + box.axis[i][2] * box.moved[2];
      range.low[i] = -box.half[i] - off_line + std::min(moved, 0.0F);
      range.high[i] = box.half[i] + off_line + std::max(moved, 0.0F);
    }
    return range;
  }
  using Direction = std::array<float, 3>;
  static Direction corner_of(const EightTriangles& eight, Index c, Index lane) noexcept {
    return {eight.corner[c][0][lane], eight.corner[c][1][lane], eight.corner[c][2][lane]};
  }
  /// Between two planes square to n a triangle is at the start, and by six corners also at the end.
  static lanes::Slab slab_along(const Direction& n, const EightTriangles& eight, Index lane, Index corners,
                                float grown) noexcept {
    lanes::Slab slab{n, 0.0F, 0.0F};
    for (Index c = 0; c < corners; ++c) {
      const Direction p = corner_of(eight, c, lane);
      const float level = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
      slab.level_low = c == 0 ? level : std::min(slab.level_low, level);
      slab.level_high = c == 0 ? level : std::max(slab.level_high, level);
    }
    slab.level_low -= grown;
    slab.level_high += grown;
    return slab;
  }
  /// Of eight triangles, those that are not apart from one of the other leaf along its normal, or square to
  /// that and to one of its sides.
  std::uint32_t beside(const EightTriangles& eight, Index corners, const EightTriangles& of_one, Index lane,
                       Index corners_of_one, float grown, std::uint32_t some) const noexcept {
    const Direction n = {of_one.normal[0][lane], of_one.normal[1][lane], of_one.normal[2][lane]};
    some &= kernels_.in_slab(eight, corners, slab_along(n, of_one, lane, corners_of_one, grown));
    for (Index c = 0; c < 3 && some != 0; ++c) {
      const Direction p = corner_of(of_one, c, lane);
      const Direction q = corner_of(of_one, (c + 1) % 3, lane);
      const Direction e = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
      Direction out = {e[1] * n[2] - e[2] * n[1], e[2] * n[0] - e[0] * n[2], e[0] * n[1] - e[1] * n[0]};
      const float length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
      if (!(length > 0.0F)) continue;
      for (float& x : out) x /= length;
      some &= kernels_.in_slab(eight, corners, slab_along(out, of_one, lane, corners_of_one, grown));
    }
    return some;
  }

  void test_leaves(std::int32_t leaf_a, const OneBox& box_a, std::int32_t leaf_b,
                   const OneBox& box_b) noexcept {
    const EightTriangles& of_a = leaves_a_.get(
        std::uint32_t(leaf_a), [&](EightTriangles& into) { gather(a_, leaf_a, nullptr, nullptr, into); });
    std::uint32_t some_a = kernels_.near_box(of_a, 3, box_b, range_of(box_b)) & used(a_, leaf_a);
    if (some_a == 0) return;
    const EightTriangles& of_b = leaves_b_.get(
        std::uint32_t(leaf_b), [&](EightTriangles& into) { gather(b_, leaf_b, &start_, &end_, into); });
    // How much farther than on a line a point of B's leaf may come along any direction, plus rounding.
    const float off = grown_ + float(turn_) * box_b.off_line;
    lanes::BoxRange range = range_of(box_a);
    for (Index i = 0; i < 3; ++i) {
      range.low[i] -= off;
      range.high[i] += off;
    }
    const std::uint32_t some_b = kernels_.near_box(of_b, 6, box_a, range) & used(b_, leaf_b);
    if (some_b == 0) return;
    std::array<std::uint32_t, kInNode> partners{};  // of each triangle of B, those of A
    std::uint32_t left_b = 0;
    for (; some_a != 0; some_a &= some_a - 1) {
      const auto i = Index(std::countr_zero(some_a));
      std::uint32_t some = beside(of_b, 6, of_a, i, 3, off, some_b);
      left_b |= some;
      for (; some != 0; some &= some - 1) partners[Index(std::countr_zero(some))] |= 1U << i;
    }
    for (; left_b != 0; left_b &= left_b - 1) {
      const auto k = Index(std::countr_zero(left_b));
      std::uint32_t some = beside(of_a, 3, of_b, k, 6, off, partners[k]);
      if (some == 0) continue;
      const PathTriangle b = triangle_of(b_, true, leaf_b, k);
      for (; some != 0; some &= some - 1)
        test(triangle_of(a_, false, leaf_a, Index(std::countr_zero(some))), b);
    }
  }

  void test(const PathTriangle& a, const PathTriangle& b) noexcept {
    if (QuickPath(a, b, motion_).parted()) return;
    TrianglePairPath pair(a.from, b.own, motion_, touching_);
    if (pair.direction(0.0).isZero(0.0)) {
      const StartContact start = pair.start_contact();
      path_.crossed |= start == StartContact::kCrossed;
      if (start == StartContact::kNearer) stop(0.0, a, b);
      return;
    }
    const double free = path_free_until(pair, path_.free, kIntervalTests);
    if (free < path_.free) stop(free, a, b);
  }
  /// Whether the step between the two is one that is ridden over.
  bool rides(const PathTriangle& a, const PathTriangle& b) const noexcept {
    return std::any_of(ridden_.normals.begin(), ridden_.normals.end(), [&](const Vec3& n) {
      return std::min({n.dot(a.from[0]), n.dot(a.from[1]), n.dot(a.from[2])}) >=
             std::max({n.dot(b.from[0]), n.dot(b.from[1]), n.dot(b.from[2])}) - ridden_.height_m;
    });
  }
  void stop(double free, const PathTriangle& a, const PathTriangle& b) noexcept {
    if (rides(a, b)) return;
    path_.free = free;
    path_.triangle_a = a.number;
    path_.triangle_b = b.number;
  }

  const Tree& a_;
  const Tree& b_;
  const RelativeMotion& motion_;
  int most_;
  const RiddenSteps& ridden_;
  const lanes::PathKernels& kernels_;
  double touching_;
  float grown_;
  Pose X_end_;
  FloatPose start_, end_;  // from the center of B's mesh to that of A's
  double turn_;            // over the motion [rad]
  lanes::PathTurn float_turn_;
  SurfacePath path_;
  Kept<EightBoxes, 64> kept_a_, kept_b_;
  Kept<EightTriangles, 64> leaves_a_, leaves_b_;
};

}  // namespace

SurfacePath surface_path(const SurfaceTree& a, const SurfaceTree& b, const RelativeMotion& motion, int most,
                         const RiddenSteps& ridden) noexcept {
  return PathWalk(a, b, motion, most, ridden, lanes::path_builds().best()).run();
}

}  // namespace tactum::inline v0_1
