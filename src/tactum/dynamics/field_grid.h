#pragma once
/// A force field as vectors on a grid, linear between its nodes in each direction ("volumetric data" of
/// [Gregory 2000, 7]).
///
///       n-1 |     .--------.          outside the box of the nodes it goes to zero
///            |    /          \         over `edge` (one spacing by default), linearly:
///            |---'            '---     no step is felt where the data ends
///           0  edge  box  edge
///
/// Samples are kept as they come, in single or double precision, x fastest, the three components of a node
/// side by side: a lookup touches four short runs of memory. Cost: some 20 ns where the neighbourhood is in
/// the cache. Constant after it is made.

#include <array>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/dynamics/analytic_field.h"

namespace tactum::inline v0_1 {

/// Where the nodes are, in the field's frame F.
struct GridShape {
  std::array<int, 3> nodes{0, 0, 0};  ///< along x, y, z; 2 or more [-]
  Vec3 spacing = Vec3::Zero();        ///< [m]
  Vec3 origin = Vec3::Zero();         ///< of the first node [m]

  std::size_t count() const noexcept {
    return std::size_t(nodes[0]) * std::size_t(nodes[1]) * std::size_t(nodes[2]);
  }
  Vec3 node(int i, int j, int k) const noexcept { return origin + spacing.cwiseProduct(Vec3(i, j, k)); }
};

/// An error unless a grid can have this shape: 2 to 4096 nodes a side, finite numbers, positive spacing.
Result<void> check_shape(const GridShape& shape);

class FieldGrid {
 public:
  /// Three numbers a node, x fastest [N].
  using Samples = std::variant<std::vector<float>, std::vector<double>>;

  /// `edge_m` 0: one spacing. An error names the first node that is not a number.
  static Result<FieldGrid> make(const GridShape& shape, Samples samples, double edge_m = 0.0);

  FieldValue at(const Vec3& p) const noexcept;
  const GridShape& shape() const noexcept { return shape_; }
  const Samples& samples() const noexcept { return samples_; }
  /// A bound on the steepness between neighbouring nodes, and of the fall to zero at the edge [N/m].
  double steepest() const noexcept { return steepest_; }

 private:
  FieldGrid(const GridShape& shape, Samples samples, double edge_m);

  GridShape shape_;
  Samples samples_;
  Vec3 per_spacing_, per_edge_;  // one over each [1/m]
  double steepest_ = 0.0;
};

/// The field of a formula at the nodes.
template <class Number>
std::vector<Number> sampled(const GridShape& shape, const std::function<Vec3(const Vec3&)>& force_at) {
  std::vector<Number> samples;
  samples.reserve(3 * shape.count());
  for (int k = 0; k < shape.nodes[2]; ++k)
    for (int j = 0; j < shape.nodes[1]; ++j)
      for (int i = 0; i < shape.nodes[0]; ++i) {
        const Vec3 force = force_at(shape.node(i, j, k));
        for (int c = 0; c < 3; ++c) samples.push_back(static_cast<Number>(force[c]));
      }
  return samples;
}

}  // namespace tactum::inline v0_1
