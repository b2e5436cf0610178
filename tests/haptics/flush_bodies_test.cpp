// Bodies that lie side by side are felt as one floor: a block slides over boards as over one plate, held or
// free, with friction or without, over steps lower than what is told in contact/flush_bodies.h.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/sample_meshes.h"
#include "support/solid_box.h"
#include "tactum/contact/flush_bodies.h"
#include "tactum/haptics/simulation.h"

namespace tactum::flush_bodies_test {
namespace {

struct Case {
  double size_m = 0.03;  // length of the block
  double rate_Hz = 1000.0;
  double mu = 0.0;
  double step = 0.0;        // by how much every second board is lower, of the block's length
  bool block_last = false;  // the block's number in the world is after the boards'
  double yaw_rad = 0.0;
  bool surface_block = false, surface_floor = false;  // felt by their surfaces, not as convex pieces
  ResponseModel response = ResponseModel::kConstraint;
};

std::shared_ptr<const Part> box_part(const Vec3& half, bool surface) {
  if (!surface) return solid_box(half);
  Result<Part> part = part_from_mesh(testing::box_mesh(half), {.pieces = PieceSource::kSurface});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

constexpr int kBoards = 8;
constexpr double kGravity = 9.81;  // [m/s^2]

/// A floor of boards across x, as long as kBoards blocks, or of one plate; and a block of 1 x 0.7 x 0.5.
struct Floor {
  World world;
  int block = -1;
  FrameSettings settings;

  Floor(const Case& c, bool one_plate) {
    const Vec3 half = c.size_m * Vec3(0.5, 0.35, 0.25);
    const auto add_block = [&] {
      block = add_body(world, {.part = box_part(half, c.surface_block),
                               .mass_kg = 0.1,
                               .X_WP = {exp_rotation({0, 0, c.yaw_rad}),
                                        {-0.3 * kBoards * c.size_m, 0, half.z() + 1e-4 * c.size_m}}});
    };
    if (!c.block_last) add_block();
    const int boards = one_plate ? 1 : kBoards;
    const double length = kBoards * c.size_m / boards;
    const auto board = box_part({0.5 * length, 1.5 * c.size_m, 0.5 * c.size_m}, c.surface_floor);
    for (int i = 0; i < boards; ++i)
      add_body(world, {.part = board,
                       .X_WP = {Mat3::Identity(),
                                {(i + 0.5) * length - 0.5 * kBoards * c.size_m, 0,
                                 -0.5 * c.size_m - (i % 2) * c.step * c.size_m}},
                       .joint = {.kind = JointKind::kFixed}});
    if (c.block_last) add_block();
    settings.response = c.response;
    settings.dt_s = 1.0 / c.rate_Hz;
    settings.coupling.damping_Ns_per_m = settings.coupling.damping_Nms_per_rad = 0.0;
    settings.smoothing.on = false;
    const int bodies = static_cast<int>(world.bodies.size());
    if (c.mu > 0.0)
      settings.friction = {std::vector<double>(static_cast<std::size_t>(bodies * bodies), c.mu), bodies};
  }
};

/// The wrench felt while the hand presses the block down by 2 mm and draws it over four seams in a second.
std::vector<Wrench> drawn(const Case& c, bool one_plate) {
  Floor floor(c, one_plate);
  floor.settings.tool.body = floor.block;
  const auto simulation = std::move(*Simulation::make(floor.world, floor.settings));
  std::vector<Wrench> felt;
  const int frames = static_cast<int>(c.rate_Hz);
  for (int i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / frames;
    const double down = 0.002 * std::min(1.0, 5.0 * t) + 1e-4 * c.size_m;
    const double along = 0.6 * kBoards * c.size_m * std::max(0.0, t - 0.2);
    simulation->step(Pose{Mat3::Identity(), {along, 0.05 * along, -down}});
    felt.push_back(simulation->report().coupling);
  }
  return felt;
}

/// The largest difference of two runs, of force and of torque over a tenth of the block [N].
double largest_difference(const std::vector<Wrench>& one, const std::vector<Wrench>& other, double size_m) {
  double most = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i)
    most = std::max({most, (one[i].f - other[i].f).norm(), (one[i].t - other[i].t).norm() / (0.1 * size_m)});
  return most;
}

TEST(FlushBodies, BoardsAreFeltAsOnePlate) {
  const double press_N = 0.002 * FrameSettings{}.coupling.stiffness_N_per_m;
  for (const Case& c :
       {Case{}, Case{.block_last = true}, Case{.size_m = 0.002}, Case{.size_m = 1.0}, Case{.rate_Hz = 500.0},
        Case{.rate_Hz = 4000.0}, Case{.yaw_rad = 0.3}, Case{.mu = 0.3}, Case{.mu = 0.3, .block_last = true},
        Case{.mu = 0.6, .yaw_rad = 0.3}, Case{.size_m = 0.3, .mu = 0.2}}) {
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, " << c.rate_Hz << " Hz, mu " << c.mu << ", yaw "
                                      << c.yaw_rad << ", last " << c.block_last);
    EXPECT_LT(largest_difference(drawn(c, true), drawn(c, false), c.size_m), 1e-3 * press_N);
  }
}

TEST(FlushBodies, StepsBelowTheToldHeightAreRiddenOver) {
  const double k = FrameSettings{}.coupling.stiffness_N_per_m;
  for (Case c : {Case{}, Case{.block_last = true}, Case{.size_m = 0.2}, Case{.rate_Hz = 4000.0},
                 Case{.yaw_rad = 0.3}}) {
    SCOPED_TRACE(::testing::Message()
                 << c.size_m << " m, " << c.rate_Hz << " Hz, yaw " << c.yaw_rad << ", last " << c.block_last);
    const std::vector<Wrench> level = drawn(c, true);
    c.step = 0.9 * kRiddenStep;
    const std::vector<Wrench> stepped = drawn(c, false);
    double most = 0.0;
    for (std::size_t i = 0; i < level.size(); ++i)
      most = std::max(most, (level[i].f - stepped[i].f).head<2>().norm());
    EXPECT_LT(most, 2.0 * k * c.step * c.size_m);
  }
}

TEST(FlushBodies, HigherStepsStopTheBlock) {
  Case c;
  c.step = 20.0 * kRiddenStep;
  double most = 0.0;
  for (const Wrench& felt : drawn(c, false)) most = std::max(most, -felt.f.x());
  EXPECT_GT(most, 1.0);
}

TEST(FlushBodies, ThePublishedResponseFeelsNoSeams) {
  for (Case c : {Case{}, Case{.block_last = true}, Case{.size_m = 0.01}, Case{.yaw_rad = 0.3}}) {
    c.response = ResponseModel::kPenalty;
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, yaw " << c.yaw_rad << ", last " << c.block_last);
    const std::vector<Wrench> one = drawn(c, true);
    const std::vector<Wrench> boards = drawn(c, false);
    double most = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i)
      most = std::max(most, (one[i].f - boards[i].f).head<2>().norm());
    // Two boards push twice as stiffly as one, so the block, which leans, is lifted a little at a seam.
    EXPECT_LT(most, 0.05 * 0.002 * FrameSettings{}.coupling.stiffness_N_per_m);
  }
}

