#pragma once
/// Contact forces by the penalty law, solved together and implicitly.
///
/// The published law pushes with  F = k (delta - d)  while d < delta [Gregory 2000, 5.2]; D_p is -d, so the
/// same line serves the overlapping pair, F = k (delta + D_p). Applied with the distance of the *start* of
/// the step, such a spring shakes as soon as k h^2 exceeds what it pushes on, and the proxy weighs nothing.
/// So the law is asked to hold at the *end* of the step: with  d' = d + h vn  and the impulse  lambda = h F,
///
///     vn + lambda / (k h^2) = (delta - d) / h,     lambda >= 0,     vn = n . (v_A - v_B) after all impulses,
///
/// which is a linear complementarity problem with a positive definite matrix, and its other side the least of
/// a convex function of the bodies' motion. That is found exactly by Newton's method while at most 24
/// directions of motion (four free bodies) and 128 rows take part: two rounds as a rule, each linear in the
/// rows. Beyond that by projected Gauss-Seidel with a bounded number of sweeps (two gears with 14 rows took
/// it 54). It is stable for every k, h and mass, and at rest its forces are the published ones exactly.

#include <span>
#include <vector>

#include "tactum/dynamics/friction_row.h"

namespace tactum {

/// Finds the impulses and adds their effect to the twists `V` (one per body). `h` [s] is the step they act
/// for. `pushes` is scratch, with room for as many as there are rows.
SolverResult solve_contacts(std::span<ContactRow> rows, std::span<const Pose> X_WB,
                            std::span<const Mobility> W, double h, int max_sweeps,
                            std::vector<PushRow>& pushes, std::span<Twist> V) noexcept;

}  // namespace tactum
