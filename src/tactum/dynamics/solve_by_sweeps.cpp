#include "tactum/dynamics/solve_by_sweeps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "tactum/base/frame_rate.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// In this part of the sweeps (one in so many) contacts have to open; rows that have not converged by then
/// are wedged, and need not open again for kClosed_s.
constexpr int kOpeningShare = 3;
constexpr double kClosed_s = 0.016;

/// In the last sweeps, one in so many of all, friction grows no more with the normal force.
constexpr int kLimitedShare = 6;

/// A sweep has more to change than the one before if the sum of squares grew by this factor: where loads move
/// from contact to contact at a steady rate, the changes stay about the same, and there momentum helps most.
constexpr double kMoreToChange = 1.01;

auto key(const ContactRow& row) {
  const SurfacePair& on = row.friction_surfaces();
  return std::tuple(on.body_a, on.body_b, on.group_a, on.group_b);
}

}  // namespace

Sweeps::Sweeps(std::size_t most_rows, std::size_t bodies) {
  rows_.reserve(most_rows + ContactProblem::kJointRows * bodies);
  joints_.reserve(bodies);
  patches_.reserve(most_rows);
  frictions_.reserve(most_rows);
  order_.reserve(most_rows);
}

/// Makes a patch for each pair of surfaces with friction, at the last frame's centre of pressure.
void Sweeps::make_patches(const RowsInProblem& contacts, std::span<const Pose> X_WB,
                          const FrictionAnchors& anchors, ContactProblem& problem) noexcept {
  patches_.clear();
  frictions_.clear();
  order_.clear();
  for (Index i = 0; i < contacts.rows.size(); ++i)
    if (contacts.rows[i].friction > 0.0) order_.push_back(static_cast<int>(i));
  const auto row = [&](int i) -> const ContactRow& { return contacts.rows[Index(i)]; };
  std::sort(order_.begin(), order_.end(),
            [&](int a, int b) { return key(row(a)) != key(row(b)) ? key(row(a)) < key(row(b)) : a < b; });
  for (auto first = order_.begin(), last = first; first != order_.end(); first = last) {
    last = std::find_if(first, order_.end(), [&](int i) { return key(row(i)) != key(row(*first)); });
    FrictionPatch& patch = patches_.emplace_back();
    patch.surfaces = row(*first).friction_surfaces();
    patch.source_patch = row(*first).patch;
    patch.coefficient = row(*first).friction;
    patch.place.skin_m = row(*first).skin_m;
    const double share = 1.0 / static_cast<double>(last - first);
    std::for_each(first, last, [&](int i) {
      patch.rolls |= row(i).rolls;
      patch.place.centre_W += share * row(i).p_W;
      patch.place.n_BA_W += row(i).n_BA_W;
      rows_[contacts.first + Index(i)].patch = static_cast<int>(patches_.size()) - 1;
    });
    patch.place.n_BA_W.normalize();
    const FrictionAnchor* const anchor = take_anchor(anchors, X_WB, patch);
    std::for_each(first, last,
                  [&](int i) { patch.place.radius_m += share * (row(i).p_W - patch.place.centre_W).norm(); });
    patch.motion = motion_of(patch, any_orthogonal(patch.place.n_BA_W), problem);
    Friction3& friction = frictions_.emplace_back();
    friction.most = kInfinity;
    if (anchor == nullptr) continue;
    friction.along.now = patch.motion.along_W.dot(anchor->force_W);
    friction.across.now = patch.motion.across_W.dot(anchor->force_W);
    friction.about.now = anchor->torque_Nm;
  }
}

