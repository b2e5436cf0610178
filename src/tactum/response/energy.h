#pragma once
/// The energy that a scene has stored, for the balance of the passivity stage: in the coupling, in moving
/// bodies, in the springs of their joints, and in what the response still owes.

#include <span>

#include "tactum/loop/passivity.h"
#include "tactum/response/settings.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// Kinetic energy of the bodies that move, their height against gravity from the world's origin, and that of
/// their joints' springs [J]. A body's velocity is that of the middle of the frame, so its height and its
/// joint are taken there too, halfway from `X_WB_start`. Of grasped parts only height and joint are counted,
/// at the frame's end: they have weight, but no inertia that a hand could feel.
double bodies_energy(const World& world, std::span<const Pose> X_WB_start, const WorldState& bodies,
                     std::span<const HandInput> hands) noexcept;

/// What a frame has to tell of its energy, as one hand sees it.
struct EnergySource {
  const World& world;
  const HandSettings& settings;
  std::span<const Pose> X_WB_start;  ///< of the bodies, where the frame began [m]
  const WorldState& bodies;
  std::span<const HandInput> hands;  ///< all of them
  int grasped = -1;                  ///< the body that this one holds; -1: none
  Twist to_hand;                     ///< from the handle on the grasped part to the hand [m, rad]
  Twist V_WH;                        ///< of the hand [m/s, rad/s]
  Wrench felt;                       ///< what the response lets the hand feel, as the device has it [N, N m]
  Wrench smoothed;     ///< the same smoothed, also of a torque that the device cannot exert [N, N m]
  double share = 1.0;  ///< of the coupling's stiffness in this frame [-]
  /// Of force fields on grasped parts, of the loads of all bodies, and of the couplings of other hands [J].
  double outside_work_J = 0.0;
  double response_J = 0.0;  ///< stored by the response: Response::stored_J() [J]
};

/// All energies as those at the device, those of the scene over the workspace scale (workspace_scale.h). The
/// work of a field on the grasped part is taken from the field, as that on a falling weight is from gravity;
/// a vortex does work without end. So does a constant torque, and damping takes it.
///
/// The coupling's spring counts as it is felt. A part that lags because its steps are kept short is far from
/// the hand, and no force tells of it: no more of a stretch counts than the force, felt or still smoothed,
/// and the coupling's damper at the hand's velocity can hold. Of a torque that the device cannot exert, which
/// nobody feels, the smoothed one alone counts, as in the work that is booked. And the spring counts as the
/// device can exert it: a stretch x beyond the force limit f gives back f x - f^2 / (2 k).
StoredEnergy stored_energy(const EnergySource& source) noexcept;

}  // namespace tactum::inline v0_1
