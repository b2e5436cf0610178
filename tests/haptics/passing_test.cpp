// A body that falls past an edge, as near as one likes, is not touched by it: it keeps its line and its spin.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/sample_meshes.h"
#include "tactum/haptics/simulation.h"
#include "tactum/mesh/make_part.h"

namespace tactum::passing_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

enum class Shape { kBall, kOctahedron, kCube };

struct Passing {
  double radius_m = 0.0135;
  double gap = 4e-4;  // of the radius
  double rate_Hz = 1000.0;
  double restitution = 0.0;
  bool wall_first = true;
  Vec3 spin = Vec3::Zero();  // [rad/s]
  Shape shape = Shape::kBall;
  bool by_surface = false, wall_by_surface = false;  // felt by their surfaces, not as convex pieces
};

TriangleMesh mesh_of(const Passing& c) {
  TriangleMesh mesh;
  switch (c.shape) {
    case Shape::kBall:
      mesh = testing::icosphere(2);
      break;
    case Shape::kCube:
      mesh = testing::box_mesh({1, 1, 1});
      break;
    case Shape::kOctahedron:
      mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
      mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
      break;
  }
  for (Vec3& vertex : mesh.vertices) vertex *= c.radius_m;
  return mesh;
}

std::shared_ptr<const Part> part_of(const TriangleMesh& mesh, bool by_surface) {
  Result<Part> part =
      part_from_mesh(mesh, {.pieces = by_surface ? PieceSource::kSurface : PieceSource::kSolid});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

/// Drops a body from five radii above the edge of a wall beside it, and expects it to fall straight.
void expect_straight(const Passing& c) {
  World world;
  world.gravity_W = {0, 0, -kGravity};
  const TriangleMesh mesh = mesh_of(c);
  const auto ball = part_of(mesh, c.by_surface);
  double side_m = c.spin.isZero(0.0) ? 0.0 : c.radius_m;  // how far the ball's facets reach to the wall
  for (const Vec3& vertex : mesh.vertices) side_m = std::max(side_m, vertex.x());
  const Vec3 start(-side_m - c.gap * c.radius_m, 0, 5.0 * c.radius_m);
  const auto add_wall = [&] {
    add_body(world, {.part = part_of(testing::box_mesh(c.radius_m * Vec3(1, 8, 5)), c.wall_by_surface),
                     .X_WP = {Mat3::Identity(), c.radius_m * Vec3(1, 0, -5)},
                     .joint = {.kind = JointKind::kFixed}});
  };
  if (c.wall_first) add_wall();
  const int number = add_body(
      world,
      {.part = ball, .mass_kg = 0.08, .X_WP = {Mat3::Identity(), start}, .V_WB = {Vec3::Zero(), c.spin}});
  if (!c.wall_first) add_wall();
  FrameSettings settings;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.impacts.restitution = {std::vector<double>(4, c.restitution), 2};
  const auto simulation = std::move(*Simulation::make(world, settings));
  const WorldState& state = simulation->state().world;
  const double time_s = std::sqrt(2.0 * 12.0 * c.radius_m / kGravity);
  for (double t = 0.0; t < time_s; t += settings.dt_s) simulation->step(Pose{});
  const auto at = static_cast<std::size_t>(number);
  EXPECT_NEAR(state.X_WB[at].p.x(), start.x(), 1e-9 * c.radius_m);
  EXPECT_NEAR(state.X_WB[at].p.y(), 0.0, 1e-9 * c.radius_m);
  EXPECT_NEAR((state.V_WB[at].w - c.spin).norm(), 0.0, 1e-6);
  EXPECT_LT(state.X_WB[at].p.z(), -6.0 * c.radius_m);  // it was not held back
}

TEST(Passing, AnEdgeThatIsNotTouchedDoesNothing) {
  for (const Passing& c :
       {Passing{}, Passing{.gap = 4e-3}, Passing{.gap = 4e-5}, Passing{.wall_first = false},
        Passing{.restitution = 1.0}, Passing{.rate_Hz = 500.0}, Passing{.rate_Hz = 4000.0},
        Passing{.radius_m = 0.001}, Passing{.radius_m = 0.5}, Passing{.spin = {0, 0, 20}}}) {
    SCOPED_TRACE(::testing::Message() << c.radius_m << " m, gap " << c.gap << ", " << c.rate_Hz << " Hz, e "
                                      << c.restitution << ", spin " << c.spin.norm());
    expect_straight(c);
  }
}

TEST(Passing, AnEdgeOfASurfaceThatIsNotTouchedDoesNothing) {
  std::vector<Passing> cases;
  for (const Passing& c :
       {Passing{}, Passing{.gap = 1e-4, .restitution = 0.5, .shape = Shape::kOctahedron},
        Passing{.gap = 4e-3, .rate_Hz = 500.0, .shape = Shape::kOctahedron},
        Passing{.restitution = 0.5, .shape = Shape::kCube}, Passing{.gap = 1e-2, .shape = Shape::kCube},
        Passing{.radius_m = 0.2,
        .rate_Hz = 4000.0,
        .restitution = 1.0,
        .wall_first = false,
        .shape = Shape::kCube},
        Passing{.radius_m = 0.001, .gap = 4e-3}, Passing{.gap = 4e-3, .spin = {0, 0, 20}}}) {
    for (const auto& [body, wall] : {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
      cases.push_back(c);
      cases.back().by_surface = body;
      cases.back().wall_by_surface = wall;
    }
  }
  for (const Passing& c : testing::sampled(cases, 5)) {
    SCOPED_TRACE(::testing::Message()
                 << "shape " << static_cast<int>(c.shape) << ", " << c.radius_m << " m, gap " << c.gap << ", "
                 << c.rate_Hz << " Hz, e " << c.restitution << ", spin " << c.spin.norm() << ", surfaces "
                 << c.by_surface << c.wall_by_surface);
    expect_straight(c);
  }
}

}  // namespace
}  // namespace tactum::passing_test
