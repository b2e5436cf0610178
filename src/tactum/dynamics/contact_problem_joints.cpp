/// The pair joints of the contact problem (contact_problem.h, pair_joint.h).

#include <algorithm>
#include <array>
#include <cmath>

#include "tactum/dynamics/contact_problem.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The product of two rows of the same two bodies, whose runs may begin at different unknowns.
double dot_of_rows(const QpRow& one, const QpRow& other) noexcept {
  double sum = 0.0;
  for (Index side = 0; side < 2; ++side) {
    const QpRow::Run& a = one.runs[side];
    const QpRow::Run& b = other.runs[side];
    for (Index i = 0; i < a.count; ++i) {
      const Index unknown = a.first + i;
      if (unknown >= b.first && unknown - b.first < b.count) sum += a.g[i] * b.g[unknown - b.first];
    }
  }
  return sum;
}

}  // namespace

/// The row of the joint's travel, with room for `own` unknowns of the joint in its first run: before a
/// displacement, behind a turn.
QpRow ContactProblem::travel_of(const PairJoint& pair, const Push& along, std::size_t own) const noexcept {
  QpRow row = row_of(pair.body, pair.parent, along);
  QpRow::Run& run = row.runs[0];
  const std::array<double, QpRow::kLongestRun> g = run.g;
  const bool turns = pair.joint.kind != JointKind::kSlider;
  const Index at = turns ? 0 : own;
  run.g.fill(0.0);
  for (Index i = 0; i < 3; ++i) run.g[at + i] = g[(turns ? 3 : 0) + i];
  run.first = turns ? run.first + 3 : run.first - static_cast<std::uint32_t>(own);
  run.count = static_cast<std::uint32_t>(3 + own);
  return row;
}

/// The inertia of the two bodies along the travel, over h^2, with what the last `locks` rows do not allow
/// taken out of it [N/m or N m/rad].
double ContactProblem::inertia_along(QpRow travel, std::size_t locks) const noexcept {
  std::array<std::array<double, 6>, 6> L{};  // of the locks' products, L L^T
  std::array<double, 6> y{};
  const std::span<const QpRow> rows(rows_.data() + (rows_.size() - locks), locks);
  double free = dot_of_rows(travel, travel);
  for (Index i = 0; i < locks; ++i) {
    for (Index j = 0; j <= i; ++j) {
      double sum = dot_of_rows(rows[i], rows[j]);
      for (Index k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
    double sum = dot_of_rows(rows[i], travel);
    for (Index k = 0; k < i; ++k) sum -= L[i][k] * y[k];
    y[i] = sum / L[i][i];
    free -= y[i] * y[i];
  }
  return free > 0.0 ? 1.0 / free : 0.0;
}

/// Adds a spring and damper along a travel: with an unknown s of their own, whose metric is drag / h and
/// whose target is `travel`, and the row  push . (x_body - x_parent) = s.
void ContactProblem::add_drag(const PairJoint& pair, const Push& along, std::size_t own, double drag_per_h,
                              double travel) noexcept {
  const Index room = pair.joint.kind == JointKind::kBall
                         ? own + 1
                         : joint_unknowns(pair.joint).before + joint_unknowns(pair.joint).behind;
  QpRow& row = rows_.emplace_back(travel_of(pair, along, room));
  const Index at = pair.joint.kind == JointKind::kSlider ? own : 3 + own;
  row.runs[0].g[at] = -1.0 / std::sqrt(drag_per_h);
  row.offset += travel;
}

void ContactProblem::add_pair_joint(const World& world, const PairJoint& pair, const WorldState& state,
                                    double h) noexcept {
  const JointLocks locks = joint_locks(world, pair, state.X_WB);
  const JointError error = joint_error(world, pair, state.X_WB);
  for (const Push& lock : locks) {
    locks_.push_back({&pair, lock, rows_.size()});
    add_row(pair.body, pair.parent, lock, -error.along(lock));
  }
  if (!(h > 0.0)) return;
  const Vec6 rate = pair_rate(world, pair, state.X_WB);
  const Push along{find(pair.body)->centre, rate.head<3>(), rate.tail<3>()};
  const Index own = joint_unknowns(pair.joint).before + joint_unknowns(pair.joint).behind;
  double inertia = 0.0;
  if (pair.joint.stiffness > 0.0) inertia = inertia_along(travel_of(pair, along, own), locks.size());
  const JointForces forces = joint_forces(pair.joint, state.joints[Index(pair.body)], inertia, h);
  if (!forces.acts) return;
  if (forces.drag > 0.0) add_drag(pair, along, 0, forces.drag / h, forces.free_rate * h);
  if (forces.drag_about_ball > 0.0)
    for (int i = 0; i < 3; ++i)
      add_drag(pair, {along.p_W, Vec3::Zero(), Vec3::Unit(i)}, Index(i), forces.drag_about_ball / h, 0.0);
  if (forces.friction > 0.0 && pair.joint.kind != JointKind::kBall) {
    JointFriction& friction = joint_frictions_.emplace_back();
    friction.friction = forces.friction;
    friction.travel = travel_of(pair, along, own);
    friction.own = static_cast<int>(pair.joint.kind == JointKind::kSlider ? own - 1 : 3 + own - 1);
  }
  if (forces.limited_down())
    limits_.push_back({pair.body, pair.parent, along, std::max(0.0, forces.travel_down)});
  if (forces.limited_up())
    limits_.push_back(
        {pair.body, pair.parent, {along.p_W, -along.force, -along.torque}, std::max(0.0, forces.travel_up)});
}

void ContactProblem::add_pair_joints(const World& world, const WorldState& state, double h) noexcept {
  for (const PairJoint& pair : world.pair_joints)
    if (find(pair.body) != nullptr && find(pair.parent) != nullptr) add_pair_joint(world, pair, state, h);
  equalities_ = rows_.size();
}

double ContactProblem::correct_pair_joints(const World& world, std::span<const Pose> X_WB) noexcept {
  double largest = 0.0;
  const PairJoint* pair = nullptr;
  JointError error;
  for (const Lock& lock : locks_) {
    if (lock.pair != pair) error = joint_error(world, *lock.pair, X_WB);
    pair = lock.pair;
    const double along = error.along(lock.push);
    rows_[lock.row].offset -= along;
    const bool turns = lock.push.force.isZero(0.0);
    const double size = turns ? 1.0 : world.bodies[Index(lock.pair->body)].part->size;
    largest = std::max(largest, std::abs(along) / size);
  }
  return largest;
}

}  // namespace tactum::inline v0_1
