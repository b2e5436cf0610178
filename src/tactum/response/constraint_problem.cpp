#include "tactum/response/constraint_problem.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// The spring of a joint's friction changes its torque by less than this share over the farthest displacement
/// of a frame.
constexpr double kFrictionSoftness = 1e-3;
constexpr double kFarthestTravel = 0.05;  // [rad or m]

Vec6 column(const Vec3& translation, const Vec3& turn) {
  Vec6 c;
  c << translation, turn;
  return c;
}

/// The displacement of the point `r` away.
Vec6 at_point(const Vec6& x, const Vec3& r) {
  return column(x.head<3>() + Vec3(x.tail<3>()).cross(r), x.tail<3>());
}

/// How many ways a joint leaves.
Index rank_of(const Joint& joint) {
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

/// What a push does on a displacement told at `centre`.
double work(const Push& push, const Vec3& centre, const Vec6& x) {
  const Vec3 torque = push.torque + (push.p_W - centre).cross(push.force);
  return push.force.dot(x.head<3>()) + torque.dot(x.tail<3>());
}

}  // namespace

Index unknowns_of(const Joint& joint) noexcept { return rank_of(joint) + (joint.friction > 0.0 ? 1 : 0); }

GraspMetric grasp_metric(const Coupling& coupling, double dt_s) noexcept {
  return {coupling.stiffness_N_per_m + coupling.damping_Ns_per_m / dt_s,
          coupling.stiffness_Nm_per_rad + coupling.damping_Nms_per_rad / dt_s};
}

Vec6 balanced_step(const Coupling& coupling, double dt_s, const Pose& X_WH_proxy, const Pose& X_WH,
                   const Twist& V_WH) noexcept {
  // k (x - stretch) + b (x / dt - v) = 0.
  const GraspMetric metric = grasp_metric(coupling, dt_s);
  const Twist stretch = twist_between(X_WH_proxy, X_WH, 1.0);
  return column((coupling.stiffness_N_per_m * stretch.v + coupling.damping_Ns_per_m * V_WH.v) /
                    metric.stiffness_N_per_m,
                (coupling.stiffness_Nm_per_rad * stretch.w + coupling.damping_Nms_per_rad * V_WH.w) /
                    metric.stiffness_Nm_per_rad);
}

ConstraintProblem::ConstraintProblem(std::size_t most_rows) : most_rows_(most_rows + 4 * kMostBodies) {
  rows_.reserve(most_rows_);
}

void ConstraintProblem::clear() noexcept {
  body_count_ = 0;
  unknowns_ = 0;
  joint_frictions_.clear();
  limits_.clear();
  rows_.clear();
  cones_.clear();
}

const ProblemBody* ConstraintProblem::find_body(int body) const noexcept {
  for (Index m = 0; m < body_count_; ++m)
    if (bodies_[m].body == body) return &bodies_[m];
  return nullptr;
}

ProblemBody* ConstraintProblem::next_body(int body, std::size_t rank, const Vec3& origin,
                                          const Vec3& centre) noexcept {
  if (unknowns_ + rank > kMostUnknowns) return nullptr;
  ProblemBody& problem_body = bodies_[body_count_++];
  problem_body.body = body;
  problem_body.first = unknowns_;
  problem_body.rank = rank;
  problem_body.origin = origin;
  problem_body.centre = centre;
  unknowns_ += rank;
  return &problem_body;
}

/// The unknowns of a jointed body: what is nearest to `wanted` in the metric and with the joint's spring and
/// damping is where it goes by itself. All are given at the body's centre.
void ConstraintProblem::set_motions(ProblemBody& problem_body, const Body& what, const Pose& X_WB,
                                    const Mat6& metric, const Vec6& wanted, double spring,
                                    double damping) noexcept {
  JointMotions S = joint_motions(what.joint, X_WB);
  for (Eigen::Index i = 0; i < S.cols(); ++i)
    S.col(i) = at_point(S.col(i), problem_body.centre - problem_body.origin);
  using Reduced = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
  using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
  Reduced M = S.transpose() * metric * S;
  Few pull = S.transpose() * metric * wanted;
  for (Eigen::Index i = 0; i < S.cols(); ++i) M(i, i) += spring + damping;
  if (spring > 0.0) pull[0] -= spring * (joint_position(what, X_WB) - what.joint.rest);
  const Eigen::LLT<Reduced> factor(M);
  factor.solveInPlace(pull);
  problem_body.wanted = S * pull;
  problem_body.motions = factor.matrixL().solve(S.transpose()).transpose();  // M^-1 = L^-T L^-1
}

