#pragma once
/// The energy balance of the port between device and program, and what keeps it: a scene that is felt must
/// not generate energy. Sampling, delay, encoder steps and an explicit response can; the hand would feel it
/// as buzzing, or as a wall that kicks. Over every step, with the wrench (f, t) that acted meanwhile and the
/// displacement (dp, da) of the handle,
///
///   balance += - f . dp - t . da                         work of the hand
///            + b |dp|^2 / dt + c |dp| + (same of da)     which the device's own damping b and friction c eat
///            - (change of everything that the scene has stored)
///   balance <= credit                                    what was dissipated long ago cannot come back
///
/// The store is one, and whole: the coupling's stretch and twist, bodies, their joints' springs, the springs
/// of contacts, impacts that are still to be felt (response/energy.h). So what comes in by one axis may leave
/// by another: a block that is tilted takes work in by turning and gives it back by pushing. The work is
/// exact, not an estimate [Hannaford and Ryu 2002]: a wrench is constant over its step, so its work is f . dp
/// whatever the path was.
///
/// While the balance is not negative the wrench passes untouched, to the bit. When it is, energy has come out
/// of the port that nobody put in, and the coupling's spring pays for it: its stiffness, translation and
/// rotation alike, is lowered until what its stretch holds has sunk by as much,
///
///   share -= share * min( - balance / spring,  20 N/s dt / |f|,  0.4 N m/s dt / |t|,  5 dt/s )
///
/// so the force that is felt changes by no more than 20 N/s for it, always towards zero, and never in free
/// air, where the spring has nothing. A stiffness that sinks is passive by itself [Ferraguti 2013]. It comes
/// back only where the spring is at rest, which costs no energy, within kRestored_s. A damper in its place
/// has to push with b V in every frame, and its V is the noise of the encoders
/// (docs/algorithms/stability.md).
///
/// A handle whose rotation is sensed but cannot be driven is turned by the hand for nothing, while the
/// coupling's twist holds what the turn would have cost. That work, of the torque that nobody feels, is
/// booked as if it had been felt: the turn is a motion that the scene is given, like that of a driven body,
/// and what it stores may push the hand. No loop is closed through it, since no force turns the handle.
///
/// What the caller's own stage adds has no spring that could pay. It has a tank instead: the work that the
/// hand does against it fills the tank up to kTank_J, what it gives the hand comes out of it, and it is
/// passed on as it is while half a credit is left, and fades to nothing as the tank runs dry.
///
/// Start and stop ramps change the wrench without work, and so does a user who sets another stiffness; what
/// they store or give is not booked. All energies are those at the device. Cost: two dozen products. No
/// clock, no allocation.

#include <array>

#include "tactum/devices/device.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The properties of the device's port, from coupling_gains.h. The defaults only watch.
struct PortSettings {
  bool actuates_torque = true;       ///< false: torque is computed, not sent
  bool keeps_balance = false;        ///< false: it only watches
  double damping_Ns_per_m = 0.0;     ///< the device's own [N s/m]
  double damping_Nms_per_rad = 0.0;  ///< [N m s/rad]
  double friction_N = 0.0;           ///< the device's own, Coulomb [N]
  double friction_Nm = 0.0;          ///< [N m]
  double delay_s = 0.0;    ///< from a write to the motors, at most SentHistory::kLongestDelay frames [s]
  double credit_J = 1e-3;  ///< the most that the balance holds [J]
};

/// The most that the tank of the caller's stage holds: a spring of 600 N/m stretched by 13 mm [J].
inline constexpr double kTank_J = 0.05;

/// The stiffness comes back within this, while nothing is touched [s].
inline constexpr double kRestored_s = 10.0;

/// Work that has passed one half of the port since the start; unlike the balance never cut [J].
struct EnergyTotals {
  double from_hand_J = 0.0;  ///< that the hand put in, moving against the wrench [J]
  double to_hand_J = 0.0;    ///< that it was given, moved along by the wrench [J]
};

struct PortReport {
  double balance_J = 0.0;        ///< negative: energy was generated [J]
  double stored_J = 0.0;         ///< by the scene [J]
  double generated_J = 0.0;      ///< below a balance of zero, since the start [J]
  double paid_J = 0.0;           ///< by the coupling's spring, since the start [J]
  double stiffness_share = 1.0;  ///< of the coupling's stiffness, from the next frame on, (0, 1] [-]
  double added_share = 1.0;      ///< of what the caller's stage adds, in this frame [-]
  EnergyTotals total;            ///< of translation
  EnergyTotals total_turning;    ///< of rotation
};

/// The wrenches of the scene that were sent in the last frames, a ring: on a device with a delay an older one
/// acts.
struct SentHistory {
  static constexpr int kLongestDelay = 64;  ///< frames
  std::array<Wrench, kLongestDelay + 1> wrenches{};
  int newest = 0;  ///< its place in the ring
};

/// What the scene has stored after the frame's step.
struct StoredEnergy {
  double total_J = 0.0;    ///< everything, from any zero [J]
  double spring_J = 0.0;   ///< the coupling's part of it [J]
  double force_N = 0.0;    ///< of the coupling's spring [N]
  double torque_Nm = 0.0;  ///< ... and of its twist [N m]
  /// The coupling's stiffness as it is set, whatever share of it is in use [N/m, N m/rad].
  double stiffness_N_per_m = 0.0, stiffness_Nm_per_rad = 0.0;

  bool same_coupling(const StoredEnergy& other) const {
    return stiffness_N_per_m == other.stiffness_N_per_m && stiffness_Nm_per_rad == other.stiffness_Nm_per_rad;
  }
};

struct PortState {
  PortReport booked;              ///< as far as it has come
  StoredEnergy stored;            ///< in the last frame
  double tank_J = 0.0;            ///< of the caller's stage, beyond the credit it begins with [J]
  Wrench added;                   ///< what was passed on of that stage in the last frame [N, N m]
  Vec3 unfelt_Nm = Vec3::Zero();  ///< PortInput::unfelt_Nm of the last frame [N m]
  Pose X_DH;                      ///< of the last good sample [m]
  bool known = false;             ///< there has been one
  SentHistory history;
};

/// The motion of the handle, as the device measures it.
struct HandleMotion {
  Pose X_DH;              ///< [m]
  bool measured = false;  ///< the sample is valid and its pose plausible; else its displacement is not known
  Twist moved;            ///< since the last good sample; zero without one [m, rad]
};

/// The motion since the last good sample that the port has taken in. Cost: one rotation vector.
HandleMotion handle_motion(const PortState& state, const DeviceSample& sample) noexcept;

struct PortInput {
  Wrench felt;    ///< of the scene, as the device can exert it, axes of D, at the handle [N, N m]
  Wrench wanted;  ///< the same with what the caller's own stage has added (force_stage.h) [N, N m]
  Wrench sent;    ///< in the last frame, after safety [N, N m]
  Vec3 unfelt_Nm = Vec3::Zero();  ///< torque of the scene that a device without torque cannot exert [N m]
  StoredEnergy stored;
  double ramp = 1.0;    ///< of the start and stop ramps, by which the last wrench was scaled: 0 to 1 [-]
  double dt_s = 0.001;  ///< time from frame to frame [s]
};

/// The wrench that is passed on to safety, and the share of the stiffness for the next frame, in `state`. A
/// motion that is not measured is left out.
Wrench passive_wrench(const PortSettings& settings, PortState& state, const HandleMotion& motion,
                      const PortInput& input, PortReport& report) noexcept;

}  // namespace tactum::inline v0_1
