#pragma once
/// The passivity observer and controller [Hannaford and Ryu 2002]: a scene that is felt must not generate
/// energy. Sampling, delay, encoder steps and an explicit response can; the hand would feel it as buzzing or
/// as a wall that kicks. The observer keeps a balance of the energy that passed the port between device and
/// program, one for translation and one for rotation:
///
///   balance += - f . dp             work of the hand: the wrench sent last, over the displacement since
///           + b |dp|^2 / dt         dissipated by the device's own damping meanwhile, at least
///           + energy that the scene's moving bodies gave up (a weight that is lowered, a body that hits)
///   balance <= credit + energy in the coupling's spring        what was dissipated long ago cannot come back
///   balance >= - credit                                        nor is a debt kept that cannot be paid soon
///
///   balance < 0:  wrench - a V,   a = min(- balance / (|V|^2 dt), the most allowed),  V = dp / dt
///
/// so the controller takes the surplus out during the next step, and does nothing as long as there is none.
/// The energy passed is exact, not an estimate: the wrench is constant over the step, so its work is f . dp
/// whatever the path was. Differences from the paper are: the two bounds of the balance (without the upper
/// one, a minute of rubbing would pay for a long burst of buzzing), the known damping, and the bodies'
/// energy. Six axes are two balances: work along one direction may pay for another, as in an isotropic spring
/// it must. Where torque is driven too, a balance below zero is paid from the other: a nut that is turned
/// pulls the hand along its axis, and that energy was not generated.
///
/// Two things are coarser than that. The energy that bodies gave up is credited to both balances, to each
/// in full. And after samples that were left out the displacement of all these frames is taken with the
/// wrench sent last, as if made in one dt. All energies are those at the device; the caller divides those of
/// the scene by the workspace scale (response/energy.h).
///
/// A handle whose rotation is sensed but cannot be driven gets no torque; its balance of rotation never sinks
/// below zero. Cost: one rotation vector and two dozen products. No clock, no allocation; the device's
/// samples are its only input from the hand.

#include "tactum/devices/device.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The properties of the device's port, from coupling_gains.h. The defaults only watch.
struct PortSettings {
  bool actuates_torque = true;             ///< false: torque is computed, not sent
  double damping_Ns_per_m = 0.0;           ///< the device's own [N s/m]
  double damping_Nms_per_rad = 0.0;        ///< [N m s/rad]
  double max_injected_Ns_per_m = 0.0;      ///< most that the controller adds; 0: it only watches [N s/m]
  double max_injected_Nms_per_rad = 0.0;   ///< [N m s/rad]
  double credit_J = 1e-3;                  ///< bounds of the balance of translation [J]
  double credit_turning_J = 1e-4 /* J */;  ///< ... and of rotation [J]
};

/// Work that has passed one half of the port since the start; unlike the balance never cut [J].
struct EnergyTotals {
  double from_hand_J = 0.0;  ///< that the hand put in, moving against the wrench [J]
  double to_hand_J = 0.0;    ///< that it was given, moved along by the wrench [J]
  double damped_J = 0.0;     ///< that the controller's damping took out, before limits and ramps [J]
};

struct PortState {
  double energy_balance_J = 0.0;          ///< of translation; negative: energy was generated [J]
  double energy_balance_turning_J = 0.0;  ///< of rotation [J]
  double bodies_J = 0.0;                  ///< energy of the scene's moving bodies in the last frame [J]
  Pose X_DH;                              ///< of the last good sample [m]
  bool known = false;                     ///< there has been one
  EnergyTotals total, total_turning;
  Wrench damper;  ///< the controller's part of the last wrench, axes of D, at the handle [N, N m]
};

struct PortInput {
  Wrench wanted;                  ///< axes of D, at the handle [N, N m]
  Wrench sent;                    ///< in the last frame, after safety [N, N m]
  double spring_J = 0.0;          ///< stored in the coupling's stretch, and in impacts still to be felt [J]
  double spring_turning_J = 0.0;  ///< ... and its twist [J]
  double bodies_J = 0.0;          ///< energy of the scene's moving bodies, from any zero [J]
  double dt_s = 0.001;            ///< time from frame to frame [s]
};

struct PortReport {
  double energy_balance_J = 0.0;          ///< [J]
  double energy_balance_turning_J = 0.0;  ///< [J]
  double injected_Ns_per_m = 0.0;         ///< damping added in this frame [N s/m]
  double injected_Nms_per_rad = 0.0;      ///< [N m s/rad]
  EnergyTotals total;                     ///< of translation
  EnergyTotals total_turning;             ///< of rotation
};

/// The wrench, damped so that it generates no energy, as far as the settings allow. A sample that is invalid
/// or implausible is left out: its displacement is not known.
Wrench passive_wrench(const PortSettings& settings, PortState& state, const DeviceSample& sample,
                      const PortInput& input, PortReport& report) noexcept;

}  // namespace tactum::inline v0_1
