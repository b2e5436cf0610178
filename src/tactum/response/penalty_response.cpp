#include "tactum/response/penalty_response.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/step.h"
#include "tactum/math/screw.h"
#include "tactum/response/coupling.h"
#include "tactum/response/field_pull.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// The held part weighs nothing: it resists as its coupling does, over a step of h seconds.
Resistance resistance_of(const MotionInput& input, const Pose& X_WB, Index body, double h_s) {
  if (static_cast<int>(body) == input.held.body)
    return coupling_resistance(input.settings.coupling, X_WB.R * input.held.X_BH.p, h_s);
  return inertial_resistance(input.world.bodies[body], X_WB);
}

/// The velocity that takes the held body in `h_s` to where the hand at X_WH has it.
Twist velocity_to_hand(const GraspedPart& held, const Pose& X_WB, const Pose& X_WH, double h_s) {
  return twist_between(X_WB, X_WH * held.X_BH.inverse(), h_s);
}

/// V scaled down so that no point within `radius_m` of the body's origin moves more than `max_step_m` in
/// `dt_s`.
Twist within_threshold(const Twist& V, double radius_m, double max_step_m, double dt_s) {
  const double step = (V.v.norm() + V.w.norm() * radius_m) * dt_s;
  return step > max_step_m ? V * (max_step_m / step) : V;
}

/// Keeps the held part's step below the threshold distance.
void limit_held(const MotionInput& input, WorldState& bodies) {
  if (input.held.body < 0) return;
  const Index held = Index(input.held.body);
  bodies.V_WB[held] = within_threshold(bodies.V_WB[held], input.radius_m[held],
                                       input.settings.penalty.max_step_m, input.dt_s);
}

/// Up to so many times the shortest depth, the depth along the motion is taken as it is; from so many times
/// on it says no more than that the motion follows the surface or leaves it, and the shortest one is taken.
/// Between, the one passes into the other without a step.
constexpr double kTrustedDepth = 2.0;
constexpr double kIgnoredDepth = 4.0;

/// By how much the shortest depth is multiplied where the depth along the motion is `ratio` times as large.
double depth_scale(double ratio) {
  if (!(ratio < kIgnoredDepth)) return 1.0;
  if (ratio <= kTrustedDepth) return ratio;
  return 1.0 + (kTrustedDepth - 1.0) * (kIgnoredDepth - ratio) / (kIgnoredDepth - kTrustedDepth);
}

/// How A moves relative to B in the middle of a patch, with the bodies at X_WB [m/s].
Vec3 velocity_across(const ContactPatch& patch, std::span<const Pose> X_WB, std::span<const Twist> V_WB) {
  const Index a = Index(patch.body_a);
  const Index b = Index(patch.body_b);
  Vec3 middle = Vec3::Zero();
  for (const ContactPoint& point : patch.manifold.points)
    middle += 0.5 * point.weight * (point.p_a + point.p_b);
  const Vec3 p_W = X_WB[a] * middle;
  return velocity_at(V_WB[a], p_W - X_WB[a].p) - velocity_at(V_WB[b], p_W - X_WB[b].p);
}

/// When the first contact closes, in [0, dt]: of convex pieces of bodies that turn, as the bodies move; else,
/// and where the budget has no test left, by the published estimate, distance over closing speed.
double first_impact(const StepInput& input, std::span<const ContactRow> rows, GapOracle& gaps,
                    std::span<const Twist> V_WB) noexcept {
  const std::span<const Pose> X_WB = input.X_WB_start;
  if (std::any_of(rows.begin(), rows.end(), [](const ContactRow& row) { return row.distance <= 0.0; }))
    return 0.0;
  const bool some_turn =
      std::any_of(V_WB.begin(), V_WB.end(), [&](const Twist& V) { return turns_in(input.dt_s, V, V); });
  FirstImpact turning{input.dt_s, true};
  if (some_turn) turning = gaps.first_impact(X_WB, V_WB, input.dt_s);
  double first = turning.time_s;
  for (const ContactRow& row : rows)
    if (!some_turn || !turning.complete || input.patches[Index(row.patch)].of_surfaces ||
        !turns_in(input.dt_s, V_WB[Index(row.body_a)], V_WB[Index(row.body_b)]))
      first = time_of_closing(row, X_WB, V_WB, first);
  return first;
}

}  // namespace

PenaltyResponse::PenaltyResponse(const World& world, const FrameSettings& settings)
    : contacts_(settings.budget.capacity.patches, Index(settings.budget.max_contact_points)),
      resistance_(world.bodies.size(), Resistance::Zero()),
      mobility_(world.bodies.size(), Mobility::Zero()),
      reach_(world.bodies.size(), 0.0) {
  depth_scale_.reserve(settings.budget.capacity.patches);
}

std::span<const double> PenaltyResponse::bound_motion(const MotionInput& input, WorldState& bodies) noexcept {
  const World& world = input.world;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = bodies.X_WB[i];
    Twist& V_WB = bodies.V_WB[i];
    resistance_[i] = resistance_of(input, X_WB, i, input.dt_s);
    if (static_cast<int>(i) == input.held.body) {
      const Pose X_WH = loaded_hand(input.settings.coupling, input.held, X_WB);
      V_WB = velocity_to_hand(input.held, X_WB, X_WH, input.dt_s);
    } else {
      V_WB.v += world.gravity_W * input.dt_s;
    }
    V_WB = constrained_velocity(body.joint, X_WB, resistance_[i], V_WB);
    mobility_[i] = mobility(body.joint, X_WB, resistance_[i]);
  }
  limit_held(input, bodies);
  for (Index i = 0; i < reach_.size(); ++i) {
    const Twist& V = bodies.V_WB[i];
    reach_[i] = (V.v.norm() + V.w.norm() * input.radius_m[i]) * input.dt_s;
  }
  return reach_;
}

