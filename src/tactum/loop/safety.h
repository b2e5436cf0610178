#pragma once
/// The last stage before the device: whatever the stages before it computed, the wrench that leaves here
/// cannot hurt the hand or the motors. It stands on its own, cannot be switched off, only tightened.
///
///   fault? ---- yes -> zero, at once                     fault: wrench or pose not finite, sample stale,
///     no                                                        reads failing, pose leapt or frozen, loop
///     |                                                         late, wrench refused, motors off
///   gain up (start ramp) or down (stop ramp)
///   wanted -> magnitude limit -> * gain -> slew limit -> magnitude limit
///
/// A fault drops to zero in one frame, without the slew limit: the wrench would otherwise go on answering a
/// pose that was not measured, and a motor without current is the one thing that is safe without knowing
/// anything. When the fault is over the force comes back by the start ramp, from zero, so that a hand that
/// meanwhile sank into a wall is not hit. A requested stop is no emergency: the pose is known, so the force
/// is led down over the stop ramp and the hand is not surprised. At the end of the stop ramp the wrench is
/// zero even when a tightened slew limit has not got there yet.
///
/// So |f| and |t| never exceed their limits; the change of f (and of t) from one frame to the next never
/// exceeds slew * period but when it goes to zero for a reason above or when the limits are tightened
/// meanwhile.

#include <cstdint>
#include <limits>
#include <string>

#include "tactum/devices/device.h"
#include "tactum/loop/loop.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The limits in force. Made by safety_limits and tightened, not by hand.
struct SafetyLimits {
  double max_force_N = 0.0;               ///< [N]
  double max_torque_Nm = 0.0;             ///< [N m]
  double max_force_slew_N_per_s = 0.0;    ///< of the force vector's change [N/s]
  double max_torque_slew_Nm_per_s = 0.0;  ///< of the torque vector's change [N m/s]
  double start_ramp_s = 0.5;              ///< from zero to full, after start and after a fault [s]
  double stop_ramp_s = 0.1;               ///< from full to zero when asked to stop [s]
  double max_sample_age_s = 0.020;        ///< an older sample is stale [s]
  double max_invalid_s = 0.005;           ///< reads that fail for so long in a row are a fault [s]
  double max_speed_m_per_s = 5.0;         ///< a handle that moves faster has leapt, or is thrown [m/s]
  double max_turn_rad_per_s = 60.0;       ///< ... or turns faster [rad/s]
  double max_still_s =
      std::numeric_limits<double>::infinity();  ///< a pose the same to the bit for longer is frozen [s]
};

/// The wishes of a user. Each can only make the limit tighter than the device's; anything else is ignored.
struct SafetySettings {
  double max_force_N = std::numeric_limits<double>::infinity();               ///< [N]
  double max_torque_Nm = std::numeric_limits<double>::infinity();             ///< [N m]
  double max_force_slew_N_per_s = std::numeric_limits<double>::infinity();    ///< [N/s]
  double max_torque_slew_Nm_per_s = std::numeric_limits<double>::infinity();  ///< [N m/s]
  double start_ramp_s = 0.0;                                                  ///< longer is tighter [s]
  double stop_ramp_s = std::numeric_limits<double>::infinity();               ///< shorter is tighter [s]
};

/// The limits of a device: its own force and torque, and slews that reach them in 5 ms (at 0.5 m/s into a
/// wall of 2 N/mm the force rises by 1000 N/s; 8.5 N in 5 ms is 1700 N/s).
SafetyLimits safety_limits(const DeviceInfo& info) noexcept;
SafetyLimits tightened(const SafetyLimits& limits, const SafetySettings& settings) noexcept;

/// Which limit acted, as bits of FrameReport::safety.
namespace safety_flag {
inline constexpr std::uint32_t kForceLimited = 1u << 0;  ///< raise nothing: the device's or the user's limit
inline constexpr std::uint32_t kTorqueLimited = 1u << 1;
inline constexpr std::uint32_t kForceSlewed = 1u << 2;
inline constexpr std::uint32_t kTorqueSlewed = 1u << 3;
inline constexpr std::uint32_t kStarting = 1u << 4;         ///< start ramp not yet at full
inline constexpr std::uint32_t kStopping = 1u << 5;         ///< a stop was requested
inline constexpr std::uint32_t kStopped = 1u << 6;          ///< ... and the wrench is zero
inline constexpr std::uint32_t kNonFiniteWrench = 1u << 7;  ///< fault
inline constexpr std::uint32_t kImplausiblePose = 1u << 8;  ///< fault
inline constexpr std::uint32_t kStaleSample = 1u << 9;      ///< fault
inline constexpr std::uint32_t kReadsFailing = 1u << 10;    ///< fault
inline constexpr std::uint32_t kMissedDeadline = 1u << 11;  ///< fault
inline constexpr std::uint32_t kPoseLeapt = 1u << 12;       ///< fault: farther than a hand moves
inline constexpr std::uint32_t kPoseFrozen = 1u << 13;      ///< fault: stiller than a hand can hold
inline constexpr std::uint32_t kWrenchRefused = 1u << 14;   ///< fault: the last write failed
inline constexpr std::uint32_t kMotorsOff = 1u << 15;       ///< fault: the device says so
inline constexpr std::uint32_t kFaults = kNonFiniteWrench | kImplausiblePose | kStaleSample | kReadsFailing |
                                         kMissedDeadline | kPoseLeapt | kPoseFrozen | kWrenchRefused |
                                         kMotorsOff;
}  // namespace safety_flag

/// "force limited, starting": for displays and logs, not for the frame.
std::string safety_flag_names(std::uint32_t flags);

struct SafetyInput {
  Wrench wanted;              ///< computed by the frame [N, N m]
  Pose X_DH;                  ///< the pose it was computed from [m]
  bool sample_valid = false;  ///< the read succeeded
  double sample_age_s = 0.0;  ///< now minus the sample's time [s]
  bool motors_on = true;      ///< as reported by the sample
  bool refused = false;       ///< the device did not take the last wrench
  double now_s = 0.0;         ///< on the loop's clock [s]
  double period_s = 0.001;    ///< nominal time between frames [s]
  bool late = false;          ///< the loop was late by more than it may
  bool stop = false;          ///< stop requested
};

/// The input of one frame.
SafetyInput safety_input(const DeviceSample& sample, const FrameTick& tick, const Wrench& wanted) noexcept;

struct SafetyState {
  Wrench sent;              ///< last frame's answer [N, N m]
  double gain = 0.0;        ///< of the ramps, 0 to 1
  double invalid_s = 0.0;   ///< for how long reads have failed in a row [s]
  Pose X_DH;                ///< the last that was measured, valid or not [m]
  double measured_s = 0.0;  ///< when, on the loop's clock [s]
  double still_s = 0.0;     ///< how long it has been the same to the bit [s]
  bool measured = false;    ///< there has been one
};

/// The part of a wrench that the limits allow, for the stages before safety. A limit of zero, as of a device
/// without torque, is left to safe_wrench. Sets the flags of the limits that act.
Wrench within_limits(const SafetyLimits& limits, const Wrench& F, std::uint32_t& flags) noexcept;

/// The wrench that may be sent. Adds the flags of what acts (safety_flag) to `flags`.
Wrench safe_wrench(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input,
                   std::uint32_t& flags) noexcept;

}  // namespace tactum::inline v0_1
