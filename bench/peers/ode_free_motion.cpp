#include <array>
#include <memory>

#include "bench/free_motion.h"
#include "bench/peers/ode_geometry.h"

namespace tactum::bench {
namespace {

using Index = std::size_t;

Vec3 vector_of(const dReal* v) { return {v[0], v[1], v[2]}; }

/// With dWorldStep, its accurate solver.
class OdeWorld {
 public:
  explicit OdeWorld(const FreeMotion& motion) : friction_(motion.friction), restitution_(motion.restitution) {
    dInitODE2(0);
    world_ = dWorldCreate();
    contacts_ = dJointGroupCreate(0);
    const Vec3& g = motion.world.gravity_W;
    dWorldSetGravity(world_, g.x(), g.y(), g.z());
    for (Index i = 0; i < motion.world.bodies.size(); ++i) add(motion.world.bodies[i], motion.shapes[i]);
  }
  ~OdeWorld() {
    shapes_.clear();
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
    dCloseODE();
  }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;

  void step(double h) {
    for (Index a = 0; a < shapes_.size(); ++a)
      for (Index b = a + 1; b < shapes_.size(); ++b) touch(a, b);
    dWorldStep(world_, h);
    dJointGroupEmpty(contacts_);
  }
  WorldState state() const {
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

 private:
  void add(const Body& body, const Shape& shape) {
    shapes_.push_back(std::make_unique<OdeGeometry>(shape));
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
  }
  void touch(Index a, Index b) {
    if (bodies_[a] == nullptr && bodies_[b] == nullptr) return;
    std::array<dContact, 16> found{};
    const int count = dCollide(shapes_[a]->id(), shapes_[b]->id(), static_cast<int>(found.size()),
                               &found[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dContact& contact = found[Index(i)];
      contact.surface.mode = dContactApprox1 | dContactBounce;
      contact.surface.mu = friction_;
      contact.surface.bounce = restitution_;
      contact.surface.bounce_vel = 1e-3;
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), bodies_[a], bodies_[b]);
    }
  }

  double friction_, restitution_;
  dWorldID world_ = nullptr;
  dJointGroupID contacts_ = nullptr;
  std::vector<std::unique_ptr<OdeGeometry>> shapes_;
  std::vector<dBodyID> bodies_;
};

}  // namespace

WorldState moved_by_ode(const FreeMotion& motion, double seconds, int steps) {
  OdeWorld world(motion);
  for (int i = 0; i < steps; ++i) world.step(seconds / steps);
  return world.state();
}

}  // namespace tactum::bench
