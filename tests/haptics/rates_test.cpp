/// The same scenes at 1, 2, 4 and 10 kHz: durations stated in seconds stay as long, and the wrench is the
/// same.
#include <gtest/gtest.h>

#include <array>

#include "support/block_rig.h"
#include "support/sandbox.h"
#include "tactum/base/frame_rate.h"
#include "tactum/contact/steady_contact.h"

namespace tactum::rates_test {
namespace {

constexpr std::array kSteps_s = {0.001, 0.0005, 0.00025, 0.0001};

TEST(Rates, AFrameHasItsShareOfATime) {
  EXPECT_EQ(frames_in(0.06, 0.001), 60);
  EXPECT_EQ(frames_in(0.06, 0.0005), 120);
  EXPECT_EQ(frames_in(0.06, 0.0001), 600);
  EXPECT_EQ(frames_in(0.002, 0.01), 1);
}

/// The direction of least depth in a corner is along x, and was along y: the shown normal turns by 90 degrees
/// at 50 rad/s.
TEST(Rates, AShownNormalTurnsAsFast) {
  const Polytope box = make_box({0.04, 0.04, 0.04});
  const Pose X_AB{Mat3::Identity(), {0.0795, 0.0795, 0.0}};
  PairDistance found;
  found.a = found.b = {FeatureKind::kVertex, 0};  // from where the supports are searched
  found.normal = -Vec3::UnitX();
  found.distance = -0.0005;
  found.p_b = {0.0395, 0.0395, 0.0};
  found.p_a = found.p_b + found.normal * found.distance;
  for (const double dt_s : kSteps_s) {
    const SteadyLimits limits(dt_s);
    SteadyContact last;
    last.normal_A = last.normal_B = -Vec3::UnitY();
    Vec3 before = last.normal_A;
    int frames = 0;
    do {
      const PairDistance shown = steady_depth(box, box, X_AB, found, limits, last);
      EXPECT_LE(std::asin(before.cross(shown.normal).norm()), kNormalTurnRate * dt_s + 1e-9) << dt_s;
      before = shown.normal;
      ++frames;
    } while (before.dot(found.normal) < 1.0 - 1e-12 && frames < 10000);
    EXPECT_NEAR(frames * dt_s, 0.5 * kPi / kNormalTurnRate, dt_s) << dt_s;
  }
}

TEST(Rates, AStepOfTheForceIsSmoothedOverTheSameTime) {
  const Wrench computed{{10.0, 0, 0}, Vec3::Zero()};
  for (const double dt_s : kSteps_s) {
    SmoothingState state;
    int frames = 0;
    while (smooth_wrench({}, dt_s, {1e9, 1e9}, state, computed).f.x() < computed.f.x()) ++frames;
    EXPECT_NEAR(frames * dt_s, 0.0195, 0.001) << dt_s;  // 0.5 N in 1 ms; the last newton at once
  }
}

/// Two blocks fall by 0.5 mm, come to rest on each other, and sleep.
TEST(Rates, BlocksRestWhereTheyDidAndFallAsleepAsSoon) {
  double first_s = 0.0;
  double first_height = 0.0;
  for (const double dt_s : kSteps_s) {
    Sandbox box;
    box.settings.dt_s = dt_s;
    box.settings.budget.sleep = true;
    box.world.gravity_W = {0, 0, -9.81};  // [m/s^2]
    box.add_fixed(make_box({0.1, 0.1, 0.01}), at(0, 0, -0.01));
    box.add(make_box({0.02, 0.02, 0.01}), at(0, 0, 0.0105));
    box.add(make_box({0.02, 0.02, 0.01}), at(0, 0, 0.0315));
    box.rub(0.4);
    int frames = 0;
    for (; box.report.asleep < 2 && frames * dt_s < 2.0; ++frames) box.step();
    const double asleep_s = frames * dt_s;
    const double height = box.X(2).p.z();
    EXPECT_EQ(box.report.asleep, 2) << dt_s;
    EXPECT_EQ(box.penetrating_frames, 0) << dt_s;
    EXPECT_NEAR(height, 0.03, 1e-5) << dt_s;
    if (dt_s == kSteps_s[0]) {
      first_s = asleep_s;
      first_height = height;
    }
    EXPECT_NEAR(asleep_s, first_s, 0.010) << dt_s;
    EXPECT_NEAR(height, first_height, 1e-6) << dt_s;
    std::printf("  %5.0f Hz: asleep after %.4f s at %.9f m\n", 1.0 / dt_s, asleep_s, height);
  }
}

/// A grasped block is led down onto a plate, pressed by 2 mm, and slid along it: the force at every 10 ms.
TEST(Rates, APressedAndSlidBlockFeelsTheSame) {
  std::vector<Vec3> first;
  double largest = 0.0;
  for (const double dt_s : kSteps_s) {
    BlockRig rig(0.3);
    rig.settings.dt_s = dt_s;
    const int frames = frames_in(0.010, dt_s);
    std::vector<Vec3> felt;
    rig.step({});
    for (int i = 1; i <= 60; ++i) {
      const double down = -0.005 * std::min(1.0, i / 30.0);                // [m] at 17 mm/s
      const double along = 0.004 * std::clamp((i - 30) / 20.0, 0.0, 1.0);  // [m] at 20 mm/s
      rig.go(at(along, 0, down), frames);
      felt.push_back(rig.report.coupling.f);
    }
    EXPECT_EQ(rig.penetrating_frames, 0) << dt_s;
    if (first.empty()) {
      first = felt;
      for (const Vec3& f : first) largest = std::max(largest, f.norm());
      EXPECT_GT(largest, 1.0);
    }
    double apart = 0.0;
    for (std::size_t i = 0; i < felt.size(); ++i) apart = std::max(apart, (felt[i] - first[i]).norm());
    std::printf("  %5.0f Hz: the force is off by %.4f N of %.3f N at most\n", 1.0 / dt_s, apart, largest);
    EXPECT_LT(apart, 0.02 * largest) << dt_s;
  }
}

}  // namespace
}  // namespace tactum::rates_test
