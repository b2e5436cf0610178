#include "tactum/haptics/held_part.h"

#include "tactum/haptics/frame_state.h"

namespace tactum {

using Index = std::size_t;

Vec6 wanted_by_hand(const FrameSettings& settings, double dt_s, const FrameState& state) noexcept {
  const Pose X_WH_proxy = state.world.X_WB[Index(state.tool.body)] * state.tool.X_BH;
  return balanced_step(settings.coupling, dt_s, X_WH_proxy, state.hand.X_WH, state.hand.V_WH);
}

Vec6 with_load(const World& world, const FrameSettings& settings, double dt_s, const FrameState& state,
               const Vec6& wanted) noexcept {
  const Index held = Index(state.tool.body);
  const Vec3 weight = world.bodies[held].mass_kg * world.gravity_W;
  const Vec3 lever = -(state.world.X_WB[held].R * state.tool.X_BH.p);  // from the handle
  const Wrench field = field_at_handle(state);
  const HeldMetric metric = held_metric(settings.coupling, dt_s);
  const HeldMetric step = step_metric(settings, dt_s, state);
  Vec6 sunk;
  sunk.head<3>() = wanted.head<3>() * (metric.stiffness_N_per_m / step.stiffness_N_per_m) +
                   (weight + field.f) / step.stiffness_N_per_m;
  sunk.tail<3>() = wanted.tail<3>() * (metric.stiffness_Nm_per_rad / step.stiffness_Nm_per_rad) +
                   (lever.cross(weight) + field.t) / step.stiffness_Nm_per_rad;
  return sunk;
}

void feel(const FrameSettings& settings, double dt_s, const Vec6& displacement, FrameState& state) noexcept {
  // M (x - x*) at the handle: with a free held part, exactly the sum of the contact forces, its weight
  // and the load of fields.
  const HeldMetric metric = held_metric(settings.coupling, dt_s);
  const Vec6 off = displacement - state.constraint.wanted;
  state.constraint.felt = {metric.stiffness_N_per_m * off.head<3>(),
                           metric.stiffness_Nm_per_rad * off.tail<3>()};
}

}  // namespace tactum
