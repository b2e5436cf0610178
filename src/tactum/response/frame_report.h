#pragma once
/// The one plain report of a frame: everything a display, a recording or a test wants to know about it.
/// Numbers only.

#include <cstdint>

#include "tactum/contact/contact_work.h"
#include "tactum/dynamics/world.h"
#include "tactum/loop/passivity.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The limits that a frame ran into, each with the setting to raise. A frame never stops for these. Of what
/// the tests of trial poses run into, only kCapacityReached is set.
namespace frame_flag {
inline constexpr std::uint32_t kBudgetShort = 1u << 0;  ///< pairs left unchecked: WorkBudget::max_exact_tests
inline constexpr std::uint32_t kCapacityReached = 1u << 1;  ///< something dropped: WorkBudget::capacity
inline constexpr std::uint32_t kPointsFull =
    1u << 2;  ///< contact points dropped: WorkBudget::max_contact_points
inline constexpr std::uint32_t kSolverBounded = 1u << 3;  ///< not converged: WorkBudget::solver_iterations
inline constexpr std::uint32_t kUncertified = 1u << 4;    ///< a distance without its certificate was used
inline constexpr std::uint32_t kMotionUndone =
    1u << 6;  ///< a motion was no number; the body stayed where it was
inline constexpr std::uint32_t kNoHand =
    1u << 5;  ///< no valid sample yet: the scene stands still, nothing is felt
/// The grasped part lags behind the hand, by ...
inline constexpr std::uint32_t kStepLimited = 1u << 7;   ///< Constraint::max_step_m or Penalty::max_step_m
inline constexpr std::uint32_t kPathUnproven = 1u << 8;  ///< at its end only: WorkBudget::max_path_tests
inline constexpr std::uint32_t kTurnLimited = 1u << 9;   ///< Constraint::max_turn_rad
inline constexpr std::uint32_t kLags = kStepLimited | kTurnLimited;  ///< any of them
}  // namespace frame_flag

/// Dry friction of one frame, over all patches that push (constraint response); friction_use.h has it by
/// patch.
struct FrictionReport {
  int sticking = 0;        ///< patches
  int slipping = 0;        ///< patches
  double cone_used = 0.0;  ///< largest fraction of a friction cone in use; 1: at its edge [-]
};

/// What one hand has of it.
struct HandReport {
  std::uint32_t safety = 0;  ///< safety_flag
  int grasped_body = -1;     ///< the body that is grasped; -1: none
  int hold = 0;              ///< how the hand holds it: a Hold (step_input.h)
  Pose X_WH;                 ///< pose of the probe [m]
  Pose X_WH_proxy;           ///< pose of the handle on the grasped part; identity when nothing is grasped [m]
  Wrench restoring;  ///< contact forces on the grasped part, at its centre of mass, world axes [N, N m]
  Wrench field;      ///< of force fields on the grasped part, at its centre of mass, world axes [N, N m]
  /// The wrench that the response lets the hand feel, before all other stages, at the handle, world axes: in
  /// the penalty response that of the coupling, in the constraint response Response::felt(). It is that of
  /// the scene, see workspace_scale.h [N, N m].
  Wrench coupling;
  /// The same within what the device can exert, after smoothing, at the handle, device axes [N, N m].
  Wrench smoothed;
  PortReport port;  ///< energy that passed between hand and scene, and the stiffness that it leaves
  Wrench passive;   ///< with the caller's own stage, before safety, at the handle, device axes [N, N m]
  Wrench shown;     ///< after safety, at the handle, device axes: the wrench that was sent [N, N m]
  /// In the constraint response, how many contact points push the grasped part; in the penalty response, how
  /// many are at the grasped part, also without force.
  int grasped_contact_points = 0;
};

/// All of it; the inherited members are those of the first hand.
struct FrameReport : HandReport {
  std::uint64_t index = 0;      ///< frames since the start
  std::uint32_t flags = 0;      ///< frame_flag
  double tolerance_m = 0.0;     ///< largest delta of a pair in contact; 0 without contact [m]
  double min_distance_m = 0.0;  ///< smallest signed distance of the pairs in contact; 0 without contact [m]
  bool penetrating = false;     ///< some pair overlaps by more than kPenetrating of both parts' sizes
  /// When the first contact closes, from the start of the frame; the whole step when none does. It is always
  /// zero in the constraint response, whose forces act over the whole step.
  double time_of_impact_s = 0.0;  ///< [s]
  int contact_points = 0;         ///< rows of the contact problem, whether they push or not
  int impacts = 0;  ///< pairs of bodies that hit each other, each impact counted (constraint response)
  int solver_iterations = 0;
  int solvers = 0;             ///< which solvers were at work: bits of ContactSolver (solver_choice.h)
  int active_constraints = 0;  ///< rows that hold the bodies (constraint response)
  int validation_tests = 0;    ///< exact tests of poses before they were taken
  int path_tests = 0;          ///< of nodes and leaves of surfaces, in proofs that steps cross nothing
  int unproven_paths = 0;      ///< pairs of surfaces whose step was tested at its end only
  int validation_retries = 0;  ///< steps that were not taken as they came
  int waiting = 0;             ///< bodies that were deferred for want of budget (waiting.h)
  int asleep = 0;              ///< bodies that rest, and were not tested
  int longest_wait = 0;        ///< frames in a row for which a body has been deferred, at most
  int cut_short = 0;           ///< bodies that stayed, because no step of theirs was found open
  /// By how much the momentum of the bodies that move freely differs from what they were given (momentum.h)
  /// [N s].
  double momentum_off_Ns = 0.0;
  bool forced_short = false;  ///< momentum_off_Ns says nothing: some step was cut short of where forces led
  FrictionReport friction;    ///< friction over all patches
  ContactWork work;

  /// Exact tests in all: what the budget bounds.
  int tests() const { return work.exact_tests + validation_tests; }
  bool in_contact() const { return work.patches > 0; }
};

}  // namespace tactum::inline v0_1
