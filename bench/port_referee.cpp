#include "bench/port_referee.h"

#include <algorithm>
#include <cmath>

namespace tactum::bench {
namespace {

using Numbers = std::span<const double>;

double number_at(Numbers row, int column) { return row[static_cast<std::size_t>(column)]; }

/// The rotation vector of a quaternion, at most half a turn long.
Vec3 rotation_vector(Quat q) {
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  return s < 1e-300 ? Vec3(Vec3::Zero()) : Vec3(q.vec() * (2.0 * std::atan2(s, q.w()) / s));
}

/// The rotation vector of the same turn that is nearest to `last`.
Vec3 followed(const Vec3& turn, const Vec3& last) {
  const double angle = turn.norm();
  if (angle < 1e-9) return turn;
  const Vec3 axis = turn / angle;
  const double turns = std::round((last.dot(axis) - angle) / (2.0 * kPi));
  return axis * (angle + 2.0 * kPi * turns);
}

/// The rest of a turn without its turn about an axis, which comes first: q = rest * turn about the axis.
Quat untwisted(const Quat& q, const Vec3& axis) {
  const double along = q.vec().dot(axis);
  const double size = std::hypot(q.w(), along);
  if (size < 1e-12) return q;
  const Vec3 v = axis * (along / size);
  return q * Quat(q.w() / size, v.x(), v.y(), v.z()).conjugate();
}

/// What a spring whose force is limited gives back from this stretch.
double given_back(double stiffness, double stretch, double limit) {
  const double yields = limit / stiffness;
  return stretch < yields ? 0.5 * stiffness * stretch * stretch
                          : limit * (stretch - yields) + 0.5 * limit * yields;
}

}  // namespace

PortReferee::PortReferee(const World& world, const FrameSettings& settings, const FrameTrace& trace)
    : world_(world), settings_(settings), joints_(world.bodies.size()) {
  const auto column = [&trace](const std::string& name) { return trace.column(name); };
  at_.ramping = column("ramping");
  at_.device_p = column("device_px_m");
  at_.device_q = column("device_qw");
  at_.hand_p = column("hand_px_m");
  at_.hand_q = column("hand_qw");
  at_.proxy_p = column("proxy_px_m");
  at_.proxy_q = column("proxy_qw");
  at_.sent_f = column("sent_fx_N");
  at_.sent_t = column("sent_tx_Nm");
  at_.smoothed_f = column("smoothed_fx_N");
  at_.unfelt = column("unfelt_tx_Nm");
  at_.computed_f = column("computed_fx_N");
  at_.hand_v = column("hand_vx_m_per_s");
  at_.hand_w = column("hand_wx_rad_per_s");
  at_.computed_t = column("computed_tx_Nm");
  at_.share = column("energy_stiffness_share");
  at_.grasped = column("grasped_body");
  at_.hold = column("hold");
  at_.field_f = column("field_fx_N");
  at_.field_t = column("field_tx_Nm");
  // The bodies' columns are the last ones, thirteen for each.
  const int first = static_cast<int>(trace.width() - 13 * world.bodies.size());
  for (int i = 0; i < static_cast<int>(world.bodies.size()); ++i) {
    at_.body_p.push_back(first + 13 * i);
    at_.body_q.push_back(first + 13 * i + 3);
    at_.body_v.push_back(first + 13 * i + 7);
    at_.body_w.push_back(first + 13 * i + 10);
  }
}

double PortReferee::spring_energy(Numbers row, std::size_t body, bool grasped) {
  const Joint& joint = world_.bodies[body].joint;
  if (!(joint.stiffness > 0.0)) return 0.0;
  Angle& angle = joints_[body];
  angle.before = angle.now;
  const Pose& start = world_.bodies[body].X_WB;
  if (joint.kind == JointKind::kSlider) {
    angle.now = (vector_at(row, at_.body_p[body]) - start.p).dot(joint.axis_W);
  } else {
    const Vec3 turn = rotation_vector(turn_at(row, at_.body_q[body]) * Quat(start.R).conjugate());
    angle.now =
        followed(joint.axis_W * turn.dot(joint.axis_W), joint.axis_W * angle.before).dot(joint.axis_W);
  }
  const double stretch = (grasped ? angle.now : 0.5 * (angle.now + angle.before)) - joint.rest;
  return 0.5 * joint.stiffness * stretch * stretch;
}

double PortReferee::body_energy(Numbers row, std::size_t body, bool grasped) {
  const Body& what = world_.bodies[body];
  if (!what.moves()) return 0.0;
  const Vec3 p = vector_at(row, at_.body_p[body]);
  const Vec3 p_before = last_.empty() || grasped ? p : vector_at(last_, at_.body_p[body]);
  double energy_J =
      spring_energy(row, body, grasped) - what.mass_kg * world_.gravity_W.dot(0.5 * (p + p_before));
  if (grasped) return energy_J;
  const Vec3 v = vector_at(row, at_.body_v[body]);
  const Vec3 w = turn_at(row, at_.body_q[body]).conjugate() * vector_at(row, at_.body_w[body]);
  return energy_J + 0.5 * what.mass_kg * v.squaredNorm() + 0.5 * w.dot(what.inertia_B * w);
}

double PortReferee::stored(Numbers row) {
  const int grasped = static_cast<int>(number_at(row, at_.grasped));
  const double scale = settings_.workspace.scale;
  double energy_J = 0.0;
  for (std::size_t i = 0; i < world_.bodies.size(); ++i)
    energy_J += body_energy(row, i, static_cast<int>(i) == grasped);
  energy_J /= scale;
  if (grasped < 0) return energy_J;
  const double share = last_.empty() ? 1.0 : number_at(last_, at_.share);  // told for the next frame
  const double stretch = (vector_at(row, at_.hand_p) - vector_at(row, at_.proxy_p)).norm() / scale;
  twist_ =
      followed(rotation_vector(turn_at(row, at_.hand_q) * turn_at(row, at_.proxy_q).conjugate()), twist_);
  if (!last_.empty() && grasped != static_cast<int>(number_at(last_, at_.grasped)))
    twist_ = followed(twist_, Vec3::Zero());
  Vec3 twist = twist_;
  constexpr int kRod = 2;  // the hand does not twist what it holds by a rod
  if (static_cast<int>(number_at(row, at_.hold)) == kRod)
    twist = rotation_vector(untwisted(turn_at(row, at_.hand_q) * turn_at(row, at_.proxy_q).conjugate(),
                                      world_.bodies[static_cast<std::size_t>(grasped)].joint.axis_W));
  const bool turns = settings_.port.actuates_torque;
  const Coupling& coupling = settings_.coupling;
  const double k = share * coupling.stiffness_N_per_m, k_r = share * coupling.stiffness_Nm_per_rad;
  // No more of a stretch is there for the hand than it feels, with the damper that works against it.
  const double felt =
      (std::max(vector_at(row, at_.computed_f).norm(), vector_at(row, at_.smoothed_f).norm()) +
       coupling.damping_Ns_per_m * vector_at(row, at_.hand_v).norm() / scale) /
      k;
  const double felt_turn =
      (std::max(turns ? vector_at(row, at_.computed_t).norm() : 0.0, vector_at(row, at_.unfelt).norm()) +
       coupling.damping_Nms_per_rad * vector_at(row, at_.hand_w).norm()) /
      k_r;
  return energy_J + given_back(k, std::min(stretch, felt), settings_.safety.max_force_N) +
         given_back(k_r, std::min(twist.norm(), felt_turn), turns ? settings_.safety.max_torque_Nm : 1e9);
}

double PortReferee::given_from_outside(Numbers row, int grasped) {
  double work_J = 0.0;
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    const Vec3 moved = vector_at(row, at_.body_p[i]) - vector_at(last_, at_.body_p[i]);
    const Vec3 turned =
        rotation_vector(turn_at(row, at_.body_q[i]) * turn_at(last_, at_.body_q[i]).conjugate());
    const Wrench& load = world_.bodies[i].load.constant;
    work_J += load.f.dot(moved) + load.t.dot(turned);
    if (static_cast<int>(i) == grasped)
      work_J += vector_at(row, at_.field_f).dot(moved) + vector_at(row, at_.field_t).dot(turned);
  }
  return work_J / settings_.workspace.scale;
}

