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
constexpr double kSkins = 2e-5;  // more than the skin of what lies flush at the start, as a part of its size

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
                          {.plates = 5, .rate_Hz = 500.0, .size_m = 0.01, .mass_ratio = 20.0},
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
      EXPECT_NEAR(stack.box.X(stack.plates[i]).p.x(), size, 0.025 * size) << "plate " << i << " of " << pile;
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

/// A row of cubes on a floor, pushed by a force on the first one.
struct RowOf {
  int cubes = 4;
  double rate_Hz = 1000.0;
  double size_m = 0.02;
  double mass_ratio = 1.0;  // of every second cube to the others
  double friction = kFriction;
  double share = 1.5;  // of the force to what the friction of the whole row holds
};

std::ostream& operator<<(std::ostream& out, const RowOf& row) {
  return out << row.cubes << " cubes of " << row.size_m << " m, " << row.rate_Hz << " Hz, mass ratio "
             << row.mass_ratio << ", friction " << row.friction << ", share " << row.share;
}

std::vector<RowOf> rows() {
  std::vector<RowOf> all{{.cubes = 2},
                         {.cubes = 4, .size_m = 0.01},
                         {.cubes = 4, .size_m = 0.1},
                         {.cubes = 4, .mass_ratio = 20.0},
                         {.cubes = 6, .mass_ratio = 0.05},
                         {.cubes = 6, .friction = 0.1},
                         {.cubes = 6, .friction = 0.6},
                         {.cubes = 5, .share = 3.0}};
  for (const double rate : testing::frame_rates_Hz())
    for (const int cubes : {3, 4, 8, 16})
      for (const double share : {0.9, 1.5}) all.push_back({.cubes = cubes, .rate_Hz = rate, .share = share});
  return testing::sampled(all, 3);
}

/// It holds against mu M g, and moves with what is more:  a = F / M - mu g.
TEST(Pile, ARowIsPushedAsOneBody) {
  for (const RowOf& row : rows()) {
    Sandbox box;
    box.settings.dt_s = 1.0 / row.rate_Hz;
    box.world.gravity_W = {0, 0, -kGravity};
    const double size = row.size_m;
    box.add_fixed(make_box({50.0 * size, 5.0 * size, 2.5 * size}), {Mat3::Identity(), {0, 0, -2.5 * size}});
    std::vector<BodySpec> cubes;
    double mass_kg = 0.0;
    for (int i = 0; i < row.cubes; ++i) {
      const double cube_kg = 2000.0 * std::pow(size, 3) * (i % 2 == 1 ? row.mass_ratio : 1.0);
      cubes.push_back({.part = solid_of(make_box({0.5 * size, size, 0.5 * size})),
                       .mass_kg = cube_kg,
                       .X_WP = {Mat3::Identity(), {size * i, 0, 0.5 * size}}});
      mass_kg += cube_kg;
    }
    cubes.front().load.constant.f = {row.share * row.friction * mass_kg * kGravity, 0, 0};
    for (const BodySpec& cube : cubes) add_body(box.world, cube);
    box.rub(row.friction);
    constexpr double kSeconds = 0.2;
    box.run(kSeconds);
    const double a = std::max(0.0, row.share - 1.0) * row.friction * kGravity;
    const double moved = 0.5 * a * kSeconds * kSeconds;
    // Flush at the start, the cubes open by a skin each, which is a part of their size.
    const double opened = kSkins * size * row.cubes;
    for (int i = 0; i < row.cubes; ++i)
      EXPECT_NEAR(box.X(1 + i).p.x() - size * i, moved, 1e-3 * moved + opened)
          << "cube " << i << " of " << row;
    EXPECT_EQ(box.penetrating_frames, 0) << row;
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
