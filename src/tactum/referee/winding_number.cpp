#include "tactum/referee/winding_number.h"

#include <cmath>

namespace tactum::inline v0_1 {

double winding_number(const TriangleMesh& mesh, const Vec3& point) {
  double half_angles = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - point;
    const Vec3 b = mesh.vertices[t[1]] - point;
    const Vec3 c = mesh.vertices[t[2]] - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    // Half the solid angle [Oosterom and Strackee 1983].
    half_angles +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return half_angles / (2.0 * kPi);
}

}  // namespace tactum::inline v0_1
