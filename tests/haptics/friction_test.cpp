#include "tactum/dynamics/friction.h"
#include "tactum/mesh/make_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "support/block_rig.h"
#include "support/effort.h"
#include "support/sample_meshes.h"

namespace tactum::friction_test {
namespace {

constexpr double kFlat_m = 0.008;   // height of the block's middle in the rig's first pose [m]
constexpr double kPress_m = 0.005;  // of the hand, into the plate [m]

/// A block that stands on a point of its own, its foot, which stays where it is as the hand turns it.
struct Standing : BlockRig {
  Vec3 foot_B, foot_W;

  explicit Standing(const Vec3& foot) : BlockRig(0.6), foot_B(foot), foot_W(foot.x(), foot.y(), 0.0) {
    settings.coupling.stiffness_Nm_per_rad = 3.0;
    step({});
  }
  Pose hand(const Vec3& turn, double above_m) const {
    const Mat3 R = exp_rotation(turn);
    return {R, foot_W - R * foot_B + Vec3(0, 0, above_m - kFlat_m)};
  }
  Vec3 foot() { return X_WB() * foot_B; }
};

/// Rocks the block for ten seconds, `hz` times a second, by turns that `turn` gives of the angle reached.
template <class Turn>
void expect_stays(const Vec3& foot_B, double hz, const Turn& turn) {
  Standing block(foot_B);
  block.go(block.hand(turn(0.0), 0.006), 200);
  block.go(block.hand(turn(0.0), -kPress_m), 200);
  const Vec3 before = block.foot();
  double most_aside = 0.0, most_off = 0.0;
  for (int i = 0; i <= 10'000; ++i) {
    const FrameReport& report = block.step(block.hand(turn(2.0 * kPi * hz * 1e-3 * i), -kPress_m));
    EXPECT_EQ(report.friction.sticking, 1);
    most_aside = std::max(most_aside, (block.foot() - before).head<2>().norm());
    most_off = std::max(most_off, block.foot().z());
  }
  EXPECT_EQ(block.penetrating_frames, 0);
  // A step of one frame leaves the first order by half the square of its turn times the arm.
  const double turned_rad = 0.2 * 2.0 * kPi * hz * 1e-3;
  const double one_step = 0.5 * turned_rad * turned_rad * foot_B.norm();
  EXPECT_LT(most_aside, block.skin() + 2.0 * one_step) << hz << " Hz";
  EXPECT_LT(most_off, 2.0 * block.skin() + 2.0 * one_step) << hz << " Hz";
}

TEST(Friction, APartThatIsRockedOnItsEdgeDoesNotWalk) {
  for (const double hz : {0.5, 2.0, 5.0})
    expect_stays({0.010, 0, -0.005}, hz,
                 [](double angle) { return Vec3(0, 0.4 + 0.2 * std::sin(angle), 0); });
}

TEST(Friction, APartThatCirclesOnItsCornerDoesNotWalk) {
  for (const double hz : {0.5, 2.0, 5.0})
    expect_stays({0.010, 0.007, -0.005}, hz, [](double angle) {
      return Vec3(-0.4 + 0.2 * std::sin(angle), 0.4 + 0.2 * std::cos(angle), 0);
    });
}

/// The creep of a block that is pulled with the fraction `share` of its friction limit while the hand turns
/// to and fro every frame [m/s].
double creep(double share, const Vec3& turn) {
  const double mu = 0.3;
  BlockRig block(mu);
  const double press = 5.0 / block.settings.coupling.stiffness_N_per_m;
  const double down = -kFlat_m + kBlockHalf.z() - press;
  block.go(at(0, 0, down), 500);
  block.go(at(share * mu * press, 0, down), 500);
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 4000; ++i) {
    if (i == 2000) before = block.X_WB().p;
    block.step(at(share * mu * press, 0, down, i % 2 == 0 ? turn : Vec3(-turn)));
  }
  EXPECT_EQ(block.report.friction.sticking, 1);
  return (block.X_WB().p - before).norm() / 2.0;
}

TEST(Friction, APatchDoesNotCreepUnderAHandThatShakes) {
  for (const Vec3& turn : {Vec3(0, 0, 0), Vec3(0, 0.001, 0), Vec3(0, 0, 0.002), Vec3(0.002, 0.002, 0.002)}) {
    EXPECT_LT(creep(0.9, turn), 1e-12) << "m/s";
    EXPECT_LT(creep(0.99, turn), 5e-8) << "m/s " << turn.transpose();
  }
}

/// A grasped block of 20 x 20 x 20 mm on a fixed one of 60 x 60 x 20 mm whose top is at z = 0; each has the
/// shape of a box, either as one convex piece or as a surface of triangles.
struct BoxOnBox : Rig {
  BoxOnBox(bool surface_above, bool surface_below, double size, double mu) : Rig(2) {
    world.bodies[0].part = box(size * Vec3(0.010, 0.010, 0.010), surface_above);
    world.bodies[0].X_WB.p.z() = size * 0.011;
    world.bodies[1].part = box(size * Vec3(0.030, 0.030, 0.010), surface_below);
    world.bodies[1].X_WB.p.z() = -size * 0.010;
    world.bodies[1].joint.kind = JointKind::kFixed;
    settings.friction = {{0.0, mu, mu, 0.0}, 2};
  }
  static std::shared_ptr<const Part> box(const Vec3& half, bool surface) {
    if (!surface) return solid_box(half);
    Result<Part> part = part_from_mesh(testing::box_mesh(half), {.pieces = PieceSource::kSurface});
    EXPECT_TRUE(part);
    EXPECT_TRUE(part->is_surface());
    return std::make_shared<const Part>(std::move(*part));
  }
};

/// |F_t| / F_n of the felt force while the block is drawn over the other one, at its least and its most.
std::pair<double, double> ratio_while_drawn(BoxOnBox& rig, double size, const Vec3& along) {
  const double press_m = 0.002;  // beyond touching: 1.2 N at the default stiffness
  rig.step({});
  rig.go(at(0, 0, -0.001 * size - press_m), 300);
  std::pair<double, double> ratio{1e9, 0.0};
  for (int i = 1; i <= 1000; ++i) {
    const Vec3 drawn = 0.010 * size * along * (i / 1000.0);
    const FrameReport& report = rig.step(at(drawn.x(), drawn.y(), -0.001 * size - press_m));
    if (i < 500) continue;
    const double now = report.coupling.f.head<2>().norm() / report.coupling.f.z();
    ratio = {std::min(ratio.first, now), std::max(ratio.second, now)};
  }
  EXPECT_EQ(rig.penetrating_frames, 0);
  return ratio;
}

TEST(Friction, ActsBetweenPartsFeltByTheirSurfaces) {
  for (const auto& [above, below] : {std::pair(false, true), {true, false}, {true, true}})
    for (const double size : testing::sampled(std::vector{0.5, 1.0, 3.0}, 3))
      for (const double mu : {0.0, 0.1, 0.3})
        for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0.6, 0.8, 0)}) {
          BoxOnBox rig(above, below, size, mu);
          const auto [least, most] = ratio_while_drawn(rig, size, along);
          EXPECT_NEAR(least, mu, 2e-3 * mu + 1e-9) << above << below << ' ' << size << ' ' << along.y();
          EXPECT_LE(most - least, 1e-3 * mu + 1e-9) << above << below << ' ' << size << ' ' << along.y();
          EXPECT_NEAR(most, mu, 2e-3 * mu + 1e-9) << above << below << ' ' << size << ' ' << along.y();
        }
}

