#pragma once
/// The solver of the contact problem for islands of many bodies through which loads pass far: towers, rows of
/// parts that are pushed, heaps on a slope. Where sweeps come nearer by a little each, it solves for all
/// bodies at once.
///
/// It is the method of multipliers [Rockafellar 1976; Alart and Curnier 1991]. A row with the multiplier u
/// pushes with  max(0, u + s / R),  where s is the length by which it is missed and R a compliance that is
/// far below that of its bodies; a patch's friction is the nearest to  u - slide / R  within its bound, which
/// is mu times the load of the round before. For given multipliers the unknowns are the least of a convex
/// function that is quadratic while the same rows push, found by Newton's method with a search along each
/// step; then every multiplier becomes its force, and what is missed falls by the ratio of the compliances.
///
/// From the first answer to the stiff problem on, the bounds of friction are those of the loads at the point
/// itself, as the bounds of a round before would leave a row of bodies that is pushed with friction beyond
/// its bound, and what takes it away turns the bodies. The step then contains what a patch that slides
/// changes with its load [Alart and Curnier 1991], which is not symmetric (math/envelope_lu.h). It is taken
/// while it reduces what is left of the gradient; else a step with the bounds as they are.
///
/// A step takes a factor of  I + sum g g^T / R,  whose size is the freedom of the bodies. Bodies are put in
/// an order that keeps those that touch together (math/unknowns_order.h), so that a tower of n bodies takes
/// work in proportion to n. What a wide heap would take is known beforehand: the caller compares it with
/// sweeps.

#include "tactum/dynamics/island_forces.h"
#include "tactum/math/envelope_cholesky.h"
#include "tactum/math/envelope_lu.h"
#include "tactum/math/unknowns_order.h"

namespace tactum::inline v0_1 {

class NewtonSolver {
 public:
  /// R, as parts of the mobility of a row's bodies and of a patch's.
  struct Compliances {
    double rows, friction;
  };

  NewtonSolver(std::size_t most_rows, std::size_t bodies);

  /// Orders the bodies of a problem. False when it takes more room than there is; then solve() may not be
  /// called.
  bool begin(const IslandForces& forces, const ContactProblem& problem) noexcept;
  /// How many sweeps take as long as one round of the method, by counts of multiplications.
  double sweeps_per_round() const noexcept { return sweeps_per_round_; }

  struct Result : SolverResult {
    /// The last round's displacements are within `harmless_m` of an answer.
    bool usable = false;
  };
  /// Takes no longer than so many sweeps. The forces have converged when they are settled
  /// (IslandForces::Remainder).
  Result solve(int max_sweeps, double harmless_m, IslandForces& forces, ContactProblem& problem) noexcept;

 private:
  /// Of a row, or of a joint's dry friction. A part t of the step closes t times what a whole step does.
  struct Term {
    double multiplier = 0.0;         ///< u [N or N m]
    double missing = 0.0;            ///< s, offset - g z; of friction, minus the slide [m or rad]
    double closes = 0.0;             ///< by how much less is missing after a whole step [m or rad]
    double compliance = 0.0;         ///< R; 0: nothing can move along it [m/N or rad/(N m)]
    double least = 0.0, most = 0.0;  ///< of the force [N or N m]

    double wanted(double t) const noexcept { return multiplier + (missing - t * closes) / compliance; }
    double force(double t) const noexcept { return std::clamp(wanted(t), least, most); }
  };
  struct PatchTerm {
    std::array<Term, 3> parts;  ///< along, across and about; without bounds of their own
    double most = 0.0;          ///< of the force, in this round [N]

    std::array<double, 3> wanted(double t) const noexcept;
  };

  void set_multipliers(const Compliances& compliances, IslandForces& forces,
                       const ContactProblem& problem) noexcept;
  void measure(const IslandForces& forces, const ContactProblem& problem) noexcept;
  void apply_forces(IslandForces& forces, ContactProblem& problem) noexcept;
  double set_gradient(const IslandForces& forces, const ContactProblem& problem) noexcept;
  double residual() const noexcept;
  void add_to_matrix(const QpRow& row, double weight) noexcept;
  void add_to_matrix(const FrictionPatch& patch, const PatchTerm& term) noexcept;
  bool add_slope_of_bounds(const IslandForces& forces, const ContactProblem& problem) noexcept;
  void set_matrix(const IslandForces& forces, const ContactProblem& problem) noexcept;
  template <class Factor>
  void find_step(const Factor& factor, const IslandForces& forces, const ContactProblem& problem) noexcept;
  bool go_with_bounds(double& left, IslandForces& forces, ContactProblem& problem) noexcept;
  bool go_to_least(const IslandForces& forces, const ContactProblem& problem) noexcept;
  double length_of_step(const IslandForces& forces) const noexcept;
  double slope_at(double t, const IslandForces& forces) const noexcept;
  void go(double t) noexcept;

  UnknownsOrder order_;
  EnvelopeCholesky factor_;
  EnvelopeLu factor_with_bounds_;
  bool bounds_follow_ = false;  // the bounds of friction are those of the loads at the point
  double sweeps_per_round_ = 0.0;
  ReservedVector<Term> terms_;  // of the rows, then of the joints' friction
  ReservedVector<PatchTerm> patches_;
  ReservedVector<double> z_, step_, gradient_, scratch_;  // z_: the point
};

}  // namespace tactum::inline v0_1
