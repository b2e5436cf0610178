#pragma once
/// The state that a frame changes: the poses of the bodies, and the state of each stage. Allocated once at
/// load time; a copy can be stepped on its own.

#include <vector>

#include "tactum/haptics/contact_stage.h"
#include "tactum/haptics/force_stage.h"
#include "tactum/haptics/hand_stage.h"
#include "tactum/loop/loop.h"
#include "tactum/loop/passivity.h"
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

/// What each hand keeps of its own from frame to frame.
struct HandFrameState {
  HandStage hand;
  SmoothingState smoothing;
  PortState port;
  SafetyState safety;
  double coupling_work_J = 0.0;  ///< that its coupling has done on the part since the start, if not alone [J]

  // Scratch of one frame.
  HandleMotion handle_moved;  ///< the motion of the device's handle
  PlacedHandle handle;        ///< on the grasped part, where the step has left it

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.hand, self.smoothing, self.port, self.safety, self.coupling_work_J);
  }
};

/// The inherited members are those of the first hand.
struct FrameState : HandFrameState {
  FrameState(const World& world, const FrameSettings& settings, StageObserver* observer = nullptr);

  WorldState world;              ///< poses and twists of the bodies, an entry for each body of the World
  std::vector<Pose> X_WB_start;  ///< poses at the start of the frame [m]
  double load_work_J = 0.0;      ///< work of the bodies' loads since the start [J]
  ContactStage contacts;
  Response response;
  std::vector<HandInput> hand_inputs;       ///< of all hands, in this frame
  std::vector<HandFrameState> other_hands;  ///< of the second hand and all after it
  std::vector<HandReport> other_reports;    ///< of the same, of the last frame
  StageObserver* observer;                  ///< may be null
  ForceStage* force_stage = nullptr;        ///< of the caller's own, for the first hand; may be null

  /// The state of a hand, counted from 0.
  HandFrameState& of_hand(std::size_t number) noexcept {
    return number == 0 ? *this : other_hands[number - 1];
  }
  const HandFrameState& of_hand(std::size_t number) const noexcept {
    return number == 0 ? *this : other_hands[number - 1];
  }
  void ended(Stage stage) noexcept {
    if (observer) observer->stage_ended(stage);
  }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.world, self.X_WB_start, self.load_work_J, self.hand, self.contacts, self.response,
          self.smoothing, self.port, self.coupling_work_J, self.safety, self.other_hands);
  }
};

/// The first stage of a frame: tracks every hand (hand_stage.h), in the order of the settings, and fills
/// state.hand_inputs. A hand that is not known yet holds its part where that started.
std::span<const HandInput> track_hands(const World& world, const FrameSettings& settings,
                                       std::span<const HandSample> samples, FrameState& state) noexcept;

/// Whether some hand is known, so that the scene may move.
bool some_known(std::span<const HandInput> hands) noexcept;

}  // namespace tactum::inline v0_1
