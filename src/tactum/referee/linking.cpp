#include "tactum/referee/linking.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

/// The unit vector, or zero where there is no direction.
Vec3 direction_of(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

/// The signed solid angle that the directions from one side to the other fill.
double solid_angle(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 r00 = b0 - a0;
  const Vec3 r01 = b1 - a0;
  const Vec3 r10 = b0 - a1;
  const Vec3 r11 = b1 - a1;
  const Vec3 n[] = {direction_of(r00.cross(r01)), direction_of(r01.cross(r11)), direction_of(r11.cross(r10)),
                    direction_of(r10.cross(r00))};
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += std::asin(std::clamp(n[i].dot(n[(i + 1) % 4]), -1.0, 1.0));
  const double sign = (b1 - b0).cross(a1 - a0).dot(r00);
  return sign > 0.0 ? sum : sign < 0.0 ? -sum : 0.0;
}

}  // namespace

double linking_number(const ClosedLine& a, const ClosedLine& b, const Pose& X_AB) {
  ClosedLine b_A;
  for (const Vec3& corner : b) b_A.push_back(X_AB * corner);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b_A.size(); ++k)
      sum += solid_angle(a[i], a[(i + 1) % a.size()], b_A[k], b_A[(k + 1) % b_A.size()]);
  return sum / (4.0 * kPi);
}

}  // namespace tactum::inline v0_1
