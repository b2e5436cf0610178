#include "tactum/haptics/constraint_problem.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// A brake's spring turns its torque by less than this share over the farthest turn of a frame.
constexpr double kBrakeSoftness = 1e-3;
constexpr double kFarthestTurn_rad = 0.05;

Vec6 column(const Vec3& way, const Vec3& turn) {
  Vec6 c;
  c << way, turn;
  return c;
}

/// The displacement of the point `r` away.
Vec6 at_point(const Vec6& x, const Vec3& r) {
  return column(x.head<3>() + Vec3(x.tail<3>()).cross(r), x.tail<3>());
}

/// One unknown along `motion`, with stiffness m: the wanted displacement is the nearest along it.
void set_single(Mover& mover, const Vec6& motion, double m, double wanted) {
  mover.hinge = motion / std::sqrt(m);
  mover.wanted = motion * wanted;
}

/// What a push does on a displacement told at `centre`.
double work(const Push& push, const Vec3& centre, const Vec6& x) {
  const Vec3 torque = push.torque + (push.p_W - centre).cross(push.force);
  return push.force.dot(x.head<3>()) + torque.dot(x.tail<3>());
}

}  // namespace

HeldMetric held_metric(const Coupling& coupling, double dt_s) noexcept {
  return {coupling.stiffness_N_per_m + coupling.damping_Ns_per_m / dt_s,
          coupling.stiffness_Nm_per_rad + coupling.damping_Nms_per_rad / dt_s};
}

Vec6 balanced_step(const Coupling& coupling, double dt_s, const Pose& X_WH_proxy, const Pose& X_WH,
                   const Twist& V_WH) noexcept {
  // k (x - way) + b (x / dt - v) = 0.
  const HeldMetric metric = held_metric(coupling, dt_s);
  const Twist way = twist_between(X_WH_proxy, X_WH, 1.0);
  return column(
      (coupling.stiffness_N_per_m * way.v + coupling.damping_Ns_per_m * V_WH.v) / metric.stiffness_N_per_m,
      (coupling.stiffness_Nm_per_rad * way.w + coupling.damping_Nms_per_rad * V_WH.w) /
          metric.stiffness_Nm_per_rad);
}

ConstraintProblem::ConstraintProblem(std::size_t most_rows) : most_rows_(most_rows + 2 * kMostMovers) {
  normals_.reserve(most_rows_ * kMostUnknowns);
  offsets_.reserve(most_rows_);
}

void ConstraintProblem::clear() noexcept {
  mover_count_ = 0;
  unknowns_ = 0;
  brakes_.clear();
  normals_.clear();
  offsets_.clear();
}

const Mover* ConstraintProblem::mover_of(int body) const noexcept {
  for (Index m = 0; m < mover_count_; ++m)
    if (movers_[m].body == body) return &movers_[m];
  return nullptr;
}

Mover* ConstraintProblem::next_mover(int body, std::size_t rank, const Vec3& origin,
                                     const Vec3& centre) noexcept {
  if (unknowns_ + rank > kMostUnknowns) return nullptr;
  Mover& mover = movers_[mover_count_++];
  mover.body = body;
  mover.first = unknowns_;
  mover.rank = rank;
  mover.origin = origin;
  mover.centre = centre;
  unknowns_ += rank;
  return &mover;
}

bool ConstraintProblem::add_held(int body, const Joint& joint, const Pose& X_WB, const Vec3& p_WH,
                                 const HeldMetric& metric, const Vec6& wanted) noexcept {
  const double k_t = metric.stiffness_N_per_m;
  const double k_r = metric.stiffness_Nm_per_rad;
  const bool hinged = joint.kind == JointKind::kHinge;
  Mover* const mover = next_mover(body, hinged ? 1 : 6, X_WB.p, p_WH);
  if (mover == nullptr) return false;
  if (hinged) {
    const Vec6 motion = at_point(hinge_motion(joint, X_WB), p_WH - X_WB.p);
    const Vec6 force = column(k_t * motion.head<3>(), k_r * motion.tail<3>());
    const double m = force.dot(motion);
    set_single(*mover, motion, m, force.dot(wanted) / m);
    add_brake(*mover, joint.friction_Nm);
    return true;
  }
  mover->wanted = wanted;
  mover->per_way = 1.0 / std::sqrt(k_t);
  mover->turns = Mat3::Identity() / std::sqrt(k_r);
  return true;
}

