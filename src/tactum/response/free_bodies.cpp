#include "tactum/response/free_bodies.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/dynamics/spin.h"
#include "tactum/response/constraint_rows.h"
#include "tactum/response/constraint_trial.h"
#include "tactum/response/frame_impacts.h"
#include "tactum/response/free_islands.h"
#include "tactum/response/joined_bodies.h"
#include "tactum/response/momentum.h"
#include "tactum/response/waiting.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// After the backtracking, how often bodies that are in contact with a stopped one may be stopped too, before
/// all stop.
constexpr int kMostStops = 12;
/// Exact tests of each gap of the grasped part's island that are kept for it.
constexpr int kRoundsOfGrasped = 4;

/// Half a frame is gone back at the start by at most so many times the time in which the body's motion fades
/// by e: farther back its velocity has no digits left.
constexpr double kFarthestBack = 10.0;

/// The fraction of every island's step that its bodies' motion bounds allow, and how far each would go.
void limit_shares(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  std::fill(f.share.begin(), f.share.end(), 1.0);
  for (Index i = 0; i < f.share.size(); ++i) {
    if (!moves_here(step, i)) continue;
    const Twist V = mean_twist(step, i);
    const double travel = (V.v.norm() + V.w.norm() * step.radius_m[i]) * step.dt_s;
    double& share = f.share[Index(f.islands.of(static_cast<int>(i)))];
    if (travel * share > step.own.motion_bound[i]) share = step.own.motion_bound[i] / travel;
    if (travel > step.own.motion_bound[i] && is_grasped(step, i))
      step.report.flags |= step.own.constraint.trust.limit;
    step.own.waiting.travel[i] = travel;
  }
  // An island's number is its first body.
  for (Index i = 0; i < f.share.size(); ++i)
    if (moves_here(step, i)) f.share[i] = f.share[Index(f.islands.of(static_cast<int>(i)))];
  if (!f.grasped_here) return;
  for (const HandInput& hand : step.hands)
    if (hand.grasped.body >= 0 && step.gaps.blocked(hand.grasped.body))
      f.share[Index(hand.grasped.body)] = 0.0;
}

/// Puts the bodies of unsettled islands, on trial, where their steps lead.
void try_steps(ConstraintStep& step) {
  const FreeBodies& f = step.own.free;
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!moves_here(step, i) || f.settled[Index(f.islands.of(static_cast<int>(i)))]) continue;
    Pose& X_trial = step.own.constraint.trial.X_WB[i];
    const Pose& X_WB = step.bodies.X_WB[i];
    X_trial = X_WB;
    const Twist on = mean_twist(step, i) * (f.share[i] * step.dt_s);
    step.own.constraint.trial.turn[i] = turn_of(step.world.bodies[i], X_WB, on.w);
    if (f.share[i] > 0.0) X_trial = constrained_pose(step.world.bodies[i], advanced(X_WB, on, 1.0));
    if (!X_trial.finite()) X_trial = X_WB;
  }
  join_trial(step);
}

/// Whether the trial leaves a body where it is now.
bool stands(const ConstraintStep& step, int body) {
  return !moves_here(step, Index(body)) || step.own.free.share[Index(body)] == 0.0;
}

/// Settles the islands whose gaps are all open on trial; false when some are not. With `all` every gap of an
/// unsettled island is tested, else only those of bodies whose step was just cut.
bool look(bool all, int keep_back, ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  const std::span<const ContactPatch> patches = step.patches;
  f.patch_asked.clear();
  f.patch_closed.clear();
  for (const ContactPatch& patch : patches) {
    const int island = f.islands.of_contact(patch.body_a, patch.body_b);
    const bool news = all || f.cut[Index(patch.body_a)] || f.cut[Index(patch.body_b)];
    const bool asked = island >= 0 && !f.of_grasped(patch) && !f.settled[Index(island)] && news &&
                       !(stands(step, patch.body_a) && stands(step, patch.body_b));
    f.patch_asked.push_back(asked ? 1 : 0);
  }
  look_at_trial(keep_back, step);
  std::fill(f.settled.begin(), f.settled.end(), 1);
  bool all_open = true;
  for (Index p = 0; p < patches.size(); ++p) {
    const bool closed = closed_at_trial(p, step);
    f.patch_closed.push_back(closed ? 1 : 0);
    if (!closed) continue;
    f.settled[Index(f.islands.of_contact(patches[p].body_a, patches[p].body_b))] = 0;
    all_open = false;
  }
  return all_open;
}

/// Whether the gap of a patch at the trial is that of a contact which the frame had not found.
bool is_elsewhere(Index patch, const ConstraintStep& step) {
  return step.own.constraint.trial.gap_answer[patch] == GapAnswer::kElsewhere;
}

