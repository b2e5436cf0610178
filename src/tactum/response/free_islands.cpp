#include "tactum/response/free_islands.h"

#include <algorithm>
#include <limits>

#include "tactum/dynamics/body_load.h"
#include "tactum/dynamics/solver_choice.h"
#include "tactum/math/screw.h"
#include "tactum/response/grasped_part.h"
#include "tactum/response/joined_bodies.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// An island while its problem is solved.
struct IslandProblem {
  ConstraintStep& step;
  Index island;
  std::span<const int> bodies, rows;  ///< numbers of bodies of the world, and of contact rows
  ContactProblem& problem;
  std::span<ContactRow> contacts = {};  ///< copies of the rows
  RowsInProblem in_problem = {};
  double share_of_wanted = 1.0;  ///< how much of the hands' displacements grasped parts are asked for
};

/// Whether nothing acts on the island: one free body that touches nothing.
bool is_idle(const IslandProblem& p) {
  return p.rows.empty() && p.bodies.size() == 1 && !is_grasped(p.step, Index(p.bodies[0])) &&
         p.step.world.bodies[Index(p.bodies[0])].joint.kind == JointKind::kFree;
}

/// Adds the bodies of the island, and its rows; with `opening` the rows ask gaps below the skin to open.
/// Without it the copies of the rows lose what they asked for, also for a later call with it.
void assemble(bool exact, bool opening, IslandProblem& p) {
  const ConstraintStep& step = p.step;
  p.problem.clear();
  for (const int body : p.bodies) {
    const Index i = Index(body);
    if (is_grasped(step, i)) {
      add_grasped(body, p.share_of_wanted, step, p.problem);
      continue;
    }
    const Body& what = step.world.bodies[i];
    const Pose& X_WB = step.bodies.X_WB[i];
    p.problem.add_body_and_joint(
        step.world, placed(step.world, step.bodies, body), X_WB.p, damped_metric(what, X_WB, step.dt_s),
        to_vector(step.own.free.V_free[i] * step.dt_s + step.own.free.detour[i]), step.dt_s);
  }
  p.problem.add_pair_joints(step.world, step.bodies, step.dt_s);
  p.problem.add_joint_rows(exact);
  p.in_problem = {p.contacts, p.problem.rows()};
  for (ContactRow& row : p.contacts) {
    if (!opening) row.asked = std::min(0.0, row.asked);
    p.problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
  }
}

/// Adds the momentum that the bodies that count receive from a force.
void give(const SurfacePair& bodies, const Vec3& force_W, const IslandProblem& p) {
  FreeBodies& f = p.step.own.free;
  f.given_Ns[p.island] += f.momentum.counted(bodies.body_a, bodies.body_b, p.step.dt_s * force_W);
}

/// Takes back what an answer has reported of friction, before another.
void forget_friction(const IslandProblem& p) {
  FreeBodies& f = p.step.own.free;
  f.given_Ns[p.island].setZero();
  if (!f.grasped_here || f.islands.of(first_grasped(p.step.hands)) != static_cast<int>(p.island)) return;
  p.step.own.contact_rows.rows.resize(p.step.own.constraint.rows.count);
  for (CoupledHand& hand : p.step.own.constraint.hands) hand.torque.setZero();
}

/// Reports the friction force on grasped parts as a row of its own, and its torque beside it.
void report_friction(const FrictionPatch& patch, const Vec3& force_W, const Vec3& torque_W,
                     const IslandProblem& p) {
  give(patch.surfaces, force_W, p);
  if (!is_grasped(p.step, Index(patch.surfaces.body_a)) && !is_grasped(p.step, Index(patch.surfaces.body_b)))
    return;
  append_friction(patch, -1, force_W, p.step.dt_s, p.step.own.contact_rows.rows);
  add_friction_torque(patch.surfaces, torque_W, p.step);
}

/// The smallest skin of the island's contacts, or of its bodies where nothing touches [m].
double least_skin(const IslandProblem& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const ContactRow& row : p.contacts) least = std::min(least, row.skin_m);
  if (p.contacts.empty())
    for (const int body : p.bodies) least = std::min(least, p.step.own.constraint.skin_m[Index(body)]);
  return least;
}

/// Sets the velocities of the bodies to those of the problem's answer.
void set_velocities(const IslandProblem& p) {
  const ConstraintStep& step = p.step;
  for (const ProblemBody& body : p.problem.bodies()) {
    const Twist displacement = to_twist(p.problem.displacement(body.body));
    step.bodies.V_WB[Index(body.body)] =
        (displacement - step.own.free.detour[Index(body.body)]) * (1.0 / step.dt_s);
  }
}

