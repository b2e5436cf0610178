#include "tactum/referee/exact_orientation.h"

#include <cmath>
#include <vector>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

/// A sum of doubles that do not overlap, the smallest first: the last one that is not zero has the sign.
class ExactSum {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (const double part : parts_) {
      const double sum = x + part;
      const double virtual_part = sum - x;
      const double error = (x - (sum - virtual_part)) + (part - virtual_part);
      if (error != 0.0) parts_[kept++] = error;
      x = sum;
    }
    parts_.resize(kept);
    parts_.push_back(x);
  }
  void add_product(double x, double y, double z) {
    const double xy = x * y;
    const double xy_error = std::fma(x, y, -xy);
    for (const double factor : {xy, xy_error}) {
      const double product = factor * z;
      add(product);
      add(std::fma(factor, z, -product));
    }
  }
  int sign() const {
    for (std::size_t i = parts_.size(); i-- > 0;)
      if (parts_[i] != 0.0) return parts_[i] > 0.0 ? 1 : -1;
    return 0;
  }

 private:
  std::vector<double> parts_;
};

/// The determinant of three points as rows, times `sign`.
void add_determinant(const Vec3& p, const Vec3& q, const Vec3& r, double sign, ExactSum& sum) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    sum.add_product(sign * p[i], q[j], r[k]);
    sum.add_product(-sign * p[i], q[k], r[j]);
  }
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d;
  const Vec3 v = b - d;
  const Vec3 w = c - d;
  double determinant = 0.0;
  double permanent = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    determinant += u[i] * (v[j] * w[k] - v[k] * w[j]);
    permanent += std::abs(u[i]) * (std::abs(v[j] * w[k]) + std::abs(v[k] * w[j]));
  }
  if (std::abs(determinant) > tolerances::kDeterminantError * permanent) return determinant > 0.0 ? 1 : -1;
  // The four-by-four determinant of the points themselves: their differences may be rounded.
  ExactSum sum;
  add_determinant(a, b, c, 1.0, sum);
  add_determinant(a, b, d, -1.0, sum);
  add_determinant(a, c, d, 1.0, sum);
  add_determinant(b, c, d, -1.0, sum);
  return sum.sign();
}

}  // namespace tactum::inline v0_1
