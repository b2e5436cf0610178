#include "tactum/response/penalty_response.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/dynamics/solver_choice.h"
#include "tactum/dynamics/step.h"
#include "tactum/math/screw.h"
#include "tactum/response/constraint.h"
#include "tactum/response/coupling.h"
#include "tactum/response/field_pull.h"
#include "tactum/response/free_bodies.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// How often the part of a step that a limit allows is bisected: to a billionth.
constexpr int kBisections = 30;

/// The grasped part has weight, but no inertia: it resists as its coupling does, at the handle.
GraspMetric coupling_stiffness(const Coupling& coupling) {
  return {coupling.stiffness_N_per_m, coupling.stiffness_Nm_per_rad};
}

/// Keeps the grasped part's step below the threshold distance. True where the step was longer.
bool limit_grasped(const MotionInput& input, WorldState& bodies) {
  if (input.grasped().body < 0) return false;
  Twist& V_WB = bodies.V_WB[Index(input.grasped().body)];
  const double step =
      (V_WB.v.norm() + V_WB.w.norm() * input.radius_m[Index(input.grasped().body)]) * input.dt_s;
  if (!(step > input.limits.step_m)) return false;
  V_WB = V_WB * (input.limits.step_m / step);
  return true;
}

/// Cuts the rest of the grasped part's step, `rest_s` seconds with V_rest after `impact_s` with V_first, so
/// that both together lead no farther than the threshold distance. The way there and back is not counted:
/// where the part is pushed off again after an impact, the contact force would be that of a pose which is
/// not taken.
void limit_rest(const MotionInput& input, const Twist& V_first, double impact_s, double rest_s,
                Twist& V_rest) {
  const double radius_m = input.radius_m[Index(input.grasped().body)];
  const Twist first = V_first * impact_s;
  const Twist rest = V_rest * rest_s;
  const auto step_of = [&](double share) {
    // Two turns one after the other turn by no more than their sum and half their product.
    const double both = 0.5 * first.w.norm() * rest.w.norm() * share;
    return (first.v + share * rest.v).norm() + ((first.w + share * rest.w).norm() + both) * radius_m;
  };
  if (!(step_of(1.0) > input.limits.step_m)) return;
  double share = 0.0;
  double more = 0.5;
  for (int i = 0; i < kBisections; ++i, more *= 0.5)
    if (step_of(share + more) <= input.limits.step_m) share += more;
  V_rest = V_rest * share;
}

/// Whether a body other than the grasped one may meet anything but that, or falls: then all of them move by
/// impulses.
bool others_meet(const World& world, int grasped) {
  if (!world.pair_joints.empty()) return true;
  int others = 0;
  bool moves = false;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (static_cast<int>(i) == grasped) continue;
    if (world.bodies[i].joint.kind == JointKind::kFree) return true;
    ++others;
    moves |= world.bodies[i].moves();
  }
  return moves && others > 1;
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
  if (rows.empty()) return input.dt_s;
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

PenaltyResponse::PenaltyResponse(const World& world, const FrameSettings& settings, WorldState& bodies)
    : contacts_(settings.budget.capacity.patches, Index(settings.budget.max_contact_points)),
      memory_(world, settings),
      pushed_(world.bodies.size(), 0),
      islands_(world),
      bodies_(world.bodies.size(), world.bodies.size()),
      rows_(world.bodies.size(), Index(settings.budget.max_contact_points)),
      problem_(Index(settings.budget.max_contact_points), world.bodies.size()),
      V_before_joints_(world.bodies.size()),
      delta_(world.bodies.size(), 0.0) {
  begin_midway(world, settings.dt_s, bodies);
  stiffness_.reserve(Index(settings.budget.max_contact_points));
  depth_scale_.reserve(settings.budget.capacity.patches);
  forces_.reserve(Index(settings.budget.max_contact_points) +
                  ContactProblem::kJointRows * world.bodies.size());
}

/// The grasped part's target, from where it is: the whole displacement to where its coupling carries its
/// weight and load, however short the step. It has no inertia, so nothing but its coupling holds it back.
void PenaltyResponse::aim_grasped(const MotionInput& input, const WorldState& bodies) noexcept {
  if (input.grasped().body < 0) return;
  const Body& body = input.world.bodies[Index(input.grasped().body)];
  Wrench load = body.load.constant;
  load.f += body.mass_kg * input.world.gravity_W;
  target_ = to_vector(
      equilibrium_step(input.coupling(), input.grasped(), load, bodies.X_WB[Index(input.grasped().body)]));
}

