#include "tactum/response/penalty_response.h"

#include <algorithm>

#include "tactum/dynamics/step.h"
#include "tactum/math/screw.h"
#include "tactum/response/coupling.h"
#include "tactum/response/field_pull.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// The held part weighs nothing: it resists as its coupling does, over a step of h seconds.
Resistance resistance_of(const MotionInput& input, const Pose& X_WB, Index body, double h_s) {
  if (static_cast<int>(body) == input.grasped.body)
    return coupling_resistance(input.settings.coupling, X_WB.R * input.grasped.X_BH.p, h_s);
  return inertial_resistance(input.world.bodies[body], X_WB);
}

/// The velocity that takes the held body in `h_s` to where the hand at X_WH has it.
Twist velocity_to_hand(const GraspedPart& grasped, const Pose& X_WB, const Pose& X_WH, double h_s) {
  return twist_between(X_WB, X_WH * grasped.X_BH.inverse(), h_s);
}

/// V scaled down so that no point within `radius_m` of the body's origin moves more than `max_step_m` in
/// `dt_s`.
Twist within_threshold(const Twist& V, double radius_m, double max_step_m, double dt_s) {
  const double step = (V.v.norm() + V.w.norm() * radius_m) * dt_s;
  return step > max_step_m ? V * (max_step_m / step) : V;
}

/// Keeps the held part's step below the threshold distance.
void limit_grasped(const MotionInput& input, WorldState& bodies) {
  if (input.grasped.body < 0) return;
  const Index grasped = Index(input.grasped.body);
  bodies.V_WB[grasped] = within_threshold(bodies.V_WB[grasped], input.radius_m[grasped],
                                          input.settings.penalty.max_step_m, input.dt_s);
}

}  // namespace

PenaltyResponse::PenaltyResponse(const World& world, const FrameSettings& settings)
    : contacts_(settings.budget.capacity.patches, Index(settings.budget.max_contact_points)),
      resistance_(world.bodies.size(), Resistance::Zero()),
      mobility_(world.bodies.size(), Mobility::Zero()),
      motion_bound_(world.bodies.size(), 0.0) {}

std::span<const double> PenaltyResponse::bound_motion(const MotionInput& input, WorldState& bodies) noexcept {
  const World& world = input.world;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = bodies.X_WB[i];
    Twist& V_WB = bodies.V_WB[i];
    resistance_[i] = resistance_of(input, X_WB, i, input.dt_s);
    if (static_cast<int>(i) == input.grasped.body) {
      const Pose X_WH = equilibrium_pose(input.settings.coupling, input.grasped, X_WB);
      V_WB = velocity_to_hand(input.grasped, X_WB, X_WH, input.dt_s);
    } else {
      V_WB.v += world.gravity_W * input.dt_s;
    }
    V_WB = constrained_velocity(body.joint, X_WB, resistance_[i], V_WB);
    mobility_[i] = mobility(body.joint, X_WB, resistance_[i]);
  }
  limit_grasped(input, bodies);
  for (Index i = 0; i < motion_bound_.size(); ++i) {
    const Twist& V = bodies.V_WB[i];
    motion_bound_[i] = (V.v.norm() + V.w.norm() * input.radius_m[i]) * input.dt_s;
  }
  return motion_bound_;
}

/// Gives the held part the whole way that is left to the hand over the rest of the frame, and what resists
/// that.
void PenaltyResponse::pull_grasped(const StepInput& input, double rest_s, WorldState& bodies) noexcept {
  if (input.grasped.body < 0) return;
  const Index i = Index(input.grasped.body);
  const Pose& X_WB = bodies.X_WB[i];
  const Joint& joint = input.world.bodies[i].joint;
  resistance_[i] = resistance_of(input, X_WB, i, rest_s);
  mobility_[i] = mobility(joint, X_WB, resistance_[i]);
  const Pose X_WH = equilibrium_pose(input.settings.coupling, input.grasped, X_WB);
  const Twist pull = velocity_to_hand(input.grasped, X_WB, X_WH, rest_s);
  bodies.V_WB[i] = constrained_velocity(joint, X_WB, resistance_[i], pull);
}

/// What joints do to the motion, but that of body `spared`.
void PenaltyResponse::slow_joints(const World& world, double h_s, int spared, WorldState& bodies) noexcept {
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (static_cast<int>(i) == spared || !world.bodies[i].moves()) continue;
    bodies.V_WB[i] = after_joint(world.bodies[i], bodies.X_WB[i], mobility_[i], h_s, bodies.V_WB[i]);
  }
}

void PenaltyResponse::step(const StepInput& input, GapOracle& /*gaps*/, WorldState& bodies,
                           FrameReport& report) noexcept {
  const World& world = input.world;
  std::vector<Pose>& X_WB = bodies.X_WB;
  std::vector<Twist>& V_WB = bodies.V_WB;
  std::vector<ContactRow>& rows = contacts_.rows;
  make_contact_rows(X_WB, input.patches, input.shading, input.settings.penalty.stiffness_N_per_m, contacts_);
  const double impact_s = smallest_time_of_impact(rows, X_WB, V_WB, input.dt_s);
  const double rest_s = input.dt_s - impact_s;
  const int grasped = input.grasped.body;
  if (impact_s > 0.0) {  // in no time nothing moves, and no joint slows anything
    // The held part has no mass to be slowed before the impact: its friction acts where it is pulled.
    slow_joints(world, impact_s, rest_s > 0.0 ? grasped : -1, bodies);
    advance_distances(rows, X_WB, V_WB, impact_s);
    advance_bodies(world, V_WB, impact_s, X_WB);
  }
  if (rest_s > 0.0) {
    pull_grasped(input, rest_s, bodies);
    const SolverResult solved = solve_contacts(
        rows, X_WB, mobility_, rest_s, input.settings.budget.solver_iterations, contacts_.pushes, V_WB);
    report.solver_iterations = solved.iterations;
    if (!solved.converged) report.flags |= frame_flag::kSolverBounded;
    report.contact_points = static_cast<int>(rows.size());
    for (const ContactRow& row : rows)
      report.grasped_contact_points += row.body_a == grasped || row.body_b == grasped ? 1 : 0;
    if (grasped >= 0) report.restoring = contact_wrench(rows, grasped, X_WB[Index(grasped)].p, rest_s);
    slow_joints(world, rest_s, -1, bodies);
    limit_grasped(input, bodies);
    advance_bodies(world, V_WB, rest_s, X_WB);
  }
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves()) X_WB[i] = constrained_pose(world.bodies[i], X_WB[i]);
  report.time_of_impact_s = impact_s;
}

Wrench PenaltyResponse::felt(const StepInput& input, const WorldState& bodies) const noexcept {
  const GraspedPart& grasped = input.grasped;
  if (grasped.body < 0) return {};
  // The velocity that counts is that of the whole frame's displacement, not the last part's after an impact.
  const Pose X_WH_before = input.X_WB_start[Index(grasped.body)] * grasped.X_BH;
  const Pose X_WH_proxy = bodies.X_WB[Index(grasped.body)] * grasped.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, X_WH_proxy, input.dt_s);
  return coupling_wrench(input.settings.coupling, grasped.X_WH, grasped.V_WH, X_WH_proxy, V_WH_proxy);
}

}  // namespace tactum
