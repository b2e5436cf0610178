#pragma once
/// A contact with its manifold, and the conditions that the tests of manifolds check.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tactum/collision/closest_features.h"
#include "tactum/collision/manifold.h"
#include "tactum/geometry/primitives.h"

namespace tactum::manifold_tests {

using Kind = FeatureKind;

struct Contact {
  PairDistance closest;
  Manifold patch;
};

/// How far the patch's points are from the plane of the face they are on, of either piece that takes part
/// with one.
inline double off_the_faces(const Polytope& A, const Polytope& B, const Pose& X_AB, const Manifold& patch) {
  double off = 0.0;
  for (const ContactPoint& p : patch.points) {
    const Vec3 in_b = X_AB.inverse() * p.p_b;
    if (patch.a.kind == Kind::kFace) {
      const Polytope::Face& face = A.faces[std::size_t(patch.a.index)];
      off = std::max(off, std::abs(face.normal.dot(p.p_a) - face.offset));
    }
    if (patch.b.kind == Kind::kFace) {
      const Polytope::Face& face = B.faces[std::size_t(patch.b.index)];
      off = std::max(off, std::abs(face.normal.dot(in_b) - face.offset));
    }
  }
  return off;
}

/// The closest features at a pose, and the manifold there, whose points are checked to lie on their faces.
inline Contact contact(const Polytope& A, const Polytope& B, const Pose& X_AB, double tolerance) {
  Contact c;
  PairCache cache;
  c.closest = closest_features(A, B, X_AB, cache);
  contact_manifold(A, B, X_AB, c.closest, tolerance, c.patch);
  EXPECT_LT(off_the_faces(A, B, X_AB, c.patch),
            1e-13 * (1.0 + X_AB.p.norm() + A.extent.magnitude + B.extent.magnitude));
  return c;
}

inline Vec3 centroid(const Manifold& patch) {
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& p : patch.points) sum += p.weight * 0.5 * (p.p_a + p.p_b);
  return sum;
}

/// Second moments about the centroid, along two unit directions.
inline double second_moment(const Manifold& patch, const Vec3& u, const Vec3& v) {
  const Vec3 c = centroid(patch);
  double sum = 0.0;
  for (const ContactPoint& p : patch.points) {
    const Vec3 r = 0.5 * (p.p_a + p.p_b) - c;
    sum += p.weight * u.dot(r) * v.dot(r);
  }
  return sum;
}

inline void expect_kinds(const Manifold& patch, Kind a, Kind b, std::size_t points) {
  EXPECT_EQ(patch.a.kind, a);
  EXPECT_EQ(patch.b.kind, b);
  EXPECT_EQ(patch.points.size(), points);
}

/// The conditions of every patch.
inline void expect_sound(const Contact& c, double tolerance, double allowed) {
  ASSERT_FALSE(c.patch.points.empty());
  double weight = 0.0;
  for (const ContactPoint& p : c.patch.points) {
    weight += p.weight;
    EXPECT_NEAR(p.distance, c.patch.normal.dot(p.p_a - p.p_b), allowed);
    EXPECT_LE(p.distance, tolerance + allowed);
    EXPECT_GE(p.distance, c.closest.distance - allowed);
  }
  EXPECT_NEAR(weight, 1.0, 1e-14);
}

/// 4 x 6 x 2 cm.
inline const Polytope& box() {
  static const Polytope P = make_box({0.02, 0.03, 0.01});
  return P;
}

inline Pose above(double x, double y, double z, const Mat3& R = Mat3::Identity()) { return {R, {x, y, z}}; }

}  // namespace tactum::manifold_tests
