// Parts that are felt by their surface and begin a scene in touch with another one, to the last bit, or in
// each other by less than a tenth of their size, move as those of convex pieces do: they are not held fast,
// and what is in each other is pushed apart.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/sample_meshes.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::start_contact_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Case {
  double size_m = 0.1;     // height of the block
  double tilt_rad = 0.15;  // about the edge it stands on
  double depth = 0.0;      // of that edge in the floor, of the size
  double rate_Hz = 1000.0;
  double friction = 0.5;
  bool by_surface = true, floor_by_surface = true;
  bool block_first = false;
};

std::shared_ptr<const Part> box_part(const Vec3& half, bool by_surface) {
  Result<Part> part = part_from_mesh(testing::box_mesh(half),
                                     {.pieces = by_surface ? PieceSource::kSurface : PieceSource::kSolid});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

/// A block that stands on an edge on a floor.
struct Standing {
  World world;
  FrameSettings settings;
  int block = -1;
  std::unique_ptr<Simulation> simulation;

  Standing(const Case& c, bool grasped) {
    const Vec3 half = c.size_m * Vec3(0.15, 0.2, 0.5);
    const auto add_block = [&] {
      const Mat3 R = exp_rotation(Vec3(0, c.tilt_rad, 0));
      const Vec3 above_edge = R * Vec3(std::copysign(half.x(), -c.tilt_rad), 0, half.z());
      block = add_body(world, {.part = box_part(half, c.by_surface),
                               .X_WP = {R, above_edge - Vec3(0, 0, c.depth * c.size_m)}});
    };
    world.gravity_W = {0, 0, -kGravity};
    if (c.block_first) add_block();
    add_body(world, {.part = box_part(c.size_m * Vec3(2, 2, 0.2), c.floor_by_surface),
                     .X_WP = {Mat3::Identity(), Vec3(0, 0, -0.2 * c.size_m)},
                     .joint = {.kind = JointKind::kFixed}});
    if (!c.block_first) add_block();
    settings.dt_s = 1.0 / c.rate_Hz;
    settings.friction = {std::vector<double>(4, c.friction), 2};
    if (grasped) settings.tool.body = block;
    simulation = std::move(*Simulation::make(world, settings));
  }
  const Pose& X_WB() const { return simulation->state().world.X_WB[std::size_t(block)]; }
  const Twist& V_WB() const { return simulation->state().world.V_WB[std::size_t(block)]; }
};

/// With surfaces in place of pieces, and in either order.
std::vector<Case> by_surfaces(const std::vector<Case>& cases) {
  std::vector<Case> made;
  for (Case c : cases)
    for (const bool block_first : {false, true})
      for (const auto& [block, floor] :
           {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
        c.by_surface = block;
        c.floor_by_surface = floor;
        c.block_first = block_first;
        made.push_back(c);
      }
  return made;
}

Case of_pieces(Case c) {
  c.by_surface = c.floor_by_surface = c.block_first = false;
  return c;
}

::testing::Message words_of(const Case& c) {
  return ::testing::Message() << c.size_m << " m, tilt " << c.tilt_rad << ", depth " << c.depth << ", "
                              << c.rate_Hz << " Hz, friction " << c.friction << ", surfaces " << c.by_surface
                              << c.floor_by_surface << ", block first " << c.block_first;
}

const std::vector<Case>& touching() {
  static const std::vector<Case> cases = {{},
                                          {.tilt_rad = -0.15},
                                          {.tilt_rad = 0.0},
                                          {.tilt_rad = 0.4},
                                          {.size_m = 0.01},
                                          {.size_m = 0.013, .tilt_rad = 0.31, .rate_Hz = 4000.0},
                                          {.size_m = 1.0, .rate_Hz = 500.0},
                                          {.friction = 0.0}};
  return cases;
}

const std::vector<Case>& overlapping() {
  static const std::vector<Case> cases = {{.depth = 1e-4},
                                          {.depth = 1e-3},
                                          {.depth = 5e-3},
                                          {.depth = 3e-2},
                                          {.tilt_rad = 0.0, .depth = 1e-3},
                                          {.tilt_rad = 0.4, .depth = 1e-3, .friction = 0.0},
                                          {.size_m = 0.013, .depth = 2e-3, .rate_Hz = 4000.0},
                                          {.size_m = 1.0, .depth = 1e-4, .rate_Hz = 500.0}};
  return cases;
}

/// It turns about its edge as one of pieces, or stands where it is level.
void expect_as_pieces(const Case& c) {
  SCOPED_TRACE(words_of(c));
  Standing surface(c, false);
  Standing pieces(of_pieces(c), false);
  const double turns_s = 0.3 * std::sqrt(c.size_m / kGravity);  // before it comes to lie
  for (double t = 0.0; t < turns_s; t += surface.settings.dt_s) {
    surface.simulation->step(Pose{});
    pieces.simulation->step(Pose{});
    EXPECT_LT(surface.V_WB().v.norm(), 2.0 * kGravity * turns_s);
  }
  const double fell_m = 0.5 * kGravity * turns_s * turns_s;
  EXPECT_LT((surface.X_WB().p - pieces.X_WB().p).norm(), 0.02 * fell_m + 2e-3 * c.depth * c.size_m);
  EXPECT_LT((surface.V_WB().w - pieces.V_WB().w).norm(), 0.02 * std::sqrt(kGravity / c.size_m));
  EXPECT_EQ(surface.simulation->report().penetrating, pieces.simulation->report().penetrating);
}

TEST(StartContact, WhatTouchesToTheLastBitIsNotHeldFast) {
  for (const Case& c : testing::sampled(by_surfaces(touching()), 16)) expect_as_pieces(c);
}

TEST(StartContact, WhatIsInEachOtherIsPushedApartAsPiecesAre) {
  for (const Case& c : testing::sampled(by_surfaces(overlapping()), 14)) expect_as_pieces(c);
}

/// The hand takes it up and aside, and presses it down: with the force that one of pieces is felt by.
TEST(StartContact, AHandMovesIt) {
  std::vector<Case> cases = touching();
  cases.insert(cases.end(), overlapping().begin(), overlapping().end());
  for (const Case& c : testing::sampled(by_surfaces(cases), 5))
    for (const Vec3& by : {Vec3(0, 0, 0.2), Vec3(0.2, 0, 0), Vec3(0, 0.2, 0), Vec3(0, 0, -0.01)}) {
      SCOPED_TRACE(words_of(c) << ", along " << by.transpose());
      Standing surface(c, true);
      Standing pieces(of_pieces(c), true);
      const double last_s = 0.5;
      for (double t = 0.0; t < last_s; t += surface.settings.dt_s) {
        const Pose hand{Mat3::Identity(), std::min(1.0, 2.0 * t / last_s) * c.size_m * by};
        surface.simulation->step(hand);
        pieces.simulation->step(hand);
      }
      const Vec3 apart = surface.X_WB().p - pieces.X_WB().p;
      EXPECT_LT(apart.norm(), 0.005 * c.size_m) << apart.transpose();
      const Vec3 felt = surface.simulation->report().coupling.f;
      const Vec3 right = pieces.simulation->report().coupling.f;
      EXPECT_LT((felt - right).norm(), 0.05 + 0.1 * right.norm())
          << felt.transpose() << ", " << right.transpose();
      EXPECT_FALSE(surface.simulation->report().penetrating);
    }
}

}  // namespace
}  // namespace tactum::start_contact_test
