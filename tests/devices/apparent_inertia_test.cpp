#include "tactum/devices/apparent_inertia.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tactum/base/random.h"

namespace tactum::apparent_inertia_test {

Mat3 cross(const Vec3& r) {
  Mat3 m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

/// A ball of mass m and moment of inertia J whose centre is at r from the handle: pushed at the handle across
/// r it gives way by turning too, so it is as light as 1 / (1/m + r^2 / J); turned it has J about its centre.
TEST(ApparentInertia, OfABallOnALeverIsThatOfTheTextbook) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const double m = random.uniform(0.01, 2.0), J = random.uniform(0.00001, 0.01);
    const Vec3 r(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
    Eigen::Matrix<double, 6, 6> M;
    const Mat3 lever = cross(r);
    M << m * Mat3::Identity(), -m * lever, m * lever, J * Mat3::Identity() - m * lever * lever;
    const ApparentInertia least = least_apparent(M);
    EXPECT_NEAR(least.mass_kg * (1.0 / m + r.squaredNorm() / J), 1.0, 1e-9);
    EXPECT_NEAR(least.inertia_kg_m2, J, 1e-9 * (J + m * r.squaredNorm()));
  }
}

TEST(ApparentInertia, OfADeviceWithoutAWristIsTheLeastOfItsThreeDirections) {
  for (const Vec3& masses : {Vec3(0.1, 0.2, 0.3), Vec3(0.3, 0.15, 0.2), Vec3(0.5, 0.5, 0.5)}) {
    const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Eigen::Matrix<double, 6, 6> M = Eigen::Matrix<double, 6, 6>::Zero();
    M.topLeftCorner<3, 3>() = R * masses.asDiagonal() * R.transpose();
    EXPECT_NEAR(least_apparent(M).mass_kg, masses.minCoeff(), 1e-12);
    EXPECT_EQ(least_apparent(M).inertia_kg_m2, 0.0) << "unknown";
  }
}

TEST(ApparentInertia, WhatNoDeviceHasIsUnknown) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const Matrix6 unit = Matrix6::Identity();
  for (const Matrix6& M : {Matrix6(0.0 * unit), Matrix6(-unit), Matrix6(1000.0 * unit),
                           Matrix6(std::numeric_limits<double>::quiet_NaN() * unit)}) {
    EXPECT_EQ(least_apparent(M).mass_kg, 0.0);
    EXPECT_EQ(least_apparent(M).inertia_kg_m2, 0.0);
  }
}

}  // namespace tactum::apparent_inertia_test
