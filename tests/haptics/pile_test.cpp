/// Piles of many bodies, through which loads pass far, against mechanics in closed form.

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <vector>

#include "support/effort.h"
#include "support/sandbox.h"

namespace tactum::pile_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kFriction = 0.3;
constexpr double kSkin_m = 4e-7;  // of what lies flush at the start, at most

struct PileOf {
  int plates = 5;
  double rate_Hz = 1000.0;
  double size_m = 0.1;      // of a plate, which is a fifth as high
  double mass_ratio = 1.0;  // of every second plate to the others
  bool floor_last = false;  // the order in which bodies are added
};

std::ostream& operator<<(std::ostream& out, const PileOf& pile) {
  return out << pile.plates << " plates of " << pile.size_m << " m, " << pile.rate_Hz << " Hz, mass ratio "
             << pile.mass_ratio << (pile.floor_last ? ", floor last" : "");
}

std::vector<PileOf> variants() {
  std::vector<PileOf> all{{.plates = 2},
                          {.plates = 3},
                          {.plates = 5},
                          {.plates = 8},
                          {.plates = 15},
                          {.plates = 5, .mass_ratio = 20.0},
                          {.plates = 5, .mass_ratio = 0.05},
                          {.plates = 6, .size_m = 0.01},
                          {.plates = 6, .size_m = 1.0},
                          {.plates = 6, .floor_last = true}};
  for (const double rate : testing::frame_rates_Hz()) all.push_back({.plates = 6, .rate_Hz = rate});
  return testing::sampled(all, 3);
}

struct Stack {
  Sandbox box;
  std::vector<int> plates;
};

