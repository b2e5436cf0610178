#include "support/rotation_between.h"

namespace tactum::testing {

Mat3 rotation_between(const Vec3& from, const Vec3& to) {
  return Quat::FromTwoVectors(from, to).normalized().toRotationMatrix();
}

}  // namespace tactum::testing