/// How far a free block slides that starts at `speed` in the middle of the first third.
double slides(const Case& c, double speed, bool one_plate) {
  Floor floor(c, one_plate);
  Body& block = floor.world.bodies[static_cast<std::size_t>(floor.block)];
  block.V_WB.v = {speed, 0.03 * speed, 0.0};
  block.X_WB.p.z() -= 0.9e-4 * c.size_m;
  floor.world.gravity_W = {0, 0, -9.81};
  const auto simulation = std::move(*Simulation::make(floor.world, floor.settings));
  for (double t = 0.0; t < speed / (c.mu * 9.81) + 0.2; t += floor.settings.dt_s) simulation->step(Pose{});
  const Pose& X_WB = simulation->state().world.X_WB[static_cast<std::size_t>(floor.block)];
  EXPECT_LT(X_WB.p.z(), block.X_WB.p.z() + 1e-3 * c.size_m);  // it is not thrown up
  return (X_WB.p - block.X_WB.p).head<2>().norm();
}

TEST(FlushBodies, AFreeBlockStopsWhereFrictionSays) {
  for (const Case& c : {Case{.mu = 0.2}, Case{.mu = 0.2, .block_last = true}, Case{.mu = 0.5, .yaw_rad = 0.4},
                        Case{.size_m = 0.3, .mu = 0.1}, Case{.rate_Hz = 4000.0, .mu = 0.2},
                        Case{.rate_Hz = 500.0, .mu = 0.2}}) {
    // It stops after half of the floor: v^2 = 2 mu g s.
    const double length = 0.5 * kBoards * c.size_m;
    const double speed = std::sqrt(2.0 * c.mu * 9.81 * length);
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, " << c.rate_Hz << " Hz, mu " << c.mu);
    EXPECT_NEAR(slides(c, speed, false), slides(c, speed, true), 2e-3 * length);
    EXPECT_NEAR(slides(c, speed, false), length * (1.0 + 0.5 * 0.03 * 0.03), 0.01 * length);
  }
}

