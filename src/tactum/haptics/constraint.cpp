#include "tactum/haptics/constraint.h"

#include <algorithm>

#include "tactum/base/frame_rate.h"
#include "tactum/base/tolerances.h"
#include "tactum/haptics/constraint_rows.h"
#include "tactum/haptics/frame_state.h"
#include "tactum/haptics/held_part.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// How often patches that slid are let slip further: what is left of the error is mu^2 a round.
constexpr int kSlipRounds = 6;
/// The trusted length after a step, in lengths of that step.
constexpr double kTrustGrowth = 2.0;
/// The tolerance of contact determination is so much more than the trusted length, in skins.
constexpr double kReachMargin = 4.0;
/// A part whose steps have been refused for so long is felt where it stands, not where the forces would
/// have it: what is felt would be the same however far the hand goes away.
constexpr double kStands_s = 0.002;

/// The bodies and what each wants: to the hand, on along its way; or, `at_rest`, nothing.
void add_bodies(const World& world, const FrameSettings& settings, double dt_s, bool at_rest,
                FrameState& state, FrameReport& report) {
  ConstraintProblem& problem = state.constraint.problem;
  problem.clear();
  const int held = state.tool.body;
  bool room = true;
  if (held >= 0) {
    const Pose& X_WB = state.world.X_WB[Index(held)];
    Vec6 wanted = Vec6::Zero();
    state.constraint.wanted = wanted;
    if (!at_rest) {
      state.constraint.wanted = wanted_by_hand(settings, dt_s, state);
      wanted = with_load(world, settings, dt_s, state, state.constraint.wanted);
    }
    room &= problem.add_held(held, world.bodies[Index(held)], X_WB, X_WB * state.tool.X_BH.p,
                             step_metric(settings, dt_s, state), wanted);
  }
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const int b = static_cast<int>(i);
    if (b == held || !state.free.near_held[i]) continue;
    const Vec6 on = at_rest ? Vec6(Vec6::Zero()) : to_vector(state.world.V_WB[i] * dt_s);
    room &= problem.add_free(b, world.bodies[i], state.world.X_WB[i], on, dt_s);
  }
  if (!room) report.flags |= frame_flag::kSolverBounded;
  problem.add_joint_rows();
}

/// Counts an answer; whether it is one.
bool solved(const QpAnswer& answer, FrameReport& report) {
  report.solver_iterations += answer.iterations;
  if (answer.status == QpStatus::kBounded) report.flags |= frame_flag::kSolverBounded;
  return answer.status == QpStatus::kSolved;
}

using RowNames = StaticVector<std::uint64_t, kMostUnknowns>;

/// The names of the contact rows that hold in the last answer.
void note_held(const ConstraintState& c, RowNames& names) {
  names.clear();
  for (const QpActive& active : c.problem.answer().active) {
    const Index row = Index(active.row) - c.first_row;
    if (Index(active.row) >= c.first_row && row < c.own_rows) names.push_back(c.names[row]);
  }
}

StaticVector<int, kMostUnknowns> rows_of(const RowNames& names, const ConstraintState& c) {
  StaticVector<int, kMostUnknowns> rows;
  for (Index row = 0; row < c.own_rows; ++row)
    if (std::find(names.begin(), names.end(), c.names[row]) != names.end())
      rows.push_back(static_cast<int>(c.first_row + row));
  return rows;
}

void begin(const StaticVector<int, kMostUnknowns>& rows, ConstraintProblem& problem) {
  problem.begin({rows.begin(), rows.end()});
}

/// Solves, from the rows begun with, or from those that hold now. False when there is no solution.
bool solve_on(const FrameSettings& settings, ConstraintProblem& problem, FrameReport& report) {
  return solved(problem.solve_on(settings.budget.solver_iterations), report);
}

/// Begins with what held in the last frame while every patch stuck, if any did. One body has so few rows that
/// to go on from the answer without friction costs no more.
void begin_sticking(ConstraintState& c) {
  if (c.problem.movers().size() == 1) return;
  StaticVector<int, kMostUnknowns> rows = rows_of(c.held_sticking, c);
  const Index of_contacts = rows.size();
  c.friction.rows_that_stuck(rows);
  if (rows.size() > of_contacts) begin(rows, c.problem);
}

