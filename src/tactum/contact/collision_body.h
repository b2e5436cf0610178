#pragma once
/// A body as the contact finder sees it.

#include <vector>

#include "tactum/geometry/part.h"
#include "tactum/geometry/revolution.h"

namespace tactum::inline v0_1 {

/// The part must outlive the finder.
struct CollisionBody {
  const Part* part = nullptr;
  bool moves = true;         ///< two bodies that do not move are never tested
  int no_contact_with = -1;  ///< nor is this one with the body of this number; -1: none
  /// Of each piece of the part, or of its whole surface, if that is a ball: the curved surface that it has in
  /// contacts. Empty: none has one.
  std::vector<RoundPiece> rounds = {};
  /// The circles that it has where it meets others by its surface. A body of pieces that has some, moves and
  /// is not grasped does so.
  Revolution revolution = {};

  /// Null where the facets of the piece are its surface.
  const RoundPiece* round(int piece) const noexcept {
    if (rounds.empty()) return nullptr;
    const RoundPiece& round = rounds[static_cast<std::size_t>(piece)];
    return round.kind == RoundKind::kNone ? nullptr : &round;
  }
};

}  // namespace tactum::inline v0_1