/// Each plate is by `lean` of its length farther along x than the one below.
Stack stack_of(const PileOf& pile, double slope_rad, double lean) {
  Stack stack;
  Sandbox& box = stack.box;
  box.settings.dt_s = 1.0 / pile.rate_Hz;
  box.world.gravity_W = kGravity * Vec3(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
  const double half = 0.5 * pile.size_m;
  const auto add_floor = [&] {
    box.add_fixed(make_box({40.0 * half, 10.0 * half, half}), {Mat3::Identity(), {10.0 * half, 0, -half}});
  };
  if (!pile.floor_last) add_floor();
  for (int i = 0; i < pile.plates; ++i) {
    const Pose X{Mat3::Identity(), {i * lean * pile.size_m, 0, (0.2 + 0.4 * i) * half}};
    const double mass_kg = 1000.0 * 0.2 * std::pow(pile.size_m, 3) * (i % 2 == 1 ? pile.mass_ratio : 1.0);
    stack.plates.push_back(add_body(
        box.world, {.part = solid_of(make_box({half, half, 0.2 * half})), .mass_kg = mass_kg, .X_WP = X}));
  }
  if (pile.floor_last) add_floor();
  box.rub(kFriction);
  return stack;
}

TEST(Pile, OnASlopeSlidesAsOneBody) {
  for (const PileOf& pile : variants()) {
    constexpr double kSlope = 0.35;  // tan 0.365
    Stack stack = stack_of(pile, kSlope, 0.0);
    const double size = pile.size_m;
    const double a = kGravity * (std::sin(kSlope) - kFriction * std::cos(kSlope));
    const double seconds = std::sqrt(2.0 * size / a);
    stack.box.run(seconds);
    for (std::size_t i = 0; i < stack.plates.size(); ++i)
      EXPECT_NEAR(stack.box.X(stack.plates[i]).p.x(), size, 0.06 * size) << "plate " << i << " of " << pile;
    EXPECT_EQ(stack.box.penetrating_frames, 0) << pile;
  }
}

TEST(Pile, OnAFlatterSlopeHolds) {
  for (const PileOf& pile : variants()) {
    Stack stack = stack_of(pile, 0.27, 0.0);  // tan 0.277
    stack.box.run(0.3);
    for (const int plate : stack.plates)
      EXPECT_LT(std::abs(stack.box.X(plate).p.x()), 1e-3 * pile.size_m) << pile;
  }
}

/// A tower whose plates are each by a part of their length beyond the one below falls when the centre of all
/// but the lowest is beyond the edge of that: from 1 / plates on.
TEST(Pile, ATowerThatLeansTooFarFallsAndOneThatDoesNotStands) {
  for (const PileOf& pile : variants()) {
    if (pile.mass_ratio != 1.0 || pile.plates < 3) continue;
    if (pile.size_m > 0.5) continue;  // see the limits in docs/algorithms/free_bodies.md
    for (const double share : {0.8, 1.4}) {
      Stack stack = stack_of(pile, 0.0, share / pile.plates);
      stack.box.settings.budget.sleep = true;  // what must fall does not sleep
      const double height = stack.box.X(stack.plates.back()).p.z();
      stack.box.run(2.0 * std::sqrt(pile.plates * pile.size_m / kGravity));
      const double fallen = (height - stack.box.X(stack.plates.back()).p.z()) / pile.size_m;
      if (share > 1.0) {
        EXPECT_GT(fallen, 0.05) << pile;
      } else {
        EXPECT_LT(std::abs(fallen), 2e-4) << pile;
      }
    }
  }
}

/// A row of plates on a floor that is pushed at one end, by a force on the first one: it holds against
/// mu n m g and moves with what is more.
TEST(Pile, ARowIsPushedAsOneBody) {
  for (const int plates : {3, 8, 16})
    for (const double rate : testing::frame_rates_Hz())
      for (const double share : {0.9, 1.5}) {
        if (share > 1.0 && plates > 3) continue;  // see the limits in docs/algorithms/free_bodies.md
        Sandbox box;
        box.settings.dt_s = 1.0 / rate;
        box.world.gravity_W = {0, 0, -kGravity};
        box.add_fixed(make_box({1.0, 0.1, 0.05}), {Mat3::Identity(), {0, 0, -0.05}});
        constexpr double kMass = 0.1;
        const double most = kFriction * plates * kMass * kGravity;
        for (int i = 0; i < plates; ++i) {
          BodySpec spec{.part = solid_of(make_box({0.01, 0.02, 0.01})),
                        .mass_kg = kMass,
                        .X_WP = {Mat3::Identity(), {0.02 * i, 0, 0.01}}};
          if (i == 0) spec.load.constant.f = {share * most, 0, 0};
          add_body(box.world, spec);
        }
        box.rub(kFriction);
        constexpr double kSeconds = 0.2;
        box.run(kSeconds);
        const double a = std::max(0.0, share - 1.0) * kFriction * kGravity;
        const double moved = 0.5 * a * kSeconds * kSeconds;
        for (int i = 0; i < plates; ++i)
          EXPECT_NEAR(box.X(1 + i).p.x() - 0.02 * i, moved, 0.01 * moved + kSkin_m * plates)
              << "plate " << i << " of " << plates << ", " << rate << " Hz, " << share;
      }
}

/// Where the solver may not do enough, the frames say so, and nobody is put to sleep in mid-air.
TEST(Pile, WhatIsNotSolvedIsFlaggedAndStaysAwake) {
  for (const int plates : {8, 15}) {
    Stack stack = stack_of({.plates = plates}, 0.35, 0.0);
    stack.box.settings.budget.sleep = true;
    stack.box.settings.budget.solver_iterations = 4;
    int unflagged_at_rest = 0;
    for (int frame = 0; frame < 400; ++frame) {
      stack.box.step();
      const bool flagged = (stack.box.report.flags & frame_flag::kSolverBounded) != 0;
      unflagged_at_rest += !flagged && stack.box.V(stack.plates.back()).v.norm() < 1e-4 ? 1 : 0;
      EXPECT_EQ(stack.box.report.asleep, 0) << plates << ", frame " << frame;
    }
    EXPECT_LT(unflagged_at_rest, 4) << plates;
  }
}

}  // namespace
}  // namespace tactum::pile_test