/// Lets every patch stick, then slip where it must, until none slips further. Where no answer keeps the
/// anchors they are taken off; where there is none at all, friction.
bool solve_sliding(const FrameSettings& settings, ConstraintState& c, FrameReport& report) {
  for (int round = 0; round <= kSlipRounds; ++round) {
    bool found = solve_on(settings, c.problem, report);
    if (!found) {
      c.friction.forget_anchors(c.problem);
      found = solve_on(settings, c.problem, report);
    }
    if (!found) {
      c.friction.clear();
      c.problem.forget_cones();
      return solve_on(settings, c.problem, report);
    }
    if (round == 0) {
      note_held(c, c.held_sticking);
      c.friction.note_sticking(c.problem);
    }
    if (!c.friction.let_slip(c.skin_m, c.problem)) break;
  }
  return true;
}

/// Keeps what the answer says of forces: impulses, the rows that hold, the wrench at the handle.
void keep_forces(const FrameSettings& settings, double dt_s, FrameState& state, FrameReport& report) {
  ConstraintState& c = state.constraint;
  note_held(c, c.held);
  for (ContactRow& row : own_rows(state)) row.impulse = 0.0;
  for (const QpActive& active : c.problem.answer().active) {
    const Index row = Index(active.row) - c.first_row;
    if (Index(active.row) >= c.first_row && row < c.own_rows)
      state.contacts.rows[row].impulse = active.multiplier * dt_s;
  }
  report.active_constraints = static_cast<int>(c.held.size());
  feel(settings, dt_s, c.problem.displacement_at_centre(c.problem.movers().front()), state);
}

/// The farthest way of a point of the body in the last answer [m].
double way_of(const FrameState& state, const Mover& mover) {
  const Vec6 x = state.constraint.moves().displacement(mover.body);
  return x.head<3>().norm() + x.tail<3>().norm() * state.finder.radius(mover.body);
}

/// The share of the answer's step that is trusted.
double trusted_share(const FrameSettings& settings, const FrameState& state) {
  const ConstraintState& c = state.constraint;
  double share = 1.0;
  for (const Mover& mover : c.moves().movers()) {
    const double way = way_of(state, mover);
    const double trusted = state.reach[Index(mover.body)] - kReachMargin * c.skin_m;
    if (way * share > trusted) share = trusted / way;
    if (mover.body != state.tool.body) continue;
    const double turn = c.moves().displacement(mover.body).tail<3>().norm();
    if (turn * share > settings.constraint.max_turn_rad) share = settings.constraint.max_turn_rad / turn;
  }
  return share;
}

/// Moves everything by `share` of the answer's step, on trial, and looks at every gap there.
bool open_after(const World& world, double share, FrameState& state, FrameReport& report) {
  ConstraintState& c = state.constraint;
  c.X_WB_trial = state.world.X_WB;  // same size: nothing is allocated
  for (const Mover& mover : c.moves().movers()) {
    const Index i = Index(mover.body);
    const Twist step = to_twist(c.moves().displacement(mover.body) * share);
    c.X_WB_trial[i] = constrained_pose(world.bodies[i], advanced(state.world.X_WB[i], step, 1.0));
    if (!c.X_WB_trial[i].finite()) return false;
  }
  look_at_trial(0, state, report);
  for (Index p = 0; p < c.gap.size(); ++p)
    if (state.free.patch_asked[p] && !open_at_trial(p, c)) return false;
  return true;
}

void take_trial(FrameState& state) {
  ConstraintState& c = state.constraint;
  state.world.X_WB.swap(c.X_WB_trial);
  for (Index p = 0; p < c.gap.size(); ++p)
    if (state.free.patch_asked[p]) c.gap[p] = c.gap_trial[p];
}

/// Contacts nearer than half the skin are opened first, as far as there is room.
void restore(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
             FrameReport& report) {
  ConstraintState& c = state.constraint;
  bool tight = false;
  for (Index p = 0; p < c.gap.size(); ++p) tight |= state.free.patch_asked[p] && c.gap[p] < 0.5 * c.skin_m;
  if (!tight || state.finder.blocked(state.tool.body)) return;
  add_bodies(world, settings, dt_s, true, state, report);
  add_contact_rows(true, c.problem, state);
  begin(rows_of(c.held, c), c.problem);
  if (!solve_on(settings, c.problem, report)) return;
  if (!open_after(world, trusted_share(settings, state), state, report)) return;
  for (ContactRow& row : own_rows(state)) row.distance = gap_at_trial(row, state);
  take_trial(state);
}

