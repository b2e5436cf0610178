#pragma once
/// The virtual coupling: the spring and damper between the probe and the proxy of the grasped part, "a simple
/// spring model based on the transformation from the actual probe to its proxy" [Gregory 2000, 6.1]. Both
/// ends are stated at the handle: the device gives its pose X_WH, the grasped body X_WB X_BH.

#include "tactum/dynamics/contact_problem.h"
#include "tactum/response/settings.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// The wrench that the hand feels, at the handle, world axes: it pulls and turns towards the proxy, the
/// handle on the part, from which the hand is `to_hand` away (handle_at) and which moves with `rate` as the
/// hand sees it.
Wrench coupling_wrench(const Coupling& coupling, const GraspedPart& grasped, const Twist& to_hand,
                       const Twist& rate) noexcept;

/// The stiffness of the coupling over one frame, at the handle: F = K (x - x*), spring and damper together.
struct GraspMetric {
  double stiffness_N_per_m = 0.0;     ///< k_t + b_t / dt [N/m]
  double stiffness_Nm_per_rad = 0.0;  ///< k_r + b_r / dt [N m/rad]
};

GraspMetric grasp_metric(const Coupling& coupling, double dt_s) noexcept;

/// The same as the metric of a body of the contact problem, stated at the handle.
inline BodyMetric body_metric(const GraspMetric& metric) noexcept {
  return {metric.stiffness_N_per_m, metric.stiffness_Nm_per_rad * Mat3::Identity()};
}

/// A grasped part as a body of the contact problem: where its metric is stated, its metric and its target.
struct GraspedBody {
  Vec3 centre_W;      ///< [m]
  BodyMetric metric;  ///< of coupling and damping
  Vec6 target;        ///< at the centre [m, rad]
};

/// That of a part at X_WB whose handle a coupling of this metric would move by `target`. The coupling acts at
/// the handle, the part's damping over `dt_s` at its centre of mass; both together resist displacements and
/// turns apart from each other at a point between the two. About the axis of a rod the coupling resists no
/// turn.
GraspedBody grasped_body_of(const BodyLoad& load, const GraspedPart& grasped, const Pose& X_WB,
                            const GraspMetric& metric, const Vec6& target, double dt_s) noexcept;

/// The part when two hands hold it, each by a coupling that alone makes it one of these: the metrics add up,
/// and so do the forces that lead to the targets. It is stated where the sum resists displacements and turns
/// apart from each other.
GraspedBody grasped_by_both(const GraspedBody& one, const GraspedBody& other) noexcept;

/// The part that `body` is, with the couplings of all hands that hold it; by_hand(hand, number) is the part
/// with that of one.
template <class ByHand>
GraspedBody grasped_by_all(std::span<const HandInput> hands, int body, const ByHand& by_hand) noexcept {
  GraspedBody by_all;
  bool first = true;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    if (hands[h].grasped.body != body) continue;
    const GraspedBody by_this = by_hand(hands[h], h);
    by_all = first ? by_this : grasped_by_both(by_all, by_this);
    first = false;
  }
  return by_all;
}

/// The displacement of the handle, (m, rad), at which the coupling's spring and damper are in balance, when
/// the hand is the displacement `to_hand` away.
Vec6 balanced_step(const Coupling& coupling, double dt_s, const Twist& to_hand, const Twist& V_WH) noexcept;

}  // namespace tactum::inline v0_1
