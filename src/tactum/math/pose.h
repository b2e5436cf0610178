#pragma once
/// The pose of a frame B in a frame A. `X_AB * p_B` is the same point in A; `X_AB * X_BC` is X_AC.

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// R v, written out: Eigen's general product is a call.
inline Vec3 rotated(const Mat3& R, const Vec3& v) {
  return R.col(0) * v.x() + R.col(1) * v.y() + R.col(2) * v.z();
}

/// R^T v: back from B to A where R is B's in A.
inline Vec3 rotated_back(const Mat3& R, const Vec3& v) {
  return {R.col(0).dot(v), R.col(1).dot(v), R.col(2).dot(v)};
}

struct Pose {
  Mat3 R = Mat3::Identity();  ///< axes of B, as columns, in A [-]
  Vec3 p = Vec3::Zero();      ///< origin of B in A [m]

  Vec3 operator*(const Vec3& point) const { return rotated(R, point) + p; }
  Pose operator*(const Pose& X) const { return {R * X.R, R * X.p + p}; }
  Pose inverse() const { return {R.transpose(), -rotated_back(R, p)}; }

  bool finite() const { return R.allFinite() && p.allFinite(); }
};

/// X_AB with the rotation put back on the manifold: products drift by about 1e-16 a factor.
inline Pose renormalized(const Pose& X) { return {Quat(X.R).normalized().toRotationMatrix(), X.p}; }

/// inverse(a) * b without forming the inverse: X_AB from X_WA and X_WB.
inline Pose relative_pose(const Pose& X_WA, const Pose& X_WB) {
  return {X_WA.R.transpose() * X_WB.R, X_WA.R.transpose() * (X_WB.p - X_WA.p)};
}

}  // namespace tactum::inline v0_1
