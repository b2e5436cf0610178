#pragma once
/// The state that a frame changes: the poses of the bodies, and the state of each stage. Allocated once at
/// load time; a copy can be stepped on its own.

#include <vector>

#include "tactum/haptics/contact_stage.h"
#include "tactum/haptics/force_stage.h"
#include "tactum/haptics/hand_stage.h"
#include "tactum/loop/safety.h"
#include "tactum/loop/smoothing.h"
#include "tactum/response/response.h"

namespace tactum::inline v0_1 {

/// The parts of a frame whose ends are reported to a stage observer. kVelocities ends with the motion bounds,
/// kExactTests with the contact patches, and kShow is everything from the felt wrench to the commanded one.
enum class Stage { kHand, kVelocities, kNearPairs, kExactTests, kResponse, kShow };
inline constexpr int kStageCount = 6;

/// Called when a stage has ended. The frame reads no clock; a caller that wants times passes an observer that
/// does.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void stage_ended(Stage stage) noexcept = 0;
};

struct FrameState {
  FrameState(const World& world, const FrameSettings& settings, StageObserver* observer = nullptr);

  WorldState world;              ///< poses and twists of the bodies, an entry for each body of the World
  std::vector<Pose> X_WB_start;  ///< poses at the start of the frame [m]
  double load_work_J = 0.0;      ///< work of the bodies' loads since the start [J]
  HandStage hand;
  ContactStage contacts;
  Response response;
  SmoothingState smoothing;
  PortState port;
  SafetyState safety;
  StageObserver* observer;            ///< may be null
  ForceStage* force_stage = nullptr;  ///< of the caller's own; may be null

  void ended(Stage stage) noexcept {
    if (observer) observer->stage_ended(stage);
  }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.world, self.X_WB_start, self.load_work_J, self.hand, self.contacts, self.response,
          self.smoothing, self.port, self.safety);
  }
};

}  // namespace tactum::inline v0_1
