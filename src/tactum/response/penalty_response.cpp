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

/// Keeps the step of the part that a hand holds below the threshold distance. True where it was longer.
bool limit_grasped(const MotionInput& input, const HandInput& hand, WorldState& bodies) {
  if (hand.grasped.body < 0) return false;
  Twist& V_WB = bodies.V_WB[Index(hand.grasped.body)];
  const double step = (V_WB.v.norm() + V_WB.w.norm() * input.radius_m[Index(hand.grasped.body)]) * input.dt_s;
  if (!(step > hand.limits.step_m)) return false;
  V_WB = V_WB * (hand.limits.step_m / step);
  return true;
}

/// Cuts the rest of the step of the part that a hand holds, `rest_s` seconds with V_rest after `impact_s`
/// with V_first, so that both together lead no farther than the threshold distance. The way there and back is
/// not counted: where the part is pushed off again after an impact, the contact force would be that of a pose
/// which is not taken.
void limit_rest(const MotionInput& input, const HandInput& hand, const Twist& V_first, double impact_s,
                double rest_s, Twist& V_rest) {
  const double radius_m = input.radius_m[Index(hand.grasped.body)];
  const Twist first = V_first * impact_s;
  const Twist rest = V_rest * rest_s;
  const auto step_of = [&](double share) {
    // Two turns one after the other turn by no more than their sum and half their product.
    const double both = 0.5 * first.w.norm() * rest.w.norm() * share;
    return (first.v + share * rest.v).norm() + ((first.w + share * rest.w).norm() + both) * radius_m;
  };
  if (!(step_of(1.0) > hand.limits.step_m)) return;
  double share = 0.0;
  double more = 0.5;
  for (int i = 0; i < kBisections; ++i, more *= 0.5)
    if (step_of(share + more) <= hand.limits.step_m) share += more;
  V_rest = V_rest * share;
}