void Sweeps::begin(const RowsInProblem& contacts, std::span<const Pose> X_WB, const FrictionAnchors& anchors,
                   RowMemory& memory, double h, ContactProblem& problem) noexcept {
  h_ = h;
  first_contact_ = contacts.first;
  const std::span<const QpRow> rows = problem.row_list();
  rows_.assign(rows.size(), Row{});
  for (Index i = 0; i < rows.size(); ++i) rows_[i].mobility = mobility(rows[i]);
  for (Index i = 0; i < contacts.rows.size(); ++i) {
    if (contacts.rows[i].state < 0) continue;
    const RowState& state = memory[contacts.rows[i].state];
    Row& row = rows_[contacts.first + i];
    row.force.now = state.force_N;
    // A row that need not open for some time may still close no further.
    row.opening = std::max(0.0, contacts.rows[i].asked);
    if (state.closed_frames == 0) continue;
    problem.tighten(contacts.first + i, -row.opening);
    row.opening = 0.0;
  }
  joints_.assign(problem.joint_frictions().size(), Force{});
  make_patches(contacts, X_WB, anchors, problem);
  problem.begin_values();
  for_each_force(problem, [&](Force& force, const auto& apply) { apply(force.now); });
}

template <class Visit>
void Sweeps::for_each_force(ContactProblem& problem, const Visit& visit) noexcept {
  double* const z = problem.values();
  const std::span<const QpRow> rows = problem.row_list();
  for (Index i = 0; i < joints_.size(); ++i) {
    const QpRow& travel = problem.joint_frictions()[i].travel;
    visit(joints_[i], [&](double f) { push(travel, f, z); });
  }
  for (Index i = 0; i < rows_.size(); ++i) visit(rows_[i].force, [&](double f) { push(rows[i], f, z); });
  for (Index i = 0; i < patches_.size(); ++i) {
    const PatchMotion& motion = patches_[i].motion;
    visit(frictions_[i].along, [&](double f) { push(motion.along, f, z); });
    visit(frictions_[i].across, [&](double f) { push(motion.across, f, z); });
    visit(frictions_[i].about, [&](double f) { push(motion.about, f, z); });
  }
}

void Sweeps::tighten(std::size_t contact, double by_m, ContactProblem& problem) noexcept {
  const Index row = first_contact_ + contact;
  const QpRow& asked = problem.row_list()[row];
  problem.tighten(row, by_m);
  // A gap that closes in this step may close less; only what exceeds that opens it.
  rows_[row].opening += std::clamp(asked.offset, 0.0, by_m);
}

/// Updates a joint's dry friction, which keeps the joint where it is as far as its bound allows; returns the
/// change of its travel [m or rad].
double Sweeps::relax_joint(std::size_t joint, ContactProblem& problem) noexcept {
  const ContactProblem::JointFriction& friction = problem.joint_frictions()[joint];
  const double mobile = mobility(friction.travel);
  if (!(mobile > 0.0)) return 0.0;
  Force& force = joints_[joint];
  const double travel = problem.opening(friction.travel);
  force.now = std::clamp(force.now - travel / mobile, -friction.friction, friction.friction);
  push(friction.travel, force.now - force.before, problem.values());
  return std::abs(force.now - force.before) * mobile;
}

