#include "tactum/dynamics/solve_by_newton.h"

#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using std::uint32_t;
constexpr Index kMostOfBody = ContactProblem::kMostOfBody, kRoomBehind = ContactProblem::kRoomBehind;

/// Room of the factor. What takes more is more work than sweeps.
constexpr Index kMostEntries = Index{1} << 18;

/// The compliances. What is missed falls by R over the compliance of what carries the load, which for a tower
/// of ten that leans is a thousandth of a plate's: so it takes stiff rows to be sure of an answer.
constexpr double kStiffShare = 1.0 / 10000.0;
constexpr NewtonSolver::Compliances kStiff{kStiffShare, 100.0 * kStiffShare};
/// From an answer that is near, as that of the last frame, few steps of the stiff problem lead to its own;
/// from others a soft one leads to the right rows in fewer steps, and falls from one round of multipliers to
/// the next.
constexpr NewtonSolver::Compliances kSoft{100.0 * kStiffShare, 1000.0 * kStiffShare};
constexpr double kFall = 0.1;
constexpr int kStiffRounds = 4;

/// Costs in multiplications: of a term in a sweep, where each waits for the one before, of a term of the
/// matrix, and how many of the factor's take as long as one of these, since they stand in lanes. Seen: a
/// round of a tower of ten takes 5.1 sweeps where these say 4.7.
constexpr double kSweepOfTerm = 40.0, kMatrixOfTerm = 100.0, kFactorLanes = 4.0;

/// The unknowns are the least for their multipliers when they are as near to what the forces cause as this
/// part of what is still to change.
constexpr double kInnerShare = 0.25;

/// What is missing counts as still when a round of multipliers leaves more than this part of it. Contacts and
/// friction that sticks then ask for motions that do not fit together, as four corners of a cube on a floor
/// and the friction of its neighbours do; it is no error where it is less than this part of what is harmless.
constexpr double kStill = 0.5, kUnfit = 1.0 / 1000.0;

/// A light body that carries heavy ones passes their load on, so a row's compliance is that of the heaviest
/// body of the island where this is lower: so many times what a force at the centre of mass moves that one,
/// several times what a force at a corner does, but not below the given part of the row's own.
constexpr double kCornerMobility = 60.0, kLeastOfOwn = 1.0 / 100.0;

/// What a round without a step takes, in sweeps.
constexpr double kSweepsWithoutStep = 2.0;

/// The last rounds are not begun when there is no time for so many and the answer is near.
constexpr double kLastRounds = 5.0;

/// So many rounds follow the first that has converged, unless nothing is left to change: what rests comes to
/// rest to the last digit by them, and what slides may never.
constexpr int kMostPolished = 3;

/// A step is as long as the function falls along it, to this part of its slope at the start.
constexpr double kFlat = 0.1;
constexpr int kMostSlopes = 20;
/// A trial of its length is no nearer to either end of where that must be than this part of it.
constexpr double kTrialMargin = 0.1;

/// How often a step whose bounds of friction follow is halved before it is given up.
constexpr int kMostBacktracks = 1;

std::array<const QpRow*, 3> rows_of(const FrictionPatch& patch) {
  return {&patch.motion.along, &patch.motion.across, &patch.motion.about};
}

/// The arm with which a direction's force counts: a torque acts at the patch's radius.
double arm_of(const FrictionPatch& patch, Index direction) {
  return direction == 2 ? patch.place.radius_m : 1.0;
}

/// How much of its bound a patch would need for a friction of so much [N].
double used_of(const FrictionPatch& patch, const std::array<double, 3>& wanted) {
  const double radius = patch.place.radius_m;
  return std::hypot(wanted[0], wanted[1], radius > 0.0 ? wanted[2] / radius : 0.0);
}

/// The motion of a patch along what it wants, as one row.
QpRow direction_of(const FrictionPatch& patch, const std::array<double, 3>& wanted, double used) {
  QpRow along = patch.motion.along;
  const std::array<double, 3> share{wanted[0] / used, wanted[1] / used, wanted[2] / used};
  for (Index side = 0; side < 2; ++side)
    for (Index i = 0; i < along.runs[side].count; ++i) {
      double sum = 0.0;
      for (Index d = 0; d < 3; ++d) sum += share[d] * rows_of(patch)[d]->runs[side].g[i];
      along.runs[side].g[i] = sum;
    }
  return along;
}

