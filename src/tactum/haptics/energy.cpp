#include "tactum/haptics/energy.h"

#include "tactum/math/screw.h"

namespace tactum {

double bodies_energy(const World& world, const WorldState& state, int held) noexcept {
  double energy_J = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = state.X_WB[i];
    if (static_cast<int>(i) == held) {  // it has weight, but the hand does not feel its inertia
      energy_J -= body.mass_kg * world.gravity_W.dot(X_WB.p);
      continue;
    }
    const Twist& V_WB = state.V_WB[i];
    const Vec3 w_B = X_WB.R.transpose() * V_WB.w;
    energy_J += 0.5 * body.mass_kg * V_WB.v.squaredNorm() + 0.5 * w_B.dot(body.inertia_B * w_B) -
                body.mass_kg * world.gravity_W.dot(X_WB.p);
  }
  return energy_J;
}

PortInput port_input(const World& world, const FrameSettings& settings, const FrameState& state,
                     const FrameReport& report) noexcept {
  PortInput input;
  input.wanted = report.smoothed;
  input.sent = state.safety.sent;
  // What a field gives the held part is its own, as a falling weight's is; a vortex gives without end.
  input.bodies_J = bodies_energy(world, state.world, state.tool.body) - state.field.given_J;
  input.dt_s = settings.dt_s;
  if (state.tool.body >= 0) {
    const Twist stretch = twist_between(report.X_WH, report.X_WH_proxy, 1.0);
    input.spring_J = 0.5 * settings.coupling.stiffness_N_per_m * stretch.v.squaredNorm();
    // What a blow took from the bodies and is still to be felt.
    input.spring_J += state.blows.pending_J();
    input.spring_turning_J = 0.5 * settings.coupling.stiffness_Nm_per_rad * stretch.w.squaredNorm();
  }
  return input;
}

}  // namespace tactum
