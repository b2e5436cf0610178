#include "tactum/dynamics/resting_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/base/frame_rate.h"
#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Contacts come in the same order from frame to frame but for those that come and go; so many may at once
/// before an impulse is forgotten.
constexpr Index kLookAhead = 64;

/// In this share of the sweeps contacts are asked to open; what has not come to an end by then is wedged, and
/// is not asked again for kLeftShut_s.
constexpr int kOpeningShare = 3;
constexpr double kLeftShut_s = 0.016;

/// In the last sweeps, so many in one of all, friction grows no more with what it presses together.
constexpr int kLimitedShare = 6;

/// A sweep has more to change than the one before by this factor, squared: where loads move from contact to
/// contact at a steady rate, it has as much, give or take a little, and there the way on is what helps most.
constexpr double kMoreToChange = 1.01;

}  // namespace

RestingContact::Last RestingContact::last(std::uint64_t name) noexcept {
  for (Index ahead = 0; ahead < std::min(kLookAhead, last_.size()); ++ahead) {
    const Index i = (next_ + ahead) % last_.size();
    if (last_[i].name != name) continue;
    next_ = i + 1;
    return last_[i];
  }
  return {.name = name};
}

Vec3 RestingContact::keep(std::uint64_t name) noexcept {
  const Last kept = last(name);
  if (now_.size() < now_.capacity()) now_.push_back(kept);
  return kept.impulse_W;
}

void RestingContact::add(const ContactRow& row, int index, int island, std::uint64_t name, double gap_m,
                         std::span<const Pose> X_WB, std::span<const Mobility> W, double h) noexcept {
  h_ = h;
  if (rows_.size() == rows_.capacity() || now_.size() == now_.capacity()) return;
  Row& next = rows_.emplace_back();
  next.body_a = row.body_a;
  next.body_b = row.body_b;
  next.index = index;
  next.island = island;
  next.last = now_.size();
  const Last before = last(name);
  now_.push_back({.name = name, .left_shut = std::max(0, before.left_shut - 1)});
  next.wanted = before.left_shut > 0 ? std::min(0.0, -gap_m / h) : -gap_m / h;
  next.opening = std::max(0.0, next.wanted);
  next.contact.set(row, X_WB, W);
  Vec3& impulse = next.contact.impulse;
  for (int d = 0; d < (next.contact.friction > 0.0 ? 3 : 1); ++d)
    impulse[d] = next.contact.direction[Index(d)].dot(before.impulse_W);
  impulse[0] = std::max(0.0, impulse[0]);
}

void RestingContact::add_joint(int body, int island, const Body& what, const Pose& X_WB, const Mobility& W,
                               double h) noexcept {
  h_ = h;
  const Joint& joint = what.joint;
  const auto add_row = [&](const Vec6& along, double wanted, double opening, double softness, double lower,
                           double upper) {
    const Vec6 response = W * along;
    const double mobile = along.dot(response);
    if (mobile > 0.0)
      joints_.push_back({body, island, along, response, mobile, wanted, opening, softness, lower, upper});
  };
  if (joint.kind == JointKind::kBall && joint.damping > 0.0)
    for (int i = 0; i < 3; ++i)
      add_row(Vec6::Unit(3 + i), 0.0, 0.0, 1.0 / (h * joint.damping), -kInfinity, kInfinity);
  const Vec6 along = joint_rate(what, X_WB);
  const double position = joint_position(what, X_WB);
  // A spring and a damper at the end of the step: impulse = -h (k (position + h rate - rest) + c rate).
  const double stiff = joint.damping + h * joint.stiffness;
  if (joint.kind != JointKind::kBall && stiff > 0.0)
    add_row(along, -joint.stiffness * (position - joint.rest) / stiff, 0.0, 1.0 / (h * stiff), -kInfinity,
            kInfinity);
  if (joint.friction > 0.0) add_row(along, 0.0, 0.0, 0.0, -joint.friction * h, joint.friction * h);
  double below = (joint.lower - position) / h;
  double above = (joint.upper - position) / h;
  if (int& left_shut = joint_left_shut_[Index(body)]; left_shut > 0) {
    --left_shut;
    below = std::min(0.0, below);
    above = std::max(0.0, above);
  }
  if (std::isfinite(below)) add_row(along, below, std::max(0.0, below), 0.0, 0.0, kInfinity);
  if (std::isfinite(above)) add_row(along, above, std::min(0.0, above), 0.0, -kInfinity, 0.0);
}

