#pragma once
/// A grasped block over a fixed plate in the constraint response, led by an ideal device.

#include "support/pressed_block.h"
#include "support/rig.h"

namespace tactum {

inline const Vec3 kBlockHalf(0.010, 0.007, 0.005);  // of the grasped block [m]

/// A grasped block of 20 x 14 x 10 mm, 3 mm over a fixed plate whose top is at z = 0, and an ideal device.
struct BlockRig : Rig {
  explicit BlockRig(double mu = 0.0) : Rig(2) {
    world.bodies[0].part = solid_box(kBlockHalf);
    world.bodies[0].X_WB.p.z() = 0.008;
    world.bodies[1].part = solid_box({0.05, 0.05, 0.01});
    world.bodies[1].X_WB.p.z() = -0.01;
    world.bodies[1].joint.kind = JointKind::kFixed;
    settings.response = ResponseModel::kConstraint;
    if (mu > 0.0) settings.friction = {{0.0, mu, mu, 0.0}, 2};
  }
  double skin() { return begun().response.constraint()->memory().constraint.skin_m[0]; }
  /// The sum of the contact forces at the handle less the wrench that is felt.
  Wrench unaccounted() const {
    const auto& grasped =
        simulation->state().response.constraint()->memory().constraint.problem.bodies().front();
    const Wrench at_handle = moved(report.restoring, grasped.centre - grasped.origin);
    return at_handle - report.coupling;
  }
};

inline Pose at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {exp_rotation(turn), {x, y, z}};
}

}  // namespace tactum