bool ConstraintProblem::add_free(int body, const Body& what, const Pose& X_WB, const Vec6& wanted,
                                 double dt_s) noexcept {
  const bool hinged = what.joint.kind == JointKind::kHinge;
  Mover* const mover = next_mover(body, hinged ? 1 : 6, X_WB.p, X_WB.p);
  if (mover == nullptr) return false;
  const Resistance M = inertial_resistance(what, X_WB) / (dt_s * dt_s);
  if (hinged) {
    const Vec6 motion = hinge_motion(what.joint, X_WB);
    const Vec6 force = M * motion;
    const double m = force.dot(motion) + what.joint.damping_Nms / dt_s;
    set_single(*mover, motion, m, force.dot(wanted) / m);
    add_brake(*mover, what.joint.friction_Nm);
    return true;
  }
  mover->wanted = wanted;
  mover->per_way = 1.0 / std::sqrt(M(0, 0));
  const Eigen::LLT<Mat3> inertia(M.bottomRightCorner<3, 3>());
  mover->turns = inertia.matrixU().solve(Mat3::Identity());  // I^-1 = U^-1 U^-T
  return true;
}

void ConstraintProblem::follow(const ConstraintProblem& led) noexcept {
  clear();
  for (const Mover& other : led.movers()) {
    Mover& mover = movers_[mover_count_++];
    mover = other;
    mover.first = unknowns_;
    mover.wanted = led.displacement_at_centre(other);
    unknowns_ += mover.rank;
  }
}

void ConstraintProblem::add_brake(const Mover& hinged, double friction_Nm) noexcept {
  if (!(friction_Nm > 0.0) || unknowns_ == kMostUnknowns) return;
  brakes_.push_back({&hinged, friction_Nm, unknowns_++});
}

void ConstraintProblem::add_brakes() noexcept {
  for (const Brake& brake : brakes_) {
    const double spring = kBrakeSoftness * brake.friction_Nm / kFarthestTurn_rad;
    const double unpulled = -brake.friction_Nm / spring;  // t*
    const Vec6& hinge = brake.hinged->hinge;
    const double turn = hinge.tail<3>().norm();
    const double wanted = brake.hinged->wanted.dot(hinge) / hinge.squaredNorm();
    for (const double side : {1.0, -1.0}) {
      normals_.resize(normals_.size() + unknowns_, 0.0);
      double* const row = normals_.data() + normals_.size() - unknowns_;
      row[brake.unknown] = 1.0 / std::sqrt(spring);
      row[brake.hinged->first] = -side * turn;
      offsets_.push_back(side * turn * wanted - unpulled);
    }
  }
}

bool ConstraintProblem::add_row(int body_a, int body_b, const Push& push, double offset) noexcept {
  if (offsets_.size() == most_rows_) return false;
  normals_.resize(normals_.size() + unknowns_, 0.0);
  double* const row = normals_.data() + normals_.size() - unknowns_;
  const auto project = [&](int body, double sign) {
    const Mover* const mover = mover_of(body);
    if (mover == nullptr) return;
    double* const g = row + mover->first;
    const Vec3 torque = push.torque + (push.p_W - mover->centre).cross(push.force);
    offset -= sign * (push.force.dot(mover->wanted.head<3>()) + torque.dot(mover->wanted.tail<3>()));
    if (mover->rank == 1) {
      g[0] = sign * (push.force.dot(mover->hinge.head<3>()) + torque.dot(mover->hinge.tail<3>()));
      return;
    }
    for (int i = 0; i < 3; ++i) {
      g[i] = sign * mover->per_way * push.force[i];
      g[3 + i] = sign * torque.dot(mover->turns.col(i));
    }
  };
  project(body_a, 1.0);
  project(body_b, -1.0);
  offsets_.push_back(offset);
  return true;
}

double ConstraintProblem::opening(int body_a, int body_b, const Push& push) const noexcept {
  double sum = 0.0;
  if (const Mover* const a = mover_of(body_a)) sum += work(push, a->centre, displacement_at_centre(*a));
  if (const Mover* const b = mover_of(body_b)) sum -= work(push, b->centre, displacement_at_centre(*b));
  return sum;
}

const QpAnswer& ConstraintProblem::solve(std::span<const int> first, int max_iterations) noexcept {
  solve_small_qp({unknowns_, normals_, offsets_, tolerances::kRowKept_m}, first, max_iterations, answer_);
  return answer_;
}

Vec6 ConstraintProblem::displacement_at_centre(const Mover& mover) const noexcept {
  const double* const z = answer_.z.data() + mover.first;
  if (mover.rank == 1) return mover.wanted + mover.hinge * z[0];
  const Vec3 along(z[0], z[1], z[2]);
  const Vec3 about(z[3], z[4], z[5]);
  return mover.wanted + column(mover.per_way * along, mover.turns * about);
}

Vec3 ConstraintProblem::wanted_turn(int body) const noexcept {
  const Mover* const mover = mover_of(body);
  return mover != nullptr ? Vec3(mover->wanted.tail<3>()) : Vec3::Zero();
}

Vec6 ConstraintProblem::displacement(int body) const noexcept {
  const Mover* const mover = mover_of(body);
  if (mover == nullptr) return Vec6::Zero();
  return at_point(displacement_at_centre(*mover), mover->origin - mover->centre);
}

}  // namespace tactum
