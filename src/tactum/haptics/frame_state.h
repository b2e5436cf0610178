#pragma once
/// Everything a frame changes, allocated once at load time.

#include <vector>

#include "tactum/collision/contact_finder.h"
#include "tactum/haptics/constraint.h"
#include "tactum/haptics/contact_force.h"
#include "tactum/haptics/field_pull.h"
#include "tactum/haptics/force_stage.h"
#include "tactum/haptics/free_bodies.h"
#include "tactum/haptics/hand.h"
#include "tactum/haptics/impulse_display.h"
#include "tactum/haptics/safety.h"
#include "tactum/haptics/settings.h"
#include "tactum/haptics/shading.h"
#include "tactum/haptics/sleep.h"
#include "tactum/haptics/smoothing.h"
#include "tactum/haptics/waiting.h"

namespace tactum {

/// The parts of a frame that a stage observer is told the end of.
enum class Stage { kHand, kVelocities, kNearPairs, kExactTests, kResponse, kShow };
inline constexpr int kStageCount = 6;

/// Told when a stage has ended. The frame reads no clock; whoever wants times passes an observer that does.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void stage_ended(Stage stage) noexcept = 0;
};

struct FrameState {
  FrameState(const World& world, const FrameSettings& settings, StageObserver* observer = nullptr);

  WorldState world;  ///< poses and twists of the bodies
  Tool tool;         ///< what is held now, and where
  FieldPull field;   ///< what force fields do to it
  HandTracking hand;
  ContactFinder finder;
  std::vector<ShadingNormals> shading;  ///< one per body; empty when shading is off
  SmoothingState smoothing;
  ImpulseDisplay blows;
  PortState port;
  SafetyState safety;
  StageObserver* observer;            ///< may be null
  ForceStage* force_stage = nullptr;  ///< of the caller's own; may be null

  // Scratch of one frame, one entry per body.
  std::vector<Resistance> resistance;
  std::vector<Mobility> mobility;
  std::vector<Pose> X_WB_start;  ///< poses at the start of the frame
  std::vector<double> reach;
  ContactRows contacts;
  ConstraintState constraint;
  FreeBodies free;
  Waiting waiting;
  Sleep sleep;

  void ended(Stage stage) noexcept {
    if (observer) observer->stage_ended(stage);
  }
};

}  // namespace tactum
