// A body that is felt by its surface, or hits one, bounces as one of convex pieces: corners that it turns
// down within a frame are hit in their turn, and no impact makes energy.

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
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::surface_impact_test {
namespace {

struct Case {
  double half_m = 0.01;  // of the cube's edge
  double speed = 1.0;    // [m/s]
  double restitution = 0.5;
  double rate_Hz = 1000.0;
  double thickness_m = 0.001;  // of the plate
  Vec3 tilt{0.3, 0.4, 0.0};    // [rad]
  Vec3 spin{3.0, 2.0, 1.0};    // [rad/s]
  bool by_surface = false, plate_by_surface = false;
};

std::shared_ptr<const Part> box_part(const Vec3& half, bool by_surface) {
  Result<Part> part = part_from_mesh(testing::box_mesh(half),
                                     {.pieces = by_surface ? PieceSource::kSurface : PieceSource::kSolid});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

/// What a cube is found to do that flies against a plate, turned, so that corner after corner hits it.
struct Flight {
  double kinetic = 1.0;  // energy at the end, of that at the start
  double largest = 0.0;  // ... and the largest on the way
  Pose X_WB;
};

Flight flown(const Case& c) {
  World world;
  add_body(world, {.part = box_part({0.5 * c.thickness_m, 10 * c.half_m, 10 * c.half_m}, c.plate_by_surface),
                   .X_WP = {Mat3::Identity(), {10 * c.half_m, 0, 0}},
                   .joint = {.kind = JointKind::kFixed}});
  const int cube = add_body(world, {.part = box_part(Vec3::Constant(c.half_m), c.by_surface),
                                    .mass_kg = 0.01,
                                    .X_WP = {exp_rotation(c.tilt), Vec3::Zero()},
                                    .V_WB = {{c.speed, 0, 0}, c.spin}});
  FrameSettings settings;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.impacts.restitution = {std::vector<double>(4, c.restitution), 2};
  const auto simulation = std::move(*Simulation::make(world, settings));
  const WorldState& state = simulation->state().world;
  const auto at = static_cast<std::size_t>(cube);
  const double inertia_by_mass = 2.0 / 3.0 * c.half_m * c.half_m;  // of a cube, about any axis
  const auto energy = [&] {
    const Twist& V = state.V_WB[at];
    return 0.5 * (V.v.squaredNorm() + inertia_by_mass * V.w.squaredNorm());
  };
  const double before = energy();
  Flight flight;
  for (double t = 0.0; t < 13.0 * c.half_m / c.speed; t += settings.dt_s) {
    simulation->step(Pose{});
    flight.largest = std::max(flight.largest, energy() / before);
  }
  flight.kinetic = energy() / before;
  flight.X_WB = state.X_WB[at];
  return flight;
}

std::vector<Case> by_surfaces(const std::vector<Case>& cases) {
  std::vector<Case> made;
  for (Case c : cases)
    for (const auto& [cube, plate] :
         {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
      c.by_surface = cube;
      c.plate_by_surface = plate;
      made.push_back(c);
    }
  return testing::sampled(made, 4);
}

::testing::Message words_of(const Case& c) {
  return ::testing::Message() << c.half_m << " m, " << c.speed << " m/s, e " << c.restitution << ", "
                              << c.rate_Hz << " Hz, plate of " << c.thickness_m << " m, surfaces "
                              << c.by_surface << c.plate_by_surface;
}

TEST(SurfaceImpacts, CornerAfterCornerBouncesAsThatOfAPiece) {
  for (const Case& c : by_surfaces({{.speed = 0.1, .restitution = 0.0},
                                    {.speed = 0.3, .restitution = 1.0},
                                    {},
                                    {.restitution = 0.0},
                                    {.speed = 3.0, .rate_Hz = 4000.0},
                                    {.speed = 3.0, .restitution = 0.0, .rate_Hz = 4000.0},
                                    {.half_m = 0.1, .speed = 3.0, .restitution = 0.8},
                                    {.speed = 0.3, .restitution = 0.6, .tilt = {0.7, 0.2, 0.1}}})) {
    SCOPED_TRACE(words_of(c));
    const Flight surface = flown(c);
    Case pieces = c;
    pieces.by_surface = pieces.plate_by_surface = false;
    const Flight piece = flown(pieces);
    EXPECT_NEAR(surface.kinetic, piece.kinetic, 2e-3);
    EXPECT_NEAR((surface.X_WB.p - piece.X_WB.p).norm(), 0.0, 0.02 * c.half_m);
    if (c.restitution == 1.0) {
      EXPECT_NEAR(surface.kinetic, 1.0, 1e-9);
    }
  }
}

TEST(SurfaceImpacts, NoneMakesEnergy) {
  for (Case c : by_surfaces({{.speed = 10.0, .restitution = 1.0},
                             {.speed = 10.0, .restitution = 0.0},
                             {.speed = 40.0, .restitution = 1.0, .thickness_m = 1e-4},
                             {.restitution = 0.5, .thickness_m = 1e-4},
                             {.restitution = 0.5, .thickness_m = 3e-4},
                             {.speed = 5.0, .rate_Hz = 500.0},
                             {.half_m = 0.002, .speed = 2.0, .restitution = 0.9},
                             {.half_m = 0.2, .speed = 20.0, .restitution = 0.3}})) {
    SCOPED_TRACE(words_of(c));
    const Flight flight = flown(c);
    EXPECT_LT(flight.largest, 1.0 + 1e-9);
    EXPECT_LT(flight.X_WB.p.x(), 10 * c.half_m);  // it has not passed the plate
  }
}

}  // namespace
}  // namespace tactum::surface_impact_test
