#pragma once
/// A body as the contact finder sees it.

#include "tactum/geometry/part.h"

namespace tactum::inline v0_1 {

/// The part must outlive the finder.
struct CollisionBody {
  const Part* part = nullptr;
  bool moves = true;         ///< two bodies that do not move are never tested
  int no_contact_with = -1;  ///< nor is this one with the body of this number; -1: none
};

}  // namespace tactum::inline v0_1
