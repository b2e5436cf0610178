#pragma once
/// A world without a grasped part, frame by frame in the constraint response.

#include <gtest/gtest.h>

#include <memory>

#include "support/add_body.h"
#include "tactum/geometry/primitives.h"
#include "tactum/haptics/simulation.h"
#include "tactum/mesh/make_part.h"

namespace tactum {

inline std::shared_ptr<const Part> solid_of(const Polytope& shape) {
  Result<Part> part = part_from_clouds({shape.vertices});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

struct Sandbox {
  World world;             ///< may be changed before the first step
  FrameSettings settings;  ///< may be changed between steps
  std::unique_ptr<Simulation> simulation;
  FrameReport report;
  int penetrating_frames = 0;
  std::uint32_t flags = 0;  ///< of all frames

  /// Physics is judged awake, see sleep_test.cpp.
  Sandbox() { settings.budget.sleep = false; }

  /// Adds a body with the density of water; returns its number.
  int add(const Polytope& shape, const Pose& X_WB, const Twist& V_WB = {}, const Joint& joint = {}) {
    return add_body(world, {.part = solid_of(shape), .X_WP = X_WB, .V_WB = V_WB, .joint = joint});
  }
  int add_fixed(const Polytope& shape, const Pose& X_WB) {
    return add(shape, X_WB, {}, {.kind = JointKind::kFixed});
  }
  /// One coefficient for all pairs.
  void rub(double mu) { settings.friction = all_pairs(mu); }
  void bounce(double e) { settings.impacts.restitution = all_pairs(e); }
  PairCoefficients all_pairs(double value) const {
    return {std::vector<double>(world.bodies.size() * world.bodies.size(), value),
            static_cast<int>(world.bodies.size())};
  }

  const FrameState& begun() {
    if (!simulation) simulation = std::move(*Simulation::make(world, settings));
    return simulation->state();
  }
  void step(const DeviceSample& sample) {
    begun();
    simulation->settings() = settings;
    simulation->step(sample);
    report = simulation->report();
    penetrating_frames += report.penetrating ? 1 : 0;
    flags |= report.flags;
  }
  void step(int frames = 1) {
    DeviceSample sample;
    sample.valid = true;
    for (int i = 0; i < frames; ++i) step(sample);
  }
  void run(double seconds) { step(static_cast<int>(std::lround(seconds / settings.dt_s))); }

  const Pose& X(int body) { return begun().world.X_WB[static_cast<std::size_t>(body)]; }
  /// The velocity at the end of the last frame: the state's is that of its middle.
  Twist V(int body) {
    Twist V = begun().world.V_WB[static_cast<std::size_t>(body)];
    if (world.bodies[static_cast<std::size_t>(body)].moves()) V.v += world.gravity_W * (0.5 * settings.dt_s);
    return V;
  }
  Vec3 momentum() {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (world.bodies[i].moves()) sum += world.bodies[i].mass_kg * V(static_cast<int>(i)).v;
    return sum;
  }
  /// About the origin of the world.
  Vec3 angular_momentum() {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      if (!body.moves()) continue;
      const Pose& X_WB = X(static_cast<int>(i));
      const Twist V_WB = V(static_cast<int>(i));
      sum += X_WB.p.cross(body.mass_kg * V_WB.v) + X_WB.R * body.inertia_B * X_WB.R.transpose() * V_WB.w;
    }
    return sum;
  }
  double energy() {
    double sum = 0.0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      if (!body.moves()) continue;
      const Twist V_WB = V(static_cast<int>(i));
      const Vec3 w_B = X(static_cast<int>(i)).R.transpose() * V_WB.w;
      sum += 0.5 * body.mass_kg * V_WB.v.squaredNorm() + 0.5 * w_B.dot(body.inertia_B * w_B) -
             body.mass_kg * world.gravity_W.dot(X(static_cast<int>(i)).p);
    }
    return sum;
  }
};

}  // namespace tactum
