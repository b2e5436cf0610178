#include "tactum/drivers/spacemouse.h"

#include <algorithm>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kPerCount = 1.0 / 500.0;  // of the full deflection

/// The daemon's axes, seen by the left hand, in D.
Vec3 spacenav_in_D(const std::array<int, 3>& counts) noexcept {
  return Vec3(-counts[2], counts[0], counts[1]) * kPerCount;
}

}  // namespace

SpaceMouse::SpaceMouse(std::string socket) : socket_(std::move(socket)) {
  info_.name = "spacemouse";
  info_.is_hardware = true;
  info_.senses_rotation = true;
  info_.workspace_radius_m = kRange_m;
}

Result<std::unique_ptr<Device>> SpaceMouse::connect(const std::string& socket) {
  std::unique_ptr<SpaceMouse> mouse(new SpaceMouse(socket.empty() ? spacenav_socket_path() : socket));
  if (Result<void> connected = mouse->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(mouse));
}

Result<void> SpaceMouse::connect_once() {
  if (is_connected_) return {};
  Result<void> connected = daemon_.connect(socket_);
  is_connected_ = static_cast<bool>(connected);
  return connected;
}

DriverSurvey SpaceMouse::survey() {
  DriverSurvey survey{"spacemouse", {}, ""};
  const Result<std::unique_ptr<Device>> mouse = connect("");
  if (mouse)
    survey.found.push_back({"spacemouse", (*mouse)->info(), ""});
  else
    survey.nothing = mouse.error().message();
  return survey;
}

Result<void> SpaceMouse::open() {
  if (Result<void> connected = connect_once(); !connected) return connected;
  X_DH_ = {};
  started_ = false;
  is_open_ = true;
  return {};
}

void SpaceMouse::close() noexcept {
  daemon_.close();
  is_connected_ = is_open_ = false;
}

bool SpaceMouse::read(double now_s, DeviceSample& sample) noexcept {
  sample.valid = false;
  if (!is_open_) return false;
  if (!daemon_.drain()) {
    is_open_ = is_connected_ = false;
    return false;
  }
  const double step_s = started_ ? std::clamp(now_s - last_s_, 0.0, kLongestStep_s) : 0.0;
  started_ = true;
  last_s_ = now_s;
  Twist V{spacenav_in_D(daemon_.state().push) * kFullSpeed_m_per_s,
          spacenav_in_D(daemon_.state().turn) * kFullTurn_rad_per_s};
  const Vec3 from = X_DH_.p;
  X_DH_ = renormalized({exp_rotation(V.w * step_s) * X_DH_.R, from + V.v * step_s});
  if (const double distance = X_DH_.p.norm(); distance > kRange_m) {
    X_DH_.p *= kRange_m / distance;
    V.v = step_s > 0.0 ? Vec3((X_DH_.p - from) / step_s) : Vec3(Vec3::Zero());
  }
  sample.time_s = now_s;
  sample.X_DH = X_DH_;
  sample.V_DH = V;
  sample.has_velocity = true;
  sample.buttons = daemon_.state().buttons;
  sample.motors_on = true;  // it has none, and nothing that says otherwise
  sample.valid = true;
  return true;
}

}  // namespace tactum::inline v0_1
