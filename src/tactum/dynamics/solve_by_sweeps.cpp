#include "tactum/dynamics/solve_by_sweeps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using Force = IslandForces::Force;

/// In this part of the sweeps (one in so many) contacts have to open; rows that have not converged by then
/// are wedged.
constexpr int kOpeningShare = 3;

/// In the last sweeps, one in so many of all, friction grows no more with the normal force.
constexpr int kLimitedShare = 6;

/// A sweep has more to change than the one before if the sum of squares grew by this factor: where loads move
/// from contact to contact at a steady rate, the changes stay about the same, and there momentum helps most.
constexpr double kMoreToChange = 1.01;

/// The progress of the sweeps since momentum was last set to zero.
struct Pace {
  double sweeps = 0.0;
  double last_change = 0.0;  // of the forces, squared
};

/// How far the sweeps may still be from the answer, by the largest changes of one window of sweeps and of the
/// one before: what is missing falls from window to window as these do.
class Remainder {
 public:
  void add(double change) {
    peak_ = std::max(peak_, change);
    if (++sweeps_ < kWindow) return;
    const double fall = peak_ / last_peak_;
    remainder_ = fall < 1.0 ? kWindow * peak_ * fall / (1.0 - fall) : kUnbounded;
    last_peak_ = std::exchange(peak_, 0.0);
    sweeps_ = 0;
  }
  double displacement_m() const { return remainder_; }

 private:
  static constexpr int kWindow = 8;
  int sweeps_ = 0;
  double peak_ = 0.0, last_peak_ = kUnbounded, remainder_ = kUnbounded;
};

/// Updates a joint's dry friction, which keeps the joint where it is as far as its bound allows; returns the
/// change of its travel [m or rad].
double relax_joint(Index joint, IslandForces& forces, ContactProblem& problem) {
  const ContactProblem::JointFriction& friction = problem.joint_frictions()[joint];
  const double mobile = mobility(friction.travel);
  if (!(mobile > 0.0)) return 0.0;
  Force& force = forces.joints()[joint];
  const double travel = problem.opening(friction.travel);
  force.now = std::clamp(force.now - travel / mobile, -friction.friction, friction.friction);
  push(friction.travel, force.now - force.before, problem.values());
  return std::abs(force.now - force.before) * mobile;
}

/// Updates a patch's friction: it sticks as far as the normal force allows; returns the largest change of a
/// displacement [m].
double relax_friction(Index number, IslandForces& forces, ContactProblem& problem) {
  const FrictionPatch& patch = forces.patches()[number];
  IslandForces::Friction3& friction = forces.frictions()[number];
  const std::array<Force*, 3> parts = friction.forces();
  const double most = forces.most_friction(number);
  const bool rests = parts[0]->now == 0.0 && parts[1]->now == 0.0 && parts[2]->now == 0.0;
  if ((!(most > 0.0) && rests) || !(friction.mobility > 0.0)) return 0.0;
  const std::array<double, 3> wanted = forces.relaxed(number, most, problem.values());
  const PatchMotion& motion = patch.motion;
  const std::array<const QpRow*, 3> rows{&motion.along, &motion.across, &motion.about};
  double change = 0.0;
  for (Index d = 0; d < 3; ++d) {
    push(*rows[d], wanted[d] - parts[d]->now, problem.values());
    parts[d]->now = wanted[d];
    const double arm = d == 2 ? patch.place.radius_m : 1.0;
    change = std::max(change, std::abs(wanted[d] - parts[d]->before) * mobility(*rows[d]) * arm);
  }
  return change;
}

/// One round of projected Gauss-Seidel; returns the largest change of a displacement.
double sweep(IslandForces& forces, ContactProblem& problem) {
  forces.for_each_force(problem, [](Force& force, const auto&) { force.before = force.now; });
  double change = 0.0;
  for (Index i = 0; i < forces.joints().size(); ++i)
    change = std::max(change, relax_joint(i, forces, problem));
  double* const z = problem.values();
  const std::span<const QpRow> rows = problem.row_list();
  for (Index i = 0; i < rows.size(); ++i) {
    IslandForces::Row& row = forces.rows()[i];
    if (!(row.mobility > 0.0)) continue;
    row.force.now += (rows[i].offset - dot(rows[i], z)) / row.mobility;
    if (i >= problem.equalities()) row.force.now = std::max(0.0, row.force.now);
    if (row.force.now == row.force.before) continue;
    push(rows[i], row.force.now - row.force.before, z);
    change = std::max(change, std::abs(row.force.now - row.force.before) * row.mobility);
  }
  forces.set_loads();
  for (Index i = 0; i < forces.patches().size(); ++i)
    change = std::max(change, relax_friction(i, forces, problem));
  return change;
}

/// Adds momentum from sweep to sweep, a fraction of the last change that grows with their number [Nesterov
/// 1983]; sets it to zero where the last sweep had more to change than the one before [Donoghue 2015]. Forces
/// that overstep their bounds are projected by the next sweep.
void accelerate(Pace& pace, IslandForces& forces, ContactProblem& problem) {
  double change = 0.0;
  forces.for_each_force(problem, [&](Force& force, const auto&) {
    change += (force.now - force.before) * (force.now - force.before);
  });
  if (change > kMoreToChange * pace.last_change) pace.sweeps = 0;
  pace.last_change = change;
  const double share = pace.sweeps / (pace.sweeps + 3.0);
  ++pace.sweeps;
  forces.for_each_force(problem, [&](Force& force, const auto& apply) {
    const double further = share * (force.now - force.swept);
    force.swept = force.now;
    if (further == 0.0) return;
    force.now += further;
    apply(further);
  });
}

void limit_friction(IslandForces& forces) {
  for (Index i = 0; i < forces.patches().size(); ++i)
    if (IslandForces::Friction3& friction = forces.frictions()[i]; friction.load > 0.0)
      friction.most = forces.patches()[i].coefficient * friction.load;
}

}  // namespace

SolverResult begin_by_sweeps(int max_sweeps, IslandForces& forces, ContactProblem& problem) noexcept {
  SolverResult result;
  const double enough = tolerances::kRestingVelocity * forces.step_s();
  Pace pace;
  while (result.iterations < max_sweeps) {
    ++result.iterations;
    result.converged = sweep(forces, problem) <= enough;
    if (result.converged || result.iterations == max_sweeps) break;
    accelerate(pace, forces, problem);
  }
  return result;
}

SolverResult solve_by_sweeps(int max_sweeps, double harmless_m, IslandForces& forces,
                             ContactProblem& problem) noexcept {
  SolverResult result;
  const double enough = forces.settled_m(problem);
  Pace pace;
  Remainder remainder;
  while (result.iterations < max_sweeps) {
    if (result.iterations++ == std::max(1, max_sweeps / kOpeningShare) && forces.close_only(problem)) {
      pace = {};
      remainder = {};
    }
    if (result.iterations == max_sweeps - max_sweeps / kLimitedShare) limit_friction(forces);
    const double change = sweep(forces, problem);
    remainder.add(change);
    result.converged = change <= enough || remainder.displacement_m() <= harmless_m;
    if (change <= enough || result.iterations == max_sweeps) break;
    accelerate(pace, forces, problem);
  }
  return result;
}

}  // namespace tactum::inline v0_1
