#include "tactum/dynamics/contact_problem.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The unknown of a joint's friction has a spring of its own, because the metric must be positive: it changes
/// the friction by less than this fraction over the farthest travel of a step.
constexpr double kFrictionSoftness = 1e-3;
constexpr double kFarthestTravel = 0.05;  // [rad or m]

Vec6 column(const Vec3& displacement, const Vec3& turn) {
  Vec6 c;
  c << displacement, turn;
  return c;
}

/// The displacement of the point `r` away.
Vec6 at_point(const Vec6& x, const Vec3& r) {
  return column(x.head<3>() + Vec3(x.tail<3>()).cross(r), x.tail<3>());
}

/// The work of a push over a displacement stated at `centre`.
double work(const Push& push, const Vec3& centre, const Vec6& x) {
  const Vec3 torque = push.torque + (push.p_W - centre).cross(push.force);
  return push.force.dot(x.head<3>()) + torque.dot(x.tail<3>());
}

/// U^-1 of A = U^T U, so that A^-1 = U^-1 U^-T, for a symmetric positive A.
Mat3 inverse_factor(const Mat3& A) noexcept {
  const double u00 = 1.0 / std::sqrt(A(0, 0));  // inverse, as u11 and u22
  const double u01 = A(0, 1) * u00;
  const double u02 = A(0, 2) * u00;
  const double u11 = 1.0 / std::sqrt(A(1, 1) - u01 * u01);
  const double u12 = (A(1, 2) - u01 * u02) * u11;
  const double u22 = 1.0 / std::sqrt(A(2, 2) - u02 * u02 - u12 * u12);
  Mat3 inverse;
  inverse << u00, -u01 * u00 * u11, (u01 * u12 * u11 - u02) * u00 * u22,  //
      0.0, u11, -u12 * u11 * u22,                                         //
      0.0, 0.0, u22;
  return inverse;
}

/// The one unknown of a body on a hinge or slider, whose column is its travel.
JointForces set_motion(ProblemBody& body, const PlacedBody& placed, const BodyMetric& metric,
                       const Vec6& target, double h) noexcept {
  const Vec6 s = at_point(single_motion(placed.body.joint, placed.X_WB), body.centre - body.origin);
  Vec6 Ms;
  Ms << metric.linear * s.head<3>(), metric.angular * s.tail<3>();
  double M = s.dot(Ms);
  double pull = Ms.dot(target);
  const double inertia = metric.has_momentum ? M : 0.0;
  const JointForces forces =
      h > 0.0 ? joint_forces(placed.body, placed.X_WB, placed.joint, inertia, h) : JointForces{};
  if (forces.drag > 0.0) {
    M += forces.drag / h;
    pull += forces.drag * forces.free_rate;
  }
  body.target = s * (pull / M);
  body.motions.col(0) = s / std::sqrt(M);
  return forces;
}

/// The three unknowns of a body on a ball.
JointForces set_motions_about_ball(ProblemBody& body, const PlacedBody& placed, const BodyMetric& metric,
                                   const Vec6& target, double h) noexcept {
  const JointForces forces =
      h > 0.0 ? joint_forces(placed.body, placed.X_WB, placed.joint, 0.0, h) : JointForces{};
  Eigen::Matrix<double, 6, 3> motions = joint_motions(placed.body.joint, placed.X_WB);
  for (int i = 0; i < 3; ++i) motions.col(i) = at_point(motions.col(i), body.centre - body.origin);
  Eigen::Matrix<double, 6, 3> MS;
  MS.topRows<3>() = metric.linear * motions.topRows<3>();
  MS.bottomRows<3>() = metric.angular * motions.bottomRows<3>();
  Mat3 M = motions.transpose() * MS;
  if (forces.drag_about_ball > 0.0) M.diagonal().array() += forces.drag_about_ball / h;
  const Mat3 factor = inverse_factor(M);
  const Vec3 pull = MS.transpose() * target;
  body.motions = motions * factor;
  body.target = body.motions * Vec3(factor.transpose() * pull);
  return forces;
}

}  // namespace

