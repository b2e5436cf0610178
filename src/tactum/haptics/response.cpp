#include "tactum/haptics/response.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/step.h"
#include "tactum/haptics/coupling.h"
#include "tactum/haptics/proxy.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// The held part weighs nothing: it resists as its coupling does, over a step of h seconds.
Resistance resistance_of(const World& world, const FrameSettings& settings, const FrameState& state, Index i,
                         double h) {
  const Pose& X_WB = state.world.X_WB[i];
  if (static_cast<int>(i) == state.tool.body)
    return coupling_resistance(settings.coupling, X_WB.R * state.tool.X_BH.p, h);
  return inertial_resistance(world.bodies[i], X_WB);
}

/// Keeps the held part's step below the threshold distance.
void limit_held(const FrameSettings& settings, double dt_s, FrameState& state) {
  if (state.tool.body < 0) return;
  Twist& V_WB = state.world.V_WB[Index(state.tool.body)];
  V_WB = within_threshold(V_WB, state.finder.radius(state.tool.body), settings.penalty.max_step_m, dt_s);
}

/// Gives the held part the whole way that is left to the hand over the `rest` of the frame, and what resists
/// that.
void pull_held(const World& world, const FrameSettings& settings, double rest, FrameState& state) {
  if (state.tool.body < 0) return;
  const Index i = Index(state.tool.body);
  const Pose& X_WB = state.world.X_WB[i];
  const Joint& joint = world.bodies[i].joint;
  state.resistance[i] = resistance_of(world, settings, state, i, rest);
  state.mobility[i] = mobility(joint, X_WB, state.resistance[i]);
  const Twist pull = velocity_to_hand(state.tool, X_WB, loaded_hand(settings, state), rest);
  state.world.V_WB[i] = constrained_velocity(joint, X_WB, state.resistance[i], pull);
}

/// What joints do to the motion, but that of body `spared`.
void slow_joints(const World& world, double h, int spared, FrameState& state) {
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (static_cast<int>(i) == spared || !world.bodies[i].moves()) continue;
    Twist& V_WB = state.world.V_WB[i];
    V_WB = after_joint(world.bodies[i], state.world.X_WB[i], state.mobility[i], h, V_WB);
  }
}

/// A body whose motion is not a number stays where it was, at rest: one bad frame must not be the last good
/// one.
void undo_non_finite(FrameState& state, FrameReport& report) {
  for (Index i = 0; i < state.world.X_WB.size(); ++i) {
    if (state.world.X_WB[i].finite() && state.world.V_WB[i].finite()) continue;
    state.world.X_WB[i] = state.X_WB_start[i];
    state.world.V_WB[i] = {};
    report.flags |= frame_flag::kMotionUndone;
  }
}

/// Distances are those the frame found, before anything moved.
void report_distances(const World& world, std::span<const ContactPatch> patches, FrameReport& report) {
  for (const ContactPatch& patch : patches) {
    const double size =
        world.bodies[Index(patch.body_a)].part->size + world.bodies[Index(patch.body_b)].part->size;
    report.penetrating |= -patch.distance > tolerances::kPenetrating * size;
    report.tolerance_m = std::max(report.tolerance_m, patch.tolerance);
    const bool first = &patch == patches.data();
    report.min_distance_m = first ? patch.distance : std::min(report.min_distance_m, patch.distance);
  }
}

void report_contacts(const FrameState& state, double h, FrameReport& report) {
  const int held = state.tool.body;
  report.contact_points = static_cast<int>(state.contacts.rows.size());
  for (const ContactRow& row : state.contacts.rows)
    report.held_contact_points += row.body_a == held || row.body_b == held ? 1 : 0;
  if (held >= 0)
    report.restoring = contact_wrench(state.contacts.rows, held, state.world.X_WB[Index(held)].p, h);
}