void ConstraintProblem::add_joint(const ProblemBody& problem_body, const Body& what,
                                  const Pose& X_WB) noexcept {
  const Joint& joint = what.joint;
  const Vec6 rate = joint_rate(what, X_WB);
  const Push along{problem_body.centre, rate.head<3>(), rate.tail<3>()};
  if (joint.friction > 0.0 && problem_body.rank == 1 && unknowns_ < kMostUnknowns)
    joint_frictions_.push_back({&problem_body, joint.friction,
                                work(along, problem_body.centre, problem_body.motions.col(0)), unknowns_++});
  if (!joint.limited()) return;
  const double position = joint_position(what, X_WB);
  if (std::isfinite(joint.lower))
    limits_.push_back({problem_body.body, along, std::max(0.0, position - joint.lower)});
  if (std::isfinite(joint.upper))
    limits_.push_back(
        {problem_body.body, {along.p_W, -along.force, -along.torque}, std::max(0.0, joint.upper - position)});
}

bool ConstraintProblem::add_grasped(int body, const Body& what, const Pose& X_WB, const Vec3& p_WH,
                                    const GraspMetric& metric, const Vec6& wanted) noexcept {
  const double k_t = metric.stiffness_N_per_m;
  const double k_r = metric.stiffness_Nm_per_rad;
  ProblemBody* const problem_body = next_body(body, rank_of(what.joint), X_WB.p, p_WH);
  if (problem_body == nullptr) return false;
  if (problem_body->rank < 6) {
    Mat6 M = Mat6::Zero();
    M.diagonal() << k_t, k_t, k_t, k_r, k_r, k_r;
    set_motions(*problem_body, what, X_WB, M, wanted, 0.0, 0.0);
    add_joint(*problem_body, what, X_WB);
    return true;
  }
  problem_body->wanted = wanted;
  problem_body->per_translation = 1.0 / std::sqrt(k_t);
  problem_body->turns = Mat3::Identity() / std::sqrt(k_r);
  return true;
}

bool ConstraintProblem::add_free(int body, const Body& what, const Pose& X_WB, const Vec6& wanted,
                                 double dt_s) noexcept {
  ProblemBody* const problem_body = next_body(body, rank_of(what.joint), X_WB.p, X_WB.p);
  if (problem_body == nullptr) return false;
  const Resistance M = inertial_resistance(what, X_WB) / (dt_s * dt_s);
  if (problem_body->rank < 6) {
    set_motions(*problem_body, what, X_WB, M, wanted, what.joint.stiffness, what.joint.damping / dt_s);
    add_joint(*problem_body, what, X_WB);
    return true;
  }
  problem_body->wanted = wanted;
  problem_body->per_translation = 1.0 / std::sqrt(M(0, 0));
  const Eigen::LLT<Mat3> inertia(M.bottomRightCorner<3, 3>());
  problem_body->turns = inertia.matrixU().solve(Mat3::Identity());  // I^-1 = U^-1 U^-T
  return true;
}

void ConstraintProblem::follow(const ConstraintProblem& led) noexcept {
  clear();
  for (const ProblemBody& other : led.bodies()) {
    ProblemBody& problem_body = bodies_[body_count_++];
    problem_body = other;
    problem_body.first = unknowns_;
    problem_body.wanted = led.displacement_at_centre(other);
    unknowns_ += problem_body.rank;
  }
  limits_ = led.limits_;
  add_joint_rows();
}

