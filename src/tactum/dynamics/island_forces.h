#pragma once
/// The forces of the contact problem of one island, as the iterative solvers change them: of every row, of
/// the joints' dry friction, and of every friction patch. A force acts on both of its bodies, so momentum is
/// conserved to rounding however far a solver has come.
///
/// Friction is that of the exact solver (friction.h): a patch for all contacts on one pair of surfaces, at
/// their centre of pressure of the last frame, with its anchor; its force in the surface and its torque about
/// the normal are bounded together by the normal force of the patch's rows.
///
/// Contacts that overlap have to open. If a body is wedged, that makes the rows infeasible, and a solver
/// would press it together ever harder. close_only() takes back what the contacts should open: from then on,
/// and for some time after, they are only kept from closing further.

#include <algorithm>
#include <array>
#include <cstdint>

#include "tactum/base/reserved_vector.h"
#include "tactum/dynamics/friction.h"

namespace tactum::inline v0_1 {

struct RowState {
  std::uint64_t name = 0;  ///< given by the caller; 0 is that of no row
  double force_N = 0.0;    ///< along the normal; not negative [N]
  int closed_frames = 0;   ///< in so many more frames its gap need not open
  int times_wedged = 0;    ///< how often in a row it had no room to open when that was asked of it
};

/// The memory of contact rows from frame to frame, by the rows' names: the last force of each in an island
/// that moves by itself. The exact solver begins with the rows that had one, the others with the forces
/// themselves.
class RowMemory {
 public:
  explicit RowMemory(std::size_t most_rows) {
    last_.reserve(most_rows);
    now_.reserve(most_rows);
  }
  /// Begins a frame.
  void begin() noexcept {
    last_.swap(now_);
    now_.clear();
    next_ = 0;
  }
  /// Gives the next row of this frame the state that the row of the same name had in the last frame, or an
  /// empty one, and returns its number; -1 when there is no room. Rows come in the same order from frame to
  /// frame but for those that come and go. Only the next kLookAhead rows of the last frame are searched: when
  /// more than that go at once, those behind them begin without their forces.
  int recall(std::uint64_t name) noexcept {
    if (now_.size() == now_.capacity()) return -1;
    RowState state{.name = name};
    for (std::size_t ahead = 0; ahead < std::min(kLookAhead, last_.size()); ++ahead) {
      const std::size_t i = (next_ + ahead) % last_.size();
      if (last_[i].name != name) continue;
      next_ = i + 1;
      state = last_[i];
      state.closed_frames = std::max(0, state.closed_frames - 1);
      break;
    }
    now_.push_back(state);
    return static_cast<int>(now_.size()) - 1;
  }
  /// The state that recall() gave this number.
  RowState& operator[](int row) noexcept { return now_[static_cast<std::size_t>(row)]; }
  const RowState& operator[](int row) const noexcept { return now_[static_cast<std::size_t>(row)]; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.last_, self.now_, self.next_);
  }

 private:
  static constexpr std::size_t kLookAhead = 64;

  ReservedVector<RowState> last_, now_;
  std::size_t next_ = 0;  // in last_
};

class IslandForces {
 public:
  IslandForces(std::size_t most_rows, std::size_t bodies);

  /// Takes a problem whose contact rows are `contacts`; their states are in `memory`. The step takes `h`
  /// seconds. All forces become those of the last frame, and the unknowns what these cause.
  void begin(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
             RowMemory& memory, double h, ContactProblem& problem) noexcept;
  /// Sets the rows' impulses and their states.
  void end(std::span<ContactRow> rows, RowMemory& memory) const noexcept;
  /// Stores the anchors. X_WB are the poses at the start of the step.
  void keep_anchors(const RowsInProblem& contacts, std::span<const Pose> X_WB, const ContactProblem& problem,
                    FrictionAnchors& anchors) noexcept;

  /// The patches with friction, and the force in the surface on body_a of each [N].
  std::span<const FrictionPatch> patches() const noexcept { return patches_; }
  Vec3 friction_force(std::size_t patch) const noexcept;
  /// ... and the torque beside it.
  Vec3 friction_torque(std::size_t patch) const noexcept;

  // Of the solvers.
  struct Force {
    double now = 0.0;     ///< [N or N m]
    double before = 0.0;  ///< a solver's: at the start of its round
    double swept = 0.0;   ///< a solver's: at the end of the sweep before
    double begun = 0.0;   ///< when the solver began
  };
  struct Row {
    Force force;
    double mobility = 0.0;  ///< |g|^2 [m/N]
    double opening = 0.0;   ///< how much of the row's offset is there to open a gap [m]
    bool asked = true;      ///< its gap has to open in this frame
    bool wedged = false;    ///< ... and had no room to
    int patch = -1;         ///< of friction
  };
  /// The friction of a patch.
  struct Friction3 {
    Force along, across, about;  ///< [N, N, N m]
    double load = 0.0;           ///< of the patch's rows [N]
    double most = 0.0;           ///< of the force, beside the cone [N]
    /// The largest displacement of the patch for a unit of its force, a turn taken at the patch's radius
    /// [m/N].
    double mobility = 0.0;

