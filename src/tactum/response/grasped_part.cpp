#include "tactum/response/grasped_part.h"
#include "tactum/response/field_pull.h"

namespace tactum::inline v0_1 {

namespace {

using Index = std::size_t;

/// The displacement of the handle that `wanted` becomes when weight, force fields and the constant force and
/// torque on the grasped part load it, (m, rad).
Vec6 with_load(const ConstraintStep& step, const HandInput& hand, const Vec6& wanted) {
  const Index grasped = Index(hand.grasped.body);
  const Wrench& constant = step.world.bodies[grasped].load.constant;
  const Vec3 weight = step.world.bodies[grasped].mass_kg * step.world.gravity_W + constant.f;
  const Vec3 lever = -(step.bodies.X_WB[grasped].R * hand.grasped.X_BH.p);  // from the handle
  const Wrench field = field_at_handle(hand.grasped, step.bodies.X_WB);
  const GraspMetric metric = grasp_metric(hand.coupling, step.dt_s);
  const GraspMetric over_step = step_metric(hand.coupling, hand.grasped, step.dt_s);
  Vec6 sunk;
  sunk.head<3>() = wanted.head<3>() * (metric.stiffness_N_per_m / over_step.stiffness_N_per_m) +
                   (weight + field.f) / over_step.stiffness_N_per_m;
  sunk.tail<3>() = wanted.tail<3>() * (metric.stiffness_Nm_per_rad / over_step.stiffness_Nm_per_rad) +
                   (lever.cross(weight) + field.t + constant.t) / over_step.stiffness_Nm_per_rad;
  return sunk;
}

/// The part with the coupling of one hand, whose handle that would move by `target`.
GraspedBody body_of(const ConstraintStep& step, const HandInput& hand, const Vec6& target) {
  const Index grasped = Index(hand.grasped.body);
  const BodyLoad load = hand.bears_load ? step.world.bodies[grasped].load : BodyLoad{};
  return grasped_body_of(load, hand.grasped, step.bodies.X_WB[grasped],
                         step_metric(hand.coupling, hand.grasped, step.dt_s), target, step.dt_s);
}

/// Adds the part with the couplings of all hands that hold it; `target_of(hand, number)` is the displacement
/// of each handle.
template <class TargetOf>
void add_part(int body, const ConstraintStep& step, ContactProblem& problem, const TargetOf& target_of) {
  const GraspedBody as_body = grasped_by_all(step.hands, body, [&](const HandInput& hand, Index h) {
    return body_of(step, hand, target_of(hand, h));
  });
  problem.add_body_and_joint(step.world, placed(step.world, step.bodies, body), as_body.centre_W,
                             as_body.metric, as_body.target, step.dt_s);
}

/// Sets what a hand feels when its handle moves by `displacement` (m, rad) from where it is, in place of what
/// it wanted.
void feel(const HandInput& hand, const Vec6& displacement, double dt_s, CoupledHand& coupled) {
  // M (x - x*) at the handle, x* without weight and fields: with a free grasped part, exactly the sum of the
  // contact forces, its weight and the load of fields. Where fields are so steep that the step was made with
  // a stiffer metric, it is that sum only when the part stands.
  const GraspMetric metric = grasp_metric(hand.coupling, dt_s);
  const Vec6 off = displacement - coupled.wanted;
  coupled.felt = {metric.stiffness_N_per_m * off.head<3>(),
                  metric.stiffness_Nm_per_rad * passed_on(hand.grasped, off.tail<3>())};
}

}  // namespace

Vec6 wanted_by_hand(const ConstraintStep& step, const HandInput& hand) noexcept {
  const Twist missing = handle_at(hand.grasped, step.bodies.X_WB[Index(hand.grasped.body)]).to_hand;
  const Twist& V_WH = hand.grasped.V_WH;
  return balanced_step(hand.coupling, step.dt_s, missing, {V_WH.v, passed_on(hand.grasped, V_WH.w)});
}

void find_wanted(ConstraintStep& step) noexcept {
  for (Index h = 0; h < step.hands.size(); ++h)
    if (step.hands[h].grasped.body >= 0)
      step.own.constraint.hands[h].wanted = wanted_by_hand(step, step.hands[h]);
}

void add_grasped(int body, double share, const ConstraintStep& step, ContactProblem& problem) noexcept {
  add_part(body, step, problem, [&](const HandInput& hand, Index number) {
    const Vec6 wanted = step.own.constraint.hands[number].wanted * share;
    return hand.bears_load ? with_load(step, hand, wanted) : wanted;
  });
}

void add_grasped_at_rest(int body, const ConstraintStep& step, ContactProblem& problem) noexcept {
  add_part(body, step, problem, [](const HandInput&, Index) { return Vec6(Vec6::Zero()); });
}

void feel_answer(const ContactProblem& problem, ConstraintStep& step) noexcept {
  for (Index h = 0; h < step.hands.size(); ++h) {
    const GraspedPart& grasped = step.hands[h].grasped;
    if (grasped.body < 0) continue;
    const Vec3 handle = step.bodies.X_WB[Index(grasped.body)] * grasped.X_BH.p;
    feel(step.hands[h], problem.displacement_at(grasped.body, handle), step.dt_s,
         step.own.constraint.hands[h]);
  }
}

void add_friction_torque(const SurfacePair& pair, const Vec3& torque_W, ConstraintStep& step) noexcept {
  for (Index h = 0; h < step.hands.size(); ++h) {
    const int body = step.hands[h].grasped.body;
    if (body < 0) continue;
    if (pair.body_a == body) step.own.constraint.hands[h].torque += torque_W;
    if (pair.body_b == body) step.own.constraint.hands[h].torque -= torque_W;
  }
}

void feel_standing(ConstraintStep& step) noexcept {
  for (Index h = 0; h < step.hands.size(); ++h)
    if (step.hands[h].grasped.body >= 0)
      feel(step.hands[h], Vec6::Zero(), step.dt_s, step.own.constraint.hands[h]);
}

}  // namespace tactum::inline v0_1