BodyMetric inertial_metric(const Body& body, const Pose& X_WB, double h) noexcept {
  const double per_step = 1.0 / (h * h);
  return {body.mass_kg * per_step, X_WB.R * body.inertia_B * X_WB.R.transpose() * per_step, true};
}

std::size_t freedom_of(const Joint& joint) noexcept {
  switch (joint.kind) {
    case JointKind::kFixed:
      return 0;
    case JointKind::kHinge:
    case JointKind::kSlider:
      return 1;
    case JointKind::kBall:
      return 3;
    case JointKind::kFree:
      break;
  }
  return 6;
}

std::size_t exact_unknowns_of(const World& world, const Body& body) noexcept {
  const Index own = freedom_of(body.joint) + (body.joint.friction > 0.0 ? 1 : 0);
  if (body.pair_joint < 0) return own;
  const JointUnknowns more = joint_unknowns(world.pair_joints[Index(body.pair_joint)].joint);
  return own + more.before + more.behind;
}

ContactProblem::ContactProblem(std::size_t most_rows, std::size_t world_bodies, std::size_t bodies)
    : index_of_(world_bodies, -1) {
  bodies_.reserve(bodies);
  joint_frictions_.reserve(bodies);
  limits_.reserve(2 * bodies);
  locks_.reserve(6 * bodies);
  rows_.reserve(most_rows + kJointRows * bodies);
  z_.reserve(std::max(kMostOfBody * bodies + kRoomBehind, columns::kColumn));
}

void ContactProblem::clear() noexcept {
  for (const ProblemBody& body : bodies_) index_of_[Index(body.body)] = -1;
  bodies_.clear();
  unknowns_ = 0;
  joint_frictions_.clear();
  limits_.clear();
  locks_.clear();
  equalities_ = 0;
  rows_.clear();
  cones_.clear();
  if (is_loaded_) load_.fill(0.0);
  is_loaded_ = false;
}

ProblemBody& ContactProblem::next_body(int body, std::size_t rank, const Vec3& origin,
                                       const Vec3& centre) noexcept {
  index_of_[Index(body)] = static_cast<int>(bodies_.size());
  ProblemBody& next = bodies_.emplace_back();
  next.body = body;
  next.first = unknowns_;
  next.rank = rank;
  next.origin = origin;
  next.centre = centre;
  unknowns_ += rank;
  return next;
}

/// Sets the unknowns of a jointed body: its target is the allowed one nearest to `target` in the metric, with
/// the joint's spring and damping. All stated at the body's centre.
void ContactProblem::set_motions(ProblemBody& body, const PlacedBody& placed, const BodyMetric& metric,
                                 const Vec6& target, double h) noexcept {
  if (body.rank == 0) {
    body.target.setZero();
    return;
  }
  const JointForces forces = body.rank == 1 ? set_motion(body, placed, metric, target, h)
                                            : set_motions_about_ball(body, placed, metric, target, h);
  if (!forces.acts) return;
  const Push along{body.centre, forces.rate.head<3>(), forces.rate.tail<3>()};
  if (forces.friction > 0.0 && body.rank == 1) {
    JointFriction& friction = joint_frictions_.emplace_back();
    friction.friction = forces.friction;
    friction.travel.runs[0] = {
        static_cast<std::uint32_t>(body.first), 1, {work(along, body.centre, body.motions.col(0))}};
    friction.travel.offset = -work(along, body.centre, body.target);
  }
  if (forces.limited_down()) limits_.push_back({body.body, -1, along, std::max(0.0, forces.travel_down)});
  if (forces.limited_up())
    limits_.push_back(
        {body.body, -1, {along.p_W, -along.force, -along.torque}, std::max(0.0, forces.travel_up)});
}

void ContactProblem::add_body(const PlacedBody& placed, const Vec3& centre_W, const BodyMetric& metric,
                              const Vec6& target, double h) noexcept {
  ProblemBody& next = next_body(placed.number, freedom_of(placed.body.joint), placed.X_WB.p, centre_W);
  if (next.rank < 6) {
    set_motions(next, placed, metric, target, h);
    return;
  }
  next.target = target;
  next.per_displacement = 1.0 / std::sqrt(metric.linear);
  next.turns = inverse_factor(metric.angular);
}

