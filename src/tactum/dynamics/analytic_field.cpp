#include "tactum/dynamics/analytic_field.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {

double steepness(const Mat3& gradient) noexcept {
  const Mat3 size = gradient.cwiseAbs();
  return std::sqrt(size.rowwise().sum().maxCoeff() * size.colwise().sum().maxCoeff());
}

FieldValue value_at(const DipoleField& field, const Vec3& p) noexcept {
  const double s = 1.0 / (p.squaredNorm() + field.core_m * field.core_m);
  const double c = field.moment_Nm3 * s * std::sqrt(s);  // M / rho^3
  // F = c (3 z p s - e_z)
  FieldValue value;
  value.force = 3.0 * c * s * p.z() * p;
  value.force.z() -= c;
  const Vec3 e_z = Vec3::UnitZ();
  value.gradient = 3.0 * c * s *
                   (p * e_z.transpose() + e_z * p.transpose() + p.z() * Mat3::Identity() -
                    5.0 * s * p.z() * (p * p.transpose()));
  return value;
}

FieldValue value_at(const WellField& field, const Vec3& p) noexcept {
  const double s = 1.0 / (field.width_m * field.width_m);
  const double c = field.depth_J * s * std::exp(-0.5 * s * p.squaredNorm());
  return {-c * p, -c * (Mat3::Identity() - s * (p * p.transpose()))};
}

FieldValue value_at(const VortexField& field, const Vec3& p) noexcept {
  const double s = 1.0 / (p.x() * p.x() + p.y() * p.y() + field.core_m * field.core_m);
  const double c = field.circulation_J / (2.0 * kPi) * s;
  const Vec3 round(-p.y(), p.x(), 0.0);
  FieldValue value;
  value.force = c * round;
  value.gradient = c * skew(Vec3::UnitZ()) - 2.0 * c * s * (round * Vec3(p.x(), p.y(), 0.0).transpose());
  return value;
}

double potential_at(const DipoleField& field, const Vec3& p) noexcept {
  const double s = 1.0 / (p.squaredNorm() + field.core_m * field.core_m);
  return field.moment_Nm3 * p.z() * s * std::sqrt(s);
}

double potential_at(const WellField& field, const Vec3& p) noexcept {
  return -field.depth_J * std::exp(-0.5 * p.squaredNorm() / (field.width_m * field.width_m));
}

double steepest(const DipoleField& field) noexcept {
  // On the axis, where it is largest: 3 M z (3 a^2 - 2 z^2) / rho^7, at z^2 = a^2 (24 - sqrt(480)) / 16.
  const double a = field.core_m;
  const double z = a * std::sqrt((24.0 - std::sqrt(480.0)) / 16.0);
  const double rho_sq = z * z + a * a;
  return std::abs(3.0 * field.moment_Nm3 * z * (3.0 * a * a - 2.0 * z * z)) /
         (rho_sq * rho_sq * rho_sq * std::sqrt(rho_sq));
}

double steepest(const WellField& field) noexcept {
  return std::abs(field.depth_J) / (field.width_m * field.width_m);
}

double steepest(const VortexField& field) noexcept {
  return std::abs(field.circulation_J) / (2.0 * kPi * field.core_m * field.core_m);
}

}  // namespace tactum::inline v0_1
