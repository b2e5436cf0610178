#pragma once
/// The first stage of a frame: the pose of the probe, the grasped part, and the load of force fields on it.

#include "tactum/haptics/hand.h"
#include "tactum/haptics/picking.h"
#include "tactum/response/field_pull.h"

namespace tactum::inline v0_1 {

/// The state of the stage, from frame to frame.
struct HandStage : HandTracking {
  Grasp grasp;
  FollowedTurn turned_W;  ///< from the handle on the grasped part to the probe
  FieldPull field;

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.X_WD, self.X_WH, self.V_WH, self.time_s, self.known, self.clutched, self.grasp, self.turned_W,
          self.field);
  }
};

/// The stage before the first frame.
HandStage begin_hand(const HandSettings& settings);

/// Takes a sample in. The first time the probe is known, the device is mapped so that the handle is at the
/// tool's grasp point and the part is grasped in the orientation it has: nothing is pulled. The button counts
/// in every valid sample, also in one whose pose is implausible and leaves the probe where it was.
///
/// `earlier` are the hands that were tracked before in this frame, of which the first that holds the part
/// bears its load. `shared`: another hand holds the same part, and will go on; a hand that releases it then
/// leaves it slowly (Grasp::left).
GraspedPart track_hand(const World& world, const HandSettings& settings, double dt_s,
                       const DeviceSample& sample, std::span<const Pose> X_WB, HandStage& hand,
                       std::span<const HandInput> earlier = {}, bool shared = false) noexcept;

}  // namespace tactum::inline v0_1
