#include "tactum/collision/surface_minima.h"

#include <algorithm>
#include <array>

#include "tactum/base/tolerances.h"
#include "tactum/collision/surface_minima_features.h"
#include "tactum/collision/surface_minima_leaves.h"

namespace tactum {
namespace {

using lanes::kLanes;
using Kind = SurfaceTree::Kind;

lanes::Bounds bounds_of(const MinimaQuery& query, double size) noexcept {
  const double grown = tolerances::kSingle * size;
  lanes::Bounds q{};
  q.grown = static_cast<float>(grown);
  q.reach = static_cast<float>(query.reach + grown);
  q.depth = static_cast<float>(query.depth + grown);
  q.far = std::max(q.reach, q.depth);
  q.slack = static_cast<float>(query.cone_slack + tolerances::kSingle);
  return q;
}

/// From one tree's center, in the other's frame from its center.
Pose between_centers(const SurfaceTree& from, const SurfaceTree& to, const Pose& X) noexcept {
  return {X.R, X * from.center() - to.center()};
}

template <Kind kind>
struct LanesOf;
template <>
struct LanesOf<SurfaceTree::kVertices> {
  using Type = lanes::Vertices;
};
template <>
struct LanesOf<SurfaceTree::kEdges> {
  using Type = lanes::Edges;
};
template <>
struct LanesOf<SurfaceTree::kFaces> {
  using Type = lanes::Faces;
};

/// Features of kind `kOne` of one surface with those of kind `kMany` of the other: down both trees at once, a
/// box against eight, then a feature against eight. X is the first surface in the second's frame; `swapped`:
/// the first is B.
template <Kind kOne, Kind kMany>
class Walk {
 public:
  Walk(const SurfaceTree& one, const SurfaceTree& many, const Pose& X, const Pose& X_back, bool swapped,
       const lanes::Bounds& bounds, FeatureComparison& features) noexcept
      : one_(one),
        many_(many),
        one_in_many_(between_centers(one, many, X)),
        many_frame_(between_centers(many, one, X_back)),
        one_frame_(one_in_many_),
        swapped_(swapped),
        bounds_(bounds),
        features_(features) {}

  void run() noexcept {
    if (one_.root(kOne) < 0 || many_.root(kMany) < 0) return;
    // Filled as far as it is used: NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    std::array<Pair, kStack> stack;
    std::size_t size = 0;
    stack[size++] = {{one_.root(kOne), 0}, {many_.root(kMany), 0}};
    while (size > 0) {
      const Pair pair = stack[--size];
      const std::int32_t one = child(one_, pair.one);
      const std::int32_t many = child(many_, pair.many);
      if (one < 0 && many < 0) {
        compare_leaves(pair);
        continue;
      }
      const bool open_one =
          many < 0 || (one >= 0 && 2.0F * extent(one_, pair.one) > extent(many_, pair.many));
      features_.work.box_tests += int(kLanes);
      std::uint32_t bits = open_one ? facing(lanes::moved(box(many_, pair.many), many_frame_),
                                             one_.nodes()[std::size_t(one)], bounds_)
                                    : facing(lanes::moved(box(one_, pair.one), one_frame_),
                                             many_.nodes()[std::size_t(many)], bounds_);
      for (; bits != 0; bits &= bits - 1) {
        if (size == kStack) {  // deeper than any tree is built
          features_.work.full = true;
          return;
        }
        const int lane = std::countr_zero(bits);
        stack[size++] = open_one ? Pair{{one, lane}, pair.many} : Pair{pair.one, {many, lane}};
      }
    }
  }

 private:
  struct Place {
    std::int32_t node, lane;
    bool operator==(const Place&) const = default;
  };
  struct Pair {
    Place one, many;
  };
  static std::int32_t child(const SurfaceTree& tree, const Place& at) noexcept {
    return tree.nodes()[std::size_t(at.node)].child[std::size_t(at.lane)];
  }
  static float extent(const SurfaceTree& tree, const Place& at) noexcept {
    const auto& half = tree.nodes()[std::size_t(at.node)].half;
    const std::size_t k = std::size_t(at.lane);
    return std::max({half[0][k], half[1][k], half[2][k]});
  }
  static lanes::Box box(const SurfaceTree& tree, const Place& at) noexcept {
    return lanes::box_of(tree.nodes()[std::size_t(at.node)], std::size_t(at.lane));
  }
  static Vec3 middle(const SurfaceTree& tree, const Place& at) noexcept {
    const auto& center = tree.nodes()[std::size_t(at.node)].center;
    const std::size_t k = std::size_t(at.lane);
    return {center[0][k], center[1][k], center[2][k]};
  }
  static const SurfaceTree::Leaf& leaf(const SurfaceTree& tree, const Place& at) noexcept {
    return tree.leaves()[std::size_t(~child(tree, at))];
  }

