#pragma once
/// The gaps of the constraint response at poses on trial: whether they are open there.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Asks for the gaps at the trial of the patches that FreeBodies::patch_asked names, as long as more than
/// `keep_back` tests are left. Fills TrialPose::gap, gap_least and gap_answer.
void look_at_trial(int keep_back, ConstraintStep& step) noexcept;
/// Whether the gap of a patch was asked for and is not open at the trial, at least gap_least. One that the
/// budget left unknown is not open.
bool closed_at_trial(std::size_t patch, const ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
