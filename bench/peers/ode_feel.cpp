#include <array>
#include <cstdarg>

#include "bench/peers/feel_peers.h"
#include "bench/peers/ode_geometry.h"

namespace tactum::bench {
namespace {

constexpr double kSoftness = 1e-10;  // of contacts: its own default in double precision

/// With dWorldStep, its accurate solver, and friction of a pyramid.
class OdeFeel final : public FeelEngine {
 public:
  OdeFeel(const FeelScene& scene, const FeelSetup& setup)
      : coupling_(scene.coupling),
        friction_(scene.friction),
        erp_(setup.erp),
        substeps_(setup.substeps),
        X_WH_(scene.hand->at(0.0).X_DH) {
    dInitODE2(0);
    dSetMessageHandler([](int, const char*, va_list) {});  // of its solver, by the thousand
    world_ = dWorldCreate();
    contacts_ = dJointGroupCreate(0);
    dWorldSetERP(world_, setup.erp);
    dWorldSetCFM(world_, kSoftness);
    for (const FeelPiece& piece : scene.fixed) {
      fixed_.push_back(std::make_unique<OdeGeometry>(piece.shape));
      fixed_.back()->place(piece.X_BP);
    }
    body_ = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, kFeltMass_kg, 0, 0, 0, kFeltInertia_kg_m2, kFeltInertia_kg_m2,
                       kFeltInertia_kg_m2, 0, 0, 0);
    dBodySetMass(body_, &mass);
    grasped_ = std::make_unique<OdeGeometry>(scene.grasped.front().shape);
    dGeomSetBody(grasped_->id(), body_);
    grasped_->place(X_WH_);  // and the body with it
  }
  ~OdeFeel() override {
    grasped_.reset();
    fixed_.clear();
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
    dCloseODE();
  }
  void step(const Pose& X_WH) override {
    const Twist V_WH = twist_between(X_WH_, X_WH, kFeelStep_s);
    const Pose X_before = X_WH_;
    for (int i = 1; i <= substeps_; ++i) {
      X_WH_ = interpolated(X_before, X_WH, static_cast<double>(i) / substeps_);
      const Wrench F = coupling_.on_hand(X_WH_, V_WH, X_WB(), V_WB());
      dBodyAddForce(body_, -F.f.x(), -F.f.y(), -F.f.z());
      dBodyAddTorque(body_, -F.t.x(), -F.t.y(), -F.t.z());
      touch();
      dWorldStep(world_, kFeelStep_s / substeps_);
      dJointGroupEmpty(contacts_);
    }
    felt_ = coupling_.on_hand(X_WH, V_WH, X_WB(), V_WB());
  }
  Pose X_WB() const override {
    const dReal* const R = dBodyGetRotation(body_);
    const dReal* const p = dBodyGetPosition(body_);
    Pose X;
    for (int i = 0; i < 3; ++i) X.R.row(i) << R[4 * i], R[4 * i + 1], R[4 * i + 2];
    X.p = {p[0], p[1], p[2]};
    return X;
  }
  Wrench felt() const override { return felt_; }

 private:
  Twist V_WB() const {
    const dReal* const v = dBodyGetLinearVel(body_);
    const dReal* const w = dBodyGetAngularVel(body_);
    return {{v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
  }
  void touch() {
    std::array<dContact, 32> found{};
    for (const auto& piece : fixed_) {
      const int count = dCollide(grasped_->id(), piece->id(), static_cast<int>(found.size()), &found[0].geom,
                                 sizeof(dContact));
      for (int i = 0; i < count; ++i) {
        dContact& contact = found[static_cast<std::size_t>(i)];
        contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
        contact.surface.mu = friction_;
        contact.surface.soft_erp = erp_;
        contact.surface.soft_cfm = kSoftness;
        dJointAttach(dJointCreateContact(world_, contacts_, &contact), body_, nullptr);
      }
    }
  }

  PeerCoupling coupling_;
  double friction_, erp_;
  int substeps_;
  Pose X_WH_;
  Wrench felt_;
  dWorldID world_ = nullptr;
  dBodyID body_ = nullptr;
  dJointGroupID contacts_ = nullptr;
  std::vector<std::unique_ptr<OdeGeometry>> fixed_;
  std::unique_ptr<OdeGeometry> grasped_;
};

}  // namespace

std::unique_ptr<FeelEngine> make_ode_feel(const FeelScene& scene, const FeelSetup& setup) {
  return std::make_unique<OdeFeel>(scene, setup);
}

}  // namespace tactum::bench
