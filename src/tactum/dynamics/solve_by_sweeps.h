#pragma once
/// The solver of the contact problem for any number of bodies: projected Gauss-Seidel from the forces of the
/// last frame [Stewart 1996], with momentum from sweep to sweep [Nesterov 1983; Mazhar 2015]: plain sweeps
/// carry a load through a stack of ten boxes too slowly. A heap at rest begins at its answer and stays there.
///
/// A problem whose sweeps have not converged after a third of their number is set back to the forces it began
/// with, and its contacts no longer open (IslandForces::close_only). Where friction makes forces grow from
/// sweep to sweep, it may not exceed its last value in the last sweeps.
///
/// Where loads pass through many bodies, sweeps come nearer to the answer by a little each: changes are then
/// small long before the answer is near. What is still missing is therefore estimated from the rate at which
/// changes fall, and only that says whether the sweeps have converged.

#include "tactum/dynamics/island_forces.h"

namespace tactum::inline v0_1 {

/// Makes at most so many sweeps in which every contact has to open, after IslandForces::begin_solution().
/// They have converged when the last one changed no velocity by more than tolerances::kRestingVelocity: a
/// higher bound would take a pile for settled that loads have only begun to go through.
SolverResult begin_by_sweeps(int max_sweeps, IslandForces& forces, ContactProblem& problem) noexcept;

/// Makes at most `max_sweeps` sweeps, after IslandForces::begin_solution(). They have converged when no
/// displacement is farther than `harmless_m` from the answer, as far as the fall of the changes tells; sweeps
/// go on until changes are far smaller.
SolverResult solve_by_sweeps(int max_sweeps, double harmless_m, IslandForces& forces,
                             ContactProblem& problem) noexcept;

}  // namespace tactum::inline v0_1