/// How far a unit of force moves the heaviest of the free bodies [m/N].
double least_mobility(const ContactProblem& problem) {
  double least = kUnbounded;
  for (const ProblemBody& body : problem.bodies())
    if (body.rank == 6) least = std::min(least, body.per_displacement * body.per_displacement);
  return least;
}

/// The row of a term: those of joints' friction follow those of the problem.
const QpRow& row_of_term(Index term, const ContactProblem& problem) {
  const std::span<const QpRow> rows = problem.row_list();
  return term < rows.size() ? rows[term] : problem.joint_frictions()[term - rows.size()].travel;
}

}  // namespace

std::array<double, 3> NewtonSolver::PatchTerm::wanted(double t) const noexcept {
  std::array<double, 3> force{};
  for (Index d = 0; d < 3; ++d) force[d] = parts[d].compliance > 0.0 ? parts[d].wanted(t) : 0.0;
  return force;
}

NewtonSolver::NewtonSolver(std::size_t most_rows, std::size_t bodies)
    : order_(most_rows + (ContactProblem::kJointRows + 1) * bodies, bodies + 1, kMostOfBody * bodies),
      factor_(kMostOfBody * bodies,
              std::min(kMostEntries, kMostOfBody * bodies * (kMostOfBody * bodies + 1) / 2)),
      factor_with_bounds_(kMostOfBody * bodies,
                          std::min(kMostEntries, kMostOfBody * bodies * (kMostOfBody * bodies + 1) / 2)) {
  terms_.reserve(most_rows + (ContactProblem::kJointRows + 1) * bodies);
  patches_.reserve(most_rows);
  for (ReservedVector<double>* const v : {&z_, &step_, &gradient_, &scratch_})
    v->reserve(kMostOfBody * bodies + kRoomBehind);
}

bool NewtonSolver::begin(const IslandForces& forces, const ContactProblem& problem) noexcept {
  const Index terms = problem.rows() + problem.joint_frictions().size();
  order_.begin();
  // The unknowns from one body to the next, with those of joints between the two.
  Index first = 0;
  for (const ProblemBody& body : problem.bodies()) {
    if (body.first > first && body.rank > 0) order_.add_segment(body.first - first);
    if (body.rank > 0) first = body.first;
  }
  if (problem.unknowns() > first) order_.add_segment(problem.unknowns() - first);
  for (Index i = 0; i < terms; ++i) order_.connect(row_of_term(i, problem));
  for (const FrictionPatch& patch : forces.patches()) order_.connect(patch.motion.along);
  if (!order_.find() || !factor_.begin(order_.envelope())) return false;
  const double all = std::max(1.0, static_cast<double>(terms + 3 * forces.patches().size()));
  sweeps_per_round_ =
      kSweepsWithoutStep + (kMatrixOfTerm + factor_.multiplications() / kFactorLanes / all) / kSweepOfTerm;
  return true;
}

/// The multipliers become the forces, and the bounds of friction follow the loads.
void NewtonSolver::set_multipliers(const Compliances& compliances, IslandForces& forces,
                                   const ContactProblem& problem) noexcept {
  forces.set_loads();
  const double of_heaviest = kCornerMobility * least_mobility(problem);
  const auto scale = [&](double own) { return std::clamp(of_heaviest, kLeastOfOwn * own, own); };
  for (Index i = 0; i < terms_.size(); ++i) {
    Term& term = terms_[i];
    if (i < problem.rows()) {
      const IslandForces::Row& row = forces.rows()[i];
      term.multiplier = row.force.now;
      term.compliance = compliances.rows * scale(row.mobility);
      term.least = i < problem.equalities() ? -kUnbounded : 0.0;
      term.most = kUnbounded;
    } else {
      const Index joint = i - problem.rows();
      const ContactProblem::JointFriction& friction = problem.joint_frictions()[joint];
      term.multiplier = forces.joints()[joint].now;
      term.compliance = compliances.rows * mobility(friction.travel);
      term.least = -friction.friction;
      term.most = friction.friction;
    }
  }
  for (Index i = 0; i < patches_.size(); ++i) {
    const IslandForces::Friction3& friction = forces.frictions()[i];
    for (Index d = 0; d < 3; ++d) {
      Term& part = patches_[i].parts[d];
      const double arm = arm_of(forces.patches()[i], d);
      part.multiplier = friction.now()[d];
      part.compliance = arm > 0.0 ? compliances.friction * scale(friction.mobility) / (arm * arm) : 0.0;
    }
    patches_[i].most = forces.most_friction(i);
  }
}

