#pragma once
/// A contact point as the responses take it, and how the search for such points' impulses ended.

#include "tactum/math/types.h"

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
};

/// Of whatever solves for impulses.
struct SolverResult {
  int iterations = 0;      ///< rounds of Newton's method, or sweeps
  bool converged = false;  ///< false: the sweeps ran out; the impulses are usable, not exact
};

}  // namespace tactum
