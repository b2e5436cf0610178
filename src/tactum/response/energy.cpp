#include "tactum/response/energy.h"

#include <algorithm>
#include <limits>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Of a joint's spring.
double spring_energy(const Joint& joint, double position) noexcept {
  const double stretch = position - joint.rest;
  return 0.5 * joint.stiffness * stretch * stretch;
}

/// One half of the coupling.
struct Spring {
  double energy_J = 0.0;
  double force = 0.0;
};

/// A spring that is stretched, with `supported` the largest force that the hand can feel of it, and whose
/// force the device limits.
Spring felt_spring(double stiffness, double stretch, double supported, double limit) noexcept {
  const double force = std::min(stiffness * stretch, supported);
  stretch = stiffness > 0.0 ? force / stiffness : 0.0;
  if (!(force > limit)) return {0.5 * force * stretch, force};
  return {limit * (stretch - 0.5 * limit / stiffness), limit};
}

}  // namespace

double bodies_energy(const World& world, std::span<const Pose> X_WB_start, const WorldState& bodies,
                     std::span<const HandInput> hands) noexcept {
  double energy_J = 0.0;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves()) continue;
    const Pose& X_WB = bodies.X_WB[i];
    const bool grasped = is_grasped(hands, i);
    const Joint& joint = world.joint_of(static_cast<int>(i));
    if (joint.stiffness > 0.0) {
      const JointPosition& at = bodies.joints[i];
      energy_J += spring_energy(joint, grasped ? at.now : 0.5 * (at.now + at.before));
    }
    const Vec3 p_W = grasped ? X_WB.p : Vec3(0.5 * (X_WB.p + X_WB_start[i].p));
    energy_J -= body.mass_kg * world.gravity_W.dot(p_W);
    if (grasped) continue;
    const Twist& V_WB = bodies.V_WB[i];
    const Vec3 w_B = X_WB.R.transpose() * V_WB.w;
    energy_J += 0.5 * body.mass_kg * V_WB.v.squaredNorm() + 0.5 * w_B.dot(body.inertia_B * w_B);
  }
  return energy_J;
}

StoredEnergy stored_energy(const EnergySource& source) noexcept {
  const HandSettings& settings = source.settings;
  const double scale = settings.workspace.scale;
  StoredEnergy stored;
  stored.stiffness_N_per_m = settings.coupling.stiffness_N_per_m;
  stored.stiffness_Nm_per_rad = settings.coupling.stiffness_Nm_per_rad;
  stored.total_J = (bodies_energy(source.world, source.X_WB_start, source.bodies, source.hands) -
                    source.outside_work_J + source.response_J) /
                   scale;
  if (source.grasped < 0) return stored;
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  const Coupling coupling = softened(settings.coupling, source.share);
  const Spring pushed = felt_spring(coupling.stiffness_N_per_m, source.to_hand.v.norm() / scale,
                                    std::max(source.felt.f.norm(), source.smoothed.f.norm()) +
                                        coupling.damping_Ns_per_m * source.V_WH.v.norm() / scale,
                                    settings.safety.max_force_N);
  // A torque that the device cannot exert is limited by nothing, and only smoothed does it count at all.
  const bool turns = settings.port.actuates_torque;
  const Spring turned = felt_spring(coupling.stiffness_Nm_per_rad, source.to_hand.w.norm(),
                                    std::max(turns ? source.felt.t.norm() : 0.0, source.smoothed.t.norm()) +
                                        coupling.damping_Nms_per_rad * source.V_WH.w.norm(),
                                    turns ? settings.safety.max_torque_Nm : kNoLimit);
  stored.spring_J = pushed.energy_J + turned.energy_J;
  stored.force_N = pushed.force;
  stored.torque_Nm = turned.force;
  stored.total_J += stored.spring_J;
  return stored;
}

}  // namespace tactum::inline v0_1
