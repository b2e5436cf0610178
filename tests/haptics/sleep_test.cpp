/// Bodies that sleep must show no difference from bodies that are awake: the same worlds with and without
/// sleep.

#include "tactum/response/sleep.h"

#include <gtest/gtest.h>

#include <functional>

#include "support/sandbox.h"
#include "tactum/math/screw.h"

namespace tactum::sleep_test {
namespace {

const Vec3 kGravity(0, 0, -9.81);  // [m/s^2]

Pose at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {exp_rotation(turn), {x, y, z}};
}

/// A floor with its top at z = 0.
void lay_floor(Sandbox& box) {
  box.world.gravity_W = kGravity;
  box.add_fixed(make_box({0.5, 0.5, 0.01}), at(0, 0, -0.01));
}

struct Twins {
  Sandbox awake, sleeping;

  explicit Twins(const std::function<void(Sandbox&)>& fill) {
    for (Sandbox* box : {&awake, &sleeping}) fill(*box);
    sleeping.settings.budget.sleep = true;
  }
  /// The farthest that any body's twin is from it [m].
  double apart() {
    double most = 0.0;
    for (int b = 0; b < static_cast<int>(awake.world.bodies.size()); ++b)
      most = std::max(most, (awake.X(b).p - sleeping.X(b).p).norm());
    return most;
  }
};

TEST(Sleep, WhatRestsFallsAsleepWhereItIsAndCostsLess) {
  Twins twins([](Sandbox& box) {
    lay_floor(box);
    for (int i = 0; i < 4; ++i) box.add(make_box({0.02, 0.02, 0.01}), at(0, 0, 0.0101 + 0.0202 * i));
    box.rub(0.4);
  });
  for (Sandbox* box : {&twins.awake, &twins.sleeping}) box->run(2.0);
  EXPECT_EQ(twins.awake.report.asleep, 0);
  EXPECT_EQ(twins.sleeping.report.asleep, 4);
  EXPECT_LT(twins.apart(), 1e-7);
  EXPECT_LT(twins.sleeping.report.tests(), twins.awake.report.tests());
  EXPECT_EQ(twins.sleeping.report.solver_iterations, 0);
  const Pose before = twins.sleeping.X(4);
  twins.sleeping.run(1.0);
  EXPECT_EQ((twins.sleeping.X(4).p - before.p).norm(), 0.0);
}

TEST(Sleep, WhatSwingsSlidesOrFliesStaysAwake) {
  Twins twins([](Sandbox& box) {
    lay_floor(box);
    // A pendulum that hardly swings, a block that hardly slides (on no friction), and one at the top of its
    // flight.
    const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = {0.3, 0, 0.4}};
    const Mat3 swung = exp_rotation({0, 0.01, 0});
    box.add(make_box({0.01, 0.01, 0.01}), {swung, Vec3(0.3, 0, 0.4) + swung * Vec3(0, 0, -0.1)}, {}, hinge);
    box.add(make_box({0.02, 0.02, 0.01}), at(-0.2, 0, 0.010001), {{1e-4, 0, 0}, Vec3::Zero()});
    box.add(make_box({0.01, 0.01, 0.01}), at(0, 0.2, 0.5), {{0, 0, 3.0}, Vec3::Zero()});
  });
  double most = 0.0;
  for (int i = 0; i < 600; ++i) {
    for (Sandbox* box : {&twins.awake, &twins.sleeping}) box->step();
    EXPECT_EQ(twins.sleeping.report.asleep, 0) << i;
    most = std::max(most, twins.apart());
  }
  EXPECT_EQ(most, 0.0);
}

