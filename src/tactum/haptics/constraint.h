#pragma once
/// The `constraint` response: the held part is a god-object with six degrees of freedom that goes where the
/// hand wants it as far as nothing is entered [Zilles 1995; Ortega 2007].
///
///     rows: every corner of every patch  ->  nearest displacement  ->  scaled to the trusted length
///        ^                                                                       |
///        '-- exact gaps at the new pose are fed back, the step halved <-- is every gap open there? --> go
///
/// A pose is only taken when the exact distance of every near pair of pieces has been computed there and is
/// open: linear rows alone would let a turning part in. Each remedy here was a failure first, see
/// docs/algorithms/constraint_response.md. Cost: 1-2 us for a peg in its hole.

#include <vector>

#include "tactum/contact/contact_finder.h"
#include "tactum/contact/patch_corners.h"
#include "tactum/haptics/constraint_problem.h"
#include "tactum/haptics/frame_report.h"
#include "tactum/haptics/friction.h"
#include "tactum/haptics/friction_use.h"
#include "tactum/haptics/step_input.h"

namespace tactum {

class ConstraintResponse;
struct ConstraintStep;

/// What the response keeps from frame to frame, and its scratch, allocated at load time.
struct ConstraintState {
  ConstraintState(const World& world, const FrameSettings& settings);

  ConstraintProblem problem;  ///< of the forces, and of the way unless normals are shaded
  ConstraintProblem way;      ///< where they are: to where the forces would have it
  Friction friction;
  double skin_m;               ///< the gap contacts are held at [m]
  double trust_m;              ///< how far a point of a body may move in the next frame [m]
  Vec6 wanted;                 ///< what the coupling asked of the handle [m, rad]
  int stood = 0;               ///< frames on end in which no step could be taken [-]
  Wrench felt;                 ///< of the contact forces, at the handle, world axes [N, N m]
  FrictionUses friction_uses;  ///< what friction does, for displays
  /// Names of the rows that held last: in the end, without friction, and while every patch stuck. The next
  /// frame's problems begin with them.
  StaticVector<std::uint64_t, kMostUnknowns> held, held_without_friction, held_sticking;
  CornerMemory corner_memory;

  // Scratch of one frame.
  std::size_t own_rows = 0;          ///< the first so many contact rows are the problem's
  std::size_t first_row = 0;         ///< of them, in the problem
  bool bent = false;                 ///< some normal is bent by shading
  bool shades = false;               ///< ... so the step is that of `way`
  std::vector<Vec3> shaded;          ///< normals of the own rows; empty without shading [-]
  std::vector<std::uint64_t> names;  ///< of the rows
  std::vector<double> feedback;      ///< what exact gaps have added to the rows [m]
  std::vector<Pose> X_WB_trial;
  std::vector<double> gap, gap_trial;  ///< of the patches: now, and at the trial [m]
  std::vector<double> gap_least;       ///< what they may become [m]
  std::vector<GapAnswer> gap_answer;   ///< how the trial's are known

  /// The problem whose answer is the step.
  ConstraintProblem& moves() { return shades ? way : problem; }
  const ConstraintProblem& moves() const { return shades ? way : problem; }
};

/// How far points may move in the frame: the trusted length for the held part and, on top of their own way,
/// for what it may push. Fills own.reach.
void trusted_reach(const MotionInput& input, const WorldState& bodies, ConstraintResponse& own) noexcept;

/// Asks for the gaps at the trial of the patches that FreeBodies::patch_asked names, as long as more than
/// `keep_back` tests are left.
void look_at_trial(int keep_back, ConstraintStep& step) noexcept;
/// Whether the gap of a patch that was asked for is open at the trial.
bool open_at_trial(std::size_t patch, const ConstraintState& c) noexcept;

/// Moves everything that moves, the held part's island last. Fills the contact rows, the felt wrench and
/// the report's response fields.
void respond_constrained(ConstraintStep& step) noexcept;

}  // namespace tactum
