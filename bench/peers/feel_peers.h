#pragma once
/// Rigid-body engines that hold a part by a spring and damper, each in a file of its own that is compiled
/// when its library is installed.

#include <cmath>

#include "bench/feel.h"
#include "tactum/math/screw.h"

namespace tactum::bench {

std::unique_ptr<FeelEngine> make_bullet_feel(const FeelScene& scene, const FeelSetup& setup);
std::unique_ptr<FeelEngine> make_ode_feel(const FeelScene& scene, const FeelSetup& setup);

/// The same stiffness as ours and critical damping, so that the held mass does not swing.
struct PeerCoupling {
  double k_t, k_r, b_t, b_r;

  explicit PeerCoupling(const Coupling& c)
      : k_t(c.stiffness_N_per_m),
        k_r(c.stiffness_Nm_per_rad),
        b_t(2.0 * std::sqrt(k_t * kFeltMass_kg)),
        b_r(2.0 * std::sqrt(k_r * kFeltInertia_kg_m2)) {}
  /// On the hand; the part gets its opposite.
  Wrench on_hand(const Pose& X_WH, const Twist& V_WH, const Pose& X_WB, const Twist& V_WB) const {
    return {k_t * (X_WB.p - X_WH.p) + b_t * (V_WB.v - V_WH.v),
            k_r * log_rotation(X_WB.R * X_WH.R.transpose()) + b_r * (V_WB.w - V_WH.w)};
  }
};

}  // namespace tactum::bench
