#pragma once
/// One friction patch for one plane: contacts of a body that lie in one plane of another have their friction
/// together, whether the plane is one face, several, or made of bodies that lie side by side.
///
///        _______________         Which of the three carries the block is not determined, for any of them
///       |_______________|        could; the sum is, and so is its centre. Friction that depended on the
///      |  1  |  2  |  3  |       parts would depend on the order in which a solver chose them.

#include <span>
#include <vector>

#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/contact_row.h"

namespace tactum::inline v0_1 {

class FrictionPlanes {
 public:
  FrictionPlanes(std::size_t bodies, std::size_t most_rows);
  /// Sets ContactRow::plane of rows that have friction: to the surfaces of the first row in its plane, of the
  /// same bodies, where all fixed ones count as one. Cost: each row is compared with the planes of the body
  /// that moves.
  void find(std::span<ContactRow> rows) noexcept;

 private:
  struct Plane {
    int row = -1;   ///< the first in it
    int next = -1;  ///< the next plane of the same body
  };
  std::vector<int> first_of_body_;  ///< number of its first plane, -1: none
  ReservedVector<Plane> planes_;
};

}  // namespace tactum::inline v0_1
