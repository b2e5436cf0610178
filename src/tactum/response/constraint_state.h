#pragma once
/// The memory of the constraint response and what it works on, allocated at load time: a struct for each of
/// its parts, and the step that is being made. The functions stand in the parts' own headers.

#include <vector>

#include "tactum/base/grouped_indices.h"
#include "tactum/base/reserved_vector.h"
#include "tactum/contact/gap_oracle.h"
#include "tactum/contact/patch_corners.h"
#include "tactum/dynamics/friction_planes.h"
#include "tactum/dynamics/impacts.h"
#include "tactum/dynamics/islands.h"
#include "tactum/dynamics/solve_by_newton.h"
#include "tactum/dynamics/solver_choice.h"
#include "tactum/response/contact_force.h"
#include "tactum/response/frame_report.h"
#include "tactum/response/friction_use.h"
#include "tactum/response/impulse_display.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// The names of rows that were active in the last frame's answers: the next frame's problems begin with them.
struct WarmStart {
  StaticVector<std::uint64_t, kMostUnknowns> in_the_end;        ///< of the answer that was used
  StaticVector<std::uint64_t, kMostUnknowns> without_friction;  ///< before friction had cones
  StaticVector<std::uint64_t, kMostUnknowns> sticking;          ///< while every patch stuck
};

/// The contact rows of the frame, and those of the grasped part's island as rows of its problem; scratch of
/// one frame but for the memory.
struct CornerRows {
  std::size_t count = 0;               ///< contact rows of all islands, before friction's are appended
  std::size_t own = 0;                 ///< the first so many of them are those of the grasped part's island
  std::size_t first = 0;               ///< number of the first own row in the problem of the forces
  std::size_t first_of_positions = 0;  ///< ... and in the position problem, without rows of joint friction
  bool bent = false;                   ///< some normal is bent by shading
  bool shades = false;                 ///< ... so the step is the answer of the position problem
  ReservedVector<Vec3> shaded;      ///< the own rows' other normals (exchange_normals); empty without shading
  RowMemory memory;                 ///< what rows keep from frame to frame, by their names
  ReservedVector<double> feedback;  ///< of each own row, what exact gaps have added to its offset so far [m]

  explicit CornerRows(std::size_t most_rows) : memory(most_rows) {
    shaded.reserve(most_rows);
    feedback.reserve(most_rows);
  }
  /// The name that a row keeps from frame to frame; 0 when it has none. Two rows may have the same name, see
  /// constraint_rows.cpp.
  std::uint64_t name_of(const ContactRow& row) const noexcept {
    return row.state < 0 ? 0 : memory[row.state].name;
  }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.count, self.own, self.first, self.first_of_positions, self.bent, self.shades, self.memory);
  }
};

/// A pose on trial, and the gaps of the patches there; scratch of one frame, an entry per body or patch. Both
/// the grasped part's island and the free ones use it, one after the other; FreeBodies::patch_asked names the
/// patches whose gaps are looked at.
struct TrialPose {
  std::vector<Pose> X_WB;          ///< where the bodies would be; after a step was taken, where they were [m]
  ReservedVector<double> gap_now;  ///< before the step; after one was taken, as it was found there [m]
  ReservedVector<double> gap;      ///< at the trial [m]
  ReservedVector<double> gap_least;      ///< the least gap that is accepted at the trial [m]
  ReservedVector<GapAnswer> gap_answer;  ///< how the gap at the trial is known
  // Of each body: whether it is on its path to the trial, how it turns on it, and the fraction of that path
  // that is proven free [-].
  std::vector<char> goes;
  std::vector<BodyTurn> turn;
  std::vector<double> path_free;
  bool path_unproven = false;  ///< ... for want of tests some of it was tested at its end only
};

/// How far the island's steps are trusted, from the outcome of the last ones.
struct StepTrust {
  double length_m = 0.0;           ///< the trust region radius of the next frame [m]
  std::uint32_t limit = 0;         ///< frame_flag of the limit that it has reached; 0: it may grow
  bool unproven = false;           ///< a path of this frame was tested at its end only
  bool looks_between = false;      ///< one of the last frame was: steps are tested on the way as well
  int consecutive_rejections = 0;  ///< frames in a row in which no step could be taken [-]
};

/// Of a hand and its coupling to the part that it holds.
struct CoupledHand {
  Vec6 wanted = Vec6::Zero();  ///< displacement of the handle that the coupling asks for, world axes [m, rad]
  Wrench felt;  ///< of contacts, weight and fields on the grasped part, at the handle, world axes [N, N m]
  ImpulseDisplay impulses;  ///< impacts on the grasped part that are being felt
  /// Of friction about normals on the grasped part, where its island is moved as a free one [N m].
  Vec3 torque = Vec3::Zero();
  Wrench hit;           ///< the impulse of this frame's impacts, at the handle, world axes [N s, N m s]
  bool is_hit = false;  ///< there was one
  int body = -1;        ///< that was grasped in the last frame
};

