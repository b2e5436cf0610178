#pragma once
/// What FCL's queries of triangle surfaces share.

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>

#include <memory>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

using FclModel = fcl::BVHModel<fcl::OBBRSS<double>>;

inline std::shared_ptr<FclModel> fcl_model(const TriangleMesh& mesh) {
  std::vector<fcl::Vector3<double>> points;
  std::vector<fcl::Triangle> triangles;
  for (const Vec3& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const Triangle& t : mesh.triangles)
    triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
  auto model = std::make_shared<FclModel>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

inline fcl::Transform3<double> fcl_transform(const Pose& X) {
  fcl::Transform3<double> T = fcl::Transform3<double>::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T.matrix()(i, j) = X.R(i, j);
    T.matrix()(i, 3) = X.p(i);
  }
  return T;
}

}  // namespace tactum::bench
