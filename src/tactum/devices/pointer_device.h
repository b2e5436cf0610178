#pragma once
/// A simulated device (simulated_device.h) whose hand is led from outside: by the mouse on the viewer's page,
/// or by any program that has a pose to offer. Until it is aimed, the hand plays its script, forth and back
/// again without end, so that a scene is alive before anyone touches it.
///
///   aim ---> critically damped, limited in speed and range --+
///                                                            +--> intended pose --> simulated device
///   script, forth and back ----------------------------------+
///
/// A mouse gives a few dozen poses a second, with jumps. Each step of the loop moves the intended pose along
/// the closed form of a critically damped spring with rate kFollow_per_s,
///
///   e(t) = (e0 + (v0 + w e0) t) exp(-w t)         e: intended pose minus aim; rotation as rotation vector
///
/// which is stable for any step, and never faster than kMaxSpeed_m_per_s and kMaxTurn_rad_per_s. The rest is
/// done by the simulated hand: it holds the handle by its spring and gives way to forces.

#include <memory>

#include "tactum/devices/simulated_device.h"

namespace tactum::inline v0_1 {

class PointerDevice final : public Device {
 public:
  static constexpr double kFollow_per_s = 40.0;     ///< how fast an aim is followed [1/s]
  static constexpr double kMaxSpeed_m_per_s = 0.6;  ///< of the intended pose when aimed [m/s]
  static constexpr double kMaxTurn_rad_per_s = 12;  ///< of the intended pose when aimed [rad/s]

  /// `script` may be null: the hand then rests at the origin until it is aimed.
  PointerDevice(const SimulatedDeviceModel& model, const HandModel& hand,
                std::shared_ptr<const HandMotion> script);

  Result<void> open() override;
  void close() noexcept override { device_.close(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override { return device_.write(F_D); }

  // On the thread that reads. From the first aim or rest on the script plays no more.
  /// Sets the pose that the hand shall go to. An invalid pose is ignored; one outside the workspace is moved
  /// into it.
  void aim(const Pose& X_DH, std::uint32_t buttons) noexcept;
  /// The hand stays at its present intended pose, and presses no button.
  void rest() noexcept;
  bool aimed() const noexcept { return aimed_; }

 private:
  /// The motion of the simulated hand: one straight piece a read.
  struct Hand final : HandMotion {
    HandState at(double world_s) const noexcept override;
    double duration_s() const noexcept override { return 0.0; }
    double start_s = 0.0, end_s = 0.0;  // of the piece, the device's own time
    Pose X_DH;                          // at its start
    Twist V_DH;                         // on it
    std::uint32_t buttons = 0;
  };

  Pose scripted(double world_s, std::uint32_t& buttons) const noexcept;
  Pose follow(double step_s) noexcept;

  std::shared_ptr<const HandMotion> script_;
  std::shared_ptr<Hand> hand_;
  SimulatedDevice device_;
  DeviceInfo info_;
  bool started_ = false;
  double now_s_ = 0.0;    // of the last read
  double world_s_ = 0.0;  // the device's own time, which is stopped during jumps
  bool aimed_ = false;
  Pose X_aim_;
  std::uint32_t buttons_ = 0;
  Twist V_aim_;  // of the intended pose while it follows
};

}  // namespace tactum::inline v0_1
