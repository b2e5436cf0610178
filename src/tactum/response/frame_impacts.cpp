#include "tactum/response/frame_impacts.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/dynamics/body_load.h"
#include "tactum/response/constraint_trial.h"
#include "tactum/response/energy.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The most impacts in a frame, for every contact point and in all; the approach that is left then is solved
/// as resting contact, without restitution.
constexpr int kImpactsAPoint = 8;
constexpr int kMostImpacts = 128;
/// The sums of all impacts; those on grasped parts are given at the handles. Hands that hold a part together
/// feel equal shares of what it is hit by.
class ImpactsOnGrasped final : public ImpactObserver {
 public:
  explicit ImpactsOnGrasped(ConstraintStep& step) : step_(step) {
    for (CoupledHand& hand : step.own.constraint.hands) {
      hand.hit = {};
      hand.is_hit = false;
    }
  }
  void hit(int body_a, int body_b, const Vec3& impulse, const Vec3& turning,
           const Vec3& p_W) noexcept override {
    step_.own.free.momentum.give(body_a, body_b, impulse);
    for (Index h = 0; h < step_.hands.size(); ++h) {
      const GraspedPart& grasped = step_.hands[h].grasped;
      if (grasped.body < 0 || (body_a != grasped.body && body_b != grasped.body)) continue;
      const Vec3 p_WH = step_.bodies.X_WB[Index(grasped.body)] * grasped.X_BH.p;
      const double sign = (body_a == grasped.body ? 1.0 : -1.0) / holders_of(step_.hands, grasped.body);
      CoupledHand& hand = step_.own.constraint.hands[h];
      hand.hit = hand.hit + Wrench{impulse, turning + (p_W - p_WH).cross(impulse)} * sign;
      hand.is_hit = true;
    }
  }

 private:
  ConstraintStep& step_;
};

/// Lets the hands feel the impulses on their parts; the energy that the bodies have lost is that of all
/// impulses in equal shares.
void show_impacts(double lost_J, ConstraintStep& step) {
  int hit = 0;
  for (const CoupledHand& hand : step.own.constraint.hands) hit += hand.is_hit ? 1 : 0;
  for (CoupledHand& hand : step.own.constraint.hands)
    if (hand.is_hit) hand.impulses.add(step.settings.impacts, step.dt_s, hand.hit, lost_J / hit);
}

ImpactBodies impact_bodies(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  return {step.world, step.bodies.X_WB, f.struck, f.A_free, f.A_seen, f.V_seen, f.detour};
}

/// Marks the bodies that impacts move, and finds what weight and load add to their twists.
void begin_impacts(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  const double half_s = 0.5 * step.dt_s;
  for (Index i = 0; i < step.world.bodies.size(); ++i) {
    const Body& body = step.world.bodies[i];
    if (!body.moves()) continue;
    f.A_free[i] = {};
    // The hand decides where its part goes: an impact does not move it, it is felt.
    f.struck[i] = !is_grasped(step, i) && f.islands.moves(static_cast<int>(i)) ? 1 : 0;
    if (!f.struck[i]) {
      f.detour[i] = {};
      continue;
    }
    Twist V = step.bodies.V_WB[i];
    drive(body, step.world.gravity_W, half_s, step.bodies.X_WB[i], V);
    f.A_free[i] = (V - step.bodies.V_WB[i]) * (1.0 / half_s);
  }
}

/// Whether the forces that the last frame found for the body are those of contacts alone: it is free, so that
/// none of them is a joint's.
bool may_rest(const ConstraintStep& step, Index body) {
  const Body& what = step.world.bodies[body];
  return step.own.free.struck[body] && what.joint.kind == JointKind::kFree && what.pair_joint < 0;
}

/// Lets the forces of resting contacts act on, in bodies that still touch something and that the hand does
/// not press.
void show_resting(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  std::fill(f.A_seen.begin(), f.A_seen.end(), Twist{});
  for (const ContactRow& row : step.own.contact_rows.rows) {
    if (row.idle || row.distance > 2.0 * row.skin_m) continue;
    for (const int body : {row.body_a, row.body_b})
      if (may_rest(step, Index(body))) f.A_seen[Index(body)] = f.A_contacts[Index(body)];
  }
  for (const ContactRow& row : step.own.contact_rows.rows)
    if (is_grasped(step, Index(row.body_a)) || is_grasped(step, Index(row.body_b)))
      f.A_seen[Index(row.body_a)] = f.A_seen[Index(row.body_b)] = {};
  f.V_seen = step.bodies.V_WB;  // same size: nothing is allocated
  for (Index i = 0; i < f.A_seen.size(); ++i) {
    if (is_zero(f.A_seen[i])) continue;
    f.A_free[i] = f.A_free[i] + f.A_seen[i];
    f.V_seen[i] = f.V_seen[i] + f.A_seen[i] * (0.5 * step.dt_s);
  }
}

