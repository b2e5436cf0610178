#include <btBulletDynamicsCommon.h>

#include "bench/peers/bullet_shape.h"
#include "bench/peers/feel_peers.h"

namespace tactum::bench {
namespace {

constexpr int kIterations = 50;  // five times its default

Vec3 from(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btVector3 to(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class BulletFeel final : public FeelEngine {
 public:
  BulletFeel(const FeelScene& scene, const FeelSetup& setup)
      : coupling_(scene.coupling), substeps_(setup.substeps), X_WH_(scene.hand->at(0.0).X_DH) {
    world_.setGravity({0, 0, 0});
    world_.getSolverInfo().m_numIterations = kIterations;
    world_.getSolverInfo().m_erp2 = setup.erp;
    for (const FeelPiece& piece : scene.fixed) add(piece, piece.X_BP, 0.0, scene.friction);
    grasped_ = add(scene.grasped.front(), X_WH_, kFeltMass_kg, 1.0);
    grasped_->setDamping(0, 0);
    grasped_->setActivationState(DISABLE_DEACTIVATION);
  }
  ~BulletFeel() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step(const Pose& X_WH) override {
    const Twist V_WH = twist_between(X_WH_, X_WH, kFeelStep_s);
    const Pose X_before = X_WH_;
    for (int i = 1; i <= substeps_; ++i) {
      X_WH_ = interpolated(X_before, X_WH, static_cast<double>(i) / substeps_);
      const Wrench F = coupling_.on_hand(X_WH_, V_WH, X_WB(), V_WB());
      grasped_->applyCentralForce(to(-F.f));
      grasped_->applyTorque(to(-F.t));
      world_.stepSimulation(kFeelStep_s / substeps_, 0);
    }
    felt_ = coupling_.on_hand(X_WH, V_WH, X_WB(), V_WB());
  }
  Pose X_WB() const override {
    const btTransform& X = grasped_->getWorldTransform();
    Pose pose;
    for (int i = 0; i < 3; ++i) pose.R.row(i) = from(X.getBasis()[i]).transpose();
    pose.p = from(X.getOrigin());
    return pose;
  }
  Wrench felt() const override { return felt_; }

 private:
  Twist V_WB() const { return {from(grasped_->getLinearVelocity()), from(grasped_->getAngularVelocity())}; }
  btRigidBody* add(const FeelPiece& piece, const Pose& X, double mass_kg, double friction) {
    shapes_.push_back(bullet_shape(piece.shape));
    const double inertia = mass_kg > 0.0 ? kFeltInertia_kg_m2 : 0.0;
    btRigidBody::btRigidBodyConstructionInfo info(mass_kg, nullptr, shapes_.back().get(),
                                                  {inertia, inertia, inertia});
    info.m_startWorldTransform = bullet_pose(X);
    info.m_friction = friction;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  PeerCoupling coupling_;
  int substeps_;
  Pose X_WH_;
  Wrench felt_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btConvexShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btRigidBody* grasped_ = nullptr;
};

}  // namespace

std::unique_ptr<FeelEngine> make_bullet_feel(const FeelScene& scene, const FeelSetup& setup) {
  return std::make_unique<BulletFeel>(scene, setup);
}

}  // namespace tactum::bench
