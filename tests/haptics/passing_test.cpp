// A body that falls past an edge, as near as one likes, is not touched by it: it keeps its line and its spin.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/simulation.h"
#include "tactum/mesh/make_part.h"

namespace tactum::passing_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Passing {
  double radius_m = 0.0135;
  double gap = 4e-4;  // of the radius
  double rate_Hz = 1000.0;
  double restitution = 0.0;
  bool wall_first = true;
  Vec3 spin = Vec3::Zero();  // [rad/s]
};

/// Drops a ball from five radii above the edge of a wall beside it, and expects it to fall straight.
void expect_straight(const Passing& c) {
  World world;
  world.gravity_W = {0, 0, -kGravity};
  const Polytope sphere = make_icosphere(2, c.radius_m);
  const auto ball = std::make_shared<const Part>(
      *part_from_clouds({std::vector<Vec3>(sphere.vertices.begin(), sphere.vertices.end())}));
  double side_m = c.spin.isZero(0.0) ? 0.0 : c.radius_m;  // how far the ball's facets reach to the wall
  for (const Vec3& vertex : ball->pieces[0].vertices) side_m = std::max(side_m, vertex.x());
  const Vec3 start(-side_m - c.gap * c.radius_m, 0, 5.0 * c.radius_m);
  const auto add_wall = [&] {
    add_body(world, {.part = solid_box(c.radius_m * Vec3(1, 8, 5)),
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

}  // namespace
}  // namespace tactum::passing_test
