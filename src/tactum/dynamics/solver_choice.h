#pragma once
/// Which solver answers a contact problem; the one place where that is decided.

#include "tactum/dynamics/contact_problem.h"

namespace tactum {

/// A bit each, so that a report can name all that were at work.
enum class ContactSolver : std::uint8_t {
  kNone = 0,
  kExact = 1,    ///< the active set method, solve_exactly.h
  kSweeps = 2,   ///< projected Gauss-Seidel, solve_by_sweeps.h
  kPenalty = 4,  ///< rows that yield, solve_penalty.h
};

/// For rows that do not yield: the exact solver as long as it has room for the unknowns, one for each joint's
/// dry friction among them.
inline ContactSolver choose_solver(std::size_t exact_unknowns) noexcept {
  return exact_unknowns <= kMostUnknowns ? ContactSolver::kExact : ContactSolver::kSweeps;
}

}  // namespace tactum
