#include "tactum/response/constraint.h"

#include <algorithm>
#include <utility>

#include "tactum/base/frame_rate.h"
#include "tactum/base/tolerances.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/math/screw.h"
#include "tactum/response/constraint_rows.h"
#include "tactum/response/constraint_trial.h"
#include "tactum/response/field_pull.h"
#include "tactum/response/free_bodies.h"
#include "tactum/response/grasped_part.h"
#include "tactum/response/joined_bodies.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The growth of the trust region radius: the next radius is so many times as long as the last step.
constexpr double kTrustGrowth = 2.0;
/// By how much motion bounds exceed the trust region radius, in skins.
constexpr double kBoundMargin = 4.0;
/// When the steps of a part have been refused for so long, the wrench that is felt is that where it stands,
/// not where the forces would have it: that one would be the same however far the hand goes away.
constexpr double kStands_s = 0.002;

/// While a path between two surfaces takes too many tests to be proven, poses on it that lie no farther apart
/// are tested, in a scene of a hand's size: minima of the distance there then show a crossing.
constexpr double kUnprovenStep_m = 3e-5;
/// ... and so many of them in a frame, the last at its end. As many times as long may a step be.
constexpr int kMostLooks = 4;

/// Adds the bodies of the island and their targets: that of a grasped part leads to its hand, the others' on
/// along their motion; `at_rest` all targets are where the bodies are.
void add_bodies(bool at_rest, ConstraintStep& step) {
  ContactProblem& problem = step.own.constraint.problem;
  problem.clear();
  if (!at_rest) find_wanted(step);
  for (const HandInput& hand : step.hands) {
    if (hand.grasped.body < 0 || !hand.bears_load) continue;  // added once
    if (at_rest)
      add_grasped_at_rest(hand.grasped.body, step, problem);
    else
      add_grasped(hand.grasped.body, 1.0, step, problem);
  }
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const int b = static_cast<int>(i);
    if (!step.own.free.near_grasped[i] || is_grasped(step, i)) continue;
    const Body& body = step.world.bodies[i];
    const Pose& X_WB = step.bodies.X_WB[i];
    const Vec6 on =
        at_rest ? Vec6(Vec6::Zero()) : to_vector(step.bodies.V_WB[i] * step.dt_s + step.own.free.detour[i]);
    problem.add_body_and_joint(step.world, placed(step.world, step.bodies, b), X_WB.p,
                               damped_metric(body, X_WB, step.dt_s), on, step.dt_s);
  }
  problem.add_pair_joints(step.world, step.bodies, step.dt_s);
  problem.add_joint_rows(true);
}

/// Adds the iterations of an answer to the report. True when it solves the problem.
bool solved(const ExactResult& result, FrameReport& report) {
  report.solver_iterations += result.iterations;
  report.solvers |= static_cast<int>(ContactSolver::kExact);
  if (result.bounded) report.flags |= frame_flag::kSolverBounded;
  return result.solved;
}

using RowNames = StaticVector<std::uint64_t, kMostUnknowns>;

/// The contact rows in the problem of the forces.
RowsInProblem contacts_of(ConstraintStep& step) { return {own_rows(step), step.own.constraint.rows.first}; }

/// The names of contact rows.
RowNames names_of(const RowNumbers& rows, ConstraintStep& step) {
  RowNames names;
  const RowsInProblem contacts = contacts_of(step);
  for (const int row : rows) names.push_back(step.own.constraint.rows.name_of(*contacts.row(row)));
  return names;
}

/// The numbers of contact rows whose first has the number `first`.
RowNumbers rows_of(const RowNames& names, Index first, ConstraintStep& step) {
  RowNumbers rows;
  if (names.empty()) return rows;
  const std::span<const ContactRow> own = own_rows(step);
  for (Index row = 0; row < own.size(); ++row)
    if (std::find(names.begin(), names.end(), step.own.constraint.rows.name_of(own[row])) != names.end())
      rows.push_back(static_cast<int>(first + row));
  return rows;
}

/// Solves a problem without friction, beginning with the rows that pushed in the last frame.
bool solve_frictionless(Index first_row, ContactProblem& problem, ConstraintStep& step) {
  const RowNumbers rows = rows_of(step.own.constraint.warm_start.in_the_end, first_row, step);
  problem.begin({rows.begin(), rows.end()});
  return solved(solve_once(step.settings.budget.solver_iterations, problem), step.report);
}

