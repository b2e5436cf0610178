#pragma once
/// The rotation nearest to a matrix that should be one: matrices from files are rounded, and rounding is not
/// orthonormal. Polar decomposition by Newton's iteration, M <- (M + M^-T) / 2 [Higham 1986]: it converges
/// quadratically to the orthogonal factor, which is the nearest orthogonal matrix in the Frobenius norm.
/// Cost: two inversions of a 3 x 3 matrix for six-decimal input.

#include <Eigen/LU>

#include "tactum/base/tolerances.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

struct NearestRotation {
  Mat3 R = Mat3::Identity();  ///< proper rotation; identity when `exists` is false [-]
  double deviation = 0.0;     ///< largest entry of |M M^T - I|: how far the input was from a rotation [-]
  bool exists = false;        ///< false: M is not finite, singular or a reflection
};

inline NearestRotation orthonormalized(const Mat3& M) {
  constexpr int kMaxIterations = 60;  // halves a factor 2^60 of stretch; near rotations take 2 or 3
  NearestRotation result;
  if (!M.allFinite()) return result;
  result.deviation = (M * M.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
  Mat3 R = M;
  for (int i = 0; i < kMaxIterations; ++i) {
    if (!(R.determinant() > 0.0)) return result;
    const Mat3 next = 0.5 * (R + R.inverse().transpose());
    const double change = (next - R).cwiseAbs().maxCoeff();
    R = next;
    if (!R.allFinite()) return result;
    if (change < tolerances::kRotationConverged) break;
  }
  result.R = R;
  result.exists = true;
  return result;
}

}  // namespace tactum::inline v0_1
