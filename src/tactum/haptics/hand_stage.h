#pragma once
/// The first stage of a frame: where is the hand, what does it hold, and what do force fields do to that?

#include "tactum/haptics/hand.h"
#include "tactum/haptics/picking.h"
#include "tactum/response/field_pull.h"

namespace tactum::inline v0_1 {

/// What the stage keeps from frame to frame.
struct HandStage : HandTracking {
  Grasp grasp;
  FieldPull field;
};

/// The stage before the first frame.
HandStage begin_hand(const FrameSettings& settings);

/// Takes a sample in. The first time the hand is known, the device is mapped so that the handle stands at the
/// tool's grasp point and the part is grasped in the orientation it has: nothing is pulled.
GraspedPart track_hand(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                       std::span<const Pose> X_WB, HandStage& hand) noexcept;

}  // namespace tactum::inline v0_1