/// Updates a patch's friction: it sticks as far as the normal force allows; returns the largest change of a
/// displacement [m].
double Sweeps::relax_friction(std::size_t number, ContactProblem& problem) noexcept {
  const FrictionPatch& patch = patches_[number];
  Friction3& friction = frictions_[number];
  double* const z = problem.values();
  const double most = std::min(friction.most, patch.coefficient * friction.load);
  const std::array<Force*, 3> forces{&friction.along, &friction.across, &friction.about};
  const bool rests = forces[0]->now == 0.0 && forces[1]->now == 0.0 && forces[2]->now == 0.0;
  if (!(most > 0.0) && rests) return 0.0;
  const PatchMotion& motion = patch.motion;
  const std::array<const QpRow*, 3> rows{&motion.along, &motion.across, &motion.about};
  const std::array<double, 3> apart{motion.along_W.dot(patch.anchor.apart_W),
                                    motion.across_W.dot(patch.anchor.apart_W), 0.0};
  double change = 0.0;
  for (Index d = 0; d < 3; ++d) {
    const double mobile = mobility(*rows[d]);
    if (!(mobile > 0.0)) continue;
    const double by = -(dot(*rows[d], z) - rows[d]->offset + apart[d]) / mobile;
    forces[d]->now += by;
    push(*rows[d], by, z);
  }
  // Force and torque use up the bound together as on an area whose points all slide, an ellipse.
  const double sideways = std::hypot(forces[0]->now, forces[1]->now);
  const double twisting = patch.place.radius_m > 0.0 ? std::abs(forces[2]->now) / patch.place.radius_m : 0.0;
  const double used = std::hypot(sideways, twisting);
  const double share = used > most ? most / used : 1.0;
  for (Index d = 0; d < 3; ++d) {
    const double wanted = d == 2 && !(patch.place.radius_m > 0.0) ? 0.0 : share * forces[d]->now;
    push(*rows[d], wanted - forces[d]->now, z);
    forces[d]->now = wanted;
    const double arm = d == 2 ? patch.place.radius_m : 1.0;
    change = std::max(change, std::abs(wanted - forces[d]->before) * mobility(*rows[d]) * arm);
  }
  return change;
}

/// One round of projected Gauss-Seidel; returns the largest change of a displacement.
double Sweeps::sweep(ContactProblem& problem) noexcept {
  for_each_force(problem, [](Force& force, const auto&) { force.before = force.now; });
  for (Friction3& friction : frictions_) friction.load = 0.0;
  double change = 0.0;
  for (Index i = 0; i < joints_.size(); ++i) change = std::max(change, relax_joint(i, problem));
  double* const z = problem.values();
  const std::span<const QpRow> rows = problem.row_list();
  for (Index i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (row.mobility > 0.0) {
      const double missing = rows[i].offset - dot(rows[i], z);
      row.force.now += missing / row.mobility;
      if (i >= problem.equalities()) row.force.now = std::max(0.0, row.force.now);
      if (row.force.now != row.force.before) {
        push(rows[i], row.force.now - row.force.before, z);
        change = std::max(change, std::abs(row.force.now - row.force.before) * row.mobility);
      }
    }
    if (row.patch >= 0) frictions_[Index(row.patch)].load += row.force.now;
  }
  for (Index i = 0; i < patches_.size(); ++i) change = std::max(change, relax_friction(i, problem));
  return change;
}

/// Adds momentum from sweep to sweep, a fraction of the last change that grows with their number [Nesterov
/// 1983]; sets it to zero where the last sweep had more to change than the one before [Donoghue 2015]. Forces
/// that overstep their bounds are projected by the next sweep.
void Sweeps::accelerate(Pace& pace, ContactProblem& problem) noexcept {
  double change = 0.0;
  for_each_force(problem, [&](Force& force, const auto&) {
    change += (force.now - force.before) * (force.now - force.before);
  });
  if (change > kMoreToChange * pace.last_change) pace.sweeps = 0;
  pace.last_change = change;
  const double share = pace.sweeps / (pace.sweeps + 3.0);
  ++pace.sweeps;
  for_each_force(problem, [&](Force& force, const auto& apply) {
    const double further = share * (force.now - force.swept);
    force.swept = force.now;
    if (further == 0.0) return;
    force.now += further;
    apply(further);
  });
}

/// Contacts need no longer open, and forces go back to what they began with. False when none had to open.
bool Sweeps::close_only(ContactProblem& problem) noexcept {
  bool asked = false;
  for (Index i = 0; i < rows_.size(); ++i) {
    const double opening = std::exchange(rows_[i].opening, 0.0);
    if (opening > 0.0) problem.tighten(i, -opening);
    rows_[i].wedged |= opening > tolerances::kRestingVelocity * h_;
    asked |= rows_[i].wedged;
  }
  if (!asked) return false;
  for_each_force(problem, [](Force& force, const auto& apply) {
    apply(force.begun - force.now);
    force.now = force.begun;
  });
  return true;
}

