#include "tactum/surface/surface_minima_leaves.h"

#include <algorithm>

namespace tactum::inline v0_1::lanes {
namespace {

class Corner {
 public:
  Corner(const SurfaceTree& tree, const Box& box) noexcept
      : tree_(tree), corner_(tree.leaves()[leaf_under(box)]) {
    const Lanes3& center = box.node->at.center;
    middle_ = tree.center() + Vec3(center[0][box.lane], center[1][box.lane], center[2][box.lane]);
  }
  const Corners& all() const noexcept { return corner_; }
  /// The corner of the triangle that is so many after that of a lane, from the middle of the box; of lanes
  /// without a feature some corner of the mesh.
  Vec3 point(std::size_t lane, std::size_t after) const noexcept {
    const auto corner = static_cast<std::size_t>(std::max(corner_[lane], 0));
    const Triangle& t = tree_.triangle(static_cast<int>(corner / 3));
    const std::size_t k = corner % 3 + after;
    return tree_.vertex(t[k < 3 ? k : k - 3]) - middle_;
  }
  /// Of the other face beside the edge of a lane; at a rim of the one face there is.
  Vec3 beyond(std::size_t lane) const noexcept {
    const std::int32_t vertex = tree_.beyond(std::max(corner_[lane], 0));
    return vertex == SurfaceTree::kWall ? point(lane, 2) : Vec3(tree_.vertex(vertex) - middle_);
  }

 private:
  const SurfaceTree& tree_;
  const Corners& corner_;
  Vec3 middle_;
};

template <class Number>
void put(const Vec3& v, std::array<std::array<Number, kLanes>, 3>& to, std::size_t lane) noexcept {
  for (std::size_t i = 0; i < 3; ++i) to[i][lane] = static_cast<Number>(v[static_cast<int>(i)]);
}

}  // namespace

void gather_leaf(const SurfaceTree& tree, const Box& box, VertexLeaf& leaf) noexcept {
  const Corner corner(tree, box);
  leaf.corner = corner.all();
  for (std::size_t lane = 0; lane < kLanes; ++lane) put(corner.point(lane, 0), leaf.point, lane);
}

void gather_leaf(const SurfaceTree& tree, const Box& box, const Kernels& kernels, EdgeLeaf& leaf) noexcept {
  const Corner corner(tree, box);
  leaf.corner = corner.all();
  std::array<Points, 4> points{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (std::size_t k = 0; k < 3; ++k) put(corner.point(lane, k), points[k], lane);
    put(corner.beyond(lane), points[3], lane);
  }
  kernels.lay_edges(points, leaf);
}

void gather_leaf(const SurfaceTree& tree, const Box& box, const Kernels& kernels, float grown,
                 FaceLeaf& leaf) noexcept {
  const Corner corner(tree, box);
  leaf.corner = corner.all();
  std::array<Points, 3> points{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (std::size_t k = 0; k < 3; ++k) put(corner.point(lane, k), points[k], lane);
  }
  kernels.lay_faces(points, grown, leaf);
}

}  // namespace tactum::inline v0_1::lanes
