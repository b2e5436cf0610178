#include "tactum/haptics/hand.h"

#include <algorithm>

#include "tactum/math/screw.h"
#include "tactum/response/workspace_scale.h"

namespace tactum::inline v0_1 {

void follow_hand(const Workspace& workspace, const DeviceSample& sample, double dt_s,
                 HandTracking& hand) noexcept {
  if (!sample.valid || !plausible(sample.X_DH)) {
    hand.V_WH = {};
    return;
  }
  if (!hand.known) hand.X_WD = workspace.X_WD;
  const Pose scaled{renormalized(sample.X_DH).R, workspace.scale * sample.X_DH.p};
  const bool pressed = workspace.clutch_button >= 0 &&
                       (sample.buttons >> static_cast<unsigned>(workspace.clutch_button) & 1u) != 0;
  if (pressed && hand.known) {
    // The mapping's origin follows, so that the hand keeps its place; orientation is never clutched.
    hand.X_WD.p = hand.X_WH.p - hand.X_WD.R * scaled.p;
  }
  const Pose X_WH = hand.X_WD * scaled;
  if (sample.has_velocity && sample.V_DH.finite() && !pressed) {
    hand.V_WH = {hand.X_WD.R * (workspace.scale * sample.V_DH.v), hand.X_WD.R * sample.V_DH.w};
  } else if (hand.known && sample.time_s == hand.time_s && X_WH.p == hand.X_WH.p && X_WH.R == hand.X_WH.R) {
    // The device was read again before it had measured: the hand goes on as it did.
  } else {
    const double since_s = std::max(dt_s, sample.time_s - hand.time_s);
    hand.V_WH = hand.known ? twist_between(hand.X_WH, X_WH, since_s) : Twist{};
  }
  hand.X_WH = X_WH;
  hand.time_s = sample.time_s;
  hand.clutched = pressed;
  hand.known = true;
}

Wrench to_device(const Workspace& workspace, const HandTracking& hand, const Wrench& F_W) noexcept {
  return at_device(rotated(hand.X_WD.R.transpose(), F_W), workspace.scale);
}

}  // namespace tactum::inline v0_1
