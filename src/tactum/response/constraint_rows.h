#pragma once
/// The contacts of a frame as rows of the constraint problem: every corner of every patch keeps its gap.
///
///        |  true normal: what must not be entered, which way the part may go
///     ---c---
///       /   shaded normal, over facets of a curved surface: which way the force acts
///
/// Forces are found with the shaded normals, the way with the true ones; a faceted cylinder so feels round
/// and is never entered [Ruspini 1997].

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Fills the contact rows, and in ConstraintState the rows' names and shaded normals. The rows of the
/// island that holds the held part come first, `own_rows` of them: those are the constraint problem's.
void make_corner_rows(ConstraintStep& step) noexcept;

/// The rows of the constraint problem.
std::span<ContactRow> own_rows(ConstraintStep& step) noexcept;

/// Adds them to the problem and returns the number of the first there. Where a gap is below the skin,
/// `opening` asks for the skin, for which there may be no room; else only that it closes no further, which
/// staying keeps.
std::size_t add_contact_rows(bool opening, ContactProblem& problem, ConstraintStep& step) noexcept;

/// The rows take their shaded normals, or their true ones back.
void exchange_normals(ConstraintStep& step) noexcept;

// How a step is brought to a pose where everything is open: exact gaps are fed back so often, then the step
// is halved so often.
inline constexpr int kFeedbacks = 2;
inline constexpr int kBacktracks = 3;

/// The gap of a row at the trial: its points go with their bodies, its normal with the face that makes it
/// [m].
double gap_at_trial(const ContactRow& row, const ConstraintStep& step) noexcept;

/// By how much the rows of one patch tell its gap at the trial too large: the normal of two edges turns with
/// both, and then the exact distance holds for all of them [m].
double overstated_at_trial(std::span<const ContactRow> rows_of_patch, const ConstraintStep& step) noexcept;

/// Second-order correction: what the trial's gaps differ from what the rows said is added to the rows.
void correct_rows(double share, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