std::span<const double> PenaltyResponse::scale_depths(const StepInput& input, GapOracle& gaps,
                                                      std::span<const Twist> V_WB) noexcept {
  depth_scale_.clear();
  if (input.settings.penalty.depth == OverlapDepth::kShortest) return depth_scale_;
  const std::span<const Pose> X_WB = input.X_WB_start;
  for (Index i = 0; i < input.patches.size() && i < depth_scale_.capacity(); ++i) {
    const ContactPatch& patch = input.patches[i];
    double& scale = depth_scale_.emplace_back(1.0);
    if (patch.distance >= 0.0) continue;
    const Vec3 v = velocity_across(patch, X_WB, V_WB);
    const double speed = v.norm();
    const double size = input.world.bodies[Index(patch.body_a)].part->size +
                        input.world.bodies[Index(patch.body_b)].part->size;
    if (speed * input.dt_s <= tolerances::kPenetrating * size) continue;  // no motion, no direction
    const double depth = gaps.depth_along(static_cast<int>(i), X_WB, -v / speed);
    if (depth > 0.0) scale = depth_scale(depth / -patch.distance);
  }
  return depth_scale_;
}

/// Gives the held part the whole way that is left to the hand over the rest of the frame, and what resists
/// that.
void PenaltyResponse::pull_held(const StepInput& input, double rest_s, WorldState& bodies) noexcept {
  if (input.held.body < 0) return;
  const Index i = Index(input.held.body);
  const Pose& X_WB = bodies.X_WB[i];
  const Joint& joint = input.world.bodies[i].joint;
  resistance_[i] = resistance_of(input, X_WB, i, rest_s);
  mobility_[i] = mobility(joint, X_WB, resistance_[i]);
  const Pose X_WH = loaded_hand(input.settings.coupling, input.held, X_WB);
  const Twist pull = velocity_to_hand(input.held, X_WB, X_WH, rest_s);
  bodies.V_WB[i] = constrained_velocity(joint, X_WB, resistance_[i], pull);
}

/// What joints do to the motion, but that of body `spared`.
void PenaltyResponse::slow_joints(const World& world, double h_s, int spared, WorldState& bodies) noexcept {
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (static_cast<int>(i) == spared || !world.bodies[i].moves()) continue;
    bodies.V_WB[i] = after_joint(world.bodies[i], bodies.X_WB[i], mobility_[i], h_s, bodies.V_WB[i]);
  }
}

void PenaltyResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                           FrameReport& report) noexcept {
  const World& world = input.world;
  std::vector<Pose>& X_WB = bodies.X_WB;
  std::vector<Twist>& V_WB = bodies.V_WB;
  std::vector<ContactRow>& rows = contacts_.rows;
  const int tests_before = gaps.tests_left();
  make_contact_rows(X_WB, input.patches, input.shading, input.settings.penalty.stiffness_N_per_m,
                    scale_depths(input, gaps, V_WB), contacts_);
  const double impact_s = first_impact(input, rows, gaps, V_WB);
  const double rest_s = input.dt_s - impact_s;
  const int held = input.held.body;
  if (impact_s > 0.0) {  // in no time nothing moves, and no joint slows anything
    // The held part has no mass to be slowed before the impact: its friction acts where it is pulled.
    slow_joints(world, impact_s, rest_s > 0.0 ? held : -1, bodies);
    advance_distances(rows, X_WB, V_WB, impact_s);
    advance_bodies(world, V_WB, impact_s, X_WB);
  }
  if (rest_s > 0.0) {
    pull_held(input, rest_s, bodies);
    const SolverResult solved = solve_contacts(
        rows, X_WB, mobility_, rest_s, input.settings.budget.solver_iterations, contacts_.pushes, V_WB);
    report.solver_iterations = solved.iterations;
    if (!solved.converged) report.flags |= frame_flag::kSolverBounded;
    report.contact_points = static_cast<int>(rows.size());
    for (const ContactRow& row : rows)
      report.held_contact_points += row.body_a == held || row.body_b == held ? 1 : 0;
    if (held >= 0) report.restoring = contact_wrench(rows, held, X_WB[Index(held)].p, rest_s);
    slow_joints(world, rest_s, -1, bodies);
    limit_held(input, bodies);
    advance_bodies(world, V_WB, rest_s, X_WB);
  }
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves()) X_WB[i] = constrained_pose(world.bodies[i], X_WB[i]);
  report.time_of_impact_s = impact_s;
  report.validation_tests = tests_before - gaps.tests_left();
}

Wrench PenaltyResponse::felt(const StepInput& input, const WorldState& bodies) const noexcept {
  const GraspedPart& held = input.held;
  if (held.body < 0) return {};
  // The velocity that counts is that of the whole frame's displacement, not the last part's after an impact.
  const Pose X_WH_before = input.X_WB_start[Index(held.body)] * held.X_BH;
  const Pose X_WH_proxy = bodies.X_WB[Index(held.body)] * held.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, X_WH_proxy, input.dt_s);
  return coupling_wrench(input.settings.coupling, held.X_WH, held.V_WH, X_WH_proxy, V_WH_proxy);
}

}  // namespace tactum
