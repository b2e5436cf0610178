#include "tactum/session/rehearsal.h"

#include <algorithm>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kRehearsedMove_m = 0.040;
constexpr double kRehearsedTurn_rad = 0.6;
constexpr double kRehearsedPress_m = 0.016;
constexpr double kRehearsedTime_s = 0.8;  // of each motion

}  // namespace

/// Moves from where it was when it was asked, straight and by one rotation, and stays there.
class RehearsedDevice::Hand final : public HandMotion {
 public:
  HandState at(double world_s) const noexcept override {
    const double share = std::clamp((world_s - start_s) / kRehearsedTime_s, 0.0, 1.0);
    HandState state;
    state.X_DH.p = X_DH.p + share * step.v;
    state.X_DH.R = exp_rotation(share * step.w) * X_DH.R;
    if (share > 0.0 && share < 1.0) state.V_DH = step * (1.0 / kRehearsedTime_s);
    return state;
  }
  double duration_s() const noexcept override { return 0.0; }

  Pose X_DH;              // when asked
  Twist step;             // from there
  double start_s = 0.0;   // of the device's world
  double now_s = 0.0;     // of the last read
  double first_s = -1.0;  // the loop's clock at the first read
};

RehearsedDevice::RehearsedDevice(const SimulatedDeviceModel& model, const HandModel& hand)
    : grip_(hand), hand_(std::make_shared<Hand>()), device_(model, hand, hand_) {}

bool RehearsedDevice::read(double now_s, DeviceSample& sample) noexcept {
  if (hand_->first_s < 0.0) hand_->first_s = now_s;
  hand_->now_s = now_s - hand_->first_s;
  return device_.read(now_s, sample);
}

void RehearsedDevice::obey(const TouchRequest& request) {
  hand_->start_s = hand_->now_s;
  hand_->step = {};
  // Each task begins with the handle in the middle and at rest, wherever a push has left it.
  hand_->X_DH = {};
  device_.place({}, {});
  device_.hold_with(request.task == TouchTask::kRelease ? no_hand() : grip_);
  if (request.task == TouchTask::kMove) hand_->step.v = kRehearsedMove_m * Vec3::Unit(request.axis);
  if (request.task == TouchTask::kTurn) hand_->step.w = kRehearsedTurn_rad * Vec3::Unit(request.axis);
  if (request.task == TouchTask::kPressDown) hand_->step.v = Vec3(0.0, 0.0, -kRehearsedPress_m);
}

}  // namespace tactum::inline v0_1