/// Keeps the forces of the answer: impulses, the rows that push, the wrenches at handles. They are those of
/// the whole step, however much of it is then taken.
void keep_forces(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  RowNumbers pushing;
  list_pushing(contacts_of(step), c.problem, pushing);
  c.warm_start.in_the_end = names_of(pushing, step);
  for (ContactRow& row : own_rows(step)) row.impulse = 0.0;
  for (const QpActive& active : c.problem.answer().active)
    if (contacts_of(step).row(active.row) != nullptr)
      own_rows(step)[Index(active.row) - c.rows.first].impulse = active.multiplier * step.dt_s;
  step.report.active_constraints = static_cast<int>(pushing.size());
  feel_answer(c.problem, step);
}

/// How far a body goes in the answer's step.
struct Extent {
  double travel_m = 0.0;   // of its farthest point
  double trusted_m = 0.0;  // ... that is within its motion bound
  double turn_rad = 0.0;
};
Extent extent_of(const ConstraintStep& step, const ProblemBody& problem_body) {
  const ConstraintState& c = step.own.constraint;
  const Index body = Index(problem_body.body);
  const Vec6 x = c.step_problem().displacement(problem_body.body);
  const double turn = x.tail<3>().norm();
  return {x.head<3>().norm() + turn * step.radius_m[body],
          step.own.motion_bound[body] - kBoundMargin * c.skin_m[body], turn};
}

/// The fraction of the answer's step that is trusted: with it no body of the island goes beyond its motion
/// bound less kBoundMargin skins, and a grasped part turns no farther than it may. Zero where nothing of a
/// bound is left, as of a body at rest, without gravity, that the part has just met.
double trusted_share(const ConstraintStep& step) {
  double share = 1.0;
  for (const ProblemBody& problem_body : step.own.constraint.step_problem().bodies()) {
    const Extent extent = extent_of(step, problem_body);
    if (extent.travel_m * share > extent.trusted_m) share = extent.trusted_m / extent.travel_m;
    if (extent.turn_rad * share > step.limits.turn_rad && is_grasped(step, Index(problem_body.body)))
      share = step.limits.turn_rad / extent.turn_rad;
  }
  return share;
}

/// Flags of the limits that cut the answer's step of grasped parts, where those limits will not grow.
std::uint32_t limit_of_step(const ConstraintStep& step) {
  const ConstraintState& c = step.own.constraint;
  std::uint32_t flags = 0;
  for (const ProblemBody& problem_body : c.step_problem().bodies()) {
    if (!is_grasped(step, Index(problem_body.body))) continue;
    const Extent extent = extent_of(step, problem_body);
    const double turns = extent.turn_rad / step.limits.turn_rad;
    const double travels = extent.travel_m / extent.trusted_m;
    if (!(std::max(turns, travels) > 1.0)) continue;
    flags |= turns > travels ? frame_flag::kTurnLimited : c.trust.limit;
  }
  return flags;
}

/// Moves everything by the fraction `share` of the answer's step, on trial. False where some pose is no pose.
bool try_step(double share, ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  c.trial.X_WB = step.bodies.X_WB;  // same size: nothing is allocated
  std::fill(c.trial.goes.begin(), c.trial.goes.end(), 0);
  for (const ProblemBody& problem_body : c.step_problem().bodies()) {
    const Index i = Index(problem_body.body);
    const Twist displacement = to_twist(c.step_problem().displacement(problem_body.body) * share);
    c.trial.goes[i] = 1;
    c.trial.turn[i] = turn_of(step.world.bodies[i], step.bodies.X_WB[i], displacement.w);
    c.trial.X_WB[i] =
        constrained_pose(step.world.bodies[i], advanced(step.bodies.X_WB[i], displacement, 1.0));
    if (!c.trial.X_WB[i].finite()) return false;
  }
  return true;
}

/// What a step on trial is found to be.
struct Trial {
  bool open = false;       // every gap is, at its end
  double path_free = 1.0;  // the fraction of the path there that is proven to be free; 1 unless `open`

  bool passed() const { return open && path_free == 1.0; }
};

/// Where something has crossed on the way to the end of a step, so much of it is tried next.
constexpr double kCutBetween = 0.5;

/// Whether nothing has crossed on the way to the end of a step whose path cannot be proven.
bool open_between(double share, ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  if (!c.trust.looks_between) return true;
  double travel_m = 0.0;
  for (const ProblemBody& body : c.step_problem().bodies())
    travel_m = std::max(travel_m, share * extent_of(step, body).travel_m);
  const int looks = std::min(kMostLooks, 1 + static_cast<int>(travel_m / (kUnprovenStep_m * step.scale)));
  for (int look = 1; look < looks; ++look) {
    if (!try_step(share * look / looks, step)) return false;
    join_trial(step);
    look_at_trial(0, step);
    for (Index p = 0; p < c.trial.gap_now.size(); ++p)
      if (step.patches[p].of_surfaces && crossed_at_trial(p, step)) return false;
  }
  return true;
}

