#include "tactum/response/energy.h"

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {

double bodies_energy(const World& world, const WorldState& bodies, int grasped) noexcept {
  double energy_J = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = bodies.X_WB[i];
    if (static_cast<int>(i) == grasped) {  // it has weight, but the hand does not feel its inertia
      energy_J -= body.mass_kg * world.gravity_W.dot(X_WB.p);
      continue;
    }
    const Twist& V_WB = bodies.V_WB[i];
    const Vec3 w_B = X_WB.R.transpose() * V_WB.w;
    energy_J += 0.5 * body.mass_kg * V_WB.v.squaredNorm() + 0.5 * w_B.dot(body.inertia_B * w_B) -
                body.mass_kg * world.gravity_W.dot(X_WB.p);
  }
  return energy_J;
}

void add_stored_energy(const World& world, const FrameSettings& settings, const WorldState& bodies,
                       int grasped, const Twist& to_hand, double outside_work_J, double pending_J,
                       PortInput& port) noexcept {
  // The work of a field on the grasped part is taken from the field, as that on a falling weight is from
  // gravity; a vortex does work without end. So does a constant torque, and damping takes it.
  const double scale = settings.workspace.scale;
  port.bodies_J = (bodies_energy(world, bodies, grasped) - outside_work_J) / scale;
  if (grasped < 0) return;
  const Coupling coupling = in_scene(settings.coupling, scale);
  port.spring_J = (0.5 * coupling.stiffness_N_per_m * to_hand.v.squaredNorm() + pending_J) / scale;
  port.spring_turning_J = 0.5 * coupling.stiffness_Nm_per_rad * to_hand.w.squaredNorm() / scale;
}

}  // namespace tactum::inline v0_1
