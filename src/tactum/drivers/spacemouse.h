#pragma once
/// The SpaceMouse of 3Dconnexion through spacenavd: input only, nothing is felt. Its cap is deflected a
/// little and springs back, so it leads by rate: the pose is moved, read by read, with a speed and a turning
/// speed in proportion to the deflection, within a sphere of the size of a desk-sized device. A cap held
/// still goes on leading; the daemon is silent then. At the loss of the daemon the pose stays where it is.
///
/// Axes: the daemon's (x, y, z) and (rx, ry, rz) are, in D, (-z, x, y) and the rotation vector (-rz, rx, ry).

#include <memory>
#include <string>

#include "tactum/devices/device.h"
#include "tactum/drivers/spacenav_socket.h"
#include "tactum/drivers/survey.h"

namespace tactum::inline v0_1 {

class SpaceMouse final : public Device {
 public:
  static constexpr double kFullSpeed_m_per_s = 0.10;  ///< at full deflection [m/s]
  static constexpr double kFullTurn_rad_per_s = 1.5;  ///< at full deflection [rad/s]
  static constexpr double kRange_m = 0.12;            ///< radius of the sphere that it leads within [m]
  static constexpr double kLongestStep_s = 0.05;      ///< a longer pause between reads counts as this [s]

  /// Connected to the daemon at `socket`; empty: where it is expected (spacenav_socket_path).
  static Result<std::unique_ptr<Device>> connect(const std::string& socket);
  static DriverSurvey survey();

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  /// Takes anything finite, and shows nothing of it; false when the daemon is gone.
  bool write(const Wrench& F_D) noexcept override { return is_open_ && F_D.finite(); }
  std::string trouble() const override { return daemon_.trouble(); }

 private:
  explicit SpaceMouse(std::string socket);
  Result<void> connect_once();

  std::string socket_;
  SpacenavSocket daemon_;
  DeviceInfo info_;
  bool is_connected_ = false;
  bool is_open_ = false;
  bool started_ = false;
  double last_s_ = 0.0;  // of the last read, the loop's clock
  Pose X_DH_;
};

}  // namespace tactum::inline v0_1