void ContactProblem::add_body_and_joint(const World& world, const PlacedBody& placed, const Vec3& centre_W,
                                        const BodyMetric& metric, const Vec6& target, double h) noexcept {
  const int pair = placed.body.pair_joint;
  const JointUnknowns more =
      pair < 0 ? JointUnknowns{} : joint_unknowns(world.pair_joints[Index(pair)].joint);
  unknowns_ += more.before;
  add_body(placed, centre_W, metric, target, h);
  unknowns_ += more.behind;
}

void ContactProblem::add_given(int body, const Vec3& origin_W, const Vec6& displacement) noexcept {
  next_body(body, 0, origin_W, origin_W).target = displacement;
}

void ContactProblem::follow(const ContactProblem& led) noexcept {
  clear();
  for (const ProblemBody& other : led.bodies()) {
    unknowns_ = other.first;  // also those of pair joints before it
    ProblemBody& body = next_body(other.body, other.rank, other.origin, other.centre);
    body.target = led.displacement_at_centre(other);
    body.per_displacement = other.per_displacement;
    body.turns = other.turns;
    body.motions = other.motions;
  }
  for (const Lock& lock : led.locks_) {
    locks_.push_back(lock);
    locks_.back().row = rows_.size();
    QpRow& row = rows_.emplace_back(row_of(lock.pair->body, lock.pair->parent, lock.push));
    row.offset = 0.0;  // the targets are joined
  }
  equalities_ = rows_.size();
  limits_.assign(led.limits_.begin(), led.limits_.end());  // within the room: an assignment would reserve
  add_joint_rows(true);
}

/// Adds one more unknown t that may not be less than the travel a of the joint, in either direction, and that
/// the friction pulls down: t >= a, t >= -a, energy T t + e t^2 / 2, so |T_a| <= T + e t, with e t a
/// thousandth of T.
void ContactProblem::add_friction_unknown(const JointFriction& friction) noexcept {
  if (unknowns_ == kMostUnknowns) return;
  JointFriction with_unknown = friction;
  with_unknown.own = 0;
  with_unknown.travel.runs[0] = {static_cast<std::uint32_t>(unknowns_++), 1, {0.0}};
  with_unknown.travel.runs[1] = friction.travel.runs[0];
  add_friction_rows(with_unknown);
}

void ContactProblem::add_friction_rows(const JointFriction& friction) noexcept {
  const double spring = kFrictionSoftness * friction.friction / kFarthestTravel;
  const double unpulled = -friction.friction / spring;  // t*
  for (const double side : {1.0, -1.0}) {
    QpRow& row = rows_.emplace_back(friction.travel);
    for (QpRow::Run& run : row.runs)
      for (double& g : run.g) g *= -side;
    row.runs[0].g[Index(friction.own)] = 1.0 / std::sqrt(spring);
    row.offset = -side * friction.travel.offset - unpulled;
  }
}

void ContactProblem::add_joint_rows(bool exact) noexcept {
  if (exact)
    for (const JointFriction& friction : joint_frictions_) {
      if (friction.own < 0) {
        add_friction_unknown(friction);
      } else {
        add_friction_rows(friction);
      }
    }
  for (const Limit& limit : limits_) add_row(limit.body, limit.parent, limit.push, -limit.travel);
}

/// Sets what a push on the first body does, and its opposite on the other one.
void ContactProblem::project(int body_a, int body_b, const Push& push, QpRow& row) const noexcept {
  for (Index side = 0; side < 2; ++side) {
    const int number = side == 0 ? body_a : body_b;
    const ProblemBody* const body = number < 0 ? nullptr : find(number);
    if (body == nullptr) continue;
    QpRow::Run& run = row.runs[side];
    run.first = static_cast<std::uint32_t>(body->first);
    run.count = static_cast<std::uint32_t>(body->rank);
    const double sign = side == 0 ? 1.0 : -1.0;
    const Vec3 force = sign * push.force;
    const Vec3 torque = sign * (push.torque + (push.p_W - body->centre).cross(push.force));
    const auto work = [&](const auto& x) {
      return force.dot(x.template head<3>()) + torque.dot(x.template tail<3>());
    };
    row.offset -= work(body->target);
    if (body->rank < 6) {
      for (Index i = 0; i < body->rank; ++i) run.g[i] = work(body->motions.col(Eigen::Index(i)));
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      run.g[Index(i)] = body->per_displacement * force[i];
      run.g[Index(3 + i)] = torque.dot(body->turns.col(i));
    }
  }
}