/// Solves again, by `solve`, with the errors that the step leaves in the joints between bodies.
template <class Solve>
void close_joints(const IslandProblem& p, const Solve& solve) {
  if (p.problem.equalities() == 0) return;
  const ConstraintStep& step = p.step;
  std::vector<Pose>& X_trial = p.step.own.constraint.trial.X_WB;
  JointErrors errors;
  while (errors.go_on()) {
    set_velocities(p);
    for (const int body : p.bodies)
      X_trial[Index(body)] =
          constrained_pose(step.world.bodies[Index(body)],
                           advanced(step.bodies.X_WB[Index(body)], mean_twist(step, Index(body)), step.dt_s));
    if (errors.closed(p.problem.correct_pair_joints(step.world, X_trial)) || !solve()) return;
  }
}

/// The exact solution; false when there is none, or the iterations ran out.
bool solve_exact(IslandProblem& p) {
  ConstraintState& c = p.step.own.constraint;
  const FrictionInput input{p.step.bodies.X_WB, c.anchors};
  ExactResult result;
  for (const bool opening : {true, false}) {
    assemble(true, opening, p);
    ExactStart start;
    for (Index i = 0; i < p.contacts.size(); ++i) {
      const int state = p.contacts[i].state;
      if (state < 0 || !(c.rows.memory[state].force_N > 0.0)) continue;
      start.without_friction.push_back(static_cast<int>(p.in_problem.first + i));
    }
    start.sticking = start.without_friction;
    result = solve_exactly(p.in_problem, input, p.step.settings.budget.solver_iterations, start, c.friction,
                           p.problem);
    p.step.report.solver_iterations += result.iterations;
    if (!result.solved) continue;
    close_joints(p, [&] {
      result =
          solve_again(p.in_problem, p.step.settings.budget.solver_iterations, start, c.friction, p.problem);
      p.step.report.solver_iterations += result.iterations;
      return result.solved;
    });
    if (result.solved) break;
  }
  if (!result.solved) {  // the sweeps that follow are to open what is too near
    for (Index i = 0; i < p.contacts.size(); ++i)
      p.contacts[i].asked = p.step.own.contact_rows.rows[Index(p.rows[i])].asked;
    return false;
  }
  p.step.report.solvers |= static_cast<int>(ContactSolver::kExact);
  for (ContactRow& row : p.contacts) row.impulse = 0.0;
  for (const QpActive& active : p.problem.answer().active)
    if (p.in_problem.row(active.row) != nullptr)
      p.contacts[Index(active.row) - p.in_problem.first].impulse = active.multiplier * p.step.dt_s;
  for (const ContactRow& row : p.contacts)
    if (row.state >= 0) c.rows.memory[row.state].force_N = row.impulse / p.step.dt_s;
  c.friction.for_each_force(p.problem, [&](Index patch, const Push& push, double multiplier) {
    report_friction(c.friction.patches()[patch], multiplier * push.force, multiplier * push.torque, p);
  });
  if (c.friction.no_room()) p.step.report.flags |= frame_flag::kCapacityReached;
  c.friction.end(p.in_problem, p.problem, p.step.bodies.X_WB, c.anchors);
  return true;
}

void solve_many(IslandProblem& p) {
  ConstraintState& c = p.step.own.constraint;
  IslandForces& forces = p.step.own.free.forces;
  assemble(false, true, p);
  forces.begin(p.in_problem, p.step.bodies.X_WB, c.anchors, c.rows.memory, p.step.dt_s, p.problem);
  // The error that is left moves nothing by more than the skin, and every step is tested before it is taken.
  const int most = p.step.settings.budget.solver_iterations;
  bool converged = false;
  const auto solve = [&] {
    const IterativeResult result =
        solve_iteratively(most, least_skin(p), p.step.own.free.newton, forces, p.problem);
    if (result.by_sweeps) p.step.report.solvers |= static_cast<int>(ContactSolver::kSweeps);
    if (result.by_newton) p.step.report.solvers |= static_cast<int>(ContactSolver::kNewton);
    p.step.report.solver_iterations += result.iterations;
    converged = result.converged;
    return converged;
  };
  solve();
  close_joints(p, solve);
  if (!converged) {
    p.step.report.flags |= frame_flag::kSolverBounded;
    for (const int body : p.bodies) p.step.own.free.unconverged[Index(body)] = 1;
  }
  forces.keep_anchors(p.in_problem, p.step.bodies.X_WB, p.problem, c.anchors);
  forces.end(p.contacts, c.rows.memory);
  for (Index i = 0; i < forces.patches().size(); ++i)
    report_friction(forces.patches()[i], forces.friction_force(i), forces.friction_torque(i), p);
}

