#pragma once
/// The vector types: Eigen's, in double precision. Float was measured to be no faster here and to lose 1e-6
/// of a part's size.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tactum::inline v0_1 {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat3 = Eigen::Matrix3d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Quat = Eigen::Quaterniond;

inline constexpr double kPi = 3.14159265358979323846;

/// The matrix of the cross product: skew(a) b = a x b.
inline Mat3 skew(const Vec3& a) {
  Mat3 S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

/// A unit vector at right angles to unit `n`, continuous but where the smallest component of `n` changes.
inline Vec3 any_orthogonal(const Vec3& n) {
  const Vec3 a = n.cwiseAbs();
  Vec3 axis = Vec3::UnitZ();
  if (a.x() <= a.y() && a.x() <= a.z()) {
    axis = Vec3::UnitX();
  } else if (a.y() <= a.z()) {
    axis = Vec3::UnitY();
  }
  return n.cross(axis).normalized();
}

}  // namespace tactum::inline v0_1
