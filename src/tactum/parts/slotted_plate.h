#pragma once
/// A plate with a row of slots through it, as convex pieces that share faces and overlap nowhere.
///
///    ______________________________      The slots stand side by side along x, their long axes along y; the
///   |   \ _ /     \ _ /     \ _ /  |     plate's middle is on the z axis, its underside on z = 0. Ends are
///   |----| |-------| |-------| |---|     square, or round: half a circle of facets that touch it from
///   | bar| |  bar  | |  bar  | |   |     outside, so that a round peg of the slot's width just passes. Bars
///   |----|_|-------|_|-------|_|---|     lie between the straight sides; about a round end the pieces are a
///   |___/___\_____/___\_____/___\__|     fan, one for each facet.

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

struct SlottedPlate {
  int slots = 3;                ///< 1 to 32 [-]
  double slot_width_m = 0.008;  ///< along x [m]
  double slot_length_m = 0.03;  ///< along y, over all; no less than the width where ends are round [m]
  double pitch_m = 0.02;        ///< from slot to slot, more than the width [m]
  double margin_m = 0.01;       ///< material around the row of slots [m]
  double thickness_m = 0.006;   ///< along z [m]
  int end_facets = 2;           ///< of each end, an even number to 32; 2: square corners [-]
};

/// The slots + 1 bars, then for each slot the fan at +y and that at -y.
Result<std::vector<Polytope>> slotted_plate_pieces(const SlottedPlate& plate);

}  // namespace tactum::inline v0_1
