#pragma once
/// Other features of a contact whose true face or edge was cut.

#include "tactum/geometry/feature.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// Features of two other pieces in the plane (or line) of a contact's: together they are one true face, or
/// edge, that was cut (seams.h). Of the same kinds as the contact's.
struct Stretch {
  const Polytope* A = nullptr;
  const Polytope* B = nullptr;
  Feature a, b;
};

}  // namespace tactum::inline v0_1