/// Tries a step, with the bodies on their joints: every gap at its end is tested, and then the path there.
Trial look_after(double share, ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  if (!open_between(share, step)) return {true, kCutBetween};
  if (!try_step(share, step)) return {};
  join_trial(step);
  look_at_trial(0, step);
  for (Index p = 0; p < c.trial.gap_now.size(); ++p)
    if (closed_at_trial(p, step)) return {};
  const double path_free = least_path_free(step);
  c.trust.unproven |= c.trial.path_unproven;
  return {true, path_free};
}

void take_trial(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  step.bodies.X_WB.swap(c.trial.X_WB);
  for (Index p = 0; p < c.trial.gap_now.size(); ++p)
    if (step.own.free.patch_asked[p]) c.trial.gap_now[p] = c.trial.gap[p];
}

/// Opens contacts nearer than half the skin first, as far as there is room. The rows' distances are then
/// those of the new pose; their points and normals stay those of the old one, as a rule a few skins away.
void restore(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  bool tight = false;
  for (Index p = 0; p < c.trial.gap_now.size(); ++p)
    tight |= step.own.free.patch_asked[p] && c.trial.gap_now[p] < 0.5 * c.skin_of(step.patches[p]);
  if (!tight || grasped_blocked(step)) return;
  add_bodies(true, step);
  c.rows.first = add_contact_rows(true, c.problem, step);
  if (!solve_frictionless(c.rows.first, c.problem, step)) return;
  const double share = trusted_share(step);
  if (!look_after(share, step).passed()) return;
  for (const ProblemBody& body : c.problem.bodies())  // the step that follows has what is left of the bound
    step.own.motion_bound[Index(body.body)] -= share * extent_of(step, body).travel_m;
  for (ContactRow& row : own_rows(step)) row.distance = gap_at_trial(row, step);
  take_trial(step);
}

/// Finds the contact forces, with the shaded normals where shading bends some; then solves the position
/// problem, which leads to where these forces would have the bodies as far as the true normals allow. False
/// when there is no answer.
bool find_forces(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  add_bodies(false, step);
  c.rows.shades = c.rows.bent;
  if (c.rows.shades) exchange_normals(step);
  c.rows.first = add_contact_rows(false, c.problem, step);
  ExactStart start{.without_friction = rows_of(c.warm_start.without_friction, c.rows.first, step),
                   .sticking = rows_of(c.warm_start.sticking, c.rows.first, step)};
  const bool found =
      solved(solve_exactly(contacts_of(step), {step.bodies.X_WB, c.anchors},
                           step.settings.budget.solver_iterations, start, c.friction, c.problem),
             step.report);
  c.warm_start.without_friction = names_of(start.without_friction, step);
  c.warm_start.sticking = names_of(start.sticking, step);
  if (found) keep_forces(step);
  if (!c.rows.shades) return found;
  exchange_normals(step);
  c.position_problem.follow(c.problem);
  c.rows.first_of_positions = add_contact_rows(false, c.position_problem, step);
  return found && solve_frictionless(c.rows.first_of_positions, c.position_problem, step);
}

/// Solves again after a correction.
bool find_again(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  const int max_iterations = step.settings.budget.solver_iterations;
  if (c.rows.shades) return solved(solve_once(max_iterations, c.position_problem), step.report);
  ExactStart start;
  const bool found =
      solved(solve_again(contacts_of(step), max_iterations, start, c.friction, c.problem), step.report);
  if (found) keep_forces(step);
  return found;
}

/// Solves again with the errors that the answer's step leaves in joints between bodies, until none is left
/// that matters. False when there is no answer.
bool close_joints(ConstraintStep& step) {
  if (step.own.constraint.step_problem().equalities() == 0) return true;
  JointErrors errors;
  while (errors.go_on() && try_step(1.0, step)) {
    if (errors.closed(step.own.constraint.step_problem().correct_pair_joints(step.world,
                                                                             step.own.constraint.trial.X_WB)))
      return true;
    if (!find_again(step)) return false;
  }
  return true;
}