/// What gains speed slowly goes where closed forms say: an arm next to upright, by cosh, and a box in next to
/// no gravity, by g t^2 / 2. In balance both sleep.
TEST(Sleep, WhatGainsSpeedSlowlyStaysAwake) {
  for (const double off : {1e-2, 1e-5, 1e-8})
    for (const double size : {0.02, 0.2, 2.0}) {
      SCOPED_TRACE(::testing::Message() << off << " rad, " << size << " m");
      Sandbox box;
      box.world.gravity_W = kGravity;
      box.settings.budget.sleep = true;
      const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = Vec3::Zero()};
      const Mat3 turn = exp_rotation({0, off, 0});
      const int arm =
          box.add(make_box({0.1 * size, 0.1 * size, size}), {turn, turn * Vec3(0, 0, size)}, {}, hinge);
      const double inertia = (0.01 + 1.0) / 3.0 + 1.0;  // times m size^2
      const double rate = std::sqrt(9.81 / (inertia * size));
      const double time_s = std::min(2.0, std::acosh(0.05 / off) / rate);
      box.run(time_s);
      EXPECT_NEAR(log_rotation(box.X(arm).R).y(), off * std::cosh(rate * time_s),
                  0.02 * off * std::cosh(rate * time_s));
    }
  for (const double gravity : {1e-5, 1e-8, 0.0}) {
    Sandbox box;
    box.world.gravity_W = {0, 0, -gravity};
    box.settings.budget.sleep = true;
    const int free = box.add(make_box({1, 1, 1}), at(0, 0, 0));
    box.run(2.0);
    EXPECT_NEAR(box.X(free).p.z(), -2.0 * gravity, 0.01 * gravity) << gravity;
    EXPECT_EQ(box.report.asleep, gravity > 0.0 ? 0 : 1);
  }
}

TEST(Sleep, ABlowWakesWhatItStrikesAndWhatThatTouches) {
  Twins twins([](Sandbox& box) {
    lay_floor(box);
    box.add(make_box({0.02, 0.02, 0.02}), at(0, 0, 0.02001));
    box.add(make_box({0.02, 0.02, 0.02}), at(0.040002, 0, 0.02001));
    box.add(make_box({0.01, 0.01, 0.01}), at(-0.3, 0, 0.02), {{1.0, 0, 0}, Vec3::Zero()},
            {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX(), .anchor_W = {-0.3, 0, 0.02}});
    box.rub(0.2);
    box.bounce(0.5);
  });
  int asleep = 0;
  for (int i = 0; i < 320; ++i) {
    for (Sandbox* box : {&twins.awake, &twins.sleeping}) box->step();
    if (i == 200) asleep = twins.sleeping.report.asleep;
  }
  EXPECT_EQ(asleep, 2);
  EXPECT_GT(twins.awake.X(2).p.x(), 0.041) << "the blow has gone through the first block";
  EXPECT_LT(twins.apart(), 1e-6);
  EXPECT_EQ(twins.sleeping.penetrating_frames, 0);
}

TEST(Sleep, WhatIsPushedWakesWithWhatStandsOnIt) {
  // Two blocks on one another, and a rod that comes along a slider and pushes the lower one.
  Twins twins([](Sandbox& box) {
    lay_floor(box);
    box.add(make_box({0.02, 0.02, 0.01}), at(0, 0, 0.0101));
    box.add(make_box({0.015, 0.015, 0.01}), at(0, 0, 0.0303));
    box.add(make_box({0.05, 0.05, 0.008}), at(-0.3, 0, 0.012), {{0.5, 0, 0}, Vec3::Zero()},
            {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX(), .anchor_W = {-0.3, 0, 0.012}});
    box.rub(0.1);
  });
  int asleep_before = 0;
  int asleep_after = 2;
  for (int i = 0; i < 1000; ++i) {
    for (Sandbox* box : {&twins.awake, &twins.sleeping}) box->step();
    if (i == 400) asleep_before = twins.sleeping.report.asleep;
    if (i == 470) asleep_after = twins.sleeping.report.asleep;
  }
  EXPECT_EQ(asleep_before, 2);
  EXPECT_EQ(asleep_after, 0);
  EXPECT_GT(twins.awake.X(1).p.x(), 0.01);
  EXPECT_LT(twins.apart(), 1e-4);  // of 0.1 m: awake bodies rest to rounding only
  EXPECT_EQ(twins.sleeping.penetrating_frames, 0);
}

}  // namespace
}  // namespace tactum::sleep_test
