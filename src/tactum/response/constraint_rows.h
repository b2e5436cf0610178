#pragma once
/// The contacts of a frame as rows of the constraint problem: every corner of every patch keeps its gap.
///
///        |  true normal: the direction that limits displacements
///     ---c---
///       /   shaded normal, over facets of a curved surface: the direction of the force
///
/// Forces are found with the shaded normals, displacements with the true ones; a faceted cylinder so feels
/// round and is never penetrated [Ruspini 1997].

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Fills the contact rows, and in ConstraintState the rows' names and shaded normals. The rows of the grasped
/// part's island come first, `own_rows` of them: those are the constraint problem's.
void make_corner_rows(ConstraintStep& step) noexcept;

/// The rows of the constraint problem.
std::span<ContactRow> own_rows(ConstraintStep& step) noexcept;

/// Adds the own rows to the problem and returns the number of the first there. Where a gap is below the skin,
/// `opening` asks for the skin, for which there may be no room; without it the row only asks that the gap
/// closes no further, which a displacement of zero satisfies. Sets ContactRow::asked, and feedback to zero.
std::size_t add_contact_rows(bool opening, ContactProblem& problem, ConstraintStep& step) noexcept;

/// Exchanges the rows' true normals for their shaded ones, or back.
void exchange_normals(ConstraintStep& step) noexcept;

// How a step is brought to a pose where everything is open: at most so many second-order corrections by exact
// gaps, then so many halvings of the step.
inline constexpr int kFeedbacks = 2;
inline constexpr int kBacktracks = 3;

/// The gap of a row at the trial: its points move with their bodies, its normal with the body whose face it
/// is square to [m].
double gap_at_trial(const ContactRow& row, const ConstraintStep& step) noexcept;

/// By how much the rows of one patch overstate its gap at the trial: the normal of two edges turns with both
/// bodies, and then the exact distance is taken for all of the rows [m]. Zero where the gap is not known
/// exactly. Of surfaces GapAnswer::kExact may stand for a lower bound only, see GapOracle::distances_at().
double overstated_at_trial(std::span<const ContactRow> rows_of_patch, const ConstraintStep& step) noexcept;

/// What an idle row asks of a step, of which `share` is taken, once a trial has closed its gap: that its body
/// is lifted to the skin over the step that it met [m].
inline double lift_of(const ContactRow& row, double share) noexcept {
  return (row.skin_m - row.distance) / share;
}

/// Second-order correction: adds to the own rows of the step's problem the difference between their linear
/// gaps and the gaps at the trial, which is the pose at the fraction `share` of the answer's step. A row is
/// stated for the whole step, so the difference is divided by `share`, which must be above zero.
void correct_rows(double share, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
