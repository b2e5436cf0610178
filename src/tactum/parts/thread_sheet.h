#pragma once
/// The sheet of a screw thread: columns of corners at equal angles about z, and the strips between them. For
/// bolt_and_nut.cpp.
///
///   column k     column k+1      Corners of one helix carry one number, `line`; a line that both columns
///      |    2 _____ |            have is an edge of the sheet, and two of them bound a square, split along
///      |_____/      | 2          the diagonal that leaves less material. Where a line begins or ends, its
///    2 |    1 _____ |            corner is joined to the neighbour below by a triangle.
///      |_____/      | 1
///    1 |____________|            Going once round, a line's number has grown by `lines_per_turn`.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1::detail {

struct ThreadCorner {
  int line = 0;
  double radius_m = 0.0;  ///< [m]
  double z_m = 0.0;       ///< [m]
};

/// From the bottom up; lines ascend.
using ThreadColumn = std::vector<ThreadCorner>;

/// The lines of a column's ends where they are no line of the thread.
inline constexpr int kLowEnd = -1'000'000;
inline constexpr int kHighEnd = 1'000'000;

/// The vertices at the sheet's lower and upper end, one of each column.
struct ThreadRims {
  std::vector<int> low;
  std::vector<int> high;
};

/// Adds the sheet to `mesh`; its outer side looks away from the axis, or toward it when `inward`. The columns
/// stand at angles 2 pi k / columns.size().
ThreadRims add_thread_sheet(const std::vector<ThreadColumn>& columns, int lines_per_turn, bool inward,
                            TriangleMesh& mesh);

}  // namespace tactum::inline v0_1::detail
