#pragma once
/// The exact solver of the contact problem, for few bodies: the active set method of small_qp.h, first
/// without friction, then with a cone for every patch that pushes (friction.h).

#include "tactum/dynamics/friction.h"

namespace tactum::inline v0_1 {

/// Numbers of rows of the problem.
using RowNumbers = StaticVector<int, kMostUnknowns>;

/// Rows to begin with, as a rule those that pushed in the last frame; after the solution those that push now.
struct ExactStart {
  RowNumbers without_friction;
  RowNumbers sticking;  ///< while every patch sticks
};

struct ExactResult {
  bool solved = false;   ///< false: no displacement satisfies all rows, or the iterations ran out
  bool bounded = false;  ///< the iterations ran out
  int iterations = 0;
};

/// The input of friction in the exact solver, beside the contacts.
struct FrictionInput {
  std::span<const Pose> X_WB;  ///< of all bodies of the world, at the start of the step
  const FrictionAnchors& anchors;
};

/// Solves the problem, whose contact rows are `contacts`. Friction is that of the rows' coefficients. Where
/// no answer satisfies the anchors' rows, the anchors are given up; where there is no answer at all,
/// friction. With friction there are several solutions, one after the other (each round of slip and of
/// sliding is one), and each of them may take `max_iterations`.
ExactResult solve_exactly(const RowsInProblem& contacts, const FrictionInput& input, int max_iterations,
                          ExactStart& start, Friction& friction, ContactProblem& problem) noexcept;

/// Solves a problem without friction, beginning with the rows that were chosen, or with those that push.
ExactResult solve_once(int max_iterations, ContactProblem& problem) noexcept;

/// Solves again from the last answer, after rows were tightened; the patches and their slip stay.
ExactResult solve_again(const RowsInProblem& contacts, int max_iterations, ExactStart& start,
                        Friction& friction, ContactProblem& problem) noexcept;

/// The contact rows that push in the last answer.
void list_pushing(const RowsInProblem& contacts, const ContactProblem& problem, RowNumbers& rows) noexcept;

}  // namespace tactum::inline v0_1