/// Finds what pushes, where shading bends normals with these, and for those the problem of the way: to where
/// the forces would have it, as far as the true normals let it. False when there is no answer.
bool find_forces(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
                 FrameReport& report) {
  ConstraintState& c = state.constraint;
  add_bodies(world, settings, dt_s, false, state, report);
  c.shades = c.bent;
  if (c.shades) exchange_normals(state);
  add_contact_rows(false, c.problem, state);
  c.friction.clear();
  begin(rows_of(c.held_without_friction, c), c.problem);
  bool found = solve_on(settings, c.problem, report);
  note_held(c, c.held_without_friction);
  if (found && c.friction.begin(world, settings.friction, own_rows(state), state.finder.patches(),
                                state.world.X_WB, c.skin_m, c.first_row, c.problem)) {
    begin_sticking(c);
    found = solve_sliding(settings, c, report);
  }
  if (found) keep_forces(settings, dt_s, state, report);
  if (!c.shades) return found;
  exchange_normals(state);
  c.way.follow(c.problem);
  add_contact_rows(false, c.way, state);
  begin(rows_of(c.held, c), c.way);
  return found && solve_on(settings, c.way, report);
}

/// Solves again after a feedback.
bool find_again(const FrameSettings& settings, double dt_s, FrameState& state, FrameReport& report) {
  ConstraintState& c = state.constraint;
  if (c.shades) return solve_on(settings, c.way, report);
  const bool found =
      c.friction.acts() ? solve_sliding(settings, c, report) : solve_on(settings, c.problem, report);
  if (found) keep_forces(settings, dt_s, state, report);
  return found;
}

/// Goes where the hand wants as far as everything stays open; returns the share of the answer that was taken.
double advance(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
               FrameReport& report) {
  if (!find_forces(world, settings, dt_s, state, report)) return 0.0;
  if (state.finder.blocked(state.tool.body)) return 0.0;
  double share = 0.0;
  for (int round = 0; round <= kFeedbacks; ++round) {
    if (round > 0) {
      ++report.validation_retries;
      feed_back(share, state);
      if (!find_again(settings, dt_s, state, report)) break;
    }
    share = trusted_share(settings, state);
    if (open_after(world, share, state, report)) return share;
  }
  for (int halving = 0; halving < kHalvings; ++halving) {
    ++report.validation_retries;
    share *= 0.5;
    if (open_after(world, share, state, report)) return share;
  }
  return 0.0;
}

/// The island of the held part: its bodies' velocities are what they did, but for what only opened a gap,
/// which no force did. Returns the share of the answer that was taken.
double move_held_island(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
                        FrameReport& report) {
  ConstraintState& c = state.constraint;
  state.free.patch_asked.clear();
  for (const ContactPatch& patch : state.finder.patches())
    state.free.patch_asked.push_back(state.free.of_held(patch) ? 1 : 0);
  restore(world, settings, dt_s, state, report);
  const double share = advance(world, settings, dt_s, state, report);
  c.stood = share > 0.0 ? 0 : c.stood + 1;
  if (share > 0.0) take_trial(state);
  if (c.stood >= frames_in(kStands_s, dt_s)) feel(settings, dt_s, Vec6::Zero(), state);
  c.friction.end(own_rows(state), c.first_row, c.problem, state.world.X_WB);
  const std::vector<Pose>& before = share > 0.0 ? c.X_WB_trial : state.world.X_WB;  // take_trial swaps them
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (state.free.near_held[i]) state.world.V_WB[i] = twist_between(before[i], state.world.X_WB[i], dt_s);
  return share;
}

/// The length that is trusted in the next frame, from what the held part's island did in this one.
void trust_step(const FrameSettings& settings, FrameState& state) {
  double way = 0.0;
  for (Index i = 0; i < state.free.near_held.size(); ++i) {
    if (!state.free.near_held[i]) continue;
    const Twist step = twist_between(state.X_WB_start[i], state.world.X_WB[i], 1.0);
    way = std::max(way, step.v.norm() + step.w.norm() * state.finder.radius(static_cast<int>(i)));
  }
  const Constraint& limits = settings.constraint;
  const double most = state.finder.work().minima > 0 ? limits.max_step_on_surfaces_m : limits.max_step_m;
  state.constraint.trust_m = std::clamp(kTrustGrowth * way, std::min(limits.least_step_m, most), most);
}