/// Sets what is missing at the point.
void NewtonSolver::measure(const IslandForces& forces, const ContactProblem& problem) noexcept {
  const double* const z = z_.data();
  for (Index i = 0; i < terms_.size(); ++i) {
    const QpRow& row = row_of_term(i, problem);
    terms_[i].missing = row.offset - dot(row, z);
  }
  for (Index i = 0; i < patches_.size(); ++i) {
    const std::array<double, 3> slide = forces.slide(i, z);
    for (Index d = 0; d < 3; ++d) patches_[i].parts[d].missing = -slide[d];
  }
}

/// Sets the forces at the point, and the problem's unknowns to what they cause.
void NewtonSolver::apply_forces(IslandForces& forces, ContactProblem& problem) noexcept {
  const Index rows = problem.rows();
  for (Index i = 0; i < terms_.size(); ++i) {
    if (!(terms_[i].compliance > 0.0)) continue;
    (i < rows ? forces.rows()[i].force : forces.joints()[i - rows]).now = terms_[i].force(0.0);
  }
  if (bounds_follow_) forces.set_loads();
  for (Index i = 0; i < patches_.size(); ++i) {
    if (bounds_follow_) patches_[i].most = forces.most_friction(i);
    forces.frictions()[i].set(forces.bounded(i, patches_[i].wanted(0.0), patches_[i].most));
  }
  problem.begin_values();
  forces.for_each_force(problem, [](IslandForces::Force& force, const auto& apply) { apply(force.now); });
}

/// Sets the gradient of the function, the point less what its forces cause; returns the largest displacement
/// of a contact between the two [m].
double NewtonSolver::set_gradient(const IslandForces& forces, const ContactProblem& problem) noexcept {
  const double* const caused = problem.values();
  for (Index i = 0; i < z_.size(); ++i) gradient_[i] = z_[i] - caused[i];
  double largest = 0.0;
  const auto add = [&](const QpRow& row, double arm) {
    largest = std::max(largest, arm * std::abs(dot(row, gradient_.data())));
  };
  for (Index i = 0; i < terms_.size(); ++i) add(row_of_term(i, problem), 1.0);
  for (const FrictionPatch& patch : forces.patches())
    for (Index d = 0; d < 3; ++d) add(*rows_of(patch)[d], arm_of(patch, d));
  return largest;
}

/// Adds  weight g g^T.
void NewtonSolver::add_to_matrix(const QpRow& row, double weight) noexcept {
  const std::span<const uint32_t> places = order_.places();
  std::array<std::pair<uint32_t, double>, 2 * QpRow::kLongestRun> g;
  Index n = 0;
  for (const QpRow::Run& run : row.runs)
    for (Index i = 0; i < run.count; ++i) g[n++] = {places[run.first + i], run.g[i]};
  for (Index i = 0; i < n; ++i) {
    const double scaled = weight * g[i].second;
    for (Index j = 0; j < n; ++j)
      if (g[j].first <= g[i].first) factor_.entry(g[i].first, g[j].first) += scaled * g[j].second;
  }
}

/// Adds the derivative of a patch's friction: of one that slides, of the part across its motion.
void NewtonSolver::add_to_matrix(const FrictionPatch& patch, const PatchTerm& term) noexcept {
  if (!(term.most > 0.0) || !(term.parts[0].compliance > 0.0)) return;
  const std::array<double, 3> wanted = term.wanted(0.0);
  const double used = used_of(patch, wanted);
  const bool slides = used > term.most;
  const double weight = slides ? term.most / used : 1.0;
  for (Index d = 0; d < 3; ++d)
    if (term.parts[d].compliance > 0.0) add_to_matrix(*rows_of(patch)[d], weight / term.parts[d].compliance);
  if (!slides) return;
  add_to_matrix(direction_of(patch, wanted, used), -weight / term.parts[0].compliance);
}

/// Sets the derivative of the gradient while the bounds of friction stay as they are: symmetric and positive.
void NewtonSolver::set_matrix(const IslandForces& forces, const ContactProblem& problem) noexcept {
  factor_.reset(1.0);
  for (Index i = 0; i < terms_.size(); ++i) {
    const Term& term = terms_[i];
    if (!(term.compliance > 0.0)) continue;
    const double wanted = term.wanted(0.0);
    if (wanted > term.least && wanted < term.most)
      add_to_matrix(row_of_term(i, problem), 1.0 / term.compliance);
  }
  for (Index i = 0; i < patches_.size(); ++i) add_to_matrix(forces.patches()[i], patches_[i]);
}

