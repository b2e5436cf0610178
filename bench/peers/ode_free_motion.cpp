#include <array>
#include <cstdarg>
#include <memory>

#include "bench/peers/motion_peers.h"
#include "bench/peers/ode_geometry.h"

namespace tactum::bench {
namespace {

using Index = std::size_t;

constexpr int kMostContacts = 16;  // of a pair of bodies

Vec3 vector_of(const dReal* v) { return {v[0], v[1], v[2]}; }

/// With dWorldStep, its accurate solver.
class OdeMotion final : public MotionEngine {
 public:
  OdeMotion(const FreeMotion& motion, double step_s)
      : step_s_(step_s), friction_(motion.friction), restitution_(motion.restitution) {
    dInitODE2(0);
    dSetMessageHandler([](int, const char*, va_list) {});  // of its solver, by the thousand
    world_ = dWorldCreate();
    contacts_ = dJointGroupCreate(0);
    const Vec3& g = motion.world.gravity_W;
    dWorldSetGravity(world_, g.x(), g.y(), g.z());
    const Index bodies = motion.world.bodies.size();
    forces_.reserve(bodies * bodies * kMostContacts);  // ODE keeps their addresses
    for (Index i = 0; i < bodies; ++i) {
      const double ball = motion.ball_of(i);
      shapes_.push_back(ball > 0.0 ? std::make_unique<OdeGeometry>(ball)
                                   : std::make_unique<OdeGeometry>(motion.shapes[i]));
      add(motion.world.bodies[i]);
    }
  }
  ~OdeMotion() override {
    shapes_.clear();
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
    dCloseODE();
  }

  void step() override {
    forces_.clear();
    for (Index a = 0; a < shapes_.size(); ++a)
      for (Index b = a + 1; b < shapes_.size(); ++b) touch(a, b);
    dWorldStep(world_, step_s_);
    dJointGroupEmpty(contacts_);
  }
  WorldState state() const override {
    WorldState state;
    for (Index i = 0; i < shapes_.size(); ++i) {
      const dReal* const R = dGeomGetRotation(shapes_[i]->id());
      Pose X;
      for (int row = 0; row < 3; ++row) X.R.row(row) << R[4 * row], R[4 * row + 1], R[4 * row + 2];
      X.p = vector_of(dGeomGetPosition(shapes_[i]->id()));
      state.X_WB.push_back(X);
      state.V_WB.push_back(bodies_[i] == nullptr ? Twist{}
                                                 : Twist{vector_of(dBodyGetLinearVel(bodies_[i])),
                                                         vector_of(dBodyGetAngularVel(bodies_[i]))});
    }
    return state;
  }
  double load_N(int fixed_body) const override {
    Vec3 sum = Vec3::Zero();
    for (const Force& force : forces_)
      if (force.fixed_body == fixed_body) sum += vector_of(force.feedback.f1);
    return sum.norm();
  }

 private:
  /// A contact's force on the body that moves, beside a fixed one; -1: both move.
  struct Force {
    int fixed_body = -1;
    dJointFeedback feedback{};
  };

  void add(const Body& body) {
    bodies_.push_back(body.moves() ? dBodyCreate(world_) : nullptr);
    const dBodyID id = bodies_.back();
    if (id != nullptr) {
      dMass mass;
      const Mat3& I = body.inertia_B;
      dMassSetParameters(&mass, body.mass_kg, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
      dBodySetMass(id, &mass);
      dGeomSetBody(shapes_.back()->id(), id);
      dBodySetLinearVel(id, body.V_WB.v.x(), body.V_WB.v.y(), body.V_WB.v.z());
      dBodySetAngularVel(id, body.V_WB.w.x(), body.V_WB.w.y(), body.V_WB.w.z());
    }
    shapes_.back()->place(body.X_WB);
    if (body.joint.kind != JointKind::kHinge) return;
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    const Vec3& at = body.joint.anchor_W;
    const Vec3& axis = body.joint.axis_W;
    dJointAttach(hinge, id, nullptr);
    dJointSetHingeAnchor(hinge, at.x(), at.y(), at.z());
    dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
  }
  void touch(Index a, Index b) {
    if (bodies_[a] == nullptr && bodies_[b] == nullptr) return;
    std::array<dContact, kMostContacts> found{};
    const int count = dCollide(shapes_[a]->id(), shapes_[b]->id(), static_cast<int>(found.size()),
                               &found[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dContact& contact = found[Index(i)];
      contact.surface.mode = dContactApprox1 | dContactBounce;
      contact.surface.mu = friction_;
      contact.surface.bounce = restitution_;
      contact.surface.bounce_vel = 1e-3;
      const dJointID joint = dJointCreateContact(world_, contacts_, &contact);
      dJointAttach(joint, bodies_[a], bodies_[b]);
      forces_.push_back({bodies_[a] == nullptr   ? static_cast<int>(a)
                         : bodies_[b] == nullptr ? static_cast<int>(b)
                                                 : -1,
                         {}});
      dJointSetFeedback(joint, &forces_.back().feedback);
    }
  }

  double step_s_, friction_, restitution_;
  dWorldID world_ = nullptr;
  dJointGroupID contacts_ = nullptr;
  std::vector<std::unique_ptr<OdeGeometry>> shapes_;
  std::vector<dBodyID> bodies_;
  std::vector<Force> forces_;
};

}  // namespace

std::unique_ptr<MotionEngine> make_ode_motion(const FreeMotion& motion, double step_s) {
  return std::make_unique<OdeMotion>(motion, step_s);
}

WorldState moved_by_ode(const FreeMotion& motion, double seconds, int steps) {
  OdeMotion world(motion, seconds / steps);
  for (int i = 0; i < steps; ++i) world.step();
  return world.state();
}

}  // namespace tactum::bench