/// Whether some gap that is not open is such a one.
bool closed_elsewhere(const ConstraintStep& step) {
  const std::span<const char> closed = step.own.free.patch_closed;
  for (Index p = 0; p < closed.size(); ++p)
    if (closed[p] && is_elsewhere(p, step)) return true;
  return false;
}

/// Cuts the steps of the bodies whose gaps are not open: to half, or, without `halve` or where the gap is not
/// known exactly, to nothing.
void cut(bool halve, ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  const std::span<const ContactPatch> patches = step.patches;
  std::fill(f.cut.begin(), f.cut.end(), 0);
  for (Index p = 0; p < patches.size(); ++p) {
    if (!f.patch_closed[p]) continue;
    const bool known = known_at_trial(p, step);
    for (const int body : {patches[p].body_a, patches[p].body_b}) {
      if (!moves_here(step, Index(body))) continue;
      double& share = f.share[Index(body)];
      if (!halve || !known) {
        share = 0.0;
      } else if (!f.cut[Index(body)]) {
        share *= 0.5;
      }
      f.cut[Index(body)] = 1;
    }
  }
  cut_together(step);
}

/// Cuts the steps of the bodies whose path to the trial is not proven to be free, to what is proven of it.
/// False when there are some.
bool cut_at_paths(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  TrialPose& trial = step.own.constraint.trial;
  for (Index i = 0; i < f.share.size(); ++i) trial.goes[i] = moves_here(step, i) && f.share[i] > 0.0 ? 1 : 0;
  if (least_path_free(step) == 1.0) return true;
  std::fill(f.cut.begin(), f.cut.end(), 0);
  for (Index i = 0; i < f.share.size(); ++i) {
    if (!trial.goes[i] || trial.path_free[i] == 1.0) continue;
    f.share[i] *= kOfFreePath * trial.path_free[i];
    f.cut[i] = 1;
    f.settled[Index(f.islands.of(static_cast<int>(i)))] = 0;
  }
  cut_together(step);
  return false;
}

/// Stops the bodies of islands that are not settled.
void stay(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  for (Index i = 0; i < f.share.size(); ++i)
    if (moves_here(step, i) && !f.settled[Index(f.islands.of(static_cast<int>(i)))]) f.share[i] = 0.0;
}

/// Tests that are kept for the grasped part's own island, which is moved after the others.
int kept_for_grasped(const ConstraintStep& step) {
  const std::span<const ContactPatch> patches = step.patches;
  const auto own = std::count_if(patches.begin(), patches.end(),
                                 [&](const ContactPatch& patch) { return step.own.free.of_grasped(patch); });
  return std::min(kRoundsOfGrasped * static_cast<int>(own), step.gaps.tests_left() / 2);
}

/// Where an impact was found so late that its gap is closed on trial, as rows are linear and bodies turn, it
/// is met earlier: that opens the gap, where a force would add to the speed with which the bodies part. False
/// when no impact, or none alone, has closed it.
bool met_earlier(std::span<const ContactRow> rows_of_patch, double too_much, ConstraintStep& step) {
  if (!closed_at_trial(Index(rows_of_patch.front().patch), step)) return false;
  std::vector<Twist>& detour = step.own.free.detour;
  Twist& of_a = detour[Index(rows_of_patch.front().body_a)];
  Twist& of_b = detour[Index(rows_of_patch.front().body_b)];
  double shorter = 0.0;
  for (const ContactRow& row : rows_of_patch) {
    const double missing = row.skin_m - (gap_at_trial(row, step) - too_much);
    if (!(missing > 0.0)) continue;
    const double by_detour = -opening(row, of_a, of_b, step);
    if (!(by_detour > missing)) return false;
    shorter = std::max(shorter, missing / by_detour);
  }
  of_a = of_a * (1.0 - shorter);
  of_b = of_b * (1.0 - shorter);
  return shorter > 0.0;
}

/// Second-order correction, as in constraint_rows.h.
void correct(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  const CornerRows& corners = step.own.constraint.rows;
  const std::span<ContactRow> rows(step.own.contact_rows.rows.data(), corners.count);
  for (Index first = corners.own, end = first; first < rows.size(); first = end) {
    for (end = first + 1; end < rows.size() && rows[end].patch == rows[first].patch;) ++end;
    const Index a = Index(rows[first].body_a);
    const Index b = Index(rows[first].body_b);
    const int of_contact = f.islands.of_contact(rows[first].body_a, rows[first].body_b);
    if (of_contact < 0 || f.settled[Index(of_contact)]) continue;
    // A force of these rows would not keep another contact open, but make energy: the step is cut there, and
    // the next frame has that contact.
    if (is_elsewhere(Index(rows[first].patch), step)) continue;
    const double too_much = overstated_at_trial(rows.subspan(first, end - first), step);
    const double share = f.share[Index(of_contact)];
    if (!(share > 0.0)) continue;  // it stays, and its rows are not corrected
    if (met_earlier(rows.subspan(first, end - first), too_much, step)) continue;
    const Twist V_a = mean_twist(step, a);
    const Twist V_b = mean_twist(step, b);
    for (Index r = first; r < end; ++r) {
      if (rows[r].idle) {
        if (closed_at_trial(Index(rows[r].patch), step)) rows[r].asked = lift_of(rows[r], share);
        continue;
      }
      const double speed = opening(rows[r], V_a, V_b, step);
      const double gap = gap_at_trial(rows[r], step) - too_much;
      const double missing = (rows[r].distance + share * speed * step.dt_s - gap) / share;
      if (missing > 0.0) rows[r].asked += missing;
    }
  }
}

