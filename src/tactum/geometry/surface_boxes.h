#pragma once
/// The trees of oriented boxes over the features of a surface: how surface_tree.h's nodes and leaves are
/// made.

#include <utility>
#include <vector>

#include "tactum/base/large_array.h"
#include "tactum/geometry/surface_cones.h"
#include "tactum/geometry/surface_layout.h"

namespace tactum::inline v0_1 {

/// Leaves hold eight features each but the last, nodes as many children as fill them: a node of n leaves has
/// children of the largest power of eight below n. Features that stay together lie near each other and have
/// similar directions.
class SurfaceBoxes {
 public:
  SurfaceBoxes(const TriangleMesh& mesh, const SurfaceCones& cones, const Vec3& center, int threads);

  LargeArray<SurfaceLayout::Node> nodes;
  LargeArray<SurfaceLayout::Corners> leaves;
  std::array<std::int32_t, 3> root{-1, -1, -1};  ///< SurfaceTree::root

 private:
  using Range = std::pair<std::size_t, std::size_t>;  ///< of order_

  /// Where the nodes and leaves below a box begin. How many there are follows from the number of features
  /// alone, so that boxes beside each other can be made at the same time.
  struct Place {
    std::size_t node, leaf;
  };
  std::int32_t make_tree(int threads);
  std::int32_t make_leaf(Range range, std::size_t leaf);
  void make_child(std::size_t node, std::size_t lane, Range range, Place below, int threads);
  std::int32_t make_node(Range range, Place place, int threads);
  /// The oriented box around a range of features, its third axis along the mean direction of their cones.
  struct Span {
    std::array<Vec3, 3> axis;
    Vec3 center, half;  ///< [m]
  };
  Span span(Range range) const;
  void make_box(SurfaceLayout::Node& node, std::size_t lane, Range range);
  void split(Range range, std::size_t unit, int threads);
  void sort_halves(Range range, std::size_t halfway, int threads);
  void cut_across(const Vec3& axis, Range range, std::size_t halfway);

  std::size_t points() const { return std::size_t(kind_) + 1; }  ///< of a feature of this kind
  /// The corner of a triangle that is `after` this one, from the center.
  Vec3 point(std::int32_t corner, std::size_t after) const {
    const Triangle& t = mesh_.triangles[corner / 3];
    return mesh_.vertices[t[(std::size_t(corner) + after) % 3]] - center_;
  }
  Vec3 middle(const ConedFeature& feature) const;

  const TriangleMesh& mesh_;
  Vec3 center_;
  double grown_;  // the largest error of a point in single precision
  SurfaceLayout::Kind kind_ = SurfaceLayout::kVertices;
  std::vector<ConedFeature> order_;  // of the kind being stored
  std::vector<std::pair<double, ConedFeature>> keyed_;
};

}  // namespace tactum::inline v0_1
