#include "tactum/response/constraint_trial.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Gaps of bodies that touch are known only up to rounding, some fraction of the skin. If gaps had to be kept
/// to the bit, a part that is jammed without play, and all that touches it, could never move again.
constexpr double kKnownGap = tolerances::kCertificate;

/// The least that a gap may become: open, and if it must shrink below half the skin, then by no more than
/// half, or by its rounding. Held to the exact last gap, a part that is too near by a rounding could never
/// move again.
double least_gap(double now, double skin) {
  const double known = kKnownGap * skin;
  return std::min(0.5 * skin, now > known ? 0.5 * now : now - known);
}

}  // namespace

void look_at_trial(int keep_back, ConstraintStep& step) noexcept {
  ConstraintState& c = step.own.constraint;
  for (Index p = 0; p < c.trial.gap_now.size(); ++p) {
    c.trial.gap_answer[p] = step.own.free.patch_asked[p] ? GapAnswer::kAsked : GapAnswer::kNotAsked;
    const double skin = c.skin_of(step.patches[p]);
    c.trial.gap_least[p] =
        step.own.free.patch_passed[p] ? 0.5 * kPassingGap * skin : least_gap(c.trial.gap_now[p], skin);
  }
  step.report.validation_tests +=
      step.gaps.distances_at(c.trial.X_WB, c.trial.gap, c.trial.gap_answer, c.trial.gap_least, keep_back);
  step.own.waiting.ran_out |= std::find(c.trial.gap_answer.begin(), c.trial.gap_answer.end(),
                                        GapAnswer::kUnknown) != c.trial.gap_answer.end();
}

bool known_at_trial(std::size_t patch, const ConstraintStep& step) noexcept {
  const GapAnswer answer = step.own.constraint.trial.gap_answer[patch];
  return answer == GapAnswer::kExact || answer == GapAnswer::kElsewhere;
}

bool closed_at_trial(std::size_t patch, const ConstraintStep& step) noexcept {
  const TrialPose& trial = step.own.constraint.trial;
  if (!step.own.free.patch_asked[patch]) return false;
  if (known_at_trial(patch, step)) return !(trial.gap[patch] >= trial.gap_least[patch]);
  return trial.gap_answer[patch] != GapAnswer::kProven;
}

bool crossed_at_trial(std::size_t patch, const ConstraintStep& step) noexcept {
  const TrialPose& trial = step.own.constraint.trial;
  if (!step.own.free.patch_asked[patch]) return false;
  if (known_at_trial(patch, step)) return !(trial.gap[patch] > 0.0);
  return trial.gap_answer[patch] != GapAnswer::kProven;
}

BodyTurn turn_of(const Body& body, const Pose& X_WB, const Vec3& turn) noexcept {
  const JointKind kind = body.joint.kind;
  const bool about_anchor = kind == JointKind::kHinge || kind == JointKind::kBall;
  return {turn, about_anchor ? body.joint.anchor_W : X_WB.p};
}

double least_path_free(ConstraintStep& step) noexcept {
  TrialPose& trial = step.own.constraint.trial;
  const PathWork work =
      step.gaps.prove_paths(trial.X_WB, trial.turn, trial.goes,
                            step.settings.budget.max_path_tests - step.report.path_tests, trial.path_free);
  trial.path_unproven = work.unproven > 0;
  step.report.path_tests += work.tests;
  step.report.unproven_paths += work.unproven;
  if (work.unproven > 0) step.report.flags |= frame_flag::kPathUnproven;
  double least = 1.0;
  for (Index i = 0; i < trial.goes.size(); ++i)
    if (trial.goes[i]) least = std::min(least, trial.path_free[i]);
  return least;
}

}  // namespace tactum::inline v0_1
