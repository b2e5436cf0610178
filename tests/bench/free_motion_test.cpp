/// Bodies that move by themselves, against ODE in steps of microseconds: an engine that shares nothing with
/// ours.

#include "bench/free_motion.h"

#include <gtest/gtest.h>

#include <iostream>

#include "support/sandbox.h"
#include "tactum/math/screw.h"

namespace tactum::bench::free_motion_test {
namespace {

/// One world, moved by either.
struct Both {
  Sandbox ours;
  FreeMotion theirs;

  void add(const Vec3& half_m, const Pose& X_WB, const Twist& V_WB, bool fixed = false) {
    const Polytope box = make_box(half_m);
    if (fixed) {
      ours.add_fixed(box, X_WB);
    } else {
      ours.add(box, X_WB, V_WB);
    }
    theirs.shapes.push_back({"box", box, half_m});
  }
  /// After so long, by ODE in steps of `step_s`.
  WorldState go(double seconds, double friction, double restitution, double step_s = 1e-5) {
    ours.rub(friction);
    ours.bounce(restitution);
    theirs.world = ours.world;
    theirs.friction = friction;
    theirs.restitution = restitution;
    ours.run(seconds);
    EXPECT_EQ(ours.penetrating_frames, 0);
    return moved_by_ode(theirs, seconds, static_cast<int>(std::lround(seconds / step_s)));
  }
  double energy_of(const WorldState& state) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < state.X_WB.size(); ++i) {
      const Body& body = theirs.world.bodies[i];
      const Vec3 w_B = state.X_WB[i].R.transpose() * state.V_WB[i].w;
      if (body.moves())
        sum += 0.5 * body.mass_kg * state.V_WB[i].v.squaredNorm() + 0.5 * w_B.dot(body.inertia_B * w_B);
    }
    return sum;
  }
};

class AgainstOde : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_ode()) GTEST_SKIP() << "built without ODE (libode-dev): there is nothing to compare with";
  }
};

/// A box that is spun about its middle axis turns over again and again, and any error grows with each turn:
/// of ODE, whose steps are of the first order, in proportion to them.
TEST_F(AgainstOde, ATumblingBoxTurnsOverAlike) {
  Both both;
  both.add({0.01, 0.02, 0.03}, {}, {{0.1, 0.0, 0.2}, {0.3, 12.0, 0.1}});
  const Vec3 L = both.ours.angular_momentum();
  const double energy = both.ours.energy();
  const WorldState theirs = both.go(2.0, 0.0, 0.0, 2e-6);
  const double apart = log_rotation(both.ours.X(0).R * theirs.X_WB[0].R.transpose()).norm();
  std::cout << "apart by " << apart << " rad after 24\n";
  EXPECT_LT(apart, 0.05);
  EXPECT_LT((both.ours.X(0).p - theirs.X_WB[0].p).norm(), 1e-9);
  EXPECT_LT((both.ours.angular_momentum() - L).norm(), 1e-12 * L.norm());
  EXPECT_NEAR(both.ours.energy(), energy, 1e-4 * energy);
}

/// Corner against face, without friction: the impulse is along the normal.
TEST_F(AgainstOde, ASkewImpactSendsBothAwayAlike) {
  for (const double restitution : {0.5, 1.0}) {
    Both both;
    both.add({0.01, 0.015, 0.02}, {exp_rotation({0.4, 0.3, 0.2}), {-0.05, 0.004, 0.003}},
             {{1.0, 0.0, 0.0}, {2.0, -1.0, 3.0}});
    both.add({0.02, 0.03, 0.025}, {Mat3::Identity(), {0.02, 0.0, 0.0}}, {{-0.2, 0.0, 0.0}, Vec3::Zero()});
    const Vec3 p = both.ours.momentum();
    const double size = both.ours.world.bodies[0].mass_kg * 1.0;
    const Vec3 L = both.ours.angular_momentum();
    const double before = both.ours.energy();
    const WorldState theirs = both.go(0.04, 0.0, restitution);
    EXPECT_LT((both.ours.momentum() - p).norm(), 1e-12 * size);
    EXPECT_LT((both.ours.angular_momentum() - L).norm(), 1e-9 * L.norm());
    std::cout << "restitution " << restitution << ": energy left, ours " << both.ours.energy() / before
              << ", ODE " << both.energy_of(theirs) / before << "\n";
    EXPECT_NEAR(both.ours.energy() / before, both.energy_of(theirs) / before, 5e-3);
    for (int i = 0; i < 2; ++i) {
      const Twist V = both.ours.V(i);
      const Twist& V_theirs = theirs.V_WB[static_cast<std::size_t>(i)];
      EXPECT_LT((V.v - V_theirs.v).norm(), 0.01) << "body " << i << ", of 1 m/s";
      EXPECT_LT((V.w - V_theirs.w).norm(), 0.02 * std::max(10.0, V_theirs.w.norm()))
          << "body " << i << ", of " << V_theirs.w.norm() << " rad/s";
    }
  }
}

TEST_F(AgainstOde, ABlockSlidesDownAnInclineAlike) {
  Both both;
  const double tilt = 0.5;
  both.ours.world.gravity_W = 9.81 * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  both.add({2.0, 0.1, 0.01}, {Mat3::Identity(), {0, 0, -0.01}}, {}, true);
  both.add({0.02, 0.015, 0.01}, {Mat3::Identity(), {0, 0, 0.01}}, {});
  const WorldState theirs = both.go(0.5, 0.3, 0.0);
  const double truth = 0.125 * 9.81 * (std::sin(tilt) - 0.3 * std::cos(tilt));
  std::cout << "slid by " << both.ours.X(1).p.x() << " m, ODE " << theirs.X_WB[1].p.x() << ", Coulomb "
            << truth << "\n";
  EXPECT_NEAR(both.ours.X(1).p.x(), truth, 0.01 * truth);
  EXPECT_NEAR(theirs.X_WB[1].p.x(), truth, 0.01 * truth);
}

}  // namespace
}  // namespace tactum::bench::free_motion_test
