#include "bench/peers/fcl_model.h"

#include <fcl/narrowphase/distance.h>

#include "bench/distance_peer.h"
#include "bench/surfaces.h"

namespace tactum::bench {
namespace {

class FclDistance final : public DistancePeer {
 public:
  FclDistance(const TriangleMesh& a, const TriangleMesh& b) : a_(fcl_model(a)), b_(fcl_model(b)) {}
  double distance(const Pose& X_AB) override {
    const fcl::DistanceRequest<double> request;
    fcl::DistanceResult<double> result;
    return fcl::distance(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), fcl_transform(X_AB),
                         request, result);
  }

 private:
  std::shared_ptr<FclModel> a_, b_;
};

class FclSurfaces final : public SurfacePeer {
 public:
  FclSurfaces(const TriangleMesh& a, const TriangleMesh& b) : distance_(a, b) {}
  void query(const Pose& X_AB) override { distance_.distance(X_AB); }

 private:
  FclDistance distance_;
};

}  // namespace

std::unique_ptr<SurfacePeer> make_fcl_surfaces(const TriangleMesh& a, const TriangleMesh& b, double) {
  return std::make_unique<FclSurfaces>(a, b);
}

std::unique_ptr<DistancePeer> make_fcl_distance(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<FclDistance>(a, b);
}

}  // namespace tactum::bench
