#pragma once
/// The `constraint` response as a stage of the frame: the grasped part and the bodies that move by themselves
/// go as far as nothing penetrates. constraint.h moves the grasped part's island, free_bodies.h the others.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

class ConstraintResponse {
 public:
  /// What it needs of a patch: its features, whose corners become rows.
  static constexpr PatchPoints kPoints = PatchPoints::kClosest;

  ConstraintResponse(const World& world, const FrameSettings& settings, WorldState& bodies);

  /// How far any point of a body may move in this frame, by body [m]; adds the first half of gravity's
  /// impulse.
  std::span<const double> bound_motion(const MotionInput& input, WorldState& bodies) noexcept;
  /// Moves everything that moves, the grasped part's island last. Fills the report's response fields.
  /// `others` are the reports of the second hand and all after it.
  void step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
            std::span<HandReport> others) noexcept;
  /// For a hand: the sum of the contact forces on the grasped part, its weight, the load of force fields and
  /// the pulses of its impacts, at the handle, world axes [N, N m]. Once a frame.
  Wrench felt(const StepInput& input, const PlacedHandle& handle, std::size_t hand) noexcept;
  /// The same without the pulses: what the coupling exerts on the hand, and its opposite on the part.
  Wrench coupled(std::size_t hand) const noexcept { return memory_.constraint.hands[hand].felt; }

  /// The contacts of the last step, and the friction at those that have it.
  std::span<const ContactRow> rows() const noexcept { return memory_.contact_rows.rows; }
  std::span<const FrictionUse> friction_uses() const noexcept {
    return {memory_.constraint.friction_uses.begin(), memory_.constraint.friction_uses.end()};
  }
  /// Energy of impacts that a hand is still to feel [J].
  double stored_J(std::size_t hand) const noexcept {
    return memory_.constraint.hands[hand].impulses.pending_J();
  }
  /// Whether rows were dropped for want of room.
  bool rows_full() const noexcept { return memory_.contact_rows.full; }
  /// Its memory, for tests and displays that look inside.
  const ConstraintMemory& memory() const noexcept { return memory_; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.memory_);
  }

 private:
  ConstraintMemory memory_;
};

}  // namespace tactum::inline v0_1
