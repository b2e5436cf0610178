#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include "bench/surfaces.h"

namespace tactum::bench {
namespace {

/// Bullet's triangle surface against triangle surface. It rounds each triangle by a margin; with half the
/// tolerance on either side it tells the pairs of triangles within the tolerance.
class GImpact final : public SurfacePeer {
 public:
  GImpact(const TriangleMesh& a, const TriangleMesh& b, double tolerance_m) : dispatcher_(&configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    hold(a, tolerance_m, part_[0]);
    hold(b, tolerance_m, part_[1]);
  }
  void query(const Pose& X_AB) override {
    const Mat3& R = X_AB.R;
    part_[1].object.setWorldTransform(btTransform(
        btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
        btVector3(X_AB.p.x(), X_AB.p.y(), X_AB.p.z())));
    const btCollisionObjectWrapper a = wrapped(part_[0]);
    const btCollisionObjectWrapper b = wrapped(part_[1]);
    btCollisionAlgorithm* algorithm = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    btManifoldResult contacts(&a, &b);
    algorithm->processCollision(&a, &b, info_, &contacts);
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
  }

 private:
  struct Part {
    btTriangleMesh mesh;
    std::unique_ptr<btGImpactMeshShape> shape;
    btCollisionObject object;
  };
  static btCollisionObjectWrapper wrapped(const Part& part) {
    return {nullptr, part.shape.get(), &part.object, part.object.getWorldTransform(), -1, -1};
  }
  static void hold(const TriangleMesh& mesh, double tolerance_m, Part& part) {
    const auto at = [&](int v) {
      const Vec3& p = mesh.vertices[std::size_t(v)];
      return btVector3(p.x(), p.y(), p.z());
    };
    for (const Triangle& t : mesh.triangles) part.mesh.addTriangle(at(t[0]), at(t[1]), at(t[2]));
    part.shape = std::make_unique<btGImpactMeshShape>(&part.mesh);
    part.shape->setMargin(0.5 * tolerance_m);
    part.shape->updateBound();
    part.object.setCollisionShape(part.shape.get());
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDispatcherInfo info_;
  std::array<Part, 2> part_;
};

}  // namespace

std::unique_ptr<SurfacePeer> make_gimpact_surfaces(const TriangleMesh& a, const TriangleMesh& b,
                                                   double tolerance_m) {
  return std::make_unique<GImpact>(a, b, tolerance_m);
}

}  // namespace tactum::bench