void RestingContact::tighten(int index, double by_m, double h) noexcept {
  const auto found = std::lower_bound(rows_.begin(), rows_.end(), index,
                                      [](const Row& row, int i) { return row.index < i; });
  if (found == rows_.end() || found->index != index) return;
  const double opened = std::max(0.0, found->wanted);
  found->wanted += by_m / h;
  found->opening += std::max(0.0, found->wanted) - opened;
}

void RestingContact::push(const Row& row, const Vec3& impulse, std::span<Twist> V) noexcept {
  for (int d = 0; d < (row.contact.friction > 0.0 ? 3 : 1); ++d)
    row.contact.along[Index(d)].push(impulse[d], V[Index(row.body_a)], V[Index(row.body_b)]);
}

/// Groups the rows by island and gives the bodies the impulses they begin with.
void RestingContact::arrange(std::span<Twist> V) noexcept {
  started_ = true;
  for (const Row& row : rows_)
    if (!row.contact.impulse.isZero(0.0)) push(row, row.contact.impulse, V);
  std::fill(islands_.begin(), islands_.end(), Range{});
  for (const Row& row : rows_) ++islands_[Index(row.island)].count;
  for (const JointRow& row : joints_) ++islands_[Index(row.island)].joint_count;
  int first = 0;
  int joint_first = 0;
  for (Range& island : islands_) {
    island.first = first;
    island.joint_first = joint_first;
    first += std::exchange(island.count, 0);
    joint_first += std::exchange(island.joint_count, 0);
  }
  order_.resize(rows_.size());
  joint_order_.resize(joints_.size());
  for (Index i = 0; i < rows_.size(); ++i) {
    Range& island = islands_[Index(rows_[i].island)];
    order_[Index(island.first + island.count++)] = static_cast<int>(i);
  }
  for (Index i = 0; i < joints_.size(); ++i) {
    Range& island = islands_[Index(joints_[i].island)];
    joint_order_[Index(island.joint_first + island.joint_count++)] = static_cast<int>(i);
  }
}

/// One round of projected Gauss-Seidel; the largest change of a velocity.
double RestingContact::sweep(const Range& island, std::span<Twist> V) noexcept {
  double change = 0.0;
  for (int i = 0; i < island.joint_count; ++i) {
    JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    Twist& v = V[Index(row.body)];
    const double off = row.wanted - row.along.dot(to_vector(v)) - row.softness * row.impulse;
    row.before = row.impulse;
    row.impulse = std::clamp(row.impulse + off / (row.mobility + row.softness), row.lower, row.upper);
    v = v + to_twist(row.response * (row.impulse - row.before));
    change = std::max(change, std::abs(row.impulse - row.before) * row.mobility);
  }
  for (int i = 0; i < island.count; ++i) {
    Row& row = rows_[Index(order_[Index(island.first + i)])];
    row.before = row.contact.impulse;
    change = std::max(change, row.contact.relax(row.wanted, V[Index(row.body_a)], V[Index(row.body_b)]));
  }
  return change;
}

/// On along the way from sweep to sweep, by a share that grows with their number [Nesterov 1983]; begins anew
/// where the last one had more to change than the one before [Donoghue 2015]. What it oversteps, the next
/// sweep projects.
void RestingContact::accelerate(const Range& island, Pace& pace, std::span<Twist> V) noexcept {
  double change = 0.0;
  for (int i = 0; i < island.count; ++i) {
    const Row& row = rows_[Index(order_[Index(island.first + i)])];
    change += (row.contact.impulse - row.before).squaredNorm();
  }
  for (int i = 0; i < island.joint_count; ++i) {
    const JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    change += (row.impulse - row.before) * (row.impulse - row.before);
  }
  if (change > kMoreToChange * pace.last_change) pace.sweeps = 0;
  pace.last_change = change;
  const double share = pace.sweeps / (pace.sweeps + 3.0);
  ++pace.sweeps;
  for (int i = 0; i < island.count; ++i) {
    Row& row = rows_[Index(order_[Index(island.first + i)])];
    const Vec3 on = share * (row.contact.impulse - row.swept);
    row.swept = row.contact.impulse;
    if (on.isZero(0.0)) continue;
    row.contact.impulse += on;
    push(row, on, V);
  }
  for (int i = 0; i < island.joint_count; ++i) {
    JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    const double on = share * (row.impulse - row.swept);
    row.swept = row.impulse;
    if (share == 0.0) continue;
    row.impulse += on;
    V[Index(row.body)] = V[Index(row.body)] + to_twist(row.response * on);
  }
}

