#include "bench/free_motion.h"

#include "bench/peers/motion_peers.h"
#include "tactum/haptics/simulation.h"

#ifndef TACTUM_PEER_ODE
#include <stdexcept>
#endif

namespace tactum::bench {
namespace {

/// One of our responses, with a hand that holds nothing.
class OurMotion final : public MotionEngine {
 public:
  OurMotion(const FreeMotion& motion, ResponseModel response, double step_s) {
    const std::size_t bodies = motion.world.bodies.size();
    const auto all_pairs = [&](double value) -> PairCoefficients {
      return {std::vector<double>(bodies * bodies, value), static_cast<int>(bodies)};
    };
    FrameSettings settings;
    settings.dt_s = step_s;
    settings.response = response;
    settings.budget.sleep = false;  // what sleeps has no contact forces
    settings.friction = all_pairs(motion.friction);
    settings.impacts.restitution = all_pairs(motion.restitution);
    simulation_ = std::move(*Simulation::make(motion.world, settings));
  }

  void step() override { simulation_->step(Pose{}); }
  WorldState state() const override { return simulation_->bodies(); }
  double load_N(int fixed_body) const override {
    Vec3 sum = Vec3::Zero();
    for (const ContactRow& row : simulation_->state().response.rows())
      if (row.body_a == fixed_body || row.body_b == fixed_body)
        sum += (row.body_a == fixed_body ? row.impulse : -row.impulse) * row.n_BA_W;
    return sum.norm() / simulation_->settings().dt_s;
  }

 private:
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace

std::unique_ptr<MotionEngine> make_constraint_motion(const FreeMotion& motion, double step_s) {
  return std::make_unique<OurMotion>(motion, ResponseModel::kConstraint, step_s);
}

std::unique_ptr<MotionEngine> make_penalty_motion(const FreeMotion& motion, double step_s) {
  return std::make_unique<OurMotion>(motion, ResponseModel::kPenalty, step_s);
}

MotionPeers motion_peers() noexcept {
  MotionPeers peers;
#ifdef TACTUM_PEER_BULLET
  peers.bullet = make_bullet_motion;
#endif
#ifdef TACTUM_PEER_ODE
  peers.ode = make_ode_motion;
#endif
#ifdef TACTUM_PEER_MUJOCO
  peers.mujoco = make_mujoco_motion;
#endif
  return peers;
}

#ifdef TACTUM_PEER_ODE
bool has_ode() noexcept { return true; }
#else
bool has_ode() noexcept { return false; }
WorldState moved_by_ode(const FreeMotion&, double, int) { throw std::logic_error("built without ODE"); }
#endif

}  // namespace tactum::bench