/// Takes these forces out of the velocities again: what was not hit has the velocity that it had.
void hide_resting(std::span<const Twist> detour_before, ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  for (Index i = 0; i < f.V_seen.size(); ++i) {
    // A body that has passed its impulse on has the velocity that it had before.
    f.hit[i] = f.detour[i].v != detour_before[i].v || f.detour[i].w != detour_before[i].w ? 1 : 0;
    Twist& V = step.bodies.V_WB[i];
    const Twist seen = V + f.A_seen[i] * (0.5 * step.dt_s);
    if (f.V_seen[i].v == seen.v && f.V_seen[i].w == seen.w) continue;
    V = f.V_seen[i] - f.A_seen[i] * (0.5 * step.dt_s);
  }
}

/// Forgets what the last frame has left of a displacement where another body has come into its way.
void clear_blocked_rests(ConstraintStep& step) {
  std::vector<Twist>& detour = step.own.free.detour;
  if (std::all_of(detour.begin(), detour.end(), [](const Twist& d) { return is_zero(d); })) return;
  for (const ContactRow& row : step.own.contact_rows.rows) {
    Twist& of_a = detour[Index(row.body_a)];
    Twist& of_b = detour[Index(row.body_b)];
    if (opening(row, of_a, of_b, step) < std::min(0.0, row.skin_m - row.distance)) of_a = of_b = {};
  }
}

/// Leaves out the contacts that bodies pass by: a row states a gap along one normal, which turns as a ball
/// falls past an edge, and would stop it where it never touches. They ask nothing until a trial closes them.
void leave_out_passed(ConstraintStep& step) {
  FreeBodies& f = step.own.free;
  const double h = step.dt_s;
  const ImpactBodies bodies = impact_bodies(step);
  const std::span<ContactRow> rows(step.own.contact_rows.rows.data(), step.own.constraint.rows.count);
  const auto meets = [&](const ContactRow& row) {
    if (!(row.distance > 2.0 * row.skin_m)) return false;
    const Meeting meeting = meeting_of(row, bodies, 0.0);
    return meeting.time_s < h && meeting.speed > slowest_impact(row, bodies, h);
  };
  for (Index first = 0, end = 0; first < rows.size(); first = end) {
    for (end = first + 1; end < rows.size() && rows[end].patch == rows[first].patch;) ++end;
    const std::span<ContactRow> own = rows.subspan(first, end - first);
    const Index a = Index(own[0].body_a);
    const Index b = Index(own[0].body_b);
    const bool free = (f.struck[a] || f.struck[b]) && !is_grasped(step, a) && !is_grasped(step, b);
    if (!free || own[0].idle || std::none_of(own.begin(), own.end(), meets)) continue;
    for (const Index i : {a, b}) f.V_free[i] = f.V_seen[i] + f.A_free[i] * (0.5 * h);
    const Passing passing =
        step.gaps.passes(own[0].patch, step.bodies.X_WB, f.V_free, h, 0.5 * own[0].skin_m);
    if (passing == Passing::kNot) continue;
    f.patch_passed[Index(own[0].patch)] = passing == Passing::kSlides ? 1 : 0;
    for (ContactRow& row : own) {
      row.idle = true;
      row.asked = kAsksNothing_m;
      row.impact.enabled = false;
    }
  }
}

}  // namespace

void drive(const Body& body, const Vec3& gravity_W, double h, const Pose& X_WB, Twist& V_WB) noexcept {
  V_WB = driven_velocity(body, gravity_W, X_WB, V_WB, h);
  if (body.joint.kind != JointKind::kFree)
    V_WB = constrained_velocity(body.joint, X_WB, damped_resistance(body, X_WB, h), V_WB);
}

double opening(const ContactRow& row, const Twist& of_a, const Twist& of_b,
               const ConstraintStep& step) noexcept {
  const std::vector<Pose>& X_WB = step.bodies.X_WB;
  return row.n_BA_W.dot(velocity_at(of_a, row.p_W - X_WB[Index(row.body_a)].p) -
                        velocity_at(of_b, row.p_W - X_WB[Index(row.body_b)].p));
}

void apply_impacts(ConstraintStep& step) noexcept {
  if (!step.own.free.others) return;
  begin_impacts(step);
  show_resting(step);
  clear_blocked_rests(step);
  leave_out_passed(step);
  const bool some_grasped = first_grasped(step.hands) >= 0;
  const auto energy_J = [&step] {
    return bodies_energy(step.world, step.bodies.X_WB, step.bodies, step.hands);
  };
  const double before_J = some_grasped ? energy_J() : 0.0;
  ImpactsOnGrasped impacts(step);
  const std::vector<Twist>& detour = step.own.free.detour;
  std::vector<Twist>& detour_before = step.own.free.V_free;
  detour_before = detour;  // same size: nothing is allocated
  const ImpactResult result = resolve_impacts(
      step.own.contact_rows.rows, impact_bodies(step), step.dt_s,
      std::min(kMostImpacts, kImpactsAPoint * static_cast<int>(step.own.contact_rows.rows.size())),
      step.own.impact_scratch, &impacts);
  hide_resting(detour_before, step);
  step.report.impacts = result.hits;
  if (!result.converged) step.report.flags |= frame_flag::kSolverBounded;
  const std::vector<CoupledHand>& hands = step.own.constraint.hands;
  if (std::any_of(hands.begin(), hands.end(), [](const CoupledHand& hand) { return hand.is_hit; }))
    show_impacts(std::max(0.0, before_J - energy_J()), step);
}

}  // namespace tactum::inline v0_1
