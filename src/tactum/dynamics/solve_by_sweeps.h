#pragma once
/// The solver of the contact problem for any number of bodies: projected Gauss-Seidel from the last frame's
/// forces [Stewart 1996], with momentum from sweep to sweep [Nesterov 1983; Mazhar 2015]: plain sweeps carry
/// a load through a stack of ten boxes too slowly. A force acts on both bodies, so momentum is conserved to
/// rounding however few sweeps there were; the sweeps reduce how far contacts close too much. A heap at rest
/// begins at its answer and stays there.
///
/// Friction is that of the exact solver (friction.h): a patch for all contacts on one pair of surfaces, at
/// their centre of pressure of the last frame, with its anchor; its force in the surface and its torque about
/// the normal are bounded together by the normal force of the patch's rows.
///
/// Contacts that overlap have to open. If a body is wedged, that makes the rows infeasible, and each sweep
/// would add as much to the forces as the one before. A problem whose sweeps have not converged after a third
/// of their number is therefore set back to the forces it began with; from then on, and for some time after,
/// its contacts are only kept from closing further. Where friction makes forces grow from sweep to sweep, it
/// may not exceed its last value in the last sweeps.

#include "tactum/dynamics/friction.h"
#include "tactum/dynamics/row_memory.h"

namespace tactum::inline v0_1 {

class Sweeps {
 public:
  Sweeps(std::size_t most_rows, std::size_t bodies);

  /// Takes a problem whose contact rows are `contacts`; their states are in `memory`. The step takes `h`
  /// seconds.
  void begin(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
             RowMemory& memory, double h, ContactProblem& problem) noexcept;
  /// Makes a contact close by `by_m` less.
  void tighten(std::size_t contact, double by_m, ContactProblem& problem) noexcept;
  /// Makes at most `max_sweeps` sweeps; may be called again after tighten(). They have converged when the
  /// last one changed no displacement by more than `harmless_m`, with friction bounded as in the last sweeps;
  /// sweeps go on until changes are far smaller.
  SolverResult solve(int max_sweeps, double harmless_m, ContactProblem& problem) noexcept;
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

 private:
  /// A force from sweep to sweep.
  struct Force {
    double now = 0.0, before = 0.0, swept = 0.0, begun = 0.0;
  };
  struct Row {
    Force force;
    double mobility = 0.0;  // |g|^2 [m/N]
    double opening = 0.0;   // how much of the row's offset is there to open a gap [m]
    bool wedged = false;    // it had to open, and had no room to
    int patch = -1;         // of friction
  };
  struct Friction3 {
    Force along, across, about;  // [N, N, N m]
    double load = 0.0;           // of the patch's rows, in this sweep [N]
    double most = 0.0;           // of the force, beside the cone [N]
  };
  /// The progress of the sweeps since momentum was last set to zero.
  struct Pace {
    double sweeps = 0.0;
    double last_change = 0.0;  // of the forces, squared
  };

  void make_patches(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
                    ContactProblem& problem) noexcept;
  double sweep(ContactProblem& problem) noexcept;
  double relax_joint(std::size_t joint, ContactProblem& problem) noexcept;
  double relax_friction(std::size_t number, ContactProblem& problem) noexcept;
  bool close_only(ContactProblem& problem) noexcept;
  void limit_friction() noexcept;
  void accelerate(Pace& pace, ContactProblem& problem) noexcept;
  template <class Visit>
  void for_each_force(ContactProblem& problem, const Visit& visit) noexcept;

  ReservedVector<Row> rows_;      // as the problem's
  ReservedVector<Force> joints_;  // as its joint frictions
  ReservedVector<FrictionPatch> patches_;
  ReservedVector<Friction3> frictions_;  // as patches_
  ReservedVector<int> order_;            // contact rows by their surfaces; scratch
  std::size_t first_contact_ = 0;
  double h_ = 0.0;  // of the step [s]
};

}  // namespace tactum::inline v0_1
