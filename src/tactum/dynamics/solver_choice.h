#pragma once
/// The choice of the solver for a contact problem; the one place where it is made.
///
/// Islands of more bodies than the exact solver takes are solved iteratively: first by a few sweeps from the
/// forces of the last frame, which is all that a heap at rest takes. Where they have not settled, by Newton's
/// method if a round of that costs few sweeps, as with towers and rows of bodies, and else by sweeps. At
/// worst, when all of these fail, it takes as long as three times the sweeps that are allowed.

#include "tactum/dynamics/solve_by_newton.h"

namespace tactum::inline v0_1 {

/// A bit each, so that a report can name all that were at work.
enum class ContactSolver : std::uint8_t {
  kExact = 1,    ///< the active set method, solve_exactly.h
  kSweeps = 2,   ///< projected Gauss-Seidel, solve_by_sweeps.h
  kPenalty = 4,  ///< rows that yield, solve_penalty.h
  kNewton = 8,   ///< the method of multipliers, solve_by_newton.h
};

/// Unknowns of an island that only the inertia of its bodies resists: two free bodies. Beyond that the
/// iterative solvers, which begin with the last frame's forces, take less time for bodies at rest.
inline constexpr std::size_t kMostExactAlone = 12;

/// For rows that do not yield. `coupled`: a coupling pulls one of the island's bodies, so its forces are
/// felt, or joints join its bodies; then the exact solver, as long as it has room for the unknowns. One of
/// these is counted for each joint's dry friction. kSweeps stands for both iterative solvers: which of the
/// two gives the answer is found on the way (solve_iteratively()).
inline ContactSolver choose_solver(std::size_t exact_unknowns, bool coupled) noexcept {
  const std::size_t most = coupled ? kMostUnknowns : kMostExactAlone;
  return exact_unknowns <= most ? ContactSolver::kExact : ContactSolver::kSweeps;
}

struct IterativeResult : SolverResult {
  bool by_sweeps = false, by_newton = false;  ///< what gave the answer
};

/// Takes a problem after IslandForces::begin(). When it has converged, no displacement is farther than
/// `harmless_m` from the answer.
IterativeResult solve_iteratively(int max_sweeps, double harmless_m, NewtonSolver& newton,
                                  IslandForces& forces, ContactProblem& problem) noexcept;

}  // namespace tactum::inline v0_1