/// Of the island of the grasped parts (constraint.h). The free islands, which are solved before it in every
/// frame, use its `problem`, `friction` and `trial` as scratch, and its anchors, row memory and lengths as
/// their own.
struct ConstraintState {
  ConstraintState(const World& world, const FrameSettings& settings);

  ContactProblem problem;           ///< of the forces, and of the positions unless normals are shaded
  ContactProblem position_problem;  ///< with true normals: to where the forces would have the bodies
  Friction friction;
  FrictionAnchors anchors;
  FrictionPlanes planes;
  FrictionUses friction_uses;  ///< friction at each patch, for displays
  std::vector<double> skin_m;  ///< of each body that moves, by its size; see skin_of() [m]
  double opening_share;        ///< fraction of the depth below the skin that is opened in a step [-]
  StepTrust trust;
  std::vector<CoupledHand> hands;  ///< in the order of MotionInput::hands
  WarmStart warm_start;
  CornerMemory corner_memory;
  CornerRows rows;
  TrialPose trial;

  /// The gap at which the contacts of a pair are kept: by the larger of the two that move [m].
  double skin_of(const ContactPatch& patch) const noexcept {
    return std::max(skin_m[static_cast<std::size_t>(patch.body_a)],
                    skin_m[static_cast<std::size_t>(patch.body_b)]);
  }
  /// The problem whose answer is the step.
  ContactProblem& step_problem() { return rows.shades ? position_problem : problem; }
  const ContactProblem& step_problem() const { return rows.shades ? position_problem : problem; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.anchors, self.friction_uses, self.trust, self.hands, self.warm_start, self.rows);
  }
};

/// The balance of momentum (momentum.h); scratch of one frame.
struct Momentum {
  explicit Momentum(const World& world) : counts(world.bodies.size(), 0) {}

  /// `impulse` acts on body_a, its opposite on body_b [N s].
  void give(int body_a, int body_b, const Vec3& impulse) noexcept {
    due_Ns += counted(body_a, body_b, impulse);
  }
  /// The part of it that counted bodies receive from bodies that are not counted [N s].
  Vec3 counted(int body_a, int body_b, const Vec3& impulse) const noexcept {
    const bool a = counts[static_cast<std::size_t>(body_a)] != 0;
    const bool b = counts[static_cast<std::size_t>(body_b)] != 0;
    if (a == b) return Vec3::Zero();
    return a ? impulse : Vec3(-impulse);
  }

  std::vector<char> counts;    ///< bodies that are free, awake, not damped and not grasped
  Vec3 due_Ns = Vec3::Zero();  ///< momentum that they should have at the end of the frame
};

/// Of the bodies that move by themselves (free_bodies.h).
struct FreeBodies {
  FreeBodies(const World& world, const FrameSettings& settings);

  Islands islands;
  IslandForces forces;  ///< of the island that the iterative solvers work on
  NewtonSolver newton;
  Momentum momentum;
  int grasped_island = -1;    ///< the island that constraint.h, or the penalty response, moves; -1: none
  bool grasped_here = false;  ///< the grasped part's island is too large for constraint.h
  bool others = false;        ///< some body moves by itself
  bool alone = true;          ///< nothing but the grasped part's island moves
  /// Of each body, whether it is in the grasped part's island, the grasped part included: that of the last
  /// frame until find_islands(), of this frame from then on.
  std::vector<char> near_grasped;

  /// Of each body, whether the forces of its last step are not the answer, because the solver ran out of
  /// iterations: what stands still by them need not be at rest.
  std::vector<char> unconverged;
  std::vector<char> joined;  ///< of each body, whether a pair joint joins it to another
  /// Of each body, the displacement that impacts add to its velocity's in this frame (impacts.h); at the end
  /// of a frame what is left of its displacement, for the next one [m, rad].
  std::vector<Twist> detour;
  /// Of each body, what contacts added to its twist in a second, in the last frame [m/s2, rad/s2].
  std::vector<Twist> A_contacts;

  /// Whether a patch belongs to the island of the grasped part that is not moved here.
  bool of_grasped(const ContactPatch& patch) const noexcept {
    return grasped_island >= 0 &&
           (islands.of(patch.body_a) == grasped_island || islands.of(patch.body_b) == grasped_island);
  }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.islands, self.grasped_island, self.grasped_here, self.others, self.alone, self.near_grasped,
          self.unconverged, self.detour, self.A_contacts);
  }

  // Scratch of one frame, one entry per body, or per patch.
  std::vector<char> struck;     ///< impacts may change its velocity
  std::vector<char> hit;        ///< ... and one did
  std::vector<Twist> V_free;    ///< if nothing touches [m/s, rad/s]
  std::vector<Twist> A_free;    ///< what adds to the twist that impacts see in a second [m/s2, rad/s2]
  std::vector<Twist> A_seen;    ///< ... and the part of resting contacts in it [m/s2, rad/s2]
  std::vector<Twist> V_seen;    ///< the twist at the start that impacts see [m/s, rad/s]
  std::vector<Vec3> given_Ns;   ///< by island: the momentum that contacts gave counted bodies [N s]
  GroupedIndices bodies, rows;  ///< by island
  ReservedVector<ContactRow> gathered;  ///< copies of the rows of one island
  std::vector<Vec3> w_start;            ///< rates at the start [rad/s]
  std::vector<Vec3> w_free;             ///< ... midway, if nothing touches [rad/s]
  std::vector<double> share;            ///< fraction of a body's step that is taken [-]
  std::vector<char> cut;                ///< its fraction was just reduced
  std::vector<char> settled;            ///< an island's step has been found open
  ReservedVector<char> patch_asked;     ///< patches whose gap is asked for, in either kind of island
  ReservedVector<char> patch_closed;    ///< ... and is not open
  ReservedVector<char> patch_passed;    ///< the bodies slide by each other there (frame_impacts.cpp)
};

