#include "tactum/devices/apparent_inertia.h"

#include <Eigen/Eigenvalues>

namespace tactum::inline v0_1 {
namespace {

constexpr double kMostMass_kg = 100.0, kMostInertia_kg_m2 = 10.0;

double least_eigenvalue(const Mat3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
}

/// What is left of the block `a` while the other three directions, of the block `b`, are free.
double least_left(const Mat3& a, const Mat3& b, const Mat3& between, double most) {
  const Mat3 left =
      least_eigenvalue(b) > 0.0 ? Mat3(a - between * b.inverse() * between.transpose()) : Mat3(a);
  const double least = least_eigenvalue(left);
  return least > 0.0 && least < most ? least : 0.0;
}

}  // namespace

ApparentInertia least_apparent(const Eigen::Matrix<double, 6, 6>& stated) {
  if (!stated.allFinite()) return {};
  const Eigen::Matrix<double, 6, 6> M = 0.5 * (stated + stated.transpose());
  const Mat3 push = M.topLeftCorner<3, 3>(), turn = M.bottomRightCorner<3, 3>();
  const Mat3 between = M.topRightCorner<3, 3>();
  return {least_left(push, turn, between, kMostMass_kg),
          least_left(turn, push, between.transpose(), kMostInertia_kg_m2)};
}

}  // namespace tactum::inline v0_1
