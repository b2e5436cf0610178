#include "tactum/dynamics/island_forces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "tactum/base/frame_rate.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// For so long rows that were found wedged need not open again. At first they are asked again in the next
/// frame, so many times: where a pile begins, forces that have not converged look the same, and bodies that
/// lie flush cannot move before their gaps open.
constexpr double kClosed_s = 0.016;
constexpr int kAskedAgain = 2;

auto key(const ContactRow& row) {
  const SurfacePair& on = row.friction_surfaces();
  return std::tuple(on.body_a, on.body_b, on.group_a, on.group_b);
}

/// How far forces have displaced the bodies of a row along it, the one that is displaced less [m].
double least_caused(const QpRow& row, const double* z) {
  double least = kUnbounded;
  for (const QpRow::Run& run : row.runs) {
    if (run.count == 0) continue;
    double sum = 0.0;
    for (Index i = 0; i < run.count; ++i) sum += run.g[i] * z[run.first + i];
    least = std::min(least, std::abs(sum));
  }
  return least < kUnbounded ? least : 0.0;
}

}  // namespace

IslandForces::IslandForces(std::size_t most_rows, std::size_t bodies) {
  rows_.reserve(most_rows + ContactProblem::kJointRows * bodies);
  joints_.reserve(bodies);
  patches_.reserve(most_rows);
  frictions_.reserve(most_rows);
  order_.reserve(most_rows);
}

/// Makes a patch for each pair of surfaces with friction, at the last frame's centre of pressure.
void IslandForces::make_patches(const RowsInProblem& contacts, std::span<const Pose> X_WB,
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
    friction.most = kUnbounded;
    const double arm = patch.place.radius_m;
    friction.mobility = std::max({mobility(patch.motion.along), mobility(patch.motion.across),
                                  arm * arm * mobility(patch.motion.about)});
    if (anchor == nullptr) continue;
    friction.along.now = patch.motion.along_W.dot(anchor->force_W);
    friction.across.now = patch.motion.across_W.dot(anchor->force_W);
    friction.about.now = anchor->torque_Nm;
  }
}

void IslandForces::begin(const RowsInProblem& contacts, std::span<const Pose> X_WB,
                         const FrictionAnchors& anchors, RowMemory& memory, double h,
                         ContactProblem& problem) noexcept {
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
    row.opening = std::max(0.0, contacts.rows[i].asked);
    row.asked = state.closed_frames == 0;
    if (row.asked) continue;
    // A row that need not open for some time may still close no further. What a trial has added to it is what
    // it needs for that.
    const double not_now = std::min(row.opening, asked_of(contacts.rows[i], opening_share(h)));
    if (!(not_now > 0.0)) continue;
    problem.tighten(contacts.first + i, -not_now);
    row.opening -= not_now;
  }
  joints_.assign(problem.joint_frictions().size(), Force{});
  make_patches(contacts, X_WB, anchors, problem);
  problem.begin_values();
  for_each_force(problem, [&](Force& force, const auto& apply) { apply(force.now); });
}

IslandForces::Remainder IslandForces::remainder(double settled_m, const ContactProblem& problem) noexcept {
  set_loads();
  const double* const z = problem.values();
  Remainder all;
  const auto add = [&](double change, const QpRow& along) {
    all.largest_m = std::max(all.largest_m, change);
    all.settled &= change <= settled_m + tolerances::kNewtonSettled * least_caused(along, z);
  };
  for (Index i = 0; i < joints_.size(); ++i) {
    const ContactProblem::JointFriction& friction = problem.joint_frictions()[i];
    const double mobile = mobility(friction.travel);
    if (!(mobile > 0.0)) continue;
    const double wanted = joints_[i].now - problem.opening(friction.travel) / mobile;
    const double force = std::clamp(wanted, -friction.friction, friction.friction);
    add(mobile * std::abs(force - joints_[i].now), friction.travel);
  }
  const std::span<const QpRow> rows = problem.row_list();
  for (Index i = 0; i < rows_.size(); ++i) {
    if (!(rows_[i].mobility > 0.0)) continue;
    double force = rows_[i].force.now + (rows[i].offset - dot(rows[i], z)) / rows_[i].mobility;
    if (i >= problem.equalities()) force = std::max(0.0, force);
    add(rows_[i].mobility * std::abs(force - rows_[i].force.now), rows[i]);
  }
  for (Index i = 0; i < patches_.size(); ++i) {
    const std::array<double, 3> now = frictions_[i].now();
    const std::array<double, 3> force = relaxed(i, most_friction(i), z);
    const double radius = patches_[i].place.radius_m;
    const double twisting = radius > 0.0 ? (force[2] - now[2]) / radius : 0.0;
    add(frictions_[i].mobility * std::hypot(force[0] - now[0], force[1] - now[1], twisting),
        patches_[i].motion.off);
  }
  return all;
}

void IslandForces::bound_friction(ContactProblem& problem) noexcept {
  set_loads();
  for (Index i = 0; i < patches_.size(); ++i) {
    const std::array<double, 3> force = bounded(i, frictions_[i].now(), most_friction(i));
    const std::array<Force*, 3> parts = frictions_[i].forces();
    const PatchMotion& motion = patches_[i].motion;
    const std::array<const QpRow*, 3> rows{&motion.along, &motion.across, &motion.about};
    for (Index d = 0; d < 3; ++d) {
      push(*rows[d], force[d] - parts[d]->now, problem.values());
      parts[d]->now = force[d];
    }
  }
}