/// Which bodies are deferred (waiting.h); one entry per body.
struct Waiting {
  Waiting(const World& world, const FrameSettings& settings);

  std::vector<char> waits;            ///< deferred in this frame
  std::vector<int> waited;            ///< deferred for so many frames in a row [-]
  std::vector<double> travel;         ///< of the last step it took or tried [m]
  std::vector<Pose> X_rest;           ///< the place it has hardly left
  std::vector<int> rested;            ///< frames that it moved in since [-]
  std::vector<int> contacts_at_rest;  ///< of those that sleep; 0: awake [-]
  int rounds = 2;                     ///< tests that a gap on trial is expected to take [-]
  bool ran_out = false;               ///< some gap of a pose on trial stayed unknown in this frame

  // Scratch of one frame.
  std::vector<Twist> V_kept;  ///< velocities at the end of the last frame [m/s, rad/s]
  ReservedVector<int> order, first_patch, next_patch, patch_of;
  ReservedVector<char> counted;  ///< of each patch
  std::vector<int> contacts;     ///< patches of each body
  std::vector<char> hit;         ///< touched by something fast

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.waits, self.waited, self.travel, self.X_rest, self.rested, self.contacts_at_rest, self.rounds,
          self.ran_out);
  }
};

/// Which bodies sleep (sleep.h); one entry per body.
struct Sleep {
  explicit Sleep(const World& world);

  std::vector<Pose> X_still;   ///< the place it has not left
  std::vector<int> still;      ///< frames since it came there [-]
  std::vector<int> touched;    ///< patches in the last frame [-]
  std::vector<int> touches;    ///< ... and now [-]
  Islands islands;             ///< by this frame's patches, asleep or not
  std::vector<char> restless;  ///< of islands

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.X_still, self.still, self.touched, self.touches, self.islands, self.restless);
  }
};

/// Everything that the constraint response keeps from frame to frame. Its parts depend on each other: a step
/// of one is made while the others' states are known (ConstraintStep).
struct ConstraintMemory {
  ConstraintMemory(const World& world, const FrameSettings& settings);

  ConstraintState constraint;  ///< the island of the grasped part (constraint.h)
  FreeBodies free;             ///< the other islands (free_bodies.h)
  Waiting waiting;             ///< waiting.h
  Sleep sleep;                 ///< sleep.h
  ContactRows contact_rows;
  ImpactScratch impact_scratch;
  std::vector<double> motion_bound;  ///< by body: how far it may move [m]

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.constraint, self.free, self.waiting, self.sleep, self.contact_rows, self.motion_bound);
  }
};

/// One step while it is made: its inputs, the gap oracle, and the states that it changes.
struct ConstraintStep : StepInput {
  /// The grasped part's contacts are springs of the penalty response: it joins no island, and its contacts
  /// have no rows here.
  bool grasped_yields = false;
  GapOracle& gaps;
  WorldState& bodies;     ///< the poses and velocities of all bodies
  ConstraintMemory& own;  ///< the memory of the response
  FrameReport& report;
  std::span<HandReport> other_reports = {};  ///< of the second hand and all after it

  /// What is reported of a hand.
  HandReport& report_of(std::size_t hand) const noexcept {
    return hand == 0 ? report : other_reports[hand - 1];
  }
};

/// Whether some hand holds a body.
inline bool is_grasped(const ConstraintStep& step, std::size_t body) noexcept {
  return is_grasped(step.hands, body);
}

/// The body that the first hand that holds one holds; -1: none.
inline int first_grasped(std::span<const HandInput> hands) noexcept {
  for (const HandInput& hand : hands)
    if (hand.grasped.body >= 0) return hand.grasped.body;
  return -1;
}

/// Whether the contact finder has left a pair of a grasped part unproven: then that must not move.
inline bool grasped_blocked(const ConstraintStep& step) noexcept {
  for (const HandInput& hand : step.hands)
    if (hand.grasped.body >= 0 && step.gaps.blocked(hand.grasped.body)) return true;
  return false;
}

}  // namespace tactum::inline v0_1
