// In which order the bodies of a world are listed changes nothing: a solid that falls onto a floor tumbles to
// rest in the same way whether it is listed before the floor or after it, and no step of it is left out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/sample_meshes.h"
#include "support/sample_solids.h"
#include "tactum/base/random.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/parts/generated_parts.h"

namespace tactum::order_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Case {
  int solid = 0;  // of solid_mesh()
  double size_m = 0.01;
  double rate_Hz = 1000.0;
  double friction = 0.0, restitution = 0.0;
  bool by_surface = true, floor_by_surface = true;
  std::uint64_t seed = 1;
};

TriangleMesh solid_mesh(const Case& c) {
  const double a = c.size_m;
  switch (c.solid) {
    case 0:
      return testing::box_mesh({0.7 * a, 0.8 * a, a});
    case 1:
      return testing::extruded_mesh({{-a, -a}, {a, -a}, {a, 0.0}, {0.0, 0.0}, {0.0, a}, {-a, a}}, -0.5 * a,
                                    0.5 * a);
    default: {
      TriangleMesh ball = testing::icosphere(c.solid - 1);
      for (Vec3& v : ball.vertices) v *= a;
      return ball;
    }
  }
}

std::shared_ptr<const Part> part_of(const TriangleMesh& mesh, bool by_surface) {
  PartOptions options;
  options.pieces = by_surface ? PieceSource::kSurface : PieceSource::kSolid;
  options.about_center_of_mass = true;
  Result<Part> part = part_from_mesh(mesh, options);
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

struct Fall {
  Pose X_WB;
  int left_out = 0;  // steps that were not made
};

Fall fall(const Case& c, bool listed_first) {
  Random random(c.seed);
  const auto any = [&] { return random.uniform(-1.0, 1.0); };
  const Mat3 R = exp_rotation(3.0 * Vec3(any(), any(), any()));
  const Pose X_WB{R, {c.size_m * any(), c.size_m * any(), 2.0 * c.size_m}};
  const auto floor_part = part_of(testing::box_mesh(c.size_m * Vec3(16, 16, 1)), c.floor_by_surface);
  const auto part = part_of(solid_mesh(c), c.by_surface);
  World world;
  world.gravity_W = {0, 0, -kGravity};
  const auto add_floor = [&] {
    add_body(world, {.part = floor_part,
                     .X_WP = {Mat3::Identity(), c.size_m * Vec3(0.3, 0.2, -1.0)},
                     .joint = {.kind = JointKind::kFixed}});
  };
  if (!listed_first) add_floor();
  const int body = add_body(world, {.part = part, .X_WP = X_WB});
  if (listed_first) add_floor();
  FrameSettings settings;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.friction = {std::vector<double>(4, c.friction), 2};
  settings.impacts.restitution = {std::vector<double>(4, c.restitution), 2};
  const auto simulation = std::move(*Simulation::make(world, settings));
  Fall fall;
  const double long_s = 6.0 * std::sqrt(2.0 * c.size_m / kGravity);
  for (double t = 0.0; t < long_s; t += settings.dt_s) {
    simulation->step(Pose{});
    fall.left_out += simulation->report().cut_short;
  }
  fall.X_WB = simulation->state().world.X_WB[static_cast<std::size_t>(body)];
  return fall;
}

std::vector<Case> cases(double friction) {
  std::vector<Case> made;
  std::uint64_t seed = 0;
  for (const int solid : {0, 1, 2, 3})
    for (const double size_m : {0.002, 0.01, 0.2})
      for (const double rate_Hz : {500.0, 1000.0, 4000.0})
        for (const auto& [body, floor] :
             {std::pair(true, true), std::pair(true, false), std::pair(false, true), std::pair(false, false)})
          for (const double restitution : {0.0, 0.5})
            made.push_back({solid, size_m, rate_Hz, friction, restitution, body, floor, ++seed});
  return testing::sampled(made, 7);
}

::testing::Message words_of(const Case& c) {
  return ::testing::Message() << "solid " << c.solid << ", " << c.size_m << " m, " << c.rate_Hz << " Hz, mu "
                              << c.friction << ", e " << c.restitution << ", surfaces " << c.by_surface
                              << c.floor_by_surface << ", seed " << c.seed;
}

TEST(Order, ASolidListedBeforeTheFloorFallsAsOneListedAfterIt) {
  for (const Case& c : cases(0.0)) {
    SCOPED_TRACE(words_of(c));
    const Fall before = fall(c, true);
    const Fall after = fall(c, false);
    EXPECT_EQ(before.left_out, 0);
    EXPECT_EQ(after.left_out, 0);
    EXPECT_LT((before.X_WB.p - after.X_WB.p).norm(), 1e-3 * c.size_m);
    EXPECT_LT((before.X_WB.R - after.X_WB.R).norm(), 1e-3);
  }
}

/// With friction the answers of the solver differ in the digits that it leaves open, which tumbling makes
/// larger.
TEST(Order, NoStepIsLeftOutWithFriction) {
  for (const Case& c : cases(0.3)) {
    SCOPED_TRACE(words_of(c));
    EXPECT_EQ(fall(c, true).left_out, 0);
    EXPECT_EQ(fall(c, false).left_out, 0);
  }
}

/// A ring of pieces that is pressed against a plate: flat or tilted onto a floor, or with its rim against a
/// wall.
struct RingCase {
  int sides = 24;
  double rate_Hz = 1000.0;
  double tilt = 0.0;  // [rad] in a second
  double yaw = 0.0;   // [rad]
  bool against_wall = false;
  ResponseModel response = ResponseModel::kPenalty;
};

/// What is felt of it in every frame.
std::vector<Wrench> pressed_ring(const RingCase& c, bool listed_first) {
  const Result<std::vector<Polytope>> pieces = hole_block_pieces({.sides = c.sides,
                                                                  .peg_width_m = 0.01,
                                                                  .clearance_m = 0.0001,
                                                                  .wall_m = 0.00592,
                                                                  .hole_depth_m = 0.007});
  EXPECT_TRUE(pieces);
  std::vector<std::vector<Vec3>> corners;
  const Mat3 yaw = exp_rotation({0, 0, c.yaw});
  double farthest = 0.0;  // of the rim along x [m]
  for (const Polytope& piece : *pieces) {
    corners.emplace_back(piece.vertices.begin(), piece.vertices.end());
    for (const Vec3& corner : corners.back()) farthest = std::max(farthest, (yaw * corner).x());
  }
  const auto ring =
      std::make_shared<const Part>(std::move(*part_from_clouds(corners, {.about_center_of_mass = true})));
  const auto plate = part_of(testing::box_mesh({0.1, 0.1, 0.01}), false);
  const Vec3 p_ring(-0.05, 0.04, 1e-7);
  const Pose X_plate =
      c.against_wall ? Pose{exp_rotation({0, 0.5 * kPi, 0}), {p_ring.x() + farthest + 0.01 + 1e-7, 0, 0}}
                     : Pose{Mat3::Identity(), {0, 0, -0.01}};
  World world;
  const auto add_plate = [&] {
    add_body(world, {.part = plate, .X_WP = X_plate, .joint = {.kind = JointKind::kFixed}});
  };
  if (!listed_first) add_plate();
  const int body = add_body(world, {.part = ring, .X_WP = {yaw, p_ring}});
  if (listed_first) add_plate();
  FrameSettings settings;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.tool.body = body;
  settings.response = c.response;
  const auto simulation = std::move(*Simulation::make(world, settings));
  std::vector<Wrench> felt;
  for (double t = 0.0; t < 0.1; t += settings.dt_s) {
    const Vec3 pressed = c.against_wall ? Vec3(0.02 * t, 0, 0) : Vec3(0, 0, -0.02 * t);
    simulation->step(Pose{exp_rotation(c.tilt * t * Vec3(1.0, 0.3, 0.0)), pressed});
    felt.push_back(simulation->report().coupling);
  }
  return felt;
}

/// At a corner of the hole the ring touches with the face under it, and at the end of an edge with that edge,
/// whichever of the features and pieces there is listed first.
TEST(Order, ARingOfPiecesIsFeltAsOneListedAfterThePlate) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (const int sides : {3, 6, 16, 23, 24, 32})
      for (const double rate_Hz : testing::frame_rates_Hz())
        for (const double tilt : {0.0, 0.1})
          for (const double yaw : {0.0, kPi / sides, 0.3})
            for (const bool against_wall : {false, true}) {
              const RingCase c{sides, rate_Hz, tilt, yaw, against_wall, response};
              SCOPED_TRACE(::testing::Message()
                           << "response " << int(response) << ", " << sides << " sides, " << rate_Hz
                           << " Hz, tilt " << tilt << ", yaw " << yaw << ", wall " << against_wall);
              const std::vector<Wrench> before = pressed_ring(c, true);
              const std::vector<Wrench> after = pressed_ring(c, false);
              ASSERT_GT(before.back().f.norm(), 0.1);
              for (std::size_t i = 0; i < before.size(); ++i) {
                ASSERT_LT((before[i].f - after[i].f).norm(), 1e-6) << i;
                ASSERT_LT((before[i].t - after[i].t).norm(), 1e-7) << i;
              }
            }
}

}  // namespace
}  // namespace tactum::order_test