/// A crate of 250 g on a floor, drawn by a hand that is h above where the crate lies: the coupling carries
/// k h of its weight, and friction is mu (m g - k h), not mu m g. Drawn 0.1 mm above, 2.4 % are missing.
TEST(Friction, OfADrawnCrateIsThatOfTheWeightWhichTheHandDoesNotCarry) {
  constexpr double kMass = 0.25, kGravity = 9.81, kMu = 0.3, kHalf = 0.05;
  for (const double rate_Hz : testing::frame_rates_Hz())
    for (const double speed : {0.02, 0.1})
      for (const double above_m : {-0.001, 0.0, 1e-4, 1e-3})
        for (const bool surface : {false, true}) {
          SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, " << speed << " m/s, " << above_m << " m");
          Rig rig(2);
          const double lies_m = tolerances::kSkin * 2.0 * std::sqrt(3.0) * kHalf;
          rig.world.bodies[0].part = BoxOnBox::box(Vec3::Constant(kHalf), surface);
          rig.world.bodies[0].mass_kg = kMass;
          rig.world.bodies[0].X_WB.p.z() = kHalf + lies_m;
          rig.world.bodies[1].part = solid_box({1, 1, 0.1});
          rig.world.bodies[1].X_WB.p.z() = -0.1;
          rig.world.bodies[1].joint.kind = JointKind::kFixed;
          rig.world.gravity_W = {0, 0, -kGravity};
          rig.settings.dt_s = 1.0 / rate_Hz;
          rig.settings.friction = {{0.0, kMu, kMu, 0.0}, 2};
          rig.step({});
          const int frames = static_cast<int>(rate_Hz);
          const FrameReport& report = rig.go(at(speed, 0, above_m), frames);
          const double carried_N = rig.settings.coupling.stiffness_N_per_m * above_m;
          const double right = kMu * (kMass * kGravity - carried_N);
          EXPECT_NEAR(-report.coupling.f.x(), right, 1e-3 * right);
          EXPECT_NEAR(report.coupling.f.z(), -carried_N, 1e-3 * kMass * kGravity);
        }
}

/// A square block is pressed on a plate and twisted about its normal until it slides. Under an even pressure
/// friction resists with the lever a (root 2 + ln(1 + root 2)) / 6 = 0.3826 a; loads at the corners alone,
/// which a rigid block may have as well, give a / root 2 = 0.7071 a. The torque is between the two.
TEST(Friction, OfATwistedBlockLiesBetweenEvenPressureAndLoadsAtTheCorners) {
  const double even = (std::sqrt(2.0) + std::log(1.0 + std::sqrt(2.0))) / 6.0;
  for (const bool surface : {false, true}) {
    for (const double size : testing::sampled(std::vector{0.5, 1.0, 3.0}, 3)) {
      for (const double mu : {0.1, 0.3}) {
        for (const double sense : {1.0, -1.0}) {
          BoxOnBox rig(surface, false, size, mu);
          rig.step({});
          rig.go(at(0, 0, -0.001 * size - 0.002), 300);
          rig.go(at(0, 0, -0.001 * size - 0.002, {0, 0, 0.4 * sense}), 1500);
          const Wrench& felt = rig.report.coupling;
          const double lever = -sense * felt.t.z() / (mu * felt.f.z() * 0.020 * size);
          EXPECT_GT(lever, 0.99 * even) << surface << ' ' << size << ' ' << mu;
          EXPECT_LT(lever, 1.01 * std::sqrt(0.5)) << surface << ' ' << size << ' ' << mu;
          EXPECT_EQ(rig.penetrating_frames, 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace tactum::friction_test
