#pragma once
/// The `penalty` response as published [Gregory 2000, 5.2, 6.1], as a stage of the frame: every contact is a
/// spring that pushes in proportion to its depth below the tolerance delta = v_c dt. The bodies advance to
/// the smallest time of impact, the contact forces act, and the bodies advance with the new velocities for
/// the rest of the frame.
///
/// A grasped part moves straight towards the probe, but no farther in one frame than the safe threshold
/// distance [Gregory 2000, 3.2]. The tolerance of contact determination grows with that speed, so a part that
/// moves towards the hand cannot pass a contact that was not tested. (The displacement by which contacts push
/// it back is bounded by the threshold too, but first tested in the next frame.) The threshold limits the
/// step that is taken, not the pull that the contact forces are weighed against: with the pull cut to the
/// threshold, a grasped gear could never push harder than the spring over half a millimetre.
///
/// Several hands, of which the paper knows one, hold their parts alike: two parts that meet push each other
/// by one spring, and a part that several hold goes where all their couplings together would have it.
///
/// The other bodies move by impulses [Gregory 2000, 6.2]: among each other and with fixed bodies they hit,
/// slide and rest as in the constraint response (free_bodies.h), and penetrate nothing. The springs of the
/// grasped parts push them beside that. Where there is only one other body, and on a joint, as of two gears,
/// nothing but a grasped part can meet it: then all that moves is one problem of springs.

#include <string>
#include <vector>

#include "tactum/base/grouped_indices.h"
#include "tactum/dynamics/islands.h"
#include "tactum/dynamics/solve_penalty.h"
#include "tactum/response/constraint_state.h"
#include "tactum/response/contact_force.h"
#include "tactum/response/frame_report.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

class PenaltyResponse {
 public:
  /// What it needs of a patch: points that carry its force over its area.
  static constexpr PatchPoints kPoints = PatchPoints::kQuadrature;

  PenaltyResponse(const World& world, const FrameSettings& settings, WorldState& bodies);

  /// How far any point of a body moves in this frame at its wanted velocity, by body [m]: that of a grasped
  /// part leads to the hand, at most the threshold distance; the others go on as they moved, pulled by
  /// gravity; all as their joints allow. Sets the bodies' velocities.
  std::span<const double> bound_motion(const MotionInput& input, WorldState& bodies) noexcept;
  /// Moves everything that moves, and puts every pose back on its joint. Fills the report's response fields.
  void step(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
            std::span<HandReport> others) noexcept;
  /// The wrench of a hand's coupling from the hand to the grasped part, at the handle, world axes [N, N m].
  /// Its damper sees the rate at which the two move apart, filtered: the velocity of the hand is one over
  /// some milliseconds, that of the part is one over the frame, in which a step of an encoder is a leap. Once
  /// a frame and hand.
  Wrench felt(const StepInput& input, const PlacedHandle& handle, std::size_t hand) noexcept;

  /// What the spring of a hand's coupling exerted on it at the end of the last step [N, N m].
  Wrench coupled(std::size_t hand) const noexcept { return hands_[hand].spring; }
  /// The contacts of the last step.
  std::span<const ContactRow> rows() const noexcept { return contacts_.rows; }
  /// Energy of the contacts' springs, at the end of the last step [J].
  double stored_J(std::size_t /*hand*/) const noexcept { return stored_J_; }
  /// Whether rows were dropped for want of room.
  bool rows_full() const noexcept { return contacts_.full || memory_.contact_rows.full; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.contacts_, self.memory_, self.stored_J_, self.hands_, self.pushed_);
  }

 private:
  /// A hand and the part that it holds.
  struct Hand {
    Twist rate;                  // of the part, as the hand sees it, filtered [m/s, rad/s]
    int rate_of = -1;            // the body whose rate it is; -1: none
    Vec6 target = Vec6::Zero();  // scratch: displacement of the handle [m, rad]
    Wrench spring;               // scratch: of its coupling, on the hand [N, N m]

    /// What is carried from frame to frame (carried_state.h).
    template <class Self, class Visit>
    static void carried(Self& self, Visit& visit) noexcept {
      visit(self.rate, self.rate_of);
    }
  };

  /// Of each patch, the factor for its depth; empty where the shortest depth is wanted.
  std::span<const double> scale_depths(const StepInput& input, GapOracle& gaps,
                                       std::span<const Twist> V_WB) noexcept;
  void aim_grasped(const MotionInput& input, const WorldState& bodies) noexcept;
  void add_body(const MotionInput& input, int body, double h_s, const WorldState& bodies) noexcept;
  double share_of_margin(const StepInput& input, const ContactRow& row, int body, const Vec3& toward_W,
                         const WorldState& bodies) const noexcept;
  void find_rows(const StepInput& input, GapOracle& gaps, const WorldState& bodies) noexcept;
  void advance(const StepInput& input, double t_s, WorldState& bodies) const noexcept;
  void report_grasped(const StepInput& input, std::size_t hand, double rest_s, const WorldState& bodies,
                      HandReport& report) const noexcept;
  void move_by_springs(const StepInput& input, GapOracle& gaps, WorldState& bodies, FrameReport& report,
                       std::span<HandReport> others) noexcept;
  void solve_island(const StepInput& input, std::size_t island, double rest_s, WorldState& bodies,
                    FrameReport& report) noexcept;
  void solve(const StepInput& input, double rest_s, WorldState& bodies, FrameReport& report) noexcept;

  ContactRows contacts_;
  ConstraintMemory memory_;   // of the bodies that move by impulses
  double stored_J_ = 0.0;     // of the contacts' springs [J]
  std::vector<Hand> hands_;   // in the order of MotionInput::hands
  std::vector<char> pushed_;  // by body: a grasped part was near it in the last frame
  // Scratch of one frame.
  bool by_impulses_ = false;      // the other bodies move by impulses
  std::vector<char> is_grasped_;  // by body: some hand holds it
  std::vector<Twist> V_first_;    // by body: up to the first impact [m/s, rad/s]
  Islands islands_;
  GroupedIndices bodies_, rows_;      // by island
  ReservedVector<double> stiffness_;  // of the contact rows of the island in work [N/m]
  ContactProblem problem_;
  PenaltySolver solver_;
  std::vector<Twist> V_before_joints_;  // by body: before joints and the hand change it [m/s, rad/s]
  std::vector<double> delta_;           // by body: its part of the tolerance, v_c dt [m]
  bool cut_ = false;                    // a motion to the hand is cut to the threshold distance
  ReservedVector<double> depth_scale_;  // by patch
};

/// What this response leaves out of a scene, in a sentence for people: empty where that is nothing, and in
/// the constraint response.
std::string penalty_sentence(const FrameSettings& settings);

}  // namespace tactum::inline v0_1