/// Adds a body with its target over a step of `h_s` seconds.
void PenaltyResponse::add_body(const MotionInput& input, int body, double h_s,
                               const WorldState& bodies) noexcept {
  const Body& what = input.world.bodies[Index(body)];
  const Pose& X_WB = bodies.X_WB[Index(body)];
  if (body == input.grasped().body) {
    const GraspedBody as_body = grasped_body_of(what.load, input.grasped(), X_WB,
                                                coupling_stiffness(input.coupling()), target_, input.dt_s);
    problem_.add_body(placed(input.world, bodies, body), as_body.centre_W, as_body.metric, as_body.target,
                      h_s);
    return;
  }
  // The joint of a body that moves by impulses acts there.
  problem_.add_body(placed(input.world, bodies, body), X_WB.p, damped_metric(what, X_WB, h_s),
                    to_vector(bodies.V_WB[Index(body)] * h_s), by_impulses_ ? 0.0 : h_s);
}

std::span<const double> PenaltyResponse::bound_motion(const MotionInput& input, WorldState& bodies) noexcept {
  const World& world = input.world;
  by_impulses_ = others_meet(world, input.grasped().body);
  aim_grasped(input, bodies);
  memory_.waiting.V_kept = bodies.V_WB;  // same size: nothing is allocated
  if (by_impulses_) {
    pull_free_bodies(input, bodies);
  } else {
    std::fill(memory_.waiting.waits.begin(), memory_.waiting.waits.end(), 0);  // none sleeps
  }
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const int number = static_cast<int>(i);
    if (!body.moves() || (by_impulses_ && number != input.grasped().body)) continue;
    Twist& V_WB = bodies.V_WB[i];
    if (number != input.grasped().body) {
      V_WB = carried_velocity(body.joint, bodies.X_WB[i], V_WB);
      V_WB = driven_velocity(body, world.gravity_W, bodies.X_WB[i], V_WB, input.dt_s);
    }
    V_before_joints_[i] = V_WB;
    if (number != input.grasped().body && body.joint.kind == JointKind::kFree) continue;
    // First the motion that the joint allows, and where the hand and the joint's forces lead without contact.
    problem_.clear();
    add_body(input, number, input.dt_s, bodies);
    problem_.add_joint_rows(false);
    solve_penalty({}, input.settings.budget.solver_iterations, forces_, problem_);
    V_WB = to_twist(problem_.displacement(number) / input.dt_s);
  }
  cut_ = limit_grasped(input, bodies);
  for (Index i = 0; i < delta_.size(); ++i) {
    const Twist& V = bodies.V_WB[i];
    delta_[i] = (V.v.norm() + V.w.norm() * input.radius_m[i]) * input.dt_s;
  }
  if (!by_impulses_) return delta_;
  // Beside its own motion, a body goes as far as the grasped part may push it.
  bound_constrained_motion(input, bodies, memory_);
  for (Index i = 0; i < delta_.size(); ++i) {
    if (static_cast<int>(i) == input.grasped().body) {
      memory_.motion_bound[i] = delta_[i];
    } else if (pushed_[i] && input.grasped().body >= 0) {
      memory_.motion_bound[i] += delta_[Index(input.grasped().body)];
    }
  }
  return memory_.motion_bound;
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
    if (world.bodies[i].moves() && !by_impulses_)
      bodies.V_WB[i] = V_before_joints_[i] + (bodies.V_WB[i] - V_before_joints_[i]) * before_impact;
  islands_.clear(world, memory_.waiting.waits);
  for (Index r = 0; r < rows.size(); ++r)  // many rows in turn are of the same two bodies
    if (r == 0 || rows[r].body_a != rows[r - 1].body_a || rows[r].body_b != rows[r - 1].body_b)
      islands_.join(rows[r].body_a, rows[r].body_b);
  const int of_grasped = by_impulses_ ? islands_.of(input.grasped().body) : -1;
  bodies_.set(world.bodies.size(), world.bodies.size(), [&](Index i) {
    const int island = islands_.moves(static_cast<int>(i)) ? islands_.of(static_cast<int>(i)) : -1;
    return by_impulses_ && island != of_grasped ? -1 : island;
  });
  rows_.set(world.bodies.size(), rows.size(),
            [&](Index r) { return islands_.of_contact(rows[r].body_a, rows[r].body_b); });
  report.solvers |= static_cast<int>(ContactSolver::kPenalty);
  for (Index island = 0; island < world.bodies.size(); ++island)
    if (!bodies_[island].empty()) solve_island(input, island, rest_s, bodies, report);
}

/// Makes the rows of the springs.
void PenaltyResponse::find_rows(const StepInput& input, GapOracle& gaps, const WorldState& bodies) noexcept {
  const int grasped = input.grasped().body;
  std::fill(pushed_.begin(), pushed_.end(), 0);
  contacts_.rows.clear();
  if (by_impulses_ && grasped < 0) return;
  const double scale = input.settings.workspace.scale;
  const ContactSource source{bodies.X_WB, input.patches, by_impulses_ ? grasped : -1, input.shading,
                             scale_depths(input, gaps, bodies.V_WB)};
  make_contact_rows(source, input.settings.penalty.stiffness_N_per_m / scale, contacts_);
  if (!by_impulses_) return;
  // The pair was looked for within more than delta, as its bodies may be pushed.
  for (ContactRow& row : contacts_.rows) {
    pushed_[Index(row.body_a)] = pushed_[Index(row.body_b)] = 1;
    row.margin = std::max(input.settings.penalty.min_tolerance_m * scale,
                          delta_[Index(row.body_a)] + delta_[Index(row.body_b)]);
  }
}