/// Keeps what is left of the displacement of a body that was hit, and then went beyond its motion bound, for
/// the next frame: it was not expected to be so fast, and is on its way again one frame later. What is left
/// after that is dropped: where the body cannot go on, the rests would add up from frame to frame.
void keep_rests(bool as_answered, ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (is_zero(f.detour[i]) || !moves_here(step, i)) continue;
    const double left_s = as_answered && f.hit[i] ? (1.0 - f.share[i]) * step.dt_s : 0.0;
    f.detour[i] = left_s > 0.0 ? mean_twist(step, i) * left_s : Twist{};
  }
}

/// Finds the islands, from the patches of the frame.
void find_islands(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  f.islands.clear(step.world, step.own.waiting.waits);
  f.grasped_island = -1;
  f.grasped_here = false;
  const auto yields = [&](const ContactPatch& patch) {
    return step.grasped_yields &&
           (is_grasped(step, Index(patch.body_a)) || is_grasped(step, Index(patch.body_b)));
  };
  for (const ContactPatch& patch : step.patches)
    if (!yields(patch)) f.islands.join(patch.body_a, patch.body_b);
  for (const PairJoint& pair : step.world.pair_joints) f.islands.join(pair.body, pair.parent);
  // All grasped parts are of one island, whether they touch or not: one problem, one step.
  const int grasped = first_grasped(step.hands);
  for (const HandInput& hand : step.hands)
    if (hand.grasped.body >= 0 && hand.grasped.body != grasped) f.islands.join(grasped, hand.grasped.body);
  const int island = grasped < 0 ? -1 : f.islands.of(grasped);
  Index unknowns = 0;
  f.alone = true;
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const bool near =
        island >= 0 && f.islands.moves(static_cast<int>(i)) && f.islands.of(static_cast<int>(i)) == island;
    f.near_grasped[i] = near ? 1 : 0;
    f.alone &= near || !f.islands.moves(static_cast<int>(i));
    if (near) unknowns += exact_unknowns_of(step.world, step.world.bodies[i]);
  }
  if (grasped < 0) return;
  f.grasped_here = choose_solver(unknowns, true) != ContactSolver::kExact;
  if (!f.grasped_here) f.grasped_island = island;
}

/// Adds the other half of weight and load.
void add_second_half(ConstraintStep& step) {
  if (!step.own.free.others) return;
  std::vector<Twist>& V_WB = step.bodies.V_WB;
  const std::vector<Pose>& X_WB = step.bodies.X_WB;
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const Body& body = step.world.bodies[i];
    if (!step.own.free.islands.moves(static_cast<int>(i)) || is_grasped(step, i)) continue;
    step.own.free.w_start[i] = V_WB[i].w;
    if (turns_freely(body)) V_WB[i].w = rate_midway(turning_inertia(body), X_WB[i].R, V_WB[i].w, step.dt_s);
    if (body.joint.kind == JointKind::kBall) V_WB[i].v = V_WB[i].w.cross(X_WB[i].p - body.joint.anchor_W);
    step.own.free.w_free[i] = V_WB[i].w;
    drive(body, step.world.gravity_W, 0.5 * step.dt_s, X_WB[i], V_WB[i]);
  }
}

/// The rates at the end of the frame of the bodies that turn freely, from their mean ones.
void end_turning(ConstraintStep& step) {
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const Body& body = step.world.bodies[i];
    if (!turns_freely(body) || is_grasped(step, i) || !step.own.free.islands.moves(static_cast<int>(i)))
      continue;
    const Mat3 inertia_B = turning_inertia(body);
    const Mat3& R_start = step.X_WB_start[i].R;
    const Pose& X_WB = step.bodies.X_WB[i];
    Twist& V = step.bodies.V_WB[i];
    const Vec3 pushed = inertia_at(inertia_B, R_start) * (V.w - step.own.free.w_free[i]);
    V.w = rate_after(inertia_B, R_start, step.own.free.w_start[i], pushed, X_WB.R);
    if (body.joint.kind == JointKind::kBall) V.v = V.w.cross(X_WB.p - body.joint.anchor_W);
  }
}

}  // namespace

