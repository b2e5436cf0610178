#pragma once
/// One step of the constraint response, while it is made: its inputs, what it may ask, and what it changes.
/// Only the files that make up this response see it.

#include "tactum/haptics/constraint_response.h"
#include "tactum/haptics/frame_report.h"

namespace tactum {

struct ConstraintStep : StepInput {
  GapOracle& gaps;
  WorldState& bodies;       ///< where everything is, and how it moves
  ConstraintResponse& own;  ///< what the response keeps
  FrameReport& report;
};

}  // namespace tactum