/// Adds what the friction of patches that slide changes with their loads. False when nothing slides.
bool NewtonSolver::add_slope_of_bounds(const IslandForces& forces, const ContactProblem& problem) noexcept {
  bool any = false;
  const std::span<const uint32_t> places = order_.places();
  for (Index i = problem.equalities(); i < problem.rows(); ++i) {
    const int patch = forces.rows()[i].patch;
    const Term& term = terms_[i];
    if (patch < 0 || !(term.compliance > 0.0) || !(term.wanted(0.0) > 0.0)) continue;
    const PatchTerm& friction = patches_[Index(patch)];
    if (!(friction.parts[0].compliance > 0.0)) continue;
    const FrictionPatch& where = forces.patches()[Index(patch)];
    const std::array<double, 3> wanted = friction.wanted(0.0);
    const double used = used_of(where, wanted);
    if (!(used > friction.most)) continue;
    if (!any) factor_with_bounds_.assign(factor_);
    any = true;
    const QpRow along = direction_of(where, wanted, used);
    const QpRow& row = problem.row_list()[i];
    const double weight = where.coefficient / term.compliance;
    for (const QpRow::Run& to : along.runs)
      for (Index a = 0; a < to.count; ++a)
        for (const QpRow::Run& from : row.runs)
          for (Index b = 0; b < from.count; ++b)
            factor_with_bounds_.add(places[to.first + a], places[from.first + b],
                                    weight * to.g[a] * from.g[b]);
  }
  return any;
}

/// Sets the step from the gradient, and what it closes.
template <class Factor>
void NewtonSolver::find_step(const Factor& factor, const IslandForces& forces,
                             const ContactProblem& problem) noexcept {
  const std::span<const uint32_t> places = order_.places();
  for (Index u = 0; u < places.size(); ++u) scratch_[places[u]] = -gradient_[u];
  factor.solve({scratch_.data(), places.size()});
  for (Index u = 0; u < places.size(); ++u) step_[u] = scratch_[places[u]];
  const double* const step = step_.data();
  for (Index i = 0; i < terms_.size(); ++i) terms_[i].closes = dot(row_of_term(i, problem), step);
  for (Index i = 0; i < patches_.size(); ++i)
    for (Index d = 0; d < 3; ++d) patches_[i].parts[d].closes = dot(*rows_of(forces.patches()[i])[d], step);
}

double NewtonSolver::residual() const noexcept {
  double sum = 0.0;
  for (const double value : gradient_) sum += value * value;
  return std::sqrt(sum);
}

/// Makes a step with bounds of friction that follow the loads, as long as what is left of the gradient falls
/// by it. False when there is none; then the point is where it was.
bool NewtonSolver::go_with_bounds(double& left, IslandForces& forces, ContactProblem& problem) noexcept {
  if (!add_slope_of_bounds(forces, problem) || !factor_with_bounds_.factor()) return false;
  const double before = residual();
  find_step(factor_with_bounds_, forces, problem);
  double t = 1.0;
  go(t);
  for (int i = 0; i <= kMostBacktracks; ++i) {
    apply_forces(forces, problem);
    set_gradient(forces, problem);
    if (residual() <= (1.0 - kFlat * t) * before) return true;
    left -= kSweepsWithoutStep;
    go(-0.5 * t);
    t *= 0.5;
  }
  go(-t);
  apply_forces(forces, problem);
  set_gradient(forces, problem);
  return false;
}

/// Makes a step to the least of the function for the bounds that friction has. False when the matrix has no
/// factor, as with numbers that are not finite.
bool NewtonSolver::go_to_least(const IslandForces& forces, const ContactProblem& problem) noexcept {
  if (!factor_.factor()) return false;
  find_step(factor_, forces, problem);
  go(length_of_step(forces));
  return true;
}

