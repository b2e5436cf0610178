#pragma once
/// The dynamics of a handle that nobody holds, from its answer to known forces along one axis:
///
///   m x'' + b x' + c sign(x') = F(t - d)
///
/// integrated twice, so that no reading is differentiated:
///
///   m x + b int(x) + c int(int(sign)) = int(int(F(t - d))) + p0 + p1 t
///
/// For a delay d it is linear in m, b, c, p0 and p1: least squares. The delay is the one whose remainder,
/// as a length, is the smallest. The commands count as held from write to write, so d has no share of a held
/// sample: it is the delay that the bound on the coupling asks for (coupling_gains.h), there and back.
///
/// A turn follows the same law, with an inertia and torques. It is fitted as the motion of a point at a lever
/// of kResponseLever_m, so that what is enough travel, what is slow, and the error of the damping have one
/// meaning. Its delay is that of the force, with which the torque is written, and need not be looked for.

#include <optional>
#include <span>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// One frame: what was read, and the force that was written then.
struct ResponseSample {
  double time_s = 0.0;   ///< of the read, on the loop's clock [s]
  double x_m = 0.0;      ///< along the axis [m]
  double force_N = 0.0;  ///< sent in this frame [N]
};

struct HandleResponse {
  double mass_kg = 0.0;           ///< [kg]
  double damping_Ns_per_m = 0.0;  ///< [N s/m]
  /// Of the damping: 0.1 N s/m and 15 % of it, or two standard deviations where that is more [N s/m].
  double damping_error_Ns_per_m = 0.0;
  double friction_N = 0.0;   ///< Coulomb [N]
  double delay_s = 0.0;      ///< from a write to the motion that is read, to 1 ms [s]
  double remainder_m = 0.0;  ///< root mean square of what the law leaves unexplained [m]
};

/// The same of turning about one axis.
struct TurnResponse {
  double inertia_kg_m2 = 0.0;              ///< [kg m^2]
  double damping_Nms_per_rad = 0.0;        ///< [N m s/rad]
  double damping_error_Nms_per_rad = 0.0;  ///< 9e-5 N m s/rad and 15 % of it, or more, as above [N m s/rad]
  double friction_Nm = 0.0;                ///< Coulomb [N m]
};

/// About as far from its axis as the fingers that hold a handle [m].
inline constexpr double kResponseLever_m = 0.030;

/// The longest delay that is looked for [s].
inline constexpr double kLongestResponseDelay_s = 0.060;

/// Times increase. An error when the handle hardly moved, or moved otherwise than the law says, as one in a
/// hand does. The delay is looked for where it is not known. Some milliseconds of work.
Result<HandleResponse> fit_handle_response(std::span<const ResponseSample> samples,
                                           std::optional<double> known_delay_s = {});

/// Of what was fitted to x = lever * angle and force = torque / lever.
TurnResponse turn_response(const HandleResponse& at_lever);

}  // namespace tactum::inline v0_1