/// Advances the bodies that move by springs.
void PenaltyResponse::advance(const StepInput& input, double t_s, WorldState& bodies) const noexcept {
  if (!by_impulses_) {
    advance_bodies(input.world, bodies.V_WB, t_s, bodies.X_WB);
  } else if (input.grasped().body >= 0) {
    const Index grasped = Index(input.grasped().body);
    bodies.X_WB[grasped] = advanced(bodies.X_WB[grasped], bodies.V_WB[grasped], t_s);
  }
}

/// Moves the grasped part, and all bodies that do not move by impulses; changes the velocities of those that
/// do.
void PenaltyResponse::move_by_springs(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                                      FrameReport& report) noexcept {
  std::vector<ContactRow>& rows = contacts_.rows;
  find_rows(input, gaps, bodies);
  const double impact_s = first_impact(input, rows, gaps, bodies.V_WB);
  const double rest_s = input.dt_s - impact_s;
  const int grasped = input.grasped().body;
  stored_J_ = 0.0;
  if (impact_s > 0.0) {
    advance_distances(rows, bodies.X_WB, bodies.V_WB, impact_s);
    advance(input, impact_s, bodies);
    aim_grasped(input, bodies);
  }
  if (cut_ && !(rest_s > 0.0)) report.flags |= frame_flag::kStepLimited;  // nothing was in its way
  if (rest_s > 0.0) {
    const Twist V_first = grasped < 0 ? Twist{} : bodies.V_WB[Index(grasped)];
    solve(input, rest_s, bodies, report);
    report.contact_points = static_cast<int>(rows.size());
    for (const ContactRow& row : rows) {
      report.grasped_contact_points += row.body_a == grasped || row.body_b == grasped ? 1 : 0;
      const double force_N = row.impulse / rest_s;
      stored_J_ += 0.5 * force_N * force_N / row.stiffness;
    }
    if (grasped >= 0) report.restoring = contact_wrench(rows, grasped, bodies.X_WB[Index(grasped)].p, rest_s);
    if (grasped >= 0) limit_rest(input, V_first, impact_s, rest_s, bodies.V_WB[Index(grasped)]);
    advance(input, rest_s, bodies);
  }
  for (Index i = 0; i < input.world.bodies.size(); ++i)
    if (input.world.bodies[i].moves() && (!by_impulses_ || static_cast<int>(i) == grasped))
      bodies.X_WB[i] = constrained_pose(input.world.bodies[i], bodies.X_WB[i]);
  report.time_of_impact_s = impact_s;
}

void PenaltyResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
                           std::span<HandReport> /*others*/) noexcept {
  const int tests_before = gaps.tests_left();
  if (!by_impulses_) {
    move_by_springs(input, gaps, bodies, report);
  } else {
    ConstraintStep others{input, true, gaps, bodies, memory_, report};
    begin_step(others);
    move_by_springs(input, gaps, bodies, report);
    for (const ContactRow& row : contacts_.rows)
      memory_.free.momentum.give(row.body_a, row.body_b, row.impulse * row.n_BA_W);
    move_free_bodies(others);
    end_step(true, others);
    report.contact_points += static_cast<int>(memory_.constraint.rows.count);
    for (const ContactRow& row : memory_.contact_rows.rows)
      if (contacts_.rows.size() < contacts_.rows.capacity()) contacts_.rows.push_back(row);
  }
  report.validation_tests = tests_before - gaps.tests_left();
}

Wrench PenaltyResponse::felt(const StepInput& input, const PlacedHandle& handle,
                             std::size_t /*hand*/) noexcept {
  const GraspedPart& grasped = input.grasped();
  if (grasped.body != rate_of_) rate_ = {};
  rate_of_ = grasped.body;
  if (grasped.body < 0) return {};
  // The velocity is that of the whole frame's displacement, not of the last part after an impact.
  const Pose X_WH_before = input.X_WB_start[Index(grasped.body)] * grasped.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, handle.X_WH_proxy, input.dt_s);
  constexpr double kFilter_s = 0.005;  // half of what devices take for a velocity
  rate_ = rate_ + (V_WH_proxy - grasped.V_WH - rate_) * (input.dt_s / (kFilter_s + input.dt_s));
  return coupling_wrench(input.coupling(), grasped, handle.to_hand, rate_);
}

}  // namespace tactum::inline v0_1