/// The slope of the function at a part t of the step.
double NewtonSolver::slope_at(double t, const IslandForces& forces) const noexcept {
  double sum = 0.0;
  for (Index u = 0; u < z_.size(); ++u) sum += (z_[u] + t * step_[u]) * step_[u];
  for (const Term& term : terms_)
    if (term.compliance > 0.0) sum -= term.force(t) * term.closes;
  for (Index i = 0; i < patches_.size(); ++i) {
    const std::array<double, 3> force = forces.bounded(i, patches_[i].wanted(t), patches_[i].most);
    for (Index d = 0; d < 3; ++d) sum -= force[d] * patches_[i].parts[d].closes;
  }
  return sum;
}

/// The part of the step that leads to the lowest point along it: the zero of the slope, which rises.
double NewtonSolver::length_of_step(const IslandForces& forces) const noexcept {
  double falls = 0.0;
  double rises = 1.0;
  double at_fall = slope_at(falls, forces);
  double at_rise = slope_at(rises, forces);
  const double flat = kFlat * std::abs(at_fall);
  if (at_rise <= flat) return rises;
  double t = rises;
  for (int i = 0; i < kMostSlopes; ++i) {
    const double chord = falls - at_fall * (rises - falls) / (at_rise - at_fall);
    const double margin = kTrialMargin * (rises - falls);
    t = std::clamp(chord, falls + margin, rises - margin);
    const double slope = slope_at(t, forces);
    if (std::abs(slope) <= flat) break;
    (slope < 0.0 ? falls : rises) = t;
    (slope < 0.0 ? at_fall : at_rise) = slope;
  }
  return t;
}

void NewtonSolver::go(double t) noexcept {
  for (Index u = 0; u < z_.size(); ++u) z_[u] += t * step_[u];
  for (Term& term : terms_) term.missing -= t * term.closes;
  for (PatchTerm& patch : patches_)
    for (Term& part : patch.parts) part.missing -= t * part.closes;
}

NewtonSolver::Result NewtonSolver::solve(int max_sweeps, double harmless_m, IslandForces& forces,
                                         ContactProblem& problem) noexcept {
  Result result;
  const Index unknowns = problem.unknowns() + kRoomBehind;
  z_.assign(problem.values(), problem.values() + unknowns);
  for (ReservedVector<double>* const v : {&step_, &gradient_, &scratch_}) v->assign(unknowns, 0.0);
  terms_.assign(problem.rows() + problem.joint_frictions().size(), Term{});
  patches_.assign(forces.patches().size(), PatchTerm{});
  Compliances compliances = kStiff;
  set_multipliers(compliances, forces, problem);
  measure(forces, problem);
  const double settled = tolerances::kRestingVelocity * forces.step_s();
  int polished = 0;
  bounds_follow_ = false;
  double last_rest = kUnbounded;  // since the bounds follow
  for (double left = max_sweeps; left >= sweeps_per_round_; left -= kSweepsWithoutStep) {
    if (result.iterations++ == kStiffRounds && !result.converged) {
      forces.restart(problem);
      z_.assign(problem.values(), problem.values() + unknowns);
      compliances = kSoft;
      bounds_follow_ = false;
      set_multipliers(compliances, forces, problem);
      measure(forces, problem);
    }
    apply_forces(forces, problem);
    const IslandForces::Remainder rest = forces.remainder(settled, problem);
    const bool is_least = set_gradient(forces, problem) <= kInnerShare * rest.largest_m;
    const bool is_stiff = compliances.rows <= kStiff.rows;
    result.converged = is_least && is_stiff && rest.settled;
    result.usable = is_least && rest.largest_m <= harmless_m;
    if (result.converged && (rest.largest_m <= settled || ++polished > kMostPolished)) break;
    if (result.usable && is_stiff && left < kLastRounds * sweeps_per_round_) break;
    if (is_least) {
      if (bounds_follow_ && rest.largest_m > kStill * last_rest && rest.largest_m <= kUnfit * harmless_m) {
        result.converged = true;
        break;
      }
      last_rest = bounds_follow_ ? rest.largest_m : kUnbounded;
      bounds_follow_ |= is_stiff;
      compliances.rows = std::max(kStiff.rows, kFall * compliances.rows);
      compliances.friction = std::max(kStiff.friction, kFall * compliances.friction);
      set_multipliers(compliances, forces, problem);
    } else {
      set_matrix(forces, problem);
      if (!(bounds_follow_ && go_with_bounds(left, forces, problem)) && !go_to_least(forces, problem)) break;
      left -= sweeps_per_round_ - kSweepsWithoutStep;
    }
  }
  return result;
}

}  // namespace tactum::inline v0_1
