#pragma once
/// The solver of the contact problem whose rows yield: the penalty law, for all contacts together and
/// implicitly.
///
/// The published law pushes with  F = k (delta - d)  while d < delta [Gregory 2000, 5.2]; D_p is -d, so the
/// same line serves the overlapping pair, F = k (delta + D_p). Applied with the distance of the *start* of
/// the step, such a spring shakes as soon as k h^2 exceeds the mass it pushes on, and the proxy weighs
/// nothing. So the law is asked to hold at the *end* of the step: with  d' = d + n . (x_a - x_b),
///
///     n . (x_a - x_b) + F / k = delta - d,     F >= 0,
///
/// which is a linear complementarity problem with a positive definite matrix, and its other side the least of
/// a convex function of the bodies' displacements. With the rows  g_i . z >= b_i  of the contact problem that
/// is
///
///     |z|^2 / 2 + sum_i k_i max(0, b_i - g_i z)^2 / 2:
///
/// quadratic while the same rows push. It is found exactly by Newton's method while at most 36 unknowns (six
/// free bodies) and 128 rows take part: two rounds as a rule, each linear in the rows. Beyond that by
/// projected Gauss-Seidel with a bounded number of sweeps (two gears with 14 rows took it 54). It is stable
/// for every k, h and mass, and at rest its forces are the published ones exactly.
///
/// Limits of joints are rows as stiff as rounding allows, and so is dry friction, whose force is bounded.

#include "tactum/dynamics/contact_problem.h"
#include "tactum/dynamics/contact_row.h"

namespace tactum::inline v0_1 {

/// Solves the problem. `stiffness` is that of its contact rows, which are the last ones [N/m]. `forces`
/// becomes the force of every row, and of every joint's dry friction behind them [N]; it has the room.
/// `max_sweeps` bounds the sweeps; Newton's method has a bound of its own.
SolverResult solve_penalty(std::span<const double> stiffness, int max_sweeps, ReservedVector<double>& forces,
                           ContactProblem& problem) noexcept;

}  // namespace tactum::inline v0_1