void begin_midway(const World& world, double dt_s, WorldState& state) noexcept {
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    JointPosition& joint = state.joints[i];
    joint.before = joint.now - dt_s * joint_rate(body, state.X_WB[i]).dot(to_vector(state.V_WB[i]));
    double back_s = 0.5 * dt_s;
    if (body.load.damps()) back_s = std::min(back_s, kFarthestBack / fastest_fading(body, state.X_WB[i]));
    drive(body, world.gravity_W, -back_s, state.X_WB[i], state.V_WB[i]);
  }
  begin_joined(world, dt_s, state);
}

void pull_free_bodies(const MotionInput& input, WorldState& bodies) noexcept {
  const World& world = input.world;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves() || is_grasped(input.hands, i)) continue;
    bodies.V_WB[i] = carried_velocity(body.joint, bodies.X_WB[i], bodies.V_WB[i]);
    drive(body, world.gravity_W, 0.5 * input.dt_s, bodies.X_WB[i], bodies.V_WB[i]);
  }
}

bool others_move(const World& world, std::span<const HandInput> hands) noexcept {
  for (Index i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].moves() && !is_grasped(hands, i)) return true;
  return false;
}

void move_free_bodies(ConstraintStep& step) noexcept {
  FreeBodies& f = step.own.free;
  std::fill(f.given_Ns.begin(), f.given_Ns.end(), Vec3::Zero());
  if (f.alone && !f.grasped_here) return;
  ConstraintState& c = step.own.constraint;
  begin_islands(step);
  std::fill(f.settled.begin(), f.settled.end(), 0);
  solve_islands(step);
  limit_shares(step);
  const int keep_back = kept_for_grasped(step);
  c.trial.X_WB = step.bodies.X_WB;  // same size: nothing is allocated
  bool all = true;
  int cuts = 0;
  for (int round = 0;; ++round) {
    try_steps(step);
    if (cuts > kBacktracks + kMostStops) break;  // stay() has stopped the rest
    const int tests = step.report.validation_tests;
    const bool open = look(all, keep_back, step);
    if (open && cut_at_paths(step)) break;
    ++step.report.validation_retries;
    if (open) {
      all = false;
      round = kFeedbacks;
      if (++cuts > kBacktracks + kMostStops) stay(step);
      continue;
    }
    // Another solution takes as many tests as this one.
    all = round < kFeedbacks && step.gaps.tests_left() - keep_back >= step.report.validation_tests - tests;
    if (all) {
      correct(step);
      solve_islands(step);
      limit_shares(step);
    } else if (++cuts <= kBacktracks + kMostStops) {
      round = kFeedbacks;
      const bool at_paths = cuts == 1 && closed_elsewhere(step) && !cut_at_paths(step);
      if (!at_paths) cut(cuts <= kBacktracks, step);
    } else {
      stay(step);
    }
  }
  keep_rests(cuts == 0, step);
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    if (!moves_here(step, i)) continue;
    step.bodies.X_WB[i] = c.trial.X_WB[i];
    // The answer leads the grasped part to the hand, however far; its velocity is what it did.
    if (is_grasped(step, i))
      step.bodies.V_WB[i] = twist_between(step.X_WB_start[i], step.bodies.X_WB[i], step.dt_s);
    if (f.share[i] > 0.0 || is_grasped(step, i)) continue;
    // A body that stays loses its velocity: kept, it would grow under gravity meanwhile.
    step.bodies.V_WB[i] = {};
    f.A_contacts[i] = {};
    ++step.report.cut_short;
  }
}

void begin_step(ConstraintStep& step) noexcept {
  TrialPose& trial = step.own.constraint.trial;
  trial.gap_now.clear();
  for (const ContactPatch& patch : step.patches) trial.gap_now.push_back(patch.distance);
  step.own.free.patch_passed.assign(trial.gap_now.size(), 0);  // within what was reserved
  trial.gap.resize(trial.gap_now.size());
  trial.gap_least.resize(trial.gap_now.size());
  trial.gap_answer.resize(trial.gap_now.size());

  step.own.free.others = others_move(step.world, step.hands);
  defer_bodies(step);
  find_islands(step);
  begin_balance(step);
  make_corner_rows(step);
  apply_impacts(step);
  add_second_half(step);
}

void end_step(bool as_forced, ConstraintStep& step) noexcept {
  step.own.constraint.anchors.end_frame([&](int body) { return step.own.free.islands.moves(body); });
  end_turning(step);
  end_balance(as_forced, step);
  go_on(step);
}

}  // namespace tactum::inline v0_1
