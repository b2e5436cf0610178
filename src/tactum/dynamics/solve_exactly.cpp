#include "tactum/dynamics/solve_exactly.h"

namespace tactum::inline v0_1 {
namespace {

/// How often patches that slid are allowed further slip: each round leaves the fraction mu^2 of the error.
constexpr int kSlipRounds = 6;

bool solve_on(int max_iterations, ContactProblem& problem, ExactResult& result) {
  const QpAnswer& answer = problem.solve_on(max_iterations);
  result.iterations += answer.iterations;
  result.bounded |= answer.status == QpStatus::kBounded;
  result.solved = answer.status == QpStatus::kSolved;
  return result.solved;
}

/// How often the loads of sliding patches are updated from the answer with them: for one body, whose
/// solutions cost little, until they stay; for several only while that takes no longer than all the rest.
constexpr int kSlidingRounds = 60;
constexpr int kSlidingRoundsOfSeveral = 16;

/// Solves with every patch sticking, then allows slip where it must be, until no patch slips further.
void solve_cones(const RowsInProblem& contacts, int max_iterations, ExactStart& start, Friction& friction,
                 ContactProblem& problem, ExactResult& result) {
  for (int round = 0; round <= kSlipRounds; ++round) {
    if (!solve_on(max_iterations, problem, result)) {
      friction.forget_anchors(problem);
      solve_on(max_iterations, problem, result);
    }
    if (!result.solved) return;
    if (round == 0) {
      list_pushing(contacts, problem, start.sticking);
      friction.note_sticking(problem);
    }
    if (!friction.update_slip(problem)) return;
  }
}

/// Replaces the cones of sliding patches by loads.
void solve_sliding(const RowsInProblem& contacts, int max_iterations, Friction& friction,
                   ContactProblem& problem, ExactResult& result) {
  const int rounds = problem.bodies().size() == 1 ? kSlidingRounds : kSlidingRoundsOfSeveral;
  for (int round = 0; round < rounds; ++round) {
    if (!friction.update_sliding(contacts, problem)) return;
    if (solve_on(max_iterations, problem, result)) continue;
    friction.refuse_loads(problem);
    solve_on(max_iterations, problem, result);
    return;
  }
}

void solve_with_friction(const RowsInProblem& contacts, int max_iterations, ExactStart& start,
                         Friction& friction, ContactProblem& problem, ExactResult& result) {
  solve_cones(contacts, max_iterations, start, friction, problem, result);
  if (result.solved) solve_sliding(contacts, max_iterations, friction, problem, result);
  if (result.solved) return;
  friction.refuse_loads(problem);
  friction.clear();
  problem.forget_cones();
  solve_on(max_iterations, problem, result);
}

/// Begins with the rows that pushed in the last frame while every patch stuck, if any did. For one body there
/// are so few rows that it costs no more to continue from the answer without friction.
void begin_sticking(const RowNumbers& last, const Friction& friction, ContactProblem& problem) {
  if (problem.bodies().size() == 1) return;
  RowNumbers rows = last;
  friction.rows_that_stuck(rows);
  if (rows.size() > last.size()) problem.begin({rows.begin(), rows.end()});
}

}  // namespace

void list_pushing(const RowsInProblem& contacts, const ContactProblem& problem, RowNumbers& rows) noexcept {
  rows.clear();
  for (const QpActive& active : problem.answer().active)
    if (contacts.row(active.row) != nullptr) rows.push_back(active.row);
}

ExactResult solve_once(int max_iterations, ContactProblem& problem) noexcept {
  ExactResult result;
  solve_on(max_iterations, problem, result);
  return result;
}

ExactResult solve_exactly(const RowsInProblem& contacts, const FrictionInput& input, int max_iterations,
                          ExactStart& start, Friction& friction, ContactProblem& problem) noexcept {
  ExactResult result;
  friction.clear();
  problem.begin({start.without_friction.begin(), start.without_friction.end()});
  const bool found = solve_on(max_iterations, problem, result);
  list_pushing(contacts, problem, start.without_friction);
  if (!found || !friction.begin(contacts, input.X_WB, input.anchors, problem)) return result;
  begin_sticking(start.sticking, friction, problem);
  solve_with_friction(contacts, max_iterations, start, friction, problem, result);
  return result;
}

ExactResult solve_again(const RowsInProblem& contacts, int max_iterations, ExactStart& start,
                        Friction& friction, ContactProblem& problem) noexcept {
  ExactResult result;
  if (friction.acts()) {
    solve_with_friction(contacts, max_iterations, start, friction, problem, result);
  } else {
    solve_on(max_iterations, problem, result);
  }
  return result;
}

}  // namespace tactum::inline v0_1