/// Whether a body that nobody holds may meet another such body, or falls: then all of them move by impulses.
bool others_meet(const World& world, std::span<const char> grasped) {
  if (!world.pair_joints.empty()) return true;
  int others = 0;
  bool moves = false;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    if (grasped[i]) continue;
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
      hands_(settings.hands()),
      pushed_(world.bodies.size(), 0),
      is_grasped_(world.bodies.size(), 0),
      V_first_(world.bodies.size()),
      islands_(world),
      bodies_(world.bodies.size(), world.bodies.size()),
      rows_(world.bodies.size(), Index(settings.budget.max_contact_points)),
      problem_(Index(settings.budget.max_contact_points), world.bodies.size()),
      solver_(Index(settings.budget.max_contact_points) +
              (ContactProblem::kJointRows + 1) * world.bodies.size()),
      V_before_joints_(world.bodies.size()),
      delta_(world.bodies.size(), 0.0) {
  begin_midway(world, settings.dt_s, bodies);
  stiffness_.reserve(Index(settings.budget.max_contact_points));
  depth_scale_.reserve(settings.budget.capacity.patches);
}

/// The grasped parts' targets, from where they are: the whole displacement to where their couplings carry
/// weight and load, however short the step. They have no inertia, so nothing but the couplings holds them
/// back.
void PenaltyResponse::aim_grasped(const MotionInput& input, const WorldState& bodies) noexcept {
  for (Index h = 0; h < input.hands.size(); ++h) {
    const HandInput& hand = input.hands[h];
    if (hand.grasped.body < 0) continue;
    const Body& body = input.world.bodies[Index(hand.grasped.body)];
    const Pose& X_WB = bodies.X_WB[Index(hand.grasped.body)];
    if (!hand.bears_load) {
      hands_[h].target = to_vector(handle_at(hand.grasped, X_WB).to_hand);
      continue;
    }
    Wrench load = body.load.constant;
    load.f += body.mass_kg * input.world.gravity_W;
    hands_[h].target = to_vector(equilibrium_step(hand.coupling, hand.grasped, load, X_WB));
  }
}

/// Adds a body with its target over a step of `h_s` seconds.
void PenaltyResponse::add_body(const MotionInput& input, int body, double h_s,
                               const WorldState& bodies) noexcept {
  const Body& what = input.world.bodies[Index(body)];
  const Pose& X_WB = bodies.X_WB[Index(body)];
  if (is_grasped_[Index(body)]) {
    const GraspedBody as_body = grasped_by_all(input.hands, body, [&](const HandInput& hand, Index number) {
      return grasped_body_of(hand.bears_load ? what.load : BodyLoad{}, hand.grasped, X_WB,
                             coupling_stiffness(hand.coupling), hands_[number].target, input.dt_s);
    });
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
  for (Index i = 0; i < is_grasped_.size(); ++i) is_grasped_[i] = is_grasped(input.hands, i) ? 1 : 0;
  by_impulses_ = others_meet(world, is_grasped_);
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
    if (!body.moves() || (by_impulses_ && !is_grasped_[i])) continue;
    Twist& V_WB = bodies.V_WB[i];
    if (!is_grasped_[i]) {
      V_WB = carried_velocity(body.joint, bodies.X_WB[i], V_WB);
      V_WB = driven_velocity(body, world.gravity_W, bodies.X_WB[i], V_WB, input.dt_s);
    }
    V_before_joints_[i] = V_WB;
    if (!is_grasped_[i] && body.joint.kind == JointKind::kFree) continue;
    // First the motion that the joint allows, and where the hand and the joint's forces lead without contact.
    problem_.clear();
    add_body(input, number, input.dt_s, bodies);
    problem_.add_joint_rows(false);
    solver_.solve({}, input.settings.budget.solver_iterations, problem_);
    V_WB = to_twist(problem_.displacement(number) / input.dt_s);
  }
  cut_ = false;
  for (const HandInput& hand : input.hands) cut_ |= limit_grasped(input, hand, bodies);
  for (Index i = 0; i < delta_.size(); ++i) {
    const Twist& V = bodies.V_WB[i];
    delta_[i] = (V.v.norm() + V.w.norm() * input.radius_m[i]) * input.dt_s;
  }
  if (!by_impulses_) return delta_;
  // Beside its own motion, a body goes as far as a grasped part may push it.
  double longest = 0.0;
  for (Index i = 0; i < delta_.size(); ++i)
    if (is_grasped_[i]) longest = std::max(longest, delta_[i]);
  bound_constrained_motion(input, bodies, memory_);
  for (Index i = 0; i < delta_.size(); ++i) {
    if (is_grasped_[i]) {
      memory_.motion_bound[i] = delta_[i];
    } else if (pushed_[i]) {
      memory_.motion_bound[i] += longest;
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
  const SolverResult solved = solver_.solve(stiffness_, input.settings.budget.solver_iterations, problem_);
  for (Index i = 0; i < stiffness_.size(); ++i)
    rows[Index(rows_[island][i])].impulse = solver_.forces()[first + i] * rest_s;
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
  const auto is_of_grasped = [&](int island) {
    return std::any_of(input.hands.begin(), input.hands.end(), [&](const HandInput& hand) {
      return hand.grasped.body >= 0 && islands_.of(hand.grasped.body) == island;
    });
  };
  bodies_.set(world.bodies.size(), world.bodies.size(), [&](Index i) {
    const int island = islands_.moves(static_cast<int>(i)) ? islands_.of(static_cast<int>(i)) : -1;
    return by_impulses_ && !is_of_grasped(island) ? -1 : island;
  });
  rows_.set(world.bodies.size(), rows.size(),
            [&](Index r) { return islands_.of_contact(rows[r].body_a, rows[r].body_b); });
  report.solvers |= static_cast<int>(ContactSolver::kPenalty);
  for (Index island = 0; island < world.bodies.size(); ++island)
    if (!bodies_[island].empty()) solve_island(input, island, rest_s, bodies, report);
}

/// What a body adds to the margin of a row: of a grasped part the published delta, of a body that is pushed
/// how far its point comes nearer in a frame. With its whole speed and spin in the margin it would be pushed
/// off at a distance, the harder the faster it is.
double PenaltyResponse::share_of_margin(const StepInput& input, const ContactRow& row, int body,
                                        const Vec3& toward_W, const WorldState& bodies) const noexcept {
  if (is_grasped_[Index(body)]) return delta_[Index(body)];
  const Vec3 v = velocity_at(bodies.V_WB[Index(body)], row.p_W - bodies.X_WB[Index(body)].p);
  return std::max(0.0, toward_W.dot(v)) * input.dt_s;
}

/// Makes the rows of the springs.
void PenaltyResponse::find_rows(const StepInput& input, GapOracle& gaps, const WorldState& bodies) noexcept {
  std::fill(pushed_.begin(), pushed_.end(), 0);
  contacts_.rows.clear();
  if (by_impulses_ && first_grasped(input.hands) < 0) return;
  const ContactSource source{bodies.X_WB, input.patches,
                             by_impulses_ ? std::span<const char>(is_grasped_) : std::span<const char>(),
                             input.shading, scale_depths(input, gaps, bodies.V_WB)};
  make_contact_rows(source, input.settings.penalty.stiffness_N_per_m / input.scale, contacts_);
  if (!by_impulses_) return;
  // The pair was looked for within more than delta, as its bodies may be pushed.
  for (ContactRow& row : contacts_.rows) {
    pushed_[Index(row.body_a)] = pushed_[Index(row.body_b)] = 1;
    row.margin = std::max(input.settings.penalty.min_tolerance_m * input.scale,
                          share_of_margin(input, row, row.body_a, -row.n_BA_W, bodies) +
                              share_of_margin(input, row, row.body_b, row.n_BA_W, bodies));
  }
}

/// Advances the bodies that move by springs.
void PenaltyResponse::advance(const StepInput& input, double t_s, WorldState& bodies) const noexcept {
  if (!by_impulses_) {
    advance_bodies(input.world, bodies.V_WB, t_s, bodies.X_WB);
    return;
  }
  for (Index i = 0; i < is_grasped_.size(); ++i)
    if (is_grasped_[i]) bodies.X_WB[i] = advanced(bodies.X_WB[i], bodies.V_WB[i], t_s);
}

/// Reports the contact forces on the part that a hand holds.
void PenaltyResponse::report_grasped(const StepInput& input, Index hand, double rest_s,
                                     const WorldState& bodies, HandReport& report) const noexcept {
  const int grasped = input.hands[hand].grasped.body;
  if (grasped < 0) return;
  for (const ContactRow& row : contacts_.rows)
    report.grasped_contact_points += row.body_a == grasped || row.body_b == grasped ? 1 : 0;
  report.restoring = contact_wrench(contacts_.rows, grasped, bodies.X_WB[Index(grasped)].p, rest_s);
}

/// Moves the grasped parts, and all bodies that do not move by impulses; changes the velocities of those that
/// do.
void PenaltyResponse::move_by_springs(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                                      FrameReport& report, std::span<HandReport> others) noexcept {
  std::vector<ContactRow>& rows = contacts_.rows;
  find_rows(input, gaps, bodies);
  const double impact_s = first_impact(input, rows, gaps, bodies.V_WB);
  const double rest_s = input.dt_s - impact_s;
  stored_J_ = 0.0;
  if (impact_s > 0.0) {
    advance_distances(rows, bodies.X_WB, bodies.V_WB, impact_s);
    advance(input, impact_s, bodies);
    aim_grasped(input, bodies);
  }
  if (cut_ && !(rest_s > 0.0)) report.flags |= frame_flag::kStepLimited;  // nothing was in its way
  if (rest_s > 0.0) {
    V_first_ = bodies.V_WB;  // same size: nothing is allocated
    solve(input, rest_s, bodies, report);
    report.contact_points = static_cast<int>(rows.size());
    for (const ContactRow& row : rows) {
      const double force_N = row.impulse / rest_s;
      stored_J_ += 0.5 * force_N * force_N / row.stiffness;
    }
    for (Index h = 0; h < input.hands.size(); ++h) {
      report_grasped(input, h, rest_s, bodies, h == 0 ? report : others[h - 1]);
      const int grasped = input.hands[h].grasped.body;
      if (grasped >= 0)
        limit_rest(input, input.hands[h], V_first_[Index(grasped)], impact_s, rest_s,
                   bodies.V_WB[Index(grasped)]);
    }
    advance(input, rest_s, bodies);
  }
  for (Index i = 0; i < input.world.bodies.size(); ++i)
    if (input.world.bodies[i].moves() && (!by_impulses_ || is_grasped_[i]))
      bodies.X_WB[i] = constrained_pose(input.world.bodies[i], bodies.X_WB[i]);
  report.time_of_impact_s = impact_s;
}

void PenaltyResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
                           std::span<HandReport> others) noexcept {
  const int tests_before = gaps.tests_left();
  if (!by_impulses_) {
    move_by_springs(input, gaps, bodies, report, others);
  } else {
    ConstraintStep by_impulses{input, true, gaps, bodies, memory_, report, others};
    begin_step(by_impulses);
    move_by_springs(input, gaps, bodies, report, others);
    for (const ContactRow& row : contacts_.rows)
      memory_.free.momentum.give(row.body_a, row.body_b, row.impulse * row.n_BA_W);
    move_free_bodies(by_impulses);
    end_step(true, by_impulses);
    report.contact_points += static_cast<int>(memory_.constraint.rows.count);
    for (const ContactRow& row : memory_.contact_rows.rows)
      if (contacts_.rows.size() < contacts_.rows.capacity()) contacts_.rows.push_back(row);
  }
  report.validation_tests = tests_before - gaps.tests_left();
  for (Index h = 0; h < input.hands.size(); ++h) {
    const HandInput& hand = input.hands[h];
    hands_[h].spring = {};
    if (hand.grasped.body < 0) continue;
    const Twist to_hand = handle_at(hand.grasped, bodies.X_WB[Index(hand.grasped.body)]).to_hand;
    hands_[h].spring = coupling_wrench(hand.coupling, hand.grasped, to_hand, {});
  }
}

Wrench PenaltyResponse::felt(const StepInput& input, const PlacedHandle& handle, std::size_t hand) noexcept {
  const GraspedPart& grasped = input.hands[hand].grasped;
  Hand& own = hands_[hand];
  if (grasped.body != own.rate_of) own.rate = {};
  own.rate_of = grasped.body;
  if (grasped.body < 0) return {};
  // The velocity is that of the whole frame's displacement, not of the last part after an impact.
  const Pose X_WH_before = input.X_WB_start[Index(grasped.body)] * grasped.X_BH;
  const Twist V_WH_proxy = twist_between(X_WH_before, handle.X_WH_proxy, input.dt_s);
  constexpr double kFilter_s = 0.005;  // half of what devices take for a velocity
  own.rate = own.rate + (V_WH_proxy - grasped.V_WH - own.rate) * (input.dt_s / (kFilter_s + input.dt_s));
  return coupling_wrench(input.hands[hand].coupling, grasped, handle.to_hand, own.rate);
}

}  // namespace tactum::inline v0_1
