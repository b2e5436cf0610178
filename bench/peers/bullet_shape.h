#pragma once
/// Shapes and poses as Bullet wants them.

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <memory>

#include "bench/shapes.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

inline btTransform bullet_pose(const Pose& X) {
  const Mat3& R = X.R;
  return btTransform(
      btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
      btVector3(X.p.x(), X.p.y(), X.p.z()));
}

/// Without the margin by which Bullet rounds its shapes: we compare the shapes as they are.
inline std::unique_ptr<btConvexShape> bullet_shape(const Shape& shape) {
  std::unique_ptr<btConvexShape> made;
  if (shape.box_half_m) {
    const Vec3& half = *shape.box_half_m;
    auto box = std::make_unique<btBoxShape>(btVector3(half.x(), half.y(), half.z()));
    made = std::move(box);
  } else {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Vec3& v : shape.polytope.vertices) hull->addPoint(btVector3(v.x(), v.y(), v.z()), false);
    hull->recalcLocalAabb();
    made = std::move(hull);
  }
  made->setMargin(0.0);
  return made;
}

}  // namespace tactum::bench
