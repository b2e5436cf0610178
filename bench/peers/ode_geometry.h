#pragma once
/// Shapes as ODE wants them.

#include <ode/ode.h>

#include <vector>

#include "bench/shapes.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

/// What ODE's geometry points to, and the geometry itself.
class OdeGeometry {
 public:
  explicit OdeGeometry(const Shape& shape) {
    if (shape.box_half_m) {
      const Vec3 side = 2.0 * *shape.box_half_m;
      id_ = dCreateBox(nullptr, side.x(), side.y(), side.z());
      return;
    }
    const Polytope& P = shape.polytope;
    for (const Vec3& v : P.vertices) points_.insert(points_.end(), {v.x(), v.y(), v.z()});
    for (const Polytope::Face& face : P.faces) {
      planes_.insert(planes_.end(), {face.normal.x(), face.normal.y(), face.normal.z(), face.offset});
      polygons_.push_back(static_cast<unsigned>(face.count));
      for (int i = 0; i < face.count; ++i)
        polygons_.push_back(static_cast<unsigned>(P.face_vertices[static_cast<std::size_t>(face.first + i)]));
    }
    id_ = dCreateConvex(nullptr, planes_.data(), static_cast<unsigned>(P.faces.size()), points_.data(),
                        static_cast<unsigned>(P.vertices.size()), polygons_.data());
  }
  explicit OdeGeometry(double ball_radius_m) : id_(dCreateSphere(nullptr, ball_radius_m)) {}
  ~OdeGeometry() { dGeomDestroy(id_); }
  OdeGeometry(const OdeGeometry&) = delete;
  OdeGeometry& operator=(const OdeGeometry&) = delete;
  dGeomID id() const { return id_; }
  void place(const Pose& X) {
    const Mat3& R = X.R;
    const dMatrix3 rotation = {R(0, 0), R(0, 1), R(0, 2), 0,       R(1, 0), R(1, 1),
                               R(1, 2), 0,       R(2, 0), R(2, 1), R(2, 2), 0};
    dGeomSetRotation(id_, rotation);
    dGeomSetPosition(id_, X.p.x(), X.p.y(), X.p.z());
  }

 private:
  std::vector<dReal> planes_, points_;
  std::vector<unsigned> polygons_;
  dGeomID id_ = nullptr;
};

}  // namespace tactum::bench
