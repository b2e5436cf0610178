#pragma once
/// The gaps of the constraint response at poses on trial: whether they are open there, and whether bodies get
/// there without crossing anything.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Bodies that slide by each other must not come nearer than this fraction of their skin.
inline constexpr double kPassingGap = 0.02;

/// Asks for the gaps at the trial of the patches that FreeBodies::patch_asked names, as long as more than
/// `keep_back` tests are left. Fills TrialPose::gap, gap_least and gap_answer.
void look_at_trial(int keep_back, ConstraintStep& step) noexcept;
/// Whether the gap of a patch at the trial has been computed, of whatever contact of its surfaces.
bool known_at_trial(std::size_t patch, const ConstraintStep& step) noexcept;

/// Whether the gap of a patch was asked for and is not open at the trial, at least gap_least. One that the
/// budget left unknown is not open.
bool closed_at_trial(std::size_t patch, const ConstraintStep& step) noexcept;

/// Whether the bodies of a patch have crossed at the trial, or that is unknown.
bool crossed_at_trial(std::size_t patch, const ConstraintStep& step) noexcept;

/// How a body at a pose turns, on its joint, when it turns by `turn` [rad].
BodyTurn turn_of(const Body& body, const Pose& X_WB, const Vec3& turn) noexcept;
/// The least fraction of a body's path to the trial that is proven to be free, of those that TrialPose::goes
/// names; all of them in TrialPose::path_free. The trial must be where the bodies are put, on their joints.
double least_path_free(ConstraintStep& step) noexcept;
/// Of a path that is free up to some place so much is taken, so that a gap is left.
inline constexpr double kOfFreePath = 0.99;

}  // namespace tactum::inline v0_1
