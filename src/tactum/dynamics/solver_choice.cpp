#include "tactum/dynamics/solver_choice.h"

#include "tactum/dynamics/solve_by_sweeps.h"

namespace tactum::inline v0_1 {
namespace {

/// The sweeps before Newton's method: one in so many of all.
constexpr int kFirstShare = 10;

/// Newton's method is worth beginning when there is time for so many rounds; two to ten are usual.
constexpr double kFewestRounds = 16.0;

}  // namespace

IterativeResult solve_iteratively(int max_sweeps, double harmless_m, NewtonSolver& newton,
                                  IslandForces& forces, ContactProblem& problem) noexcept {
  IterativeResult result;
  forces.begin_solution(problem);
  const int first = max_sweeps / kFirstShare;
  if (newton.begin(forces, problem) && kFewestRounds * newton.sweeps_per_round() <= max_sweeps - first) {
    static_cast<SolverResult&>(result) = begin_by_sweeps(first, forces, problem);
    result.by_sweeps = result.converged;
    if (result.converged) return result;
    NewtonSolver::Result solved;
    const auto solve = [&] {
      solved = newton.solve(max_sweeps - first, harmless_m, forces, problem);
      result.iterations += solved.iterations;
      result.converged = solved.converged;
      return solved.converged;
    };
    // What is wedged has no answer before its contacts need no longer open.
    const bool solved_open = solve() || (solved.usable && !forces.is_wedged(problem));
    if (!solved_open && forces.close_only(problem)) solve();
    result.by_newton = solved.converged || solved.usable;
    if (result.by_newton) {
      forces.bound_friction(problem);
      return result;
    }
    forces.restart(problem);
  }
  const SolverResult swept = solve_by_sweeps(max_sweeps, harmless_m, forces, problem);
  result.iterations += swept.iterations;
  result.converged = swept.converged;
  result.by_sweeps = true;
  return result;
}

}  // namespace tactum::inline v0_1