  void compare_leaves(const Pair& pair) noexcept {
    ++features_.work.leaf_pairs;
    const SurfaceTree::Leaf& one = leaf(one_, pair.one);
    const SurfaceTree::Leaf& many = leaf(many_, pair.many);
    if (!(pair.one == last_)) {  // pairs of one leaf mostly follow each other
      last_ = pair.one;
      last_middle_ = one_in_many_ * middle(one_, pair.one);
      lanes::put_lanes(one_, one, middle(one_, pair.one), singles_);
      lanes::turn(singles_, one_frame_);
    }
    const Vec3 from = middle(many_, pair.many);
    const Vec3 apart = last_middle_ - from;
    const lanes::Three off = {static_cast<float>(apart.x()), static_cast<float>(apart.y()),
                              static_cast<float>(apart.z())};
    std::uint32_t singles = near_box(singles_, off, box(many_, pair.many), bounds_);
    if (singles == 0) return;
    Kept& kept = kept_[std::size_t(~child(many_, pair.many)) % kept_.size()];
    if (!(kept.at == pair.many)) {
      kept.at = pair.many;
      lanes::put_lanes(many_, many, from, kept.eight);
    }
    const auto& eight = kept.eight;
    for (; singles != 0; singles &= singles - 1) {
      const std::size_t i = std::size_t(std::countr_zero(singles));
      const auto at = [&](const SurfaceTree::Lanes3& v) { return lanes::Three{v[0][i], v[1][i], v[2][i]}; };
      lanes::Three point = at(singles_.point);
      for (std::size_t k = 0; k < 3; ++k) point[k] += off[k];
      std::uint32_t bits = 0;
      if constexpr (kOne == SurfaceTree::kEdges) {
        bits = near_edge(point, at(singles_.along), eight, bounds_);
      } else {
        bits = near_vertex(point, eight, bounds_);
      }
      for (; bits != 0; bits &= bits - 1)
        compare(one.corner[i], many.corner[std::size_t(std::countr_zero(bits))]);
    }
  }

  void compare(std::int32_t one, std::int32_t many) noexcept {
    if constexpr (kOne == SurfaceTree::kEdges) {
      features_.edge_edge(one, many);
    } else if constexpr (kMany == SurfaceTree::kVertices) {
      features_.vertex_vertex(one, many);
    } else if constexpr (kMany == SurfaceTree::kEdges) {
      features_.vertex_edge(swapped_, one, many);
    } else {
      features_.vertex_face(swapped_, one, many);
    }
  }

  /// Leaves laid out in lanes: neighbours of one leaf are mostly neighbours of the next.
  struct Kept {
    Place at{-1, -1};
    typename LanesOf<kMany>::Type eight{};
  };

  static constexpr std::size_t kStack = 256;  // eleven levels of each, seven more pairs a level

  const SurfaceTree& one_;
  const SurfaceTree& many_;
  Pose one_in_many_;
  lanes::Frame many_frame_, one_frame_;  // of the one's boxes in the many's tree, and the other way round
  bool swapped_;
  const lanes::Bounds& bounds_;
  FeatureComparison& features_;
  typename LanesOf<kOne>::Type singles_{};  // of the last leaf, in the many's frame
  Vec3 last_middle_ = Vec3::Zero();
  Place last_{-1, -1};
  std::array<Kept, 64> kept_{};
};

}  // namespace

MinimaWork surface_minima(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                          const MinimaQuery& query, std::vector<SurfaceMinimum>& minima) noexcept {
  FeatureComparison features(a, b, X_AB, query, minima);
  const lanes::Bounds bounds = bounds_of(query, a.size() + b.size());
  const Pose X_BA = X_AB.inverse();
  using Tree = SurfaceTree;
  Walk<Tree::kEdges, Tree::kEdges>(a, b, X_BA, X_AB, false, bounds, features).run();
  Walk<Tree::kVertices, Tree::kFaces>(a, b, X_BA, X_AB, false, bounds, features).run();
  Walk<Tree::kVertices, Tree::kFaces>(b, a, X_AB, X_BA, true, bounds, features).run();
  Walk<Tree::kVertices, Tree::kEdges>(a, b, X_BA, X_AB, false, bounds, features).run();
  Walk<Tree::kVertices, Tree::kEdges>(b, a, X_AB, X_BA, true, bounds, features).run();
  Walk<Tree::kVertices, Tree::kVertices>(a, b, X_BA, X_AB, false, bounds, features).run();
  features.finish();
  return features.work;
}

}  // namespace tactum
