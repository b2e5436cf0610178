#pragma once
/// Force fields by formula: the force on a sample point of unit weight at a place. They are stated in the
/// field's own frame F, whose origin is the middle and whose z axis is the field's. Fields of a potential
/// push downhill, F = - grad U; a vortex has none. Each is smooth everywhere, so that a hand can go through
/// its middle.
///
///     dipole   U = M z / rho^3,  rho^2 = r^2 + a^2          in at one end, out at the other
///     well     U = - D exp(- r^2 / (2 w^2))                 to the middle
///     vortex   F = C / (2 pi) (z x p) / (d^2 + a^2)         round the axis at the distance d from it;
///                                                           its curl is  C / pi a^2 / (d^2 + a^2)^2

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// A field at a place: the force and how it changes.
struct FieldValue {
  Vec3 force = Vec3::Zero();     ///< on a sample point of unit weight [N]
  Mat3 gradient = Mat3::Zero();  ///< column j: its change along axis j [N/m]
};

/// A bound on how fast the force changes along any direction, the square root of the largest row sum times
/// the largest column sum: exact for a spring that is the same all round, and for a rotation [N/m].
double steepness(const Mat3& gradient) noexcept;

struct DipoleField {
  double moment_Nm3 = 0.0;  ///< M [N m^3]
  double core_m = 0.0;      ///< a [m]
};
struct WellField {
  double depth_J = 0.0;  ///< D; negative: a hill [J]
  double width_m = 0.0;  ///< w, where the force is largest [m]
};
struct VortexField {
  double circulation_J = 0.0;  ///< C: work of one turn far from the axis [J]
  double core_m = 0.0;         ///< a, where the force is largest [m]
};

FieldValue value_at(const DipoleField& field, const Vec3& p) noexcept;
FieldValue value_at(const WellField& field, const Vec3& p) noexcept;
FieldValue value_at(const VortexField& field, const Vec3& p) noexcept;

/// U of a sample point of unit weight [J].
double potential_at(const DipoleField& field, const Vec3& p) noexcept;
double potential_at(const WellField& field, const Vec3& p) noexcept;

/// A bound on the steepness of the field everywhere [N/m].
double steepest(const DipoleField& field) noexcept;
double steepest(const WellField& field) noexcept;
double steepest(const VortexField& field) noexcept;

}  // namespace tactum::inline v0_1