/// The points at which something pushes the body: corners, and the centre of a patch whose load friction's
/// cone carries alone.
int pushing_points(std::span<const ContactRow> corners, int body, const ConstraintState& c) {
  int points = 0;
  std::array<bool, Friction::kMostPatches> counted{};
  for (const ContactRow& row : corners) {
    if (!(row.impulse > 0.0) || (row.body_a != body && row.body_b != body)) continue;
    ++points;
    if (row.grip >= 0) counted[Index(row.grip)] = true;
  }
  for (Index i = 0; i < c.friction_uses.size(); ++i) {
    const PatchKey& key = c.friction.patches()[i].key;
    if (c.friction_uses[i].load_N > 0.0 && !counted[i] && (key.body_a == body || key.body_b == body))
      ++points;
  }
  return points;
}

/// The contacts as they push: normal forces of corners, and of friction the edges of its cones.
void report_rows(const World& world, double dt_s, FrameState& state, FrameReport& report) {
  const int held = state.tool.body;
  const ConstraintState& c = state.constraint;
  if (c.shades) exchange_normals(state);
  report.contact_points = static_cast<int>(c.names.size());
  use_of_friction(world, c.friction, state.finder.patches(), c.first_row, c.problem, own_rows(state),
                  state.constraint.friction_uses);
  report.friction = sum_of(c.friction_uses);
  report.held_contact_points = pushing_points({state.contacts.rows.data(), c.names.size()}, held, c);
  Vec3 torque = Vec3::Zero();
  Vec3 origin = held < 0 ? Vec3(Vec3::Zero()) : state.X_WB_start[Index(held)].p;
  if (state.free.held_island >= 0) {
    origin = c.problem.movers().front().origin;
    torque = c.friction.add_forces(held, dt_s, c.problem, state.contacts.rows);
  }
  if (held < 0) return;
  report.restoring = contact_wrench(state.contacts.rows, held, origin, dt_s);
  report.restoring.t += torque;
}

}  // namespace

ConstraintState::ConstraintState(const World& world, const FrameSettings& settings)
    : problem(static_cast<Index>(settings.budget.max_contact_points)),
      way(static_cast<Index>(settings.budget.max_contact_points)),
      trust_m(settings.constraint.least_step_m),
      corner_memory(settings.budget.rooms.patches / 4 + 1),
      X_WB_trial(world.bodies.size()) {
  double size = 0.0;
  for (const Body& body : world.bodies)
    if (body.moves()) size = std::max(size, body.part->size);
  skin_m = tolerances::kSkin * size;
  const Index rows = static_cast<Index>(settings.budget.max_contact_points);
  names.reserve(rows);
  feedback.reserve(rows);
  shaded.reserve(rows);
  gap.reserve(settings.budget.rooms.patches);
  gap_trial.reserve(settings.budget.rooms.patches);
  gap_least.reserve(settings.budget.rooms.patches);
  gap_answer.reserve(settings.budget.rooms.patches);
}

void trusted_reach(const World& world, double dt_s, FrameState& state) noexcept {
  const ConstraintState& c = state.constraint;
  const double pull = world.gravity_W.norm() * dt_s;
  for (Index i = 0; i < state.reach.size(); ++i) {
    state.reach[i] = kReachMargin * c.skin_m;
    if (!world.bodies[i].moves()) continue;
    const Twist& V = state.world.V_WB[i];
    const bool held = static_cast<int>(i) == state.tool.body;
    if (!held)
      state.reach[i] += (V.v.norm() + pull + V.w.norm() * state.finder.radius(static_cast<int>(i))) * dt_s;
    if (held || state.free.near_held[i]) state.reach[i] += c.trust_m;
  }
}

void respond_constrained(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
                         FrameReport& report) noexcept {
  ConstraintState& c = state.constraint;
  const std::span<const ContactPatch> patches = state.finder.patches();
  c.gap.clear();
  for (const ContactPatch& patch : patches) c.gap.push_back(patch.distance);
  c.gap_trial.resize(c.gap.size());
  c.gap_least.resize(c.gap.size());
  c.gap_answer.resize(c.gap.size());

  state.free.others = others_move(world, state.tool.body);
  let_wait(world, settings, dt_s, state, report);
  find_islands(world, state);
  begin_balance(world, dt_s, state);
  make_corner_rows(world, settings, state);
  strike(world, settings, dt_s, state, report);
  move_free_bodies(world, settings, dt_s, state, report);
  double share = 1.0;  // of the held island's step
  if (state.free.held_island >= 0) {
    share = move_held_island(world, settings, dt_s, state, report);
  } else {
    c.friction.forget();
  }
  trust_step(settings, state);
  end_turning(world, state);
  end_balance(world, dt_s, share == 1.0 && !c.shades, state, report);
  go_on(state);
  report_rows(world, dt_s, state, report);
}

}  // namespace tactum
