#pragma once
/// A six degree-of-freedom device that needs no hardware: a rigid handle with inertia, friction, encoders, a
/// delayed and limited wrench, held by a hand (hand_model.h) that follows a motion (hand_motion.h).
///
///   write -> limit -> delay -> motors -+                    +-> encoder -> windowed velocity -> read
///                                      +-> handle + hand ---+
///   intended motion -> spring, damper -+   stops at the workspace's edge
///
/// `read(now)` moves this world up to `now` in equal substeps of about 0.1 ms with the last written wrench
/// held constant, as by a real device's amplifier. Each substep is the implicit midpoint rule in the hand's
/// spring and all dampers, with Coulomb friction as a proximal step:
///
///   u = prox( 2 m v / h + F + k (x_hand - x) + b v_hand ) / (2 m / h + h k / 2 + b + b_device)
///   x += h u,  v = 2 u - v            prox shortens a vector by the friction force, to zero if shorter
///
/// It is stable for any stiffness and generates no energy: the work of every element is its force times u. It
/// is of second order because a first-order rule would carry the handle half a substep ahead under a constant
/// force and so hide a tenth of the half period of delay by which a held wrench makes a stiff wall unstable.
/// Rotation is computed in the same way with a rotation vector and an isotropic inertia; there the energy
/// balance holds to second order of the substep.
///
/// A jump of `now` by more than kMaxStepsPerRead substeps is not caught up: the world, hand included, stands
/// still for the rest, so that a debugger's pause does not end in a leap. Deterministic: the state depends
/// only on the sequence of calls.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "tactum/devices/device.h"
#include "tactum/devices/hand_model.h"
#include "tactum/devices/hand_motion.h"

namespace tactum::inline v0_1 {

/// The numbers of one device.
struct SimulatedDeviceModel {
  std::string name;                  ///< "premium-1.5-6dof"
  double mass_kg = 0.1;              ///< apparent at the handle [kg]
  double inertia_kg_m2 = 1e-4;       ///< apparent at the handle [kg m^2]
  double damping_Ns_per_m = 0.0;     ///< viscous, of bearings and motors [N s/m]
  double damping_Nms_per_rad = 0.0;  ///< [N m s/rad]
  double friction_N = 0.0;           ///< Coulomb [N]
  double friction_Nm = 0.0;          ///< Coulomb [N m]
  double encoder_step_m = 0.0;       ///< along each axis; 0: exact [m]
  double encoder_step_rad = 0.0;     ///< of each component of the rotation vector; 0: exact [rad]
  double command_delay_s = 0.0;      ///< from write to the motors, at most kMaxDelay_s [s]
  double velocity_window_s = 0.010;  ///< of the velocity estimate; 0: the device gives none [s]
  double watchdog_s = 0.030;         ///< without a write for so long, the motors go limp [s]
  double max_force_N = 0.0;          ///< saturation of the force's magnitude [N]
  double max_torque_Nm = 0.0;  ///< saturation of the torque's magnitude; 0: cannot turn the handle [N m]
  double max_stiffness_N_per_m = 0.0;     ///< reported in DeviceInfo [N/m]
  double max_stiffness_Nm_per_rad = 0.0;  ///< reported in DeviceInfo [N m/rad]
  double workspace_radius_m = 0.1;        ///< mechanical stop, a sphere about the origin [m]
  double rate_Hz = 1000.0;                ///< [Hz]
};

/// The presets of real devices, and one by name.
const std::vector<SimulatedDeviceModel>& simulated_device_presets();
Result<SimulatedDeviceModel> simulated_device_preset(const std::string& name);

class SimulatedDevice final : public Device {
 public:
  static constexpr double kSubstep_s = 1e-4;     ///< aimed at [s]
  static constexpr int kMaxStepsPerRead = 1000;  ///< a read moves the world by at most this many
  static constexpr double kMaxDelay_s = 0.050;   ///< [s]

  /// `motion` may be null: the hand then rests at the origin.
  SimulatedDevice(SimulatedDeviceModel model, HandModel hand, std::shared_ptr<const HandMotion> motion);

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;

  // Quantities that a real device cannot report; for tests and displays.
  const Pose& true_pose() const noexcept { return X_DH_; }          ///< before the encoders [m]
  const Twist& true_twist() const noexcept { return V_DH_; }        ///< [m/s, rad/s]
  const Wrench& motor_wrench() const noexcept { return motors_; }   ///< acting at the last substep [N, N m]
  const HandState& intended() const noexcept { return intended_; }  ///< at the last substep
  double energy_J() const noexcept;                                 ///< kinetic, and of the hand's spring [J]
  double slept_s() const noexcept { return slept_s_; }              ///< time jumped over [s]
  long saturated_writes() const noexcept { return saturated_writes_; }
  long watchdog_trips() const noexcept { return watchdog_trips_; }
  /// From now on another hand holds the handle, or none (no_hand()).
  void hold_with(HandModel hand) noexcept { hand_ = std::move(hand); }
  /// Puts the handle somewhere with a velocity, after open: the start of an experiment.
  void place(const Pose& X_DH, const Twist& V_DH) noexcept;

 private:
  struct Command {
    double due_s = 0.0;  // world time from which it acts
    Wrench F;
  };
  struct Reading {
    double time_s = 0.0;
    Pose X;
  };
  static constexpr int kCommandRoom = 512;  // 50 ms of delay at 10 kHz
  static constexpr int kReadingRoom = 256;

  double total_mass() const noexcept { return model_.mass_kg + hand_.mass_kg; }
  double total_inertia() const noexcept { return model_.inertia_kg_m2 + hand_.inertia_kg_m2; }
  HandState hand_at(double world_s) const noexcept;
  void substep(double h) noexcept;
  void move_handle(const HandState& hand, double h) noexcept;
  void update_motors() noexcept;
  void stop_at_workspace_edge() noexcept;
  Pose encoded() const noexcept;
  void estimate_velocity(double now_s, DeviceSample& sample) noexcept;

  SimulatedDeviceModel model_;
  HandModel hand_;
  std::shared_ptr<const HandMotion> motion_;
  DeviceInfo info_;

  bool is_open_ = false;
  bool started_ = false;  // a first read has set the clock
  double now_s_ = 0.0;    // of the last read, the loop's clock
  double world_s_ = 0.0;  // of this world: starts at 0, stopped during jumps
  double slept_s_ = 0.0;
  Pose X_DH_;
  Twist V_DH_;
  HandState intended_;
  Wrench motors_;
  double last_write_s_ = 0.0;  // world time
  bool limp_ = true;           // nothing written yet, or the watchdog has tripped
  long saturated_writes_ = 0;
  long watchdog_trips_ = 0;
  std::array<Command, kCommandRoom> commands_{};  // ring, oldest at command_tail_
  int command_tail_ = 0;
  int command_count_ = 0;
  std::array<Reading, kReadingRoom> readings_{};  // ring, newest at reading_head_ - 1
  int reading_head_ = 0;
  int reading_count_ = 0;
};

}  // namespace tactum::inline v0_1