void respond_by_penalty(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
                        FrameReport& report) {
  std::vector<Pose>& X_WB = state.world.X_WB;
  std::vector<Twist>& V_WB = state.world.V_WB;
  std::vector<ContactRow>& rows = state.contacts.rows;
  make_contact_rows(X_WB, state.finder.patches(), state.shading, settings.penalty.stiffness_N_per_m,
                    state.contacts);
  const double impact = smallest_time_of_impact(rows, X_WB, V_WB, dt_s);
  const double rest = dt_s - impact;
  if (impact > 0.0) {  // in no time nothing moves, and no joint slows anything
    // The held part has no mass to be slowed before the impact: its friction acts where it is pulled.
    slow_joints(world, impact, rest > 0.0 ? state.tool.body : -1, state);
    advance_distances(rows, X_WB, V_WB, impact);
    advance_bodies(world, V_WB, impact, X_WB);
  }
  if (rest > 0.0) {
    pull_held(world, settings, rest, state);
    const SolverResult solved = solve_contacts(
        rows, X_WB, state.mobility, rest, settings.budget.solver_iterations, state.contacts.pushes, V_WB);
    report.solver_iterations = solved.iterations;
    if (!solved.converged) report.flags |= frame_flag::kSolverBounded;
    report_contacts(state, rest, report);
    slow_joints(world, rest, -1, state);
    limit_held(settings, dt_s, state);
    advance_bodies(world, V_WB, rest, X_WB);
  }
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves()) X_WB[i] = constrained_pose(world.bodies[i], X_WB[i]);
  report.time_of_impact_s = impact;
}

}  // namespace

void grasp(const FrameSettings& settings, FrameState& state) noexcept {
  if (state.tool.body < 0) return;
  const Pose& X_WB = state.world.X_WB[Index(state.tool.body)];
  HandTracking& hand = state.hand;
  hand.X_WD.p += X_WB * settings.tool.X_BH.p - hand.X_WH.p;
  hand.X_WH.p = X_WB * settings.tool.X_BH.p;
  state.tool.X_BH.R = X_WB.R.transpose() * hand.X_WH.R;
}

void wanted_velocities(const World& world, const FrameSettings& settings, double dt_s,
                       FrameState& state) noexcept {
  if (settings.response == ResponseModel::kConstraint) return pull_free_bodies(world, dt_s, state);
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = state.world.X_WB[i];
    Twist& V_WB = state.world.V_WB[i];
    state.resistance[i] = resistance_of(world, settings, state, i, dt_s);
    if (static_cast<int>(i) == state.tool.body) {
      V_WB = velocity_to_hand(state.tool, X_WB, loaded_hand(settings, state), dt_s);
    } else {
      V_WB.v += world.gravity_W * dt_s;
    }
    V_WB = constrained_velocity(body.joint, X_WB, state.resistance[i], V_WB);
    state.mobility[i] = mobility(body.joint, X_WB, state.resistance[i]);
  }
  limit_held(settings, dt_s, state);
}

void tolerances_from_speed(const World& world, const FrameSettings& settings, double dt_s,
                           FrameState& state) noexcept {
  if (settings.response == ResponseModel::kConstraint) return trusted_reach(world, dt_s, state);
  for (Index i = 0; i < state.reach.size(); ++i) {
    const Twist& V = state.world.V_WB[i];
    state.reach[i] = (V.v.norm() + V.w.norm() * state.finder.radius(static_cast<int>(i))) * dt_s;
  }
}

PatchPoints points_wanted(const FrameSettings& settings) noexcept {
  return settings.response == ResponseModel::kConstraint ? PatchPoints::kClosest : PatchPoints::kQuadrature;
}

void respond(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
             FrameReport& report) noexcept {
  state.X_WB_start = state.world.X_WB;  // same size: nothing is allocated
  report_distances(world, state.finder.patches(), report);
  if (settings.response == ResponseModel::kConstraint) {
    respond_constrained(world, settings, dt_s, state, report);
  } else {
    respond_by_penalty(world, settings, dt_s, state, report);
  }
  undo_non_finite(state, report);
  book_field_work(state);
  if (state.contacts.full) report.flags |= frame_flag::kPointsFull;
}

Wrench felt_wrench(const FrameSettings& settings, FrameState& state, FrameReport& report) noexcept {
  report.X_WH = state.hand.X_WH;
  const Wrench blows = state.blows.next();
  if (state.tool.body < 0) return {};
  const Pose& X_WB = state.world.X_WB[Index(state.tool.body)];
  report.X_WH_proxy = X_WB * state.tool.X_BH;
  report.field = state.field.load.at_centre;
  if (settings.response == ResponseModel::kConstraint) return state.constraint.felt + blows;
  // The velocity that counts is the way of the whole frame, not the last part's after an impact.
  const Pose X_WH_before = state.X_WB_start[Index(state.tool.body)] * state.tool.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, report.X_WH_proxy, settings.dt_s);
  return coupling_wrench(settings.coupling, state.hand.X_WH, state.hand.V_WH, report.X_WH_proxy, V_WH_proxy);
}

}  // namespace tactum
