#pragma once
/// The contract of a haptic device: the interface of every device, real or simulated, for the loop.
///
/// Units are SI. The device frame D is: x toward the operator, y to the operator's right, z up, origin at the
/// centre of the workspace; a driver converts its own axes. H is the handle. Wrenches act on the hand, at the
/// handle's origin, with axes of D.
///
/// One thread (the loop's) calls read and write after open; nothing else touches the device meanwhile.

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "tactum/base/result.h"
#include "tactum/base/tolerances.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The state of the hand at one instant, as the device reports it.
struct DeviceSample {
  double time_s = 0.0;  ///< when it was measured, on the loop's clock [s]
  Pose X_DH;            ///< handle in device frame [m]
  Twist V_DH;  ///< of the handle's origin, axes of D [m/s, rad/s]; zero when the device has no estimate
  bool has_velocity = false;  ///< whether V_DH was measured or estimated by the device
  std::uint32_t buttons = 0;  ///< bit 0 is the primary button
  bool motors_on = true;  ///< false: the device reports that it does not push: dead-man switch, brakes, no
                          ///< power, its own watchdog
  bool valid = false;     ///< false: the read failed, everything else is the last known
  double grip_rad = 0.0;  ///< opening of the gripper, 0 closed; 0 on a device without one [rad]
  Wrench F_D_delivered;   ///< the wrench that the device says it exerts, axes of D [N, N m]
  bool has_delivered = false;  ///< whether the device says so; it may be older than the sample
};

/// No device's workspace is larger than this; a handle reported beyond it is a driver's mistake.
inline constexpr double kFarthestHandle_m = 10.0;  ///< [m]

/// Whether a pose can be that of a handle: finite, within that distance, and its matrix a rotation to six
/// decimals. A buffer of zeros is finite and would otherwise pass for a turn by half a circle.
inline bool plausible(const Pose& X_DH) noexcept {
  const auto x = X_DH.R.col(0), y = X_DH.R.col(1), z = X_DH.R.col(2);
  // Every comparison is false when a number in it is not finite.
  const auto is = [](double found, double expected) {
    return std::abs(found - expected) < tolerances::kRotationNear;
  };
  return X_DH.p.norm() < kFarthestHandle_m && is(x.dot(x), 1.0) && is(y.dot(y), 1.0) && is(z.dot(z), 1.0) &&
         is(x.dot(y), 0.0) && is(y.dot(z), 0.0) && is(z.dot(x), 0.0) && x.cross(y).dot(z) > 0.0;
}

/// The dynamics of the handle, as far as known; 0: unknown.
struct HandleDynamics {
  double mass_kg = 0.0;              ///< apparent at the handle, the least of all directions [kg]
  double inertia_kg_m2 = 0.0;        ///< the same of turning [kg m^2]
  double damping_Ns_per_m = 0.0;     ///< viscous [N s/m]
  double damping_Nms_per_rad = 0.0;  ///< [N m s/rad]
  double friction_N = 0.0;           ///< Coulomb [N]
  double friction_Nm = 0.0;          ///< [N m]
  double encoder_step_m = 0.0;       ///< [m]
  double encoder_step_rad = 0.0;     ///< [rad]
  double delay_s = 0.0;              ///< from a write to the motors [s]
};

/// The abilities of a device; queried, never guessed from its name.
struct DeviceInfo {
  std::string name;                       ///< "simulated premium-1.5-6dof"
  std::string serial{};                   ///< tells two of a kind apart; empty: the device has none
  bool is_hardware = false;               ///< a real device: its time is that of the hand, no virtual clock
  bool senses_rotation = false;           ///< orientation of the handle is measured
  bool actuates_force = false;            ///< can push
  bool actuates_torque = false;           ///< can turn the handle
  double max_force_N = 0.0;               ///< largest force it may be asked for [N]
  double max_torque_Nm = 0.0;             ///< largest torque it may be asked for [N m]
  double max_stiffness_N_per_m = 0.0;     ///< stiffest wall that its maker or users find stable, 1 kHz [N/m]
  double max_stiffness_Nm_per_rad = 0.0;  ///< the same for rotation [N m/rad]
  double workspace_radius_m = 0.0;        ///< largest sphere about the origin within its workspace [m]
  double max_still_s = 0.0;     ///< no hand keeps its reading the same to the bit for longer; 0: unknown [s]
  double rate_Hz = 1000.0;      ///< rate it wants to be served at [Hz]
  std::string rotation_fill{};  ///< how orientations between the readings of a slower sensor are made; empty:
                                ///< each sample has one that was read
  HandleDynamics handle{};
};

class Device {
 public:
  virtual ~Device() = default;
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Makes the device ready with zero wrench. Slow; may allocate. An error states what is missing and the
  /// remedy.
  virtual Result<void> open() = 0;
  /// Zero wrench, then releases the device. Safe to call twice.
  virtual void close() noexcept = 0;
  virtual const DeviceInfo& info() const noexcept = 0;

  /// The newest sample at `now_s` on the loop's clock; false (and sample.valid = false) when it failed.
  /// A simulated device moves its world up to `now_s` here. Never waits longer than a device transfer.
  virtual bool read(double now_s, DeviceSample& sample) noexcept = 0;

  /// Sets the wrench on the hand until the next write; false when the device did not take it.
  virtual bool write(const Wrench& F_D) noexcept = 0;

  /// What is wrong with the device, in a sentence with its cure; empty when it knows of nothing. For the
  /// owner, while no loop runs. May allocate.
  virtual std::string trouble() const { return {}; }
};

}  // namespace tactum::inline v0_1
