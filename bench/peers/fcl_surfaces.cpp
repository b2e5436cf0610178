#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

#include "bench/surfaces.h"

namespace tactum::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

std::shared_ptr<Model> model_of(const TriangleMesh& mesh) {
  std::vector<fcl::Vector3<double>> points;
  std::vector<fcl::Triangle> triangles;
  for (const Vec3& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const Triangle& t : mesh.triangles)
    triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

class FclSurfaces final : public SurfacePeer {
 public:
  FclSurfaces(const TriangleMesh& a, const TriangleMesh& b) : a_(model_of(a)), b_(model_of(b)) {}
  void query(const Pose& X_AB) override {
    fcl::Transform3<double> T = fcl::Transform3<double>::Identity();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) T.matrix()(i, j) = X_AB.R(i, j);
      T.matrix()(i, 3) = X_AB.p(i);
    }
    const fcl::DistanceRequest<double> request;
    fcl::DistanceResult<double> result;
    fcl::distance(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), T, request, result);
  }

 private:
  std::shared_ptr<Model> a_, b_;
};

}  // namespace

std::unique_ptr<SurfacePeer> make_fcl_surfaces(const TriangleMesh& a, const TriangleMesh& b, double) {
  return std::make_unique<FclSurfaces>(a, b);
}

}  // namespace tactum::bench
