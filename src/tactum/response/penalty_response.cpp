#include "tactum/response/penalty_response.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/dynamics/solver_choice.h"
#include "tactum/dynamics/step.h"
#include "tactum/math/screw.h"
#include "tactum/response/coupling.h"
#include "tactum/response/field_pull.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The grasped part weighs nothing: it resists as its coupling does, at the handle.
GraspMetric coupling_stiffness(const Coupling& coupling) {
  return {coupling.stiffness_N_per_m, coupling.stiffness_Nm_per_rad};
}

/// Keeps the grasped part's step below the threshold distance. True where the step was longer.
bool limit_grasped(const MotionInput& input, WorldState& bodies) {
  if (input.grasped.body < 0) return false;
  Twist& V_WB = bodies.V_WB[Index(input.grasped.body)];
  const double step =
      (V_WB.v.norm() + V_WB.w.norm() * input.radius_m[Index(input.grasped.body)]) * input.dt_s;
  if (!(step > input.limits.step_m)) return false;
  V_WB = V_WB * (input.limits.step_m / step);
  return true;
}

/// Up to kTrustedDepth times the shortest depth, the depth along the motion is used as it is; from the second
/// limit on it only means that the motion follows the surface or leaves it, and the shortest depth is used.
/// Between the two limits the one passes into the other without a step.
constexpr double kTrustedDepth = 2.0;
constexpr double kIgnoredDepth = 4.0;

/// The factor for the shortest depth where the depth along the motion is `ratio` times as large.
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

/// When the first contact closes, in [0, dt]: by conservative advancement for convex pieces of bodies that
/// turn; else, and where the budget has no test left, by the published estimate, distance over closing speed.
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
      islands_(world),
      bodies_(world.bodies.size(), world.bodies.size()),
      rows_(world.bodies.size(), Index(settings.budget.max_contact_points)),
      problem_(Index(settings.budget.max_contact_points), world.bodies.size()),
      all_move_(world.bodies.size(), 0),
      V_before_joints_(world.bodies.size()),
      motion_bound_(world.bodies.size(), 0.0) {
  stiffness_.reserve(Index(settings.budget.max_contact_points));
  depth_scale_.reserve(settings.budget.capacity.patches);
  forces_.reserve(Index(settings.budget.max_contact_points) + 4 * world.bodies.size());
}

/// Adds a body with its target over a step of `h_s` seconds. The grasped part's target is the whole
/// displacement to the hand however short the step: it weighs nothing, so nothing but its coupling holds it
/// back.
void PenaltyResponse::add_body(const MotionInput& input, int body, double h_s,
                               const WorldState& bodies) noexcept {
  const Body& what = input.world.bodies[Index(body)];
  const Pose& X_WB = bodies.X_WB[Index(body)];
  if (body == input.grasped.body) {
    const Twist target = equilibrium_step(input.coupling, input.grasped, what.load.constant, X_WB);
    const GraspedBody as_body = grasped_body_of(
        what.load, input.grasped, X_WB, coupling_stiffness(input.coupling), to_vector(target), input.dt_s);
    problem_.add_body(placed(input.world, bodies, body), as_body.centre_W, as_body.metric, as_body.target,
                      h_s);
    return;
  }
  problem_.add_body(placed(input.world, bodies, body), X_WB.p, damped_metric(what, X_WB, h_s),
                    to_vector(bodies.V_WB[Index(body)] * h_s), h_s);
}

std::span<const double> PenaltyResponse::bound_motion(const MotionInput& input, WorldState& bodies) noexcept {
  const World& world = input.world;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    Twist& V_WB = bodies.V_WB[i];
    const int number = static_cast<int>(i);
    if (number != input.grasped.body) {
      V_WB = carried_velocity(body.joint, bodies.X_WB[i], V_WB);
      V_WB = driven_velocity(body, world.gravity_W, bodies.X_WB[i], V_WB, input.dt_s);
    }
    V_before_joints_[i] = V_WB;
    if (number != input.grasped.body && body.joint.kind == JointKind::kFree) continue;
    // First the motion that the joint allows, and where the hand and the joint's forces lead without contact.
    problem_.clear();
    add_body(input, number, input.dt_s, bodies);
    problem_.add_joint_rows(false);
    solve_penalty({}, input.settings.budget.solver_iterations, forces_, problem_);
    V_WB = to_twist(problem_.displacement(number) / input.dt_s);
  }
  cut_ = limit_grasped(input, bodies);
  for (Index i = 0; i < motion_bound_.size(); ++i) {
    const Twist& V = bodies.V_WB[i];
    motion_bound_[i] = (V.v.norm() + V.w.norm() * input.radius_m[i]) * input.dt_s;
  }
  return motion_bound_;
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

