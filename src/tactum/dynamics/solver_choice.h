#pragma once
/// The choice of the solver for a contact problem; the one place where it is made.

#include "tactum/dynamics/contact_problem.h"

namespace tactum::inline v0_1 {

/// A bit each, so that a report can name all that were at work.
enum class ContactSolver : std::uint8_t {
  kExact = 1,    ///< the active set method, solve_exactly.h
  kSweeps = 2,   ///< projected Gauss-Seidel, solve_by_sweeps.h
  kPenalty = 4,  ///< rows that yield, solve_penalty.h
};

/// Unknowns of an island that only the inertia of its bodies resists: two free bodies. Beyond that the
/// sweeps, which begin with the last frame's forces, take less time for bodies at rest.
inline constexpr std::size_t kMostExactAlone = 12;

/// For rows that do not yield. `coupled`: a coupling pulls one of the island's bodies, so its forces are
/// felt, or joints join its bodies; then the exact solver, as long as it has room for the unknowns. One of
/// these is counted for each joint's dry friction.
inline ContactSolver choose_solver(std::size_t exact_unknowns, bool coupled) noexcept {
  const std::size_t most = coupled ? kMostUnknowns : kMostExactAlone;
  return exact_unknowns <= most ? ContactSolver::kExact : ContactSolver::kSweeps;
}

}  // namespace tactum::inline v0_1
