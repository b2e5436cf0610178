#include "tactum/response/grasped_part.h"
#include "tactum/response/field_pull.h"

namespace tactum::inline v0_1 {

using Index = std::size_t;

Vec6 wanted_by_hand(const ConstraintStep& step) noexcept {
  const Twist missing = handle_at(step.grasped, step.bodies.X_WB[Index(step.grasped.body)]).to_hand;
  const Twist& V_WH = step.grasped.V_WH;
  return balanced_step(step.coupling, step.dt_s, missing, {V_WH.v, passed_on(step.grasped, V_WH.w)});
}

Vec6 with_load(const ConstraintStep& step, const Vec6& wanted) noexcept {
  const Index grasped = Index(step.grasped.body);
  const Wrench& constant = step.world.bodies[grasped].load.constant;
  const Vec3 weight = step.world.bodies[grasped].mass_kg * step.world.gravity_W + constant.f;
  const Vec3 lever = -(step.bodies.X_WB[grasped].R * step.grasped.X_BH.p);  // from the handle
  const Wrench field = field_at_handle(step.grasped, step.bodies.X_WB);
  const GraspMetric metric = grasp_metric(step.coupling, step.dt_s);
  const GraspMetric over_step = step_metric(step.coupling, step.grasped, step.dt_s);
  Vec6 sunk;
  sunk.head<3>() = wanted.head<3>() * (metric.stiffness_N_per_m / over_step.stiffness_N_per_m) +
                   (weight + field.f) / over_step.stiffness_N_per_m;
  sunk.tail<3>() = wanted.tail<3>() * (metric.stiffness_Nm_per_rad / over_step.stiffness_Nm_per_rad) +
                   (lever.cross(weight) + field.t + constant.t) / over_step.stiffness_Nm_per_rad;
  return sunk;
}

void add_grasped(const Vec6& target, const ConstraintStep& step, ContactProblem& problem) noexcept {
  const Index grasped = Index(step.grasped.body);
  const Pose& X_WB = step.bodies.X_WB[grasped];
  const GraspedBody as_body =
      grasped_body_of(step.world.bodies[grasped].load, step.grasped, X_WB,
                      step_metric(step.coupling, step.grasped, step.dt_s), target, step.dt_s);
  problem.add_body_and_joint(step.world, placed(step.world, step.bodies, step.grasped.body), as_body.centre_W,
                             as_body.metric, as_body.target, step.dt_s);
}

Vec6 displacement_of_handle(const ContactProblem& problem, const ConstraintStep& step) noexcept {
  const Vec3 handle = step.bodies.X_WB[Index(step.grasped.body)] * step.grasped.X_BH.p;
  return problem.displacement_at(step.grasped.body, handle);
}

void feel(const Vec6& displacement, ConstraintStep& step) noexcept {
  // M (x - x*) at the handle, x* without weight and fields: with a free grasped part, exactly the sum of the
  // contact forces, its weight and the load of fields. Where fields are so steep that the step was made with
  // a stiffer metric, it is that sum only when the part stands.
  const GraspMetric metric = grasp_metric(step.coupling, step.dt_s);
  const Vec6 off = displacement - step.own.constraint.wanted;
  step.own.constraint.felt = {metric.stiffness_N_per_m * off.head<3>(),
                              metric.stiffness_Nm_per_rad * passed_on(step.grasped, off.tail<3>())};
}

}  // namespace tactum::inline v0_1