/// Asks nothing of the island to open any more and sets it back to where it began; false when nothing was
/// asked that is more than rounding.
bool RestingContact::open_nothing(const Range& island, std::span<Twist> V) noexcept {
  bool asked = false;
  const int frames_left_shut = frames_in(kLeftShut_s, h_);
  const auto take_off = [&](auto& row, int& left_shut) {
    const double opening = std::exchange(row.opening, 0.0);
    row.wanted -= opening;
    if (!(std::abs(opening) > tolerances::kRestingVelocity)) return;
    left_shut = frames_left_shut;
    asked = true;
  };
  for (int i = 0; i < island.joint_count; ++i) {
    JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    take_off(row, joint_left_shut_[Index(row.body)]);
  }
  for (int i = 0; i < island.count; ++i) {
    Row& row = rows_[Index(order_[Index(island.first + i)])];
    take_off(row, now_[row.last].left_shut);
  }
  if (!asked) return false;
  for (int i = 0; i < island.joint_count; ++i) {
    JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    Twist& v = V[Index(row.body)];
    v = v + to_twist(row.response * (row.begun - row.impulse));
    row.impulse = row.begun;
  }
  for (int i = 0; i < island.count; ++i) {
    Row& row = rows_[Index(order_[Index(island.first + i)])];
    push(row, row.begun - row.contact.impulse, V);
    row.contact.impulse = row.begun;
  }
  return true;
}

void RestingContact::limit_friction(const Range& island) noexcept {
  for (int i = 0; i < island.count; ++i) {
    FrictionRow& contact = rows_[Index(order_[Index(island.first + i)])].contact;
    if (contact.impulse[0] > 0.0) contact.most_across = contact.friction * contact.impulse[0];
  }
}

SolverResult RestingContact::solve_island(const Range& island, int max_sweeps, double harmless,
                                          std::span<Twist> V) noexcept {
  SolverResult result;
  double fastest = 0.0;
  for (int i = 0; i < island.count; ++i) {
    Row& row = rows_[Index(order_[Index(island.first + i)])];
    row.begun = row.contact.impulse;
    row.contact.most_across = kInfinity;
    fastest = std::max({fastest, V[Index(row.body_a)].v.norm(), V[Index(row.body_b)].v.norm()});
  }
  for (int i = 0; i < island.joint_count; ++i) {
    JointRow& row = joints_[Index(joint_order_[Index(island.joint_first + i)])];
    row.begun = row.impulse;
  }
  const double enough = tolerances::kRestingVelocity + tolerances::kSlidingVelocity * fastest;
  Pace pace;
  while (result.iterations < max_sweeps) {
    if (result.iterations++ == std::max(1, max_sweeps / kOpeningShare) && open_nothing(island, V)) pace = {};
    if (result.iterations == max_sweeps - max_sweeps / kLimitedShare) limit_friction(island);
    const double change = sweep(island, V);
    result.converged = change <= harmless;
    if (change <= enough || result.iterations == max_sweeps) break;
    accelerate(island, pace, V);
  }
  return result;
}

SolverResult RestingContact::solve(int max_sweeps, double harmless, std::span<const char> settled,
                                   std::span<Twist> V) noexcept {
  if (!started_) arrange(V);
  SolverResult result{.iterations = 0, .converged = true};
  for (Index i = 0; i < islands_.size(); ++i) {
    if (settled[i] != 0 || islands_[i].count + islands_[i].joint_count == 0) continue;
    const SolverResult solved = solve_island(islands_[i], max_sweeps, harmless, V);
    result.iterations = std::max(result.iterations, solved.iterations);
    result.converged &= solved.converged;
  }
  return result;
}

void RestingContact::end() noexcept {
  for (const Row& row : rows_) now_[row.last].impulse_W = row.contact.impulse_W();
  last_.swap(now_);
}

}  // namespace tactum