    std::array<Force*, 3> forces() noexcept { return {&along, &across, &about}; }
    std::array<double, 3> now() const noexcept { return {along.now, across.now, about.now}; }
    void set(const std::array<double, 3>& force) noexcept {
      along.now = force[0];
      across.now = force[1];
      about.now = force[2];
    }
  };
  std::span<Row> rows() noexcept { return rows_; }
  std::span<const Row> rows() const noexcept { return rows_; }
  std::span<Force> joints() noexcept { return joints_; }
  std::span<Friction3> frictions() noexcept { return frictions_; }
  std::span<const Friction3> frictions() const noexcept { return frictions_; }
  /// Of the step [s].
  double step_s() const noexcept { return h_; }

  /// Calls visit(force, apply) with every force; apply(change) adds what a change causes to the unknowns.
  template <class Visit>
  void for_each_force(ContactProblem& problem, const Visit& visit) noexcept;
  /// The displacement of a patch that friction opposes, in its three directions: along, across, and the turn
  /// about the normal, its anchor's offset added, for the unknowns z [m, m, rad].
  std::array<double, 3> slide(std::size_t patch, const double* z) const noexcept;
  /// The friction of a patch that would move it to where nothing slides, within `most_N`.
  std::array<double, 3> relaxed(std::size_t patch, double most_N, const double* z) const noexcept;
  /// The friction of a patch, where it would be `wanted` without its bound: force and torque use up the bound
  /// together as on an area whose points all slide, an ellipse [N, N, N m].
  std::array<double, 3> bounded(std::size_t patch, const std::array<double, 3>& wanted,
                                double most_N) const noexcept;
  /// The largest friction force of a patch under its present load [N].
  double most_friction(std::size_t patch) const noexcept {
    return std::min(frictions_[patch].most, patches_[patch].coefficient * frictions_[patch].load);
  }
  /// Sets the loads of the patches to the forces of their rows.
  void set_loads() noexcept;
  /// Remembers the forces, for close_only(), and takes the limits of the last solution off friction.
  void begin_solution(ContactProblem& problem) noexcept;
  /// Displacements that differ by less are the same: so little that nothing moves visibly by it, with a part
  /// of the farthest displacement [m].
  double settled_m(const ContactProblem& problem) const noexcept;
  /// How far the forces are from the answer: the changes of displacements if every force were updated for
  /// itself.
  struct Remainder {
    double largest_m = 0.0;
    /// Each is less than settled_m() and tolerances::kNewtonSettled of what forces have displaced the bodies
    /// there.
    bool settled = true;
  };
  /// Sets the loads.
  Remainder remainder(double settled_m, const ContactProblem& problem) noexcept;
  /// Reduces friction to what the loads allow.
  void bound_friction(ContactProblem& problem) noexcept;
  /// Forces go back to what they began with.
  void restart(ContactProblem& problem) noexcept;
  /// Whether some contact that has to open misses most of that.
  bool is_wedged(const ContactProblem& problem) const noexcept;
  /// Contacts need no longer open, and forces go back to what they began with. False when none had to open.
  bool close_only(ContactProblem& problem) noexcept;

 private:
  void make_patches(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
                    ContactProblem& problem) noexcept;

  ReservedVector<Row> rows_;      // as the problem's
  ReservedVector<Force> joints_;  // as its joint frictions
  ReservedVector<FrictionPatch> patches_;
  ReservedVector<Friction3> frictions_;  // as patches_
  ReservedVector<int> order_;            // contact rows by their surfaces; scratch
  std::size_t first_contact_ = 0;
  double h_ = 0.0;  // of the step [s]
};

template <class Visit>
void IslandForces::for_each_force(ContactProblem& problem, const Visit& visit) noexcept {
  double* const z = problem.values();
  const std::span<const QpRow> rows = problem.row_list();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const QpRow& travel = problem.joint_frictions()[i].travel;
    visit(joints_[i], [&](double f) { push(travel, f, z); });
  }
  for (std::size_t i = 0; i < rows_.size(); ++i)
    visit(rows_[i].force, [&](double f) { push(rows[i], f, z); });
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    const PatchMotion& motion = patches_[i].motion;
    visit(frictions_[i].along, [&](double f) { push(motion.along, f, z); });
    visit(frictions_[i].across, [&](double f) { push(motion.across, f, z); });
    visit(frictions_[i].about, [&](double f) { push(motion.about, f, z); });
  }
}

}  // namespace tactum::inline v0_1