/// Solves for the velocities of an island over the rest of the frame.
void PenaltyResponse::solve_island(const StepInput& input, Index island, double rest_s, WorldState& bodies,
                                   FrameReport& report) noexcept {
  std::vector<ContactRow>& rows = contacts_.rows;
  problem_.clear();
  for (const int body : bodies_[island]) add_body(input, body, rest_s, bodies);
  problem_.add_joint_rows(false);
  const Index first = problem_.rows();
  stiffness_.clear();
  for (const int number : rows_[island]) {
    const ContactRow& row = rows[Index(number)];
    stiffness_.push_back(row.stiffness);
    problem_.add_row(row.body_a, row.body_b, push_of(row), row.margin - row.distance);
  }
  const SolverResult solved =
      solve_penalty(stiffness_, input.settings.budget.solver_iterations, forces_, problem_);
  for (Index i = 0; i < stiffness_.size(); ++i)
    rows[Index(rows_[island][i])].impulse = forces_[first + i] * rest_s;
  for (const ProblemBody& body : problem_.bodies())
    bodies.V_WB[Index(body.body)] = to_twist(problem_.displacement(body.body) / rest_s);
  report.solver_iterations += solved.iterations;
  if (!solved.converged) report.flags |= frame_flag::kSolverBounded;
}

/// Solves for the velocities of everything that moves over the rest of the frame, island by island.
void PenaltyResponse::solve(const StepInput& input, double rest_s, WorldState& bodies,
                            FrameReport& report) noexcept {
  const World& world = input.world;
  const std::span<const ContactRow> rows = contacts_.rows;
  // Of the joints' forces over the whole frame, only the part up to the impact counts here.
  const double before_impact = 1.0 - rest_s / input.dt_s;
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves())
      bodies.V_WB[i] = V_before_joints_[i] + (bodies.V_WB[i] - V_before_joints_[i]) * before_impact;
  islands_.clear(world, all_move_);
  for (Index r = 0; r < rows.size(); ++r)  // many rows in turn are of the same two bodies
    if (r == 0 || rows[r].body_a != rows[r - 1].body_a || rows[r].body_b != rows[r - 1].body_b)
      islands_.join(rows[r].body_a, rows[r].body_b);
  bodies_.set(world.bodies.size(), world.bodies.size(),
              [&](Index i) { return world.bodies[i].moves() ? islands_.of(static_cast<int>(i)) : -1; });
  rows_.set(world.bodies.size(), rows.size(),
            [&](Index r) { return islands_.of_contact(rows[r].body_a, rows[r].body_b); });
  report.solvers |= static_cast<int>(ContactSolver::kPenalty);
  for (Index island = 0; island < world.bodies.size(); ++island)
    if (!bodies_[island].empty()) solve_island(input, island, rest_s, bodies, report);
}

void PenaltyResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                           FrameReport& report) noexcept {
  const World& world = input.world;
  std::vector<Pose>& X_WB = bodies.X_WB;
  std::vector<Twist>& V_WB = bodies.V_WB;
  std::vector<ContactRow>& rows = contacts_.rows;
  const int tests_before = gaps.tests_left();
  make_contact_rows(X_WB, input.patches, input.shading,
                    input.settings.penalty.stiffness_N_per_m / input.settings.workspace.scale,
                    scale_depths(input, gaps, V_WB), contacts_);
  const double impact_s = first_impact(input, rows, gaps, V_WB);
  const double rest_s = input.dt_s - impact_s;
  const int grasped = input.grasped.body;
  if (impact_s > 0.0) {
    advance_distances(rows, X_WB, V_WB, impact_s);
    advance_bodies(world, V_WB, impact_s, X_WB);
  }
  if (cut_ && !(rest_s > 0.0)) report.flags |= frame_flag::kStepLimited;  // nothing was in its way
  if (rest_s > 0.0) {
    solve(input, rest_s, bodies, report);
    report.contact_points = static_cast<int>(rows.size());
    for (const ContactRow& row : rows)
      report.grasped_contact_points += row.body_a == grasped || row.body_b == grasped ? 1 : 0;
    if (grasped >= 0) report.restoring = contact_wrench(rows, grasped, X_WB[Index(grasped)].p, rest_s);
    limit_grasped(input, bodies);
    advance_bodies(world, V_WB, rest_s, X_WB);
  }
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves()) X_WB[i] = constrained_pose(world.bodies[i], X_WB[i]);
  report.time_of_impact_s = impact_s;
  report.validation_tests = tests_before - gaps.tests_left();
}

Wrench PenaltyResponse::felt(const StepInput& input, const PlacedHandle& handle) const noexcept {
  const GraspedPart& grasped = input.grasped;
  if (grasped.body < 0) return {};
  // The velocity is that of the whole frame's displacement, not of the last part after an impact.
  const Pose X_WH_before = input.X_WB_start[Index(grasped.body)] * grasped.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, handle.X_WH_proxy, input.dt_s);
  return coupling_wrench(input.coupling, grasped, handle.to_hand, V_WH_proxy);
}

}  // namespace tactum::inline v0_1
