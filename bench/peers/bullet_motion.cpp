#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "bench/peers/bullet_shape.h"
#include "bench/peers/motion_peers.h"

namespace tactum::bench {
namespace {

using Index = std::size_t;

constexpr int kIterations = 500;  // fifty times its default

Vec3 from(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btVector3 to(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Shapes without margins, no sleep, no damping, no least speed of restitution; overlaps are taken out apart
/// from the velocities, whatever their depth.
class BulletMotion final : public MotionEngine {
 public:
  BulletMotion(const FreeMotion& motion, double step_s) : step_s_(step_s) {
    world_.setGravity(to(motion.world.gravity_W));
    world_.getSolverInfo().m_numIterations = kIterations;
    world_.getSolverInfo().m_restitutionVelocityThreshold = 0.0;
    world_.getSolverInfo().m_splitImpulsePenetrationThreshold = 0.0;
    for (Index i = 0; i < motion.world.bodies.size(); ++i) add(motion, i);
  }
  ~BulletMotion() override {
    for (const auto& hinge : hinges_) world_.removeConstraint(hinge.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step() override { world_.stepSimulation(step_s_, 0); }
  WorldState state() const override {
    WorldState state;
    for (const auto& body : bodies_) {
      const btTransform& X = body->getWorldTransform();
      Pose& X_WB = state.X_WB.emplace_back();
      for (int i = 0; i < 3; ++i) X_WB.R.row(i) = from(X.getBasis()[i]).transpose();
      X_WB.p = from(X.getOrigin());
      state.V_WB.push_back({from(body->getLinearVelocity()), from(body->getAngularVelocity())});
    }
    return state;
  }
  double load_N(int fixed_body) const override {
    const btCollisionObject* const fixed = bodies_[Index(fixed_body)].get();
    btVector3 sum(0, 0, 0);  // on body 0 of each manifold
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold* const manifold = dispatcher_.getManifoldByIndexInternal(i);
      if (manifold->getBody0() != fixed && manifold->getBody1() != fixed) continue;
      const double sign = manifold->getBody0() == fixed ? 1.0 : -1.0;
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold->getContactPoint(k);
        sum += sign * (point.m_appliedImpulse * point.m_normalWorldOnB +
                       point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                       point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2);
      }
    }
    return sum.length() / step_s_;
  }

 private:
  void add(const FreeMotion& motion, Index i) {
    const Body& body = motion.world.bodies[i];
    if (motion.ball_of(i) > 0.0) {
      shapes_.push_back(std::make_unique<btSphereShape>(motion.ball_of(i)));
    } else {
      shapes_.push_back(bullet_shape(motion.shapes[i]));
    }
    const bool moves = body.moves();
    const Vec3 inertia = moves ? Vec3(body.inertia_B.diagonal()) : Vec3(Vec3::Zero());
    btRigidBody::btRigidBodyConstructionInfo info(moves ? body.mass_kg : 0.0, nullptr, shapes_.back().get(),
                                                  to(inertia));
    info.m_startWorldTransform = bullet_pose(body.X_WB);
    // Bullet multiplies the coefficients of the two bodies.
    info.m_friction = std::sqrt(motion.friction);
    info.m_restitution = std::sqrt(motion.restitution);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& made = *bodies_.back();
    made.setLinearVelocity(to(body.V_WB.v));
    made.setAngularVelocity(to(body.V_WB.w));
    made.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&made);
    if (body.joint.kind != JointKind::kHinge) return;
    const Vec3 pivot = body.X_WB.inverse() * body.joint.anchor_W;
    const Vec3 axis = body.X_WB.R.transpose() * body.joint.axis_W;
    hinges_.push_back(std::make_unique<btHingeConstraint>(made, to(pivot), to(axis)));
    world_.addConstraint(hinges_.back().get());
  }

  double step_s_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btConvexShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btHingeConstraint>> hinges_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
};

}  // namespace

std::unique_ptr<MotionEngine> make_bullet_motion(const FreeMotion& motion, double step_s) {
  return std::make_unique<BulletMotion>(motion, step_s);
}

}  // namespace tactum::bench
