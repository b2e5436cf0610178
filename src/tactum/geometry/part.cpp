#include "tactum/geometry/part.h"

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {

void find_true_surface(Part& part) {
  part.true_surface = true_surface(part.pieces, part.hierarchy, tolerances::kCoplanarMeshOffset * part.size);
}

}  // namespace tactum::inline v0_1
