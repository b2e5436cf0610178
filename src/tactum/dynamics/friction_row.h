#pragma once
/// A contact point's three directions and how two bodies answer pushes along them; shared by all that solves
/// for impulses.

#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "tactum/dynamics/contact_row.h"
#include "tactum/dynamics/joint.h"

namespace tactum {

/// A direction of a point of two bodies: how its velocity follows from their twists, and what a unit impulse
/// changes.
struct PushRow {
  Vec6 jacobian_a = Vec6::Zero(), jacobian_b = Vec6::Zero();
  Vec6 response_a = Vec6::Zero(), response_b = Vec6::Zero();
  double mobility = 0.0;  ///< change of the velocity per unit impulse [1/kg]

  void set(const Vec3& direction, const Vec3& arm_a, const Vec3& arm_b, const Mobility& W_a,
           const Mobility& W_b) noexcept {
    jacobian_a << direction, arm_a.cross(direction);
    jacobian_b << -direction, -arm_b.cross(direction);
    respond(W_a, jacobian_a, response_a);
    respond(W_b, jacobian_b, response_b);
    mobility = jacobian_a.dot(response_a) + jacobian_b.dot(response_b);
  }
  /// What does not move, as a rule one of the two, is not worth a product.
  static void respond(const Mobility& W, const Vec6& jacobian, Vec6& response) noexcept {
    if (W.isZero(0.0)) {
      response.setZero();
    } else {
      response.noalias() = W * jacobian;
    }
  }
  double velocity(const Twist& a, const Twist& b) const noexcept {
    return jacobian_a.head<3>().dot(a.v) + jacobian_a.tail<3>().dot(a.w) + jacobian_b.head<3>().dot(b.v) +
           jacobian_b.tail<3>().dot(b.w);
  }
  void push(double impulse, Twist& a, Twist& b) const noexcept {
    a.v += response_a.head<3>() * impulse;
    a.w += response_a.tail<3>() * impulse;
    b.v += response_b.head<3>() * impulse;
    b.w += response_b.tail<3>() * impulse;
  }
};

/// A point with a normal and two tangents, and the impulse that acts on A there.
struct FrictionRow {
  std::array<PushRow, 3> along;  ///< normal, then the tangents
  std::array<Vec3, 3> direction{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  Vec3 impulse = Vec3::Zero();  ///< along these [N s]
  double friction = 0.0;
  double most_across =
      std::numeric_limits<double>::infinity();  ///< of what it rubs with, beside the cone [N s]

  void set(const ContactRow& row, std::span<const Pose> X_WB, std::span<const Mobility> W) noexcept {
    const auto a = static_cast<std::size_t>(row.body_a);
    const auto b = static_cast<std::size_t>(row.body_b);
    direction[0] = row.n_BA_W;
    direction[1] = any_orthogonal(row.n_BA_W);
    direction[2] = row.n_BA_W.cross(direction[1]);
    friction = row.friction;
    for (std::size_t i = 0; i < (friction > 0.0 ? 3u : 1u); ++i)
      along[i].set(direction[i], row.p_W - X_WB[a].p, row.p_W - X_WB[b].p, W[a], W[b]);
    impulse.setZero();
  }
  Vec3 impulse_W() const noexcept {
    return direction[0] * impulse[0] + direction[1] * impulse[1] + direction[2] * impulse[2];
  }

  /// One step of projected Gauss-Seidel: towards a normal velocity of at least `wanted`, and no sliding.
  /// Returns the largest change of a velocity [m/s].
  double relax(double wanted, Twist& a, Twist& b) noexcept {
    if (!(along[0].mobility > 0.0)) return 0.0;
    const double missing = wanted - along[0].velocity(a, b);
    if (missing <= 0.0 && impulse.isZero(0.0)) return 0.0;  // it does not push, so it does not rub
    const double normal = std::max(0.0, impulse[0] + missing / along[0].mobility);
    double change = std::abs(normal - impulse[0]) * along[0].mobility;
    along[0].push(normal - impulse[0], a, b);
    impulse[0] = normal;
    if (!(friction > 0.0)) return change;
    Vec3 after = impulse;
    for (std::size_t i = 1; i < 3; ++i)
      if (along[i].mobility > 0.0) after[i] -= along[i].velocity(a, b) / along[i].mobility;
    const double across = std::sqrt(after[1] * after[1] + after[2] * after[2]);
    const double most = std::min(most_across, friction * normal);
    if (across > most) {
      after[1] *= most / across;
      after[2] *= most / across;
    }
    for (std::size_t i = 1; i < 3; ++i) {
      change = std::max(change, std::abs(after[i] - impulse[i]) * along[i].mobility);
      along[i].push(after[i] - impulse[i], a, b);
      impulse[i] = after[i];
    }
    return change;
  }
};

}  // namespace tactum
