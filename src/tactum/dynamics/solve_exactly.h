#pragma once
/// The exact solver of the contact problem, for few bodies: the active set method of small_qp.h, first
/// without friction, then with a cone for every patch that pushes (friction.h).

#include "tactum/dynamics/friction.h"

namespace tactum::inline v0_1 {

/// Numbers of rows of the problem.
using RowNumbers = StaticVector<int, kMostUnknowns>;

/// Rows to begin with, as a rule those that pushed in the last frame; afterwards those that push now.
struct ExactStart {
  RowNumbers without_friction;
  RowNumbers sticking;  ///< while every patch sticks
};

struct ExactResult {
  bool solved = false;   ///< false: no displacement keeps all rows, or the iterations ran out
  bool bounded = false;  ///< the iterations ran out
  int iterations = 0;
};

/// What friction in the exact solver needs beside the contacts.
struct FrictionInput {
  std::span<const Pose> X_WB;  ///< of all bodies of the world, at the start of the step
  ContactScale scale;
  const FrictionAnchors& anchors;
};

/// Solves the problem, whose contact rows are `contacts`. Friction is that of the rows' coefficients. Where
/// no answer keeps the anchors they are taken off; where there is none at all, friction.
ExactResult solve_exactly(const RowsInProblem& contacts, const FrictionInput& input, int max_iterations,
                          ExactStart& start, Friction& friction, ContactProblem& problem) noexcept;

/// Solves a problem without friction, from the rows it was begun with, or from those that push.
ExactResult solve_once(int max_iterations, ContactProblem& problem) noexcept;

/// Goes on from the last answer, after rows were tightened; patches stay what they are.
ExactResult solve_again(const RowsInProblem& contacts, int max_iterations, ExactStart& start,
                        Friction& friction, ContactProblem& problem) noexcept;

/// The contact rows that push in the last answer.
void list_pushing(const RowsInProblem& contacts, const ContactProblem& problem, RowNumbers& rows) noexcept;

}  // namespace tactum::inline v0_1
