#pragma once
/// How the grasped part and the world answer: one of two responses, each a stage of the frame with the same
/// three calls. The choice is made here, in one place; a third would be another file and another alternative.

#include <variant>

#include "tactum/response/constraint_response.h"
#include "tactum/response/penalty_response.h"

namespace tactum::inline v0_1 {

class Response {
 public:
  /// The response that the settings name. It may change the velocities that the world starts with.
  Response(const World& world, const FrameSettings& settings, WorldState& bodies);

  /// Whether patches carry weighted points or the closest one.
  PatchPoints points() const noexcept;
  /// How far any point of a body may move in this frame, by body [m]; sets the velocities that the bodies
  /// want.
  std::span<const double> bound_motion(const MotionInput& input, WorldState& bodies) noexcept;
  /// Moves everything that moves. Fills the report's response fields, and in `others` those of the second
  /// hand and all after it.
  void step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
            std::span<HandReport> others = {}) noexcept;
  /// The wrench that a hand feels, at the handle, world axes; zero while nothing is grasped [N, N m]. In
  /// the penalty response it is the wrench of the coupling; in the constraint response the contact forces,
  /// the weight and the load of fields on the grasped part, and the pulses of its impacts. `handle` is where
  /// the step has left the grasped part's. Call it once a frame: it moves the pulses on.
  Wrench felt(const StepInput& input, const PlacedHandle& handle, std::size_t hand = 0) noexcept;
  /// What the coupling of a hand exerted on it in the last step, without pulses, at the handle, world axes;
  /// in the penalty response without the coupling's damper [N, N m].
  Wrench coupled(std::size_t hand) const noexcept;

  /// The contacts of the last step, for displays.
  std::span<const ContactRow> rows() const noexcept;
  /// Friction at the contacts that have it, by ContactRow::friction_patch; empty in the penalty response.
  std::span<const FrictionUse> friction_uses() const noexcept;
  /// Energy that the response holds for a hand beside bodies and coupling: of impacts that are still to be
  /// felt, and of the penalty response's contact springs [J].
  double stored_J(std::size_t hand = 0) const noexcept;

  /// The constraint response, if it is the one; else null. For tests and displays that look inside.
  const ConstraintResponse* constraint() const noexcept { return std::get_if<ConstraintResponse>(&model_); }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.model_);
  }

 private:
  std::variant<PenaltyResponse, ConstraintResponse> model_;
};

}  // namespace tactum::inline v0_1