/// Where the answer has a grasped part beyond its motion bound, as a hand does that is far ahead, what it
/// meets would be pushed to the speed of a step that it does not make. The island is then solved again, with
/// as much of the hands' displacements as leaves the parts within the bounds. What is felt is that of the
/// first answer.
void follow_slower(IslandProblem& p) {
  const ConstraintStep& step = p.step;
  double share = 1.0;
  for (const HandInput& hand : step.hands) {
    if (hand.grasped.body < 0) continue;
    const Index grasped = Index(hand.grasped.body);
    const Twist displacement = to_twist(p.problem.displacement(hand.grasped.body));
    const double travel = displacement.v.norm() + displacement.w.norm() * step.radius_m[grasped];
    if (travel > step.own.motion_bound[grasped])
      share = std::min(share, step.own.motion_bound[grasped] / travel);
  }
  if (share == 1.0) return;
  p.share_of_wanted = share;
  step.report.flags |= step.own.constraint.trust.limit;
  forget_friction(p);
  solve_many(p);
}

void solve_island(IslandProblem& p) {
  const ConstraintStep& step = p.step;
  if (is_idle(p)) {
    step.own.free.A_contacts[Index(p.bodies[0])] = {};
    return;
  }
  Index unknowns = 0;
  bool coupled_to_hand = false;
  bool jointed = false;
  for (const int body : p.bodies) {
    const Body& what = step.world.bodies[Index(body)];
    unknowns += exact_unknowns_of(step.world, what);
    coupled_to_hand |= is_grasped(step, Index(body));
    jointed |= what.pair_joint >= 0;
  }
  const bool exact =
      choose_solver(unknowns, coupled_to_hand || jointed) == ContactSolver::kExact && solve_exact(p);
  if (!exact) solve_many(p);
  if (coupled_to_hand) {
    feel_answer(p.problem, p.step);
    follow_slower(p);
  }
  for (const ContactRow& row : p.contacts) give(row, row.impulse / step.dt_s * row.n_BA_W, p);
  set_velocities(p);
  FreeBodies& f = step.own.free;
  for (const ProblemBody& body : p.problem.bodies()) {
    const Index i = Index(body.body);
    f.A_contacts[i] = (step.bodies.V_WB[i] - f.V_free[i]) * (1.0 / step.dt_s);
  }
}

}  // namespace

bool moves_here(const ConstraintStep& step, Index body) noexcept {
  const FreeBodies& f = step.own.free;
  if (!f.islands.moves(static_cast<int>(body))) return false;
  return f.grasped_island < 0 || f.islands.of(static_cast<int>(body)) != f.grasped_island;
}

Twist mean_twist(const ConstraintStep& step, Index body) noexcept {
  Twist V = step.bodies.V_WB[body] + step.own.free.detour[body] * (1.0 / step.dt_s);
  if (step.own.free.joined[body]) V.w += change_of_axis(step, body);
  return V;
}

void begin_islands(ConstraintStep& step) noexcept {
  FreeBodies& f = step.own.free;
  const Index bodies = step.world.bodies.size();
  const std::span<const ContactRow> rows = step.own.contact_rows.rows;
  f.bodies.set(bodies, bodies,
               [&](Index i) { return moves_here(step, i) ? f.islands.of(static_cast<int>(i)) : -1; });
  f.rows.set(bodies, rows.size(), [&](Index r) {
    return r < step.own.constraint.rows.own ? -1 : f.islands.of_contact(rows[r].body_a, rows[r].body_b);
  });
  std::fill(f.unconverged.begin(), f.unconverged.end(), 0);
  f.V_free = step.bodies.V_WB;  // same size: nothing is allocated
  if (f.grasped_here) find_wanted(step);
}

void solve_islands(ConstraintStep& step) noexcept {
  FreeBodies& f = step.own.free;
  std::vector<ContactRow>& rows = step.own.contact_rows.rows;
  for (Index island = 0; island < f.given_Ns.size(); ++island) {
    IslandProblem p{step, island, f.bodies[island], f.rows[island], step.own.constraint.problem};
    if (p.bodies.empty() || f.settled[island] != 0) continue;
    forget_friction(p);
    f.gathered.clear();
    for (const int row : p.rows) f.gathered.push_back(rows[Index(row)]);
    p.contacts = f.gathered;
    solve_island(p);
    for (Index i = 0; i < p.rows.size(); ++i) rows[Index(p.rows[i])].impulse = f.gathered[i].impulse;
  }
}

}  // namespace tactum::inline v0_1