void Sweeps::limit_friction() noexcept {
  for (Index i = 0; i < patches_.size(); ++i)
    if (frictions_[i].load > 0.0) frictions_[i].most = patches_[i].coefficient * frictions_[i].load;
}

SolverResult Sweeps::solve(int max_sweeps, double harmless_m, ContactProblem& problem) noexcept {
  SolverResult result;
  for_each_force(problem, [](Force& force, const auto&) { force.begun = force.now; });
  for (Friction3& friction : frictions_) friction.most = kInfinity;
  double farthest = 0.0;
  for (const ProblemBody& body : problem.bodies())
    farthest = std::max(farthest, Vec3(problem.displacement(body.body).head<3>()).norm());
  const double enough = tolerances::kRestingVelocity * h_ + tolerances::kSlidingVelocity * farthest;
  Pace pace;
  while (result.iterations < max_sweeps) {
    if (result.iterations++ == std::max(1, max_sweeps / kOpeningShare) && close_only(problem)) pace = {};
    if (result.iterations == max_sweeps - max_sweeps / kLimitedShare) limit_friction();
    const double change = sweep(problem);
    result.converged = change <= harmless_m;
    if (change <= enough || result.iterations == max_sweeps) break;
    accelerate(pace, problem);
  }
  return result;
}

void Sweeps::end(std::span<ContactRow> rows, RowMemory& memory) const noexcept {
  for (Index i = 0; i < rows.size(); ++i) {
    const Row& row = rows_[first_contact_ + i];
    rows[i].impulse = row.force.now * h_;
    if (rows[i].state < 0) continue;
    RowState& state = memory[rows[i].state];
    state.force_N = row.force.now;
    if (row.wedged) state.closed_frames = frames_in(kClosed_s, h_);
  }
}

void Sweeps::keep_anchors(const RowsInProblem& contacts, std::span<const Pose> X_WB,
                          const ContactProblem& problem, FrictionAnchors& anchors) noexcept {
  for (FrictionPatch& patch : patches_) patch.load_N = 0.0;
  const auto for_pushing_rows = [&](const auto& visit) {
    for (Index i = 0; i < contacts.rows.size(); ++i) {
      const Row& row = rows_[contacts.first + i];
      if (row.patch >= 0 && row.force.now > 0.0)
        visit(patches_[Index(row.patch)], row.force.now, contacts.rows[i].p_W);
    }
  };
  for_pushing_rows([](FrictionPatch& patch, double force, const Vec3&) { patch.load_N += force; });
  for (FrictionPatch& patch : patches_)
    if (patch.load_N > 0.0) patch.place.centre_W.setZero();
  for_pushing_rows([](FrictionPatch& patch, double force, const Vec3& p_W) {
    patch.place.centre_W += force / patch.load_N * p_W;
  });
  for (Index i = 0; i < patches_.size(); ++i) {
    FrictionPatch& patch = patches_[i];
    const Friction3& friction = frictions_[i];
    const double twisting = patch.place.radius_m > 0.0 ? friction.about.now / patch.place.radius_m : 0.0;
    const double used = std::hypot(friction.along.now, friction.across.now, twisting);
    if (!(used < (1.0 - tolerances::kAtFrictionBound) * patch.coefficient * patch.load_N))
      patch.slip.displacement_m = kInfinity;
    FrictionAnchor anchor = next_anchor(patch, patch.place.centre_W, used > 0.0, X_WB, problem);
    anchor.force_W = friction_force(i);
    anchor.torque_Nm = friction.about.now;
    anchors.add(anchor);
  }
}

Vec3 Sweeps::friction_force(std::size_t patch) const noexcept {
  const PatchMotion& motion = patches_[patch].motion;
  return frictions_[patch].along.now * motion.along_W + frictions_[patch].across.now * motion.across_W;
}

Vec3 Sweeps::friction_torque(std::size_t patch) const noexcept {
  return frictions_[patch].about.now * patches_[patch].place.n_BA_W;
}

}  // namespace tactum::inline v0_1