void ConstraintProblem::add_joint_rows() noexcept {
  for (const JointFriction& joint_friction : joint_frictions_) {
    const double spring = kFrictionSoftness * joint_friction.friction / kFarthestTravel;
    const double unpulled = -joint_friction.friction / spring;  // t*
    const ProblemBody& problem_body = *joint_friction.problem_body;
    const double wanted = joint_friction.per_unknown * problem_body.wanted.dot(problem_body.motions.col(0)) /
                          problem_body.motions.col(0).squaredNorm();
    for (const double side : {1.0, -1.0}) {
      QpRow& row = rows_.emplace_back();
      row.runs[0] = {static_cast<std::uint32_t>(joint_friction.unknown), 1, {1.0 / std::sqrt(spring)}};
      row.runs[1] = {static_cast<std::uint32_t>(problem_body.first), 1, {-side * joint_friction.per_unknown}};
      row.offset = side * wanted - unpulled;
    }
  }
  for (const Limit& limit : limits_) add_row(row_of(limit.body, -1, limit.push), -limit.travel_left);
}

QpRow ConstraintProblem::row_of(int body_a, int body_b, const Push& push) const noexcept {
  QpRow row;
  const auto project = [&](int body, double sign, QpRow::Run& run) {
    const ProblemBody* const problem_body = find_body(body);
    if (problem_body == nullptr) return;
    run.first = static_cast<std::uint32_t>(problem_body->first);
    run.count = static_cast<std::uint32_t>(problem_body->rank);
    std::array<double, QpRow::kLongestRun>& g = run.g;
    const Vec3 torque = push.torque + (push.p_W - problem_body->centre).cross(push.force);
    row.offset -=
        sign * (push.force.dot(problem_body->wanted.head<3>()) + torque.dot(problem_body->wanted.tail<3>()));
    if (problem_body->rank < 6) {
      for (Index i = 0; i < problem_body->rank; ++i)
        g[i] = sign * work(push, problem_body->centre, problem_body->motions.col(Eigen::Index(i)));
      return;
    }
    for (int i = 0; i < 3; ++i) {
      g[Index(i)] = sign * problem_body->per_translation * push.force[i];
      g[Index(3 + i)] = sign * torque.dot(problem_body->turns.col(i));
    }
  };
  project(body_a, 1.0, row.runs[0]);
  project(body_b, -1.0, row.runs[1]);
  return row;
}

bool ConstraintProblem::add_row(const QpRow& row, double offset) noexcept {
  if (rows_.size() == most_rows_) return false;
  rows_.push_back(row);
  rows_.back().offset += offset;
  return true;
}

std::size_t ConstraintProblem::add_cone(const QpCone& cone) noexcept {
  const Index first = rows_.size() + cones_.size() * QpCone::kEdges;
  cones_.push_back(cone);
  return first;
}

QpProblem ConstraintProblem::nearest_point() const noexcept {
  return {unknowns_, rows_, {cones_.begin(), cones_.end()}, tolerances::kRowKept_m};
}

void ConstraintProblem::begin(std::span<const int> first) noexcept { qp_.begin(nearest_point(), first); }

const QpAnswer& ConstraintProblem::solve_on(int max_iterations) noexcept {
  return qp_.solve_on(nearest_point(), max_iterations);
}

Vec6 ConstraintProblem::displacement_at_centre(const ProblemBody& problem_body) const noexcept {
  const double* const z = answer().z.data() + problem_body.first;
  if (problem_body.rank < 6) {
    Vec6 x = problem_body.wanted;
    for (Index i = 0; i < problem_body.rank; ++i) x += problem_body.motions.col(Eigen::Index(i)) * z[i];
    return x;
  }
  const Vec3 along(z[0], z[1], z[2]);
  const Vec3 about(z[3], z[4], z[5]);
  return problem_body.wanted + column(problem_body.per_translation * along, problem_body.turns * about);
}

Vec3 ConstraintProblem::wanted_turn(int body) const noexcept {
  const ProblemBody* const problem_body = find_body(body);
  return problem_body != nullptr ? Vec3(problem_body->wanted.tail<3>()) : Vec3::Zero();
}

Vec6 ConstraintProblem::displacement(int body) const noexcept {
  const ProblemBody* const problem_body = find_body(body);
  if (problem_body == nullptr) return Vec6::Zero();
  return at_point(displacement_at_centre(*problem_body), problem_body->origin - problem_body->centre);
}

}  // namespace tactum
