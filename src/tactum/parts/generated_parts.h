#pragma once
/// Parts made by rule for scenes, each as convex pieces that share faces and overlap nowhere.
///
///        ____peg____  z = length        A peg stands with its tip on z = 0; a hole block's floor, where it
///   ____  |       |  ____ z = depth     has one, lies below z = 0. So equal poses put the peg into the hole,
///  |    | |       | |    |              on its floor. Both are centred on the z axis; everything else (box,
///  |____| \_______/ |____|              sphere, ellipsoid, prism: geometry/primitives.h) is centred on the
///  |____________________| z = 0         origin.
///          floor

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The prism over a convex polygon (counter-clockwise) between two heights [m].
Result<Polytope> extruded(const std::vector<Vec2>& polygon, double z_low_m, double z_high_m);

/// A peg. Rectangular with `sides` = 0, else a prism whose corners lie on a circle of diameter width_m.
struct Peg {
  int sides = 0;           ///< 0, or 3 to 256 [-]
  double width_m = 0.02;   ///< along x [m]
  double depth_m = 0.014;  ///< along y; a round peg ignores it [m]
  double length_m = 0.05;  ///< along z [m]
  double chamfer_m = 0.0;  ///< the tip's edges are cut at 45 degrees by this much; 0: sharp [m]
};

/// One convex piece.
Result<std::vector<Polytope>> peg_pieces(const Peg& peg);

/// A block with a hole that leaves `clearance_m` between it and a `peg_width_m` x `peg_depth_m` peg.
/// Rectangular with `sides` = 0, else a ring about a prism-shaped hole whose sides touch the hole's circle.
struct HoleBlock {
  int sides = 0;                ///< 0, or 3 to 256 [-]
  double peg_width_m = 0.02;    ///< of the peg it is for, along x; a round peg's diameter [m]
  double peg_depth_m = 0.014;   ///< of the peg it is for, along y [m]
  double clearance_m = 0.0005;  ///< hole less peg, both sides together, in x and in y [m]
  double wall_m = 0.015;        ///< material around the hole [m]
  double hole_depth_m = 0.03;   ///< [m]
  double floor_m = 0.0;         ///< thickness of the floor; 0: the hole goes through [m]
};

/// Four walls (or one per side), then the floor if there is one.
Result<std::vector<Polytope>> hole_block_pieces(const HoleBlock& block);

}  // namespace tactum::inline v0_1