/// Looks for a step towards where the hand wants the part, as far as everything stays open; returns the
/// fraction of the answer that may be taken, whose pose is then the trial. Zero: none was found.
double advance(ConstraintStep& step) {
  if (!find_forces(step) || !close_joints(step)) return 0.0;
  if (grasped_blocked(step)) return 0.0;
  double share = 0.0;
  Trial trial;
  for (int round = 0; round <= kFeedbacks && !trial.open; ++round) {
    if (round > 0) {
      if (!(share > 0.0)) return 0.0;  // nothing may move: no exact gap can correct a row
      ++step.report.validation_retries;
      correct_rows(share, step);
      if (!find_again(step) || !close_joints(step)) break;
    }
    share = trusted_share(step);
    trial = look_after(share, step);
    if (trial.passed()) return share;
  }
  share = std::min(share, trusted_share(step));  // a correction that failed has left another answer
  for (int shorter = 0; shorter < kBacktracks; ++shorter) {
    ++step.report.validation_retries;
    share *= trial.open ? kOfFreePath * trial.path_free : 0.5;
    trial = look_after(share, step);
    if (trial.passed()) return share;
  }
  return 0.0;
}

/// Moves the island of the grasped part. The velocities of its bodies are their displacements over the frame,
/// less those that only opened gaps, which no force caused, and the detours by impacts. Returns the fraction
/// of the answer that was taken.
double move_grasped_island(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  step.own.free.patch_asked.clear();
  for (const ContactPatch& patch : step.patches)
    step.own.free.patch_asked.push_back(step.own.free.of_grasped(patch) ? 1 : 0);
  restore(step);
  const double share = advance(step);
  if (c.friction.no_room()) step.report.flags |= frame_flag::kCapacityReached;
  c.friction.end(contacts_of(step), c.problem, step.bodies.X_WB, c.anchors);
  c.trust.consecutive_rejections = share > 0.0 ? 0 : c.trust.consecutive_rejections + 1;
  if (share > 0.0 && share < 1.0) step.report.flags |= limit_of_step(step);
  if (share > 0.0) take_trial(step);
  if (c.trust.consecutive_rejections >= frames_in(kStands_s, step.dt_s)) feel_standing(step);
  const std::vector<Pose>& before = share > 0.0 ? c.trial.X_WB : step.bodies.X_WB;  // take_trial swaps them
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!step.own.free.near_grasped[i]) continue;
    Twist& detour = step.own.free.detour[i];
    const Twist V_free = step.bodies.V_WB[i];
    step.bodies.V_WB[i] =
        twist_between(before[i], step.bodies.X_WB[i], step.dt_s) - detour * (share / step.dt_s);
    step.own.free.A_contacts[i] = (step.bodies.V_WB[i] - V_free) * (share == 1.0 ? 1.0 / step.dt_s : 0.0);
    detour = {};
  }
  return share;
}

/// The trust region radius of the next frame, from the velocities of the grasped part's island. Where
/// constraint.h moved it these are what the bodies did; an island that was moved as a free one has those that
/// its forces led to, also where its step was cut.
void update_trust_length(ConstraintStep& step) {
  double travel = 0.0;
  for (Index i = 0; i < step.own.free.near_grasped.size(); ++i) {
    if (!step.own.free.near_grasped[i]) continue;
    const Twist& V_WB = step.bodies.V_WB[i];
    travel = std::max(travel, step.dt_s * (V_WB.v.norm() + V_WB.w.norm() * step.radius_m[i]));
  }
  const auto near = [&](int body) { return step.own.free.near_grasped[Index(body)] != 0; };
  const bool on_surfaces =
      std::any_of(step.patches.begin(), step.patches.end(), [&](const ContactPatch& patch) {
        return patch.of_surfaces && (near(patch.body_a) || near(patch.body_b));
      });
  StepTrust& trust = step.own.constraint.trust;
  trust.looks_between = std::exchange(trust.unproven, false);
  const int looks = step.own.free.grasped_here ? 1 : kMostLooks;  // an island moved as a free one has one
  const double unproven_m = looks * kUnprovenStep_m * step.scale;
  const double most = trust.looks_between ? std::min(step.limits.step_m, unproven_m) : step.limits.step_m;
  const double least = step.limits.least_step_m * (on_surfaces ? Constraint::kLeastOnSurfaces : 1.0);
  trust.length_m = std::clamp(kTrustGrowth * travel, std::min(least, most), most);
  trust.limit = trust.length_m < most ? 0 : frame_flag::kStepLimited;
}