QpRow ContactProblem::row_of(int body_a, int body_b, const Push& push) const noexcept {
  QpRow row;
  project(body_a, body_b, push, row);
  return row;
}

bool ContactProblem::add_row(int body_a, int body_b, const Push& push, double offset) noexcept {
  if (rows_.size() == rows_.capacity()) return false;
  QpRow& row = rows_.emplace_back();
  row.offset = offset;
  project(body_a, body_b, push, row);
  return true;
}

std::size_t ContactProblem::add_cone(const QpCone& cone) noexcept {
  const Index first = rows_.size() + cones_.size() * QpCone::kEdges;
  cones_.push_back(loaded(cone));
  return first;
}

void ContactProblem::set_cone(std::size_t first_edge, const QpCone& cone) noexcept {
  *(cones_.begin() + (first_edge - rows_.size()) / QpCone::kEdges) = loaded(cone);
}

/// The cone with its offsets for z'.
QpCone ContactProblem::loaded(const QpCone& cone) const noexcept {
  QpCone shifted = cone;
  if (is_loaded_)
    for (QpRow* const row : {&shifted.off, &shifted.along, &shifted.across, &shifted.about})
      row->offset -= dot(*row, load_.data());
  return shifted;
}

void ContactProblem::add_load(const QpRow& along, double force_N) noexcept {
  if (force_N == 0.0) return;
  std::array<double, columns::kColumn> more{};
  push(along, force_N, more.data());
  for (Index i = 0; i < more.size(); ++i) load_[i] += more[i];
  is_loaded_ = true;
  for (QpRow& row : rows_) row.offset -= dot(row, more.data());
  for (QpCone& cone : cones_)
    for (QpRow* const row : {&cone.off, &cone.along, &cone.across, &cone.about})
      row->offset -= dot(*row, more.data());
}

QpProblem ContactProblem::nearest_point() const noexcept {
  return {unknowns_, rows_, {cones_.begin(), cones_.end()}, equalities_, tolerances::kRowKept_m};
}

void ContactProblem::begin(std::span<const int> first) noexcept { qp_.begin(nearest_point(), first); }

const QpAnswer& ContactProblem::solve_on(int max_iterations) noexcept {
  const QpProblem problem = nearest_point();
  const QpAnswer& answer = qp_.solve_on(problem, max_iterations);
  // From the multipliers, so that displacements are to the last bit those that the forces cause.
  z_.assign(load_.begin(), load_.end());
  for (const QpActive& active : answer.active)
    push(problem.row(Index(active.row)), active.multiplier, z_.data());
  return answer;
}

void ContactProblem::begin_values() noexcept { z_.assign(unknowns_ + kRoomBehind, 0.0); }

Vec6 ContactProblem::displacement_at_centre(const ProblemBody& body) const noexcept {
  const double* const at = z() + body.first;
  if (body.rank < 6) {
    Vec6 x = body.target;
    for (Index i = 0; i < body.rank; ++i) x += body.motions.col(Eigen::Index(i)) * at[i];
    return x;
  }
  const Vec3 along(at[0], at[1], at[2]);
  const Vec3 about(at[3], at[4], at[5]);
  return body.target + column(body.per_displacement * along, body.turns * about);
}

Vec6 ContactProblem::displacement_at(int body, const Vec3& p_W) const noexcept {
  const ProblemBody& found = *find(body);
  return at_point(displacement_at_centre(found), p_W - found.centre);
}

Vec3 ContactProblem::target_turn(int body) const noexcept {
  const ProblemBody* const found = find(body);
  return found != nullptr ? Vec3(found->target.tail<3>()) : Vec3::Zero();
}

Vec6 ContactProblem::displacement(int body) const noexcept {
  const ProblemBody* const found = find(body);
  if (found == nullptr) return Vec6::Zero();
  return at_point(displacement_at_centre(*found), found->origin - found->centre);
}

}  // namespace tactum::inline v0_1
