#pragma once
/// The exact half of surface_minima.h: which pairs of features are minima.

#include <vector>

#include "tactum/geometry/surface_tree.h"
#include "tactum/math/pose.h"
#include "tactum/surface/surface_minimum.h"

namespace tactum::inline v0_1 {

/// Whether a direction is in a normal cone.
enum class InCone : std::uint8_t { kOutside, kInflated, kStrict };

class FeatureComparison {
 public:
  FeatureComparison(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB, const MinimaQuery& query,
                    std::vector<SurfaceMinimum>& minima) noexcept;

  /// A vertex of the first with a feature of the second, the first being A unless `swapped`. Features are
  /// named by corners, as in the leaves of a SurfaceTree.
  void vertex_face(bool swapped, std::int32_t vertex, std::int32_t face) noexcept;
  void vertex_edge(bool swapped, std::int32_t vertex, std::int32_t edge) noexcept;
  void vertex_vertex(std::int32_t a, std::int32_t b) noexcept;
  void edge_edge(std::int32_t a, std::int32_t b) noexcept;
  /// From here on minima are not stored, and only those nearer than this fraction of the nearest are
  /// searched.
  void narrow_by(double share) noexcept { share_ = share; }
  double max_distance() const noexcept { return max_distance_; }  ///< up to where minima are looked for [m]
  /// Sorts what was found.
  void finish() noexcept;

  MinimaWork work;

 private:
  /// One of the two surfaces, and its pose in A.
  struct Side {
    const SurfaceTree& tree;
    bool is_a;
    Mat3 R;
    Vec3 p;
    Vec3 position(int vertex) const noexcept {
      return is_a ? tree.vertex(vertex) : Vec3(rotated(R, tree.vertex(vertex)) + p);
    }
    /// The corner of a triangle that comes `after` places later.
    Vec3 point(std::int32_t corner, std::size_t after) const noexcept {
      return position(tree.triangle(corner / 3)[(std::size_t(corner) % 3 + after) % 3]);
    }
    /// Of the triangle, unit, outward [-].
    Vec3 normal(std::int32_t corner) const noexcept;
  };
  /// An edge in A's frame.
  struct Edge {
    std::int32_t corner;
    Vec3 from, along;
    int triangle() const noexcept { return corner / 3; }
  };
  struct Touch {
    Vec3 p_a, p_b, normal;
    double distance;
    Feature a, b;
    InCone cone;
  };

  static Edge edge(const Side& side, std::int32_t corner) noexcept;
  const Side& side(bool swapped) const noexcept { return swapped ? b_ : a_; }
  /// Takes a pair of edges with these nearest points if n or -n is in both cones; distance = n . (p_a - p_b).
  void take_edges(const Edge& a, const Edge& b, const Vec3& p_a, const Vec3& p_b, const Vec3& n,
                  double distance) noexcept;
  void parallel_edges(const Edge& a, const Edge& b) noexcept;

  /// Judges e . u <= 0, where `value` is e . u and `length_sq` the square of e's length.
  InCone falls_away(double value, double length_sq) const noexcept;
  InCone in_edge_cone(const Side& side, const Edge& edge, const Vec3& u) const noexcept;
  InCone in_vertex_cone(const Side& side, std::int32_t corner, const Vec3& u) const noexcept;
  /// Whether u is within the inflation of the true cone.
  bool near_vertex_cone(const SurfaceTree& tree, int vertex, const Vec3& u) const noexcept;
  /// The direction that must fall away from a vertex at p, for a neighbour `w` of SurfaceTree::around().
  static Vec3 falling(const SurfaceTree& tree, const Vec3& p, std::int32_t w) noexcept;
  void take(const Touch& touch, int triangle_a, int triangle_b) noexcept;
  bool in_range(double distance) const noexcept {
    return distance <= max_distance_ && distance >= -query_.depth;
  }

  Side a_, b_;
  const MinimaQuery& query_;
  std::vector<SurfaceMinimum>& minima_;
  double max_distance_;
  double share_ = 0.0;
  double touching_;  // below this points have no direction between them [m]
  double inflation_sq_;
  double parallel_sq_;  // square of the sine below which edges touch along an interval
};

}  // namespace tactum::inline v0_1