/// The number of points at which something pushes the body: corners, and the centre of a patch whose load is
/// carried by the cone of friction alone.
int pushing_points(std::span<const ContactRow> corners, int body, const ConstraintState& c) {
  int points = 0;
  std::array<bool, Friction::kMostPatches> counted{};
  for (const ContactRow& row : corners) {
    if (!(row.impulse > 0.0) || (row.body_a != body && row.body_b != body)) continue;
    ++points;
    if (row.friction_patch >= 0) counted[Index(row.friction_patch)] = true;
  }
  for (Index i = 0; i < c.friction_uses.size(); ++i) {
    const SurfacePair& key = c.friction.patches()[i].surfaces;
    if (c.friction_uses[i].load_N > 0.0 && !counted[i] && (key.body_a == body || key.body_b == body))
      ++points;
  }
  return points;
}

/// Appends friction forces as contact rows, and adds their torques about normals on the grasped parts up.
void report_friction(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  std::vector<ContactRow>& rows = step.own.contact_rows.rows;
  for (CoupledHand& hand : c.hands) hand.torque.setZero();
  c.friction.for_each_force(c.problem, [&](Index number, const Push& push, double multiplier) {
    const FrictionPatch& patch = c.friction.patches()[number];
    add_friction_torque(patch.surfaces, multiplier * push.torque, step);
    append_friction(patch, static_cast<int>(number), multiplier * push.force, step.dt_s, rows);
  });
}

/// Reports the contact forces on the part that a hand holds.
void report_grasped(const HandInput& hand, const CoupledHand& coupled, const ConstraintStep& step,
                    HandReport& report) {
  const int grasped = hand.grasped.body;
  const ContactRows& all = step.own.contact_rows;
  report.grasped_contact_points =
      pushing_points({all.rows.data(), step.own.constraint.rows.count}, grasped, step.own.constraint);
  if (grasped < 0) return;
  Vec3 origin = step.X_WB_start[Index(grasped)].p;
  if (step.own.free.grasped_island >= 0)
    for (const ProblemBody& body : step.own.constraint.problem.bodies())
      if (body.body == grasped) origin = body.origin;
  report.restoring = contact_wrench(all.rows, grasped, origin, step.dt_s);
  if (step.own.free.grasped_island >= 0 || step.own.free.grasped_here) report.restoring.t += coupled.torque;
}

/// Reports the contact forces: normal forces of corners, and friction.
void report_rows(ConstraintStep& step) {
  ConstraintState& c = step.own.constraint;
  if (c.rows.shades) exchange_normals(step);
  step.report.contact_points = static_cast<int>(c.rows.count);
  c.friction_uses.clear();
  if (step.own.free.grasped_island >= 0) {
    use_of_friction(c.friction, c.problem, c.rows.first, own_rows(step), c.friction_uses);
    report_friction(step);
  }
  step.report.friction = sum_of(c.friction_uses);
  for (Index h = 0; h < step.hands.size(); ++h)
    report_grasped(step.hands[h], c.hands[h], step, step.report_of(h));
}

}  // namespace

void bound_constrained_motion(const MotionInput& input, const WorldState& bodies,
                              ConstraintMemory& own) noexcept {
  const ConstraintState& c = own.constraint;
  const double pull = input.world.gravity_W.norm() * input.dt_s;
  for (Index i = 0; i < own.motion_bound.size(); ++i) {
    own.motion_bound[i] = kBoundMargin * c.skin_m[i];
    if (!input.world.bodies[i].moves()) continue;
    const Twist& V = bodies.V_WB[i];
    const bool grasped = is_grasped(input.hands, i);
    if (!grasped) {
      const Body& body = input.world.bodies[i];
      const Twist spring = most_by_spring(body, bodies.X_WB[i], bodies.joints[i], input.dt_s);
      const Twist load = most_by_load(body, bodies.X_WB[i], input.dt_s);
      const Twist& left = own.free.detour[i];
      own.motion_bound[i] += left.v.norm() + left.w.norm() * input.radius_m[i];
      own.motion_bound[i] += (V.v.norm() + spring.v.norm() + load.v.norm() + pull +
                              (V.w.norm() + spring.w.norm() + load.w.norm()) * input.radius_m[i]) *
                             input.dt_s;
    }
    if (grasped || own.free.near_grasped[i]) own.motion_bound[i] += c.trust.length_m;
  }
  bound_joined(input, bodies, own.motion_bound);
}

void respond_constrained(ConstraintStep& step) noexcept {
  begin_step(step);
  move_free_bodies(step);
  double share = 1.0;  // of the step of the grasped part's island
  if (step.own.free.grasped_island >= 0) share = move_grasped_island(step);
  update_trust_length(step);
  end_step(share == 1.0 && !step.own.constraint.rows.shades, step);
  report_rows(step);
}

}  // namespace tactum::inline v0_1