/// The block, the floor, or both felt by their surfaces.
std::vector<Case> by_surfaces(const std::vector<Case>& cases) {
  std::vector<Case> made;
  for (Case c : cases)
    for (const auto& [block, floor] :
         {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
      c.surface_block = block;
      c.surface_floor = floor;
      made.push_back(c);
    }
  return testing::sampled(made, 5);
}

TEST(FlushBodies, SurfacesAreFeltAsOneFloor) {
  for (const Case& c : by_surfaces({{},
                                    {.size_m = 0.01},
                                    {.rate_Hz = 4000.0},
                                    {.mu = 0.3, .yaw_rad = 0.3},
                                    {.size_m = 0.01, .rate_Hz = 4000.0, .mu = 0.3, .block_last = true},
                                    {.size_m = 0.3, .mu = 0.3}})) {
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, " << c.rate_Hz << " Hz, mu " << c.mu << ", yaw "
                                      << c.yaw_rad << ", surfaces " << c.surface_block << c.surface_floor);
    const std::vector<Wrench> felt = drawn(c, false);
    double step = 0.0, ratio = 0.0, torque = 0.0;
    for (std::size_t i = felt.size() * 2 / 5; i < felt.size(); ++i) {
      step = std::max(step, (felt[i].f - felt[i - 1].f).norm());
      ratio = std::max(ratio, std::abs(felt[i].f.head<2>().norm() / felt[i].f.z() - c.mu));
      torque = std::max(torque, std::abs(felt[i].t.z()));
    }
    EXPECT_LT(step, 1e-3);
    EXPECT_LT(ratio, 1e-3);
    EXPECT_LT(torque, 1e-3 * c.size_m * felt.back().f.z());
  }
}

TEST(FlushBodies, SurfacesRideOverStepsBelowTheToldHeight) {
  const double k = FrameSettings{}.coupling.stiffness_N_per_m;
  for (Case c : by_surfaces({{},
                             {.size_m = 0.2},
                             {.rate_Hz = 4000.0},
                             {.yaw_rad = 0.3},
                             {.rate_Hz = 500.0, .block_last = true}})) {
    SCOPED_TRACE(::testing::Message()
                 << c.size_m << " m, " << c.rate_Hz << " Hz, yaw " << c.yaw_rad << ", last " << c.block_last
                 << ", surfaces " << c.surface_block << c.surface_floor);
    const std::vector<Wrench> level = drawn(c, true);
    c.step = 0.9 * kRiddenStep;
    const std::vector<Wrench> stepped = drawn(c, false);
    double most = 0.0;
    for (std::size_t i = 0; i < level.size(); ++i) {
      most = std::max(most, (level[i].f - stepped[i].f).head<2>().norm());
    }
    EXPECT_LT(most, 2.0 * k * c.step * c.size_m);
  }
}

TEST(FlushBodies, AFreeBlockOverSurfacesStopsWhereFrictionSays) {
  for (const Case& c : by_surfaces({{.mu = 0.2},
                                    {.mu = 0.2, .block_last = true},
                                    {.mu = 0.5, .yaw_rad = 0.4},
                                    {.size_m = 0.3, .mu = 0.1},
                                    {.rate_Hz = 4000.0, .mu = 0.2}})) {
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, " << c.rate_Hz << " Hz, mu " << c.mu
                                      << ", surfaces " << c.surface_block << c.surface_floor);
    const double length = 0.5 * kBoards * c.size_m * (1.0 + 0.5 * 0.03 * 0.03);
    const double speed = std::sqrt(2.0 * c.mu * kGravity * 0.5 * kBoards * c.size_m);
    EXPECT_NEAR(slides(c, speed, false), length, 1e-3 * length);
  }
}

TEST(FlushBodies, AFreeBlockRidesOverStepsAsOverALevelFloor) {
  std::vector<Case> cases =
      by_surfaces({{.mu = 0.2}, {.mu = 0.5, .yaw_rad = 0.4}, {.size_m = 0.3, .mu = 0.2}});
  cases.push_back({.mu = 0.2});  // of pieces
  cases.push_back({.size_m = 0.3, .mu = 0.2});
  cases.push_back({.size_m = 0.3, .rate_Hz = 4000.0, .mu = 0.2});
  cases.push_back({.rate_Hz = 4000.0, .mu = 0.3, .block_last = true});
  for (Case c : cases) {
    SCOPED_TRACE(::testing::Message() << c.size_m << " m, " << c.rate_Hz << " Hz, mu " << c.mu
                                      << ", surfaces " << c.surface_block << c.surface_floor);
    c.step = 0.9 * kRiddenStep;
    const double length = 0.5 * kBoards * c.size_m * (1.0 + 0.5 * 0.03 * 0.03);
    const double speed = std::sqrt(2.0 * c.mu * kGravity * 0.5 * kBoards * c.size_m);
    EXPECT_NEAR(slides(c, speed, false), length, 0.01 * length);
  }
}

}  // namespace
}  // namespace tactum::flush_bodies_test
