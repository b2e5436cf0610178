/// A tilted peg in a slot touches it at two points. Whether it can be pulled out is geometry alone: when the
/// line between the two points lies inside both friction cones, the two contact forces balance any pull among
/// themselves, and the peg is wedged [Simunovic 1975; Whitney 1982]. These tests hold the constraint response
/// to that condition.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/effort.h"
#include "support/pressed_block.h"
#include "support/rig.h"

namespace tactum::wedging_test {
namespace {

constexpr double kWidth = 0.020;       // of the peg [m]
constexpr double kClearance = 0.0001;  // of the slot [m]
constexpr double kHalfLength = 0.020;  // of the peg [m]
constexpr double kSqueeze_rad = 0.05;  // the hand turns so much farther than the walls let the peg
constexpr double kStuck_m = 1e-6;      // less than this is no motion

/// A peg in a slot between two walls whose rims are at z = 0, and an ideal device.
struct Slot : Rig {
  explicit Slot(double depth) : Rig(3) {
    world.bodies[0].part = solid_box({0.5 * kWidth, 0.007, kHalfLength});
    world.bodies[0].X_WB.p.z() = kHalfLength - depth;
    for (const int side : {1, 2}) {
      Body& wall = world.bodies[std::size_t(side)];
      wall.part = solid_box({0.02, 0.02, 0.025});
      wall.X_WB.p = {(side == 1 ? -1.0 : 1.0) * (0.5 * (kWidth + kClearance) + 0.02), 0.0, -0.025};
      wall.joint.kind = JointKind::kFixed;
    }
    step({});
  }
  void rub(double mu) { settings.friction = {{0, mu, mu, mu, 0, mu, mu, mu, 0}, 3}; }
};

Pose turned(double angle, const Vec3& p = Vec3::Zero()) { return {exp_rotation({0, angle, 0}), p}; }

/// The angle at which a peg that stands `depth` deep touches both walls: found by bisection on the gap
/// between its lower corner and the one wall when its side rests on the rim of the other.
double tilt_at(double depth) {
  double low = 0.0, high = 0.3;
  for (int i = 0; i < 60; ++i) {
    const double tilt = 0.5 * (low + high);
    // Across the slot: width times cosine, and the sine of the part below the rim along the side.
    const double span = kWidth * std::cos(tilt) + depth * std::tan(tilt);
    (span > kWidth + kClearance ? high : low) = tilt;
  }
  return 0.5 * (low + high);
}

/// The friction at which the line between the two contacts leaves the narrower cone, from the peg's pose.
double wedging_limit(const Pose& X_WB, double tilt) {
  const double sense = tilt > 0.0 ? 1.0 : -1.0;  // turned about y: the tip goes to -x
  const Vec3 rim(sense * 0.5 * (kWidth + kClearance), 0, 0);
  const Vec3 corner = X_WB * Vec3(-sense * 0.5 * kWidth, 0, -kHalfLength);
  const Vec3 line = (Vec3(corner.x(), 0, corner.z()) - rim).normalized();
  const Vec3 off_rim = X_WB.R * Vec3(-sense, 0, 0);
  const Vec3 off_wall(sense, 0, 0);
  const double at_rim = std::acos(std::abs(line.dot(off_rim)));
  const double at_wall = std::acos(std::abs(line.dot(off_wall)));
  return std::tan(std::max(at_rim, at_wall));
}

/// Jams a peg `depth` deep without friction, so that both contacts are there, then adds friction and pulls
/// with ten times the force that friction resists by the squeeze alone.
struct Pull {
  Slot slot;
  double angle, limit;  // of the hand; analytic friction
  Vec3 p_jammed;

  Pull(double depth, double mu, double sense) : slot(depth), angle(sense * (tilt_at(depth) + kSqueeze_rad)) {
    slot.go(turned(angle), 300);
    slot.go(slot.X_DH, 100);
    limit = wedging_limit(slot.X_WB(), angle);
    slot.rub(mu);
    slot.go(slot.X_DH, 20);
    p_jammed = slot.X_WB().p;
    const Coupling& coupling = slot.settings.coupling;
    const double wedged_N = 2.0 * mu * coupling.stiffness_Nm_per_rad * kSqueeze_rad / depth;
    slot.go(turned(angle, {0, 0, 10.0 * wedged_N / coupling.stiffness_N_per_m}), 500);
    slot.go(slot.X_DH, 500);
    EXPECT_EQ(slot.penetrating_frames, 0);
  }
  double displacement() { return (slot.X_WB().p - p_jammed).norm(); }
};

TEST(Wedging, TheJammedPegHoldsAboveTheGeometricLimitAndComesOutBelow) {
  for (const double depth : testing::sampled(std::vector{0.004, 0.006, 0.010}, 3))
    for (const double sense : {1.0, -1.0}) {
      double limit = 0.0, low = 0.05, high = 1.0;
      while (high - low > 0.002) {
        const double mu = 0.5 * (low + high);
        Pull pull(depth, mu, sense);
        limit = pull.limit;
        (pull.displacement() < kStuck_m ? high : low) = mu;
      }
      std::printf("%g mm deep: wedged from friction %.4f, analytic %.4f\n", 1e3 * depth, high, limit);
      EXPECT_NEAR(high, limit, 0.05 * limit) << depth << " " << sense;
    }
}

TEST(Wedging, AJammedPegIsFreedByTurningItStraight) {
  const double depth = 0.006;
  Pull pull(depth, 1.3 * 0.5 * depth / (0.5 * kWidth), 1.0);
  ASSERT_LT(pull.displacement(), kStuck_m);
  // A still hand, and a pull twice as hard, do not help.
  pull.slot.go(turned(pull.angle, 2.0 * pull.slot.X_DH.p), 500);
  pull.slot.go(pull.slot.X_DH, 3000);
  EXPECT_LT(pull.displacement(), kStuck_m);
  // The hand ends the pull, turns the peg to the other side and back, and pulls a little.
  pull.slot.go(turned(pull.angle), 300);
  pull.slot.go(turned(-pull.angle), 300);
  pull.slot.go(turned(0.0), 300);
  pull.slot.go(turned(0.0, {0, 0, 1.5 * depth}), 300);
  EXPECT_GT(pull.slot.X_WB().p.z() - pull.p_jammed.z(), depth);
  EXPECT_EQ(pull.slot.penetrating_frames, 0);
}

TEST(Wedging, AWedgeThatNoTurningSqueezesHoldsNothing) {
  // Pulled so hard that the displacement along the walls hides how it comes off them: only the hand, which no
  // longer turns the peg against its walls, shows that nothing presses them.
  for (const double mu_of_limit : {1.1, 1.3, 2.0}) {
    const double depth = 0.006;
    Pull pull(depth, mu_of_limit * 0.5 * depth / (0.5 * kWidth), 1.0);
    ASSERT_LT(pull.displacement(), kStuck_m) << mu_of_limit;
    const Vec3 pulled = pull.slot.X_DH.p;
    pull.slot.go(turned(tilt_at(depth) + 0.2 * kSqueeze_rad, pulled), 500);
    pull.slot.go(pull.slot.X_DH, 500);
    EXPECT_LT(pull.displacement(), kStuck_m) << "squeezed a fifth as hard it still holds, " << mu_of_limit;
    pull.slot.go(turned(0.5 * tilt_at(depth), pulled), 500);
    EXPECT_GT(pull.slot.X_WB().p.z() - pull.p_jammed.z(), depth) << mu_of_limit;
    EXPECT_EQ(pull.slot.penetrating_frames, 0);
  }
}

}  // namespace
}  // namespace tactum::wedging_test
