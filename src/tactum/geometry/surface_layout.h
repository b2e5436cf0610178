#pragma once
/// The storage of the features of a surface under their trees of oriented boxes: surface_tree.h owns it,
/// surface_boxes.h and surface_cones.h fill it.

#include <array>
#include <cstdint>

namespace tactum::inline v0_1 {

struct SurfaceLayout {
  static constexpr int kLanes = 8;
  using Lanes = std::array<float, kLanes>;
  using Lanes3 = std::array<Lanes, 3>;
  using Corners = std::array<std::int32_t, kLanes>;
  enum Kind : std::uint8_t { kVertices, kEdges, kFaces };

  /// Where eight oriented boxes stand: their middles and axes, `across` being up x along.
  struct Stand {
    Lanes3 up, center, along, across;  ///< axes are units [-], the center [m]
  };
  /// Eight boxes, relative to the mesh's center. `up` is the mean direction of the cones within; `cone` is
  /// the largest angle from it to one of them.
  struct Node {
    Stand at{};
    Lanes3 half{};    ///< half the sides along `along`, `across` and `up` [m]
    Lanes cone{};     ///< [rad]
    Lanes extent{};   ///< of two boxes the one where it is larger is opened
    Corners child{};  ///< a node; ~n: the leaf n; 0: no box
  };

  /// Instead of the vertex beyond an edge: the wall behind a rim.
  static constexpr std::int32_t kWall = -1;
};

}  // namespace tactum::inline v0_1