void PortReferee::look(Numbers row) {
  const double stored_J = stored(row);
  const bool ramped = !last_.empty() && number_at(last_, at_.ramping) != 0.0;
  if (known_ && !ramped) {
    const Mat3& R_WD = settings_.workspace.X_WD.R;
    const Vec3 moved = R_WD * (vector_at(row, at_.device_p) - vector_at(last_, at_.device_p));
    const Vec3 turned =
        R_WD * rotation_vector(turn_at(row, at_.device_q) * turn_at(last_, at_.device_q).conjugate());
    const Vec3 torque =
        settings_.port.actuates_torque ? vector_at(last_, at_.sent_t) : vector_at(last_, at_.unfelt);
    const double work_J = -vector_at(last_, at_.sent_f).dot(moved) - torque.dot(turned);
    const double given_J = given_from_outside(row, static_cast<int>(number_at(row, at_.grasped)));
    const PortSettings& port = settings_.port;
    const double eaten_J =
        port.damping_Ns_per_m * moved.squaredNorm() / settings_.dt_s + port.friction_N * moved.norm() +
        port.damping_Nms_per_rad * turned.squaredNorm() / settings_.dt_s + port.friction_Nm * turned.norm();
    eaten_J_ += eaten_J;
    balance_J_ += work_J + eaten_J + given_J - (stored_J - stored_J_);
    lowest_of_motors_J_ = std::min(lowest_of_motors_J_, balance_J_ - eaten_J_);
    lowest_J_ = std::min(lowest_J_, balance_J_);
    highest_J_ = std::max(highest_J_, balance_J_);
    fall_J_ = std::max(fall_J_, highest_J_ - balance_J_);
  }
  stored_J_ = stored_J;
  last_.assign(row.begin(), row.end());
  known_ = true;
}

}  // namespace tactum::bench
