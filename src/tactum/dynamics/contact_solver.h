#pragma once
/// Contact forces by the penalty law, solved together and implicitly.
///
/// The published law pushes with  F = k (delta - d)  while d < delta [Gregory 2000, 5.2]; D_p is -d, so the
/// same line serves the overlapping pair, F = k (delta + D_p). Applied with the distance of the *start* of
/// the step, such a spring shakes as soon as k h^2 exceeds what it pushes on, and the proxy weighs nothing.
/// So the law is asked to hold at the *end* of the step: with  d' = d + h vn  and the impulse  lambda = h F,
///
///     vn + lambda / (k h^2) = (delta - d) / h,     lambda >= 0,     vn = n . (v_A - v_B) after all impulses,
///
/// which is a linear complementarity problem with a positive definite matrix, and its other side the least of
/// a convex function of the bodies' motion. That is found exactly by Newton's method while at most 24
/// directions of motion (four free bodies) and 128 rows take part: two rounds as a rule, each linear in the
/// rows. Beyond that by projected Gauss-Seidel with a bounded number of sweeps (two gears with 14 rows took
/// it 54). It is stable for every k, h and mass, and at rest its forces are the published ones exactly.

#include <span>

#include "tactum/dynamics/joint.h"

namespace tactum {

/// One contact point between two bodies: normal from B to A, as in collision/contact.h, told in the world.
struct ContactRow {
  int body_a = -1, body_b = -1;
  int patch = -1;              ///< the caller's number of the patch it stands for; the solver ignores it
  int grip = -1;               ///< ... and of the friction it takes part in
  Vec3 n_BA_W = Vec3::Zero();  ///< unit [-]
  Vec3 p_W = Vec3::Zero();     ///< where the force acts [m]
  double distance = 0.0;       ///< signed, at the start of the step [m]
  double tolerance = 0.0;      ///< delta of the pair [m]
  double stiffness = 0.0;      ///< k, the point's share [N/m]
  double friction = 0.0;       ///< Coulomb's coefficient [-]
  double restitution = 0.0;    ///< of the speed, in an impact [-]
  bool struck = true;          ///< takes part in impacts
  bool hit = false;            ///< an impact was seen here first, in this frame
  double impulse = 0.0;        ///< lambda, the solver's answer [N s]

  // For the sweeps only: lever arms, twist changes per unit impulse.
  Vec6 jacobian_a = Vec6::Zero(), jacobian_b = Vec6::Zero();
  Vec6 response_a = Vec6::Zero(), response_b = Vec6::Zero();
  double diagonal = 0.0;
};

struct SolverResult {
  int iterations = 0;      ///< rounds of Newton's method, or sweeps
  bool converged = false;  ///< false: the sweeps ran out; the impulses are usable, not exact
};

/// Finds the impulses and adds their effect to the twists `V` (one per body). `h` [s] is the step they act
/// for.
SolverResult solve_contacts(std::span<ContactRow> rows, std::span<const Pose> X_WB,
                            std::span<const Mobility> W, double h, int max_sweeps,
                            std::span<Twist> V) noexcept;

}  // namespace tactum
