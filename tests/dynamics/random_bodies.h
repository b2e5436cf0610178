#pragma once
/// Bodies of any freedom for tests of the contact problem.

#include <vector>

#include "tactum/base/random.h"
#include "tactum/dynamics/world.h"
#include "tactum/math/screw.h"

namespace tactum::test {

inline Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// A body of some hundred grams without a part; its inertia is that of some solid.
inline Body random_body(Random& random, JointKind kind) {
  Body body;
  body.mass_kg = random.uniform(0.1, 0.5);
  const Mat3 R = exp_rotation(random_vector(random, 2));
  const double a = random.uniform(1e-5, 2e-5);
  const double b = random.uniform(1e-5, 2e-5);
  body.inertia_B = R * Vec3(a, b, 0.8 * (a + b)).asDiagonal() * R.transpose();
  body.X_WB = {exp_rotation(random_vector(random, 2)), random_vector(random, 0.02)};
  body.joint.kind = kind;
  body.joint.axis_W = random_vector(random, 1.0).normalized();
  body.joint.anchor_W = body.X_WB.p + random_vector(random, 0.03);
  return body;
}

}  // namespace tactum::test
