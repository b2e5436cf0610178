// Where there is no memory for a contact its bodies stay where they are, and a flag says so: with whatever
// capacity, nothing is entered.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"

namespace tactum::capacity_test {
namespace {

/// A square plate of n by n boxes side by side, with its centre in the origin, or the surface of it.
std::shared_ptr<const Part> plate(int n, double width, double height, bool surface) {
  TriangleMesh mesh;
  std::vector<std::vector<Vec3>> clouds;
  for (int i = 0; i < n * n; ++i) {
    const double tile = width / n;
    const Vec3 low(tile * (i % n) - 0.5 * width, tile * (i / n) - 0.5 * width, -0.5 * height);
    std::vector<Vec3>& cloud = clouds.emplace_back();
    for (int k = 0; k < 8; ++k)
      cloud.push_back(low + Vec3(k & 1 ? tile : 0.0, k & 2 ? tile : 0.0, k & 4 ? height : 0.0));
  }
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part);
  if (!surface) return std::make_shared<const Part>(std::move(*part));
  Result<Part> shell = part_from_mesh(part->surface, {.pieces = PieceSource::kSurface});
  EXPECT_TRUE(shell);
  return std::make_shared<const Part>(std::move(*shell));
}

struct Case {
  const char* what;
  ContactFinderCapacity capacity;
  int block_tiles = 2, floor_tiles = 4;
  bool surface = false;
  bool grasped = true;
  double size_m = 0.04;
  double rate_Hz = 1000.0;
};

struct Outcome {
  bool flagged = false;
  double lowest_m = 0.0;  // of the block's lower face over the floor
};

/// A block that is pressed into a floor by the hand, or falls on it.
Outcome pressed(const Case& c) {
  World world;
  world.gravity_W = {0, 0, c.grasped ? 0.0 : -9.81};
  const double height = 0.25 * c.size_m;
  const double gap = 0.1 * c.size_m;
  const int block = add_body(world, {.part = plate(c.block_tiles, c.size_m, height, c.surface),
                                     .mass_kg = 0.1,
                                     .X_WP = {Mat3::Identity(), {0, 0, 0.5 * height + gap}}});
  add_body(world, {.part = plate(c.floor_tiles, 3.0 * c.size_m, height, c.surface),
                   .X_WP = {Mat3::Identity(), {0, 0, -0.5 * height}},
                   .joint = {.kind = JointKind::kFixed}});
  FrameSettings settings;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.budget.capacity = c.capacity;
  settings.tool.body = c.grasped ? block : -1;
  const auto simulation = std::move(*Simulation::make(std::move(world), settings));
  Outcome outcome{.lowest_m = gap};
  const int frames = static_cast<int>(0.6 * c.rate_Hz);
  for (int i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / frames;
    simulation->step(Pose{Mat3::Identity(), {0.2 * c.size_m * t, 0, -4.0 * gap * std::min(1.0, 2.0 * t)}});
    outcome.flagged |= (simulation->report().flags & frame_flag::kCapacityReached) != 0;
    const Pose& X_WB = simulation->bodies().X_WB[static_cast<std::size_t>(block)];
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner(k & 1 ? 0.5 * c.size_m : -0.5 * c.size_m, k & 2 ? 0.5 * c.size_m : -0.5 * c.size_m,
                        k & 4 ? 0.5 * height : -0.5 * height);
      outcome.lowest_m = std::min(outcome.lowest_m, (X_WB * corner).z());
    }
  }
  return outcome;
}

TEST(Capacity, WithoutRoomNothingIsEntered) {
  const std::vector<Case> cases{
      {"room for one pair", {.pairs = 1}},
      {"room for half of the pairs", {.pairs = 8}},
      {"room for one patch", {.patches = 1}},
      {"room for three patches", {.patches = 3}},
      {"a block that falls, room for one pair", {.pairs = 1}, 2, 4, false, false},
      {"a block that falls, room for one patch", {.patches = 1}, 2, 4, false, false},
      {"one piece on many, room for two patches", {.patches = 2}, 1, 6, false, false, 0.2, 500.0},
      {"surfaces, room for one patch", {.patches = 1}, 2, 2, true},
      {"surfaces, room for two minima", {.minima = 2}, 2, 2, true},
      {"falling surfaces, room for two minima", {.minima = 2}, 2, 2, true, false, 0.01, 4000.0},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const Outcome outcome = pressed(c);
    EXPECT_TRUE(outcome.flagged);
    EXPECT_GE(outcome.lowest_m, 0.0);
  }
}

TEST(Capacity, WithRoomTheBlockComesToTheFloor) {
  for (const bool grasped : {true, false})
    for (const bool surface : {true, false}) {
      SCOPED_TRACE(::testing::Message() << "grasped " << grasped << ", surface " << surface);
      const Outcome outcome = pressed({"ample", {}, 2, 2, surface, grasped});
      EXPECT_FALSE(outcome.flagged);
      EXPECT_GE(outcome.lowest_m, 0.0);
      EXPECT_LT(outcome.lowest_m, 1e-4 * 0.04);
    }
}

}  // namespace
}  // namespace tactum::capacity_test
