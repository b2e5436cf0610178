#pragma once
/// From many minima to few that keep the support of the contact.
///
/// To the solver a minimum is a half-space on the step (translation x, rotation w about `center`):
///
///      n . x + (r x n) . w  >=  -distance            r = p_b - center
///
/// that is a point (n, r x n, distance) in seven dimensions. A minimum may be left out where a kept one has
/// almost the same half-space: for all steps within the bounds, it is overstepped by no more than
///
///      error = max(0, distance_kept - distance)
///              + |n - n_kept| max_translation + |r x n - (r x n)_kept| max_rotation
///
/// The nearest is kept first, then again and again the one with the largest error, until none is above
/// `enough` or the room is full: farthest-first, which is within twice the best possible choice of as many
/// [Gonzalez 1985]. So the first few spread over normals and lever arms, and the error of the dropped ones is
/// a bound, not an estimate. Ties go to the lower index.
///
/// The dropped minima form groups about the kept one they are nearest to. A group that is far enough from the
/// one just kept loses no member to it and is skipped [Elkan 2003]; of 4 400 minima on a thread, 1 024 kept,
/// that leaves a fortieth of the pairs.

#include <span>

#include "tactum/surface/surface_minimum.h"

namespace tactum::inline v0_1 {

struct ReductionBounds {
  Vec3 center = Vec3::Zero();    ///< the centre of rotations, A's frame [m]
  double max_translation = 0.0;  ///< of a step [m]
  double max_rotation = 0.0;     ///< of a step [rad]
  double enough = 0.0;           ///< stop when no dropped minimum is overstepped by more [m]
};

struct ReductionReport {
  int kept = 0;
  int dropped = 0;
  double largest_error =
      0.0;  ///< a dropped minimum can be overstepped by at most this in a step within the bounds [m]
};

/// The state of each minimum and of each group meanwhile.
struct ReductionScratch {
  double error = 0.0;        ///< afterwards, of a dropped one: by how much it can be overstepped [m]
  Vec3 push = Vec3::Zero();  ///< the normal times the largest translation [m]
  Vec3 turn = Vec3::Zero();  ///< the lever arm times the largest rotation [m]
  double distance = 0.0;     ///< [m]
  int next = -1;             ///< in its group
  int first = -1;            ///< of the group with this number
  int farthest = -1;         ///< of the group: the one with the largest error
  int chosen = -1;           ///< of the group: the kept one in its middle
  int went = -1;             ///< of the minimum with this number: its place after a kept one took its own
};

/// Orders `minima` so that the kept ones, at most `room`, come first, in the order of their choice; the rest
/// follows. `scratch` must be as long as `minima` at least. No allocation.
ReductionReport reduce_contacts(std::span<SurfaceMinimum> minima, std::span<ReductionScratch> scratch,
                                std::size_t room, const ReductionBounds& bounds) noexcept;

}  // namespace tactum::inline v0_1