void IslandForces::begin_solution(ContactProblem& problem) noexcept {
  for_each_force(problem, [](Force& force, const auto&) { force.begun = force.now; });
  for (Friction3& friction : frictions_) friction.most = kUnbounded;
}

double IslandForces::settled_m(const ContactProblem& problem) const noexcept {
  double farthest = 0.0;
  for (const ProblemBody& body : problem.bodies())
    farthest = std::max(farthest, Vec3(problem.displacement(body.body).head<3>()).norm());
  return tolerances::kRestingVelocity * h_ + tolerances::kSlidingVelocity * farthest;
}

std::array<double, 3> IslandForces::slide(std::size_t patch, const double* z) const noexcept {
  const PatchMotion& motion = patches_[patch].motion;
  const Vec3& apart = patches_[patch].anchor.apart_W;
  const auto moved = [z](const QpRow& row) { return dot(row, z) - row.offset; };
  return {moved(motion.along) + motion.along_W.dot(apart), moved(motion.across) + motion.across_W.dot(apart),
          moved(motion.about)};
}

/// All directions yield alike, so that what slides is pulled straight against its motion.
std::array<double, 3> IslandForces::relaxed(std::size_t patch, double most_N,
                                            const double* z) const noexcept {
  const Friction3& friction = frictions_[patch];
  std::array<double, 3> wanted = friction.now();
  if (!(friction.mobility > 0.0)) return wanted;
  const std::array<double, 3> slid = slide(patch, z);
  const double radius = patches_[patch].place.radius_m;
  for (Index d = 0; d < 3; ++d) wanted[d] -= (d == 2 ? radius * radius : 1.0) * slid[d] / friction.mobility;
  return bounded(patch, wanted, most_N);
}

std::array<double, 3> IslandForces::bounded(std::size_t patch, const std::array<double, 3>& wanted,
                                            double most_N) const noexcept {
  const double radius = patches_[patch].place.radius_m;
  const double twisting = radius > 0.0 ? wanted[2] / radius : 0.0;
  const double used = std::hypot(wanted[0], wanted[1], twisting);
  const double share = used > most_N ? most_N / used : 1.0;
  return {share * wanted[0], share * wanted[1], share * twisting * radius};
}

void IslandForces::set_loads() noexcept {
  for (Friction3& friction : frictions_) friction.load = 0.0;
  for (const Row& row : rows_)
    if (row.patch >= 0) frictions_[Index(row.patch)].load += row.force.now;
}

void IslandForces::restart(ContactProblem& problem) noexcept {
  for_each_force(problem, [](Force& force, const auto& apply) {
    apply(force.begun - force.now);
    force.now = force.begun;
  });
}

bool IslandForces::is_wedged(const ContactProblem& problem) const noexcept {
  for (Index i = 0; i < rows_.size(); ++i)
    if (rows_[i].opening > tolerances::kRestingVelocity * h_ &&
        -problem.opening(problem.row_list()[i]) > 0.5 * rows_[i].opening)
      return true;
  return false;
}

bool IslandForces::close_only(ContactProblem& problem) noexcept {
  bool asked = false;
  for (Index i = 0; i < rows_.size(); ++i) {
    const double opening = std::exchange(rows_[i].opening, 0.0);
    if (opening > 0.0) problem.tighten(i, -opening);
    rows_[i].wedged |= opening > tolerances::kRestingVelocity * h_;
    asked |= rows_[i].wedged;
  }
  if (asked) restart(problem);
  return asked;
}

void IslandForces::end(std::span<ContactRow> rows, RowMemory& memory) const noexcept {
  for (Index i = 0; i < rows.size(); ++i) {
    const Row& row = rows_[first_contact_ + i];
    rows[i].impulse = row.force.now * h_;
    if (rows[i].state < 0) continue;
    RowState& state = memory[rows[i].state];
    state.force_N = row.force.now;
    if (row.wedged) {
      state.closed_frames = state.times_wedged < kAskedAgain ? 1 : frames_in(kClosed_s, h_);
      state.times_wedged = std::min(kAskedAgain, state.times_wedged + 1);
    } else if (row.asked) {
      state.times_wedged = 0;
    }
  }
}

void IslandForces::keep_anchors(const RowsInProblem& contacts, std::span<const Pose> X_WB,
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
      patch.slip.displacement_m = kUnbounded;
    FrictionAnchor anchor = next_anchor(patch, patch.place.centre_W, used > 0.0, X_WB, problem);
    anchor.force_W = friction_force(i);
    anchor.torque_Nm = friction.about.now;
    anchors.add(anchor);
  }
}

Vec3 IslandForces::friction_force(std::size_t patch) const noexcept {
  const PatchMotion& motion = patches_[patch].motion;
  return frictions_[patch].along.now * motion.along_W + frictions_[patch].across.now * motion.across_W;
}

Vec3 IslandForces::friction_torque(std::size_t patch) const noexcept {
  return frictions_[patch].about.now * patches_[patch].place.n_BA_W;
}

}  // namespace tactum::inline v0_1
