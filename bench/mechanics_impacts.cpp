#include <algorithm>

#include "bench/mechanics_scene.h"

namespace tactum::bench {
namespace {

/// A cube falls flat and bounces: the greatest height it comes to, as a share of that of the fall.
MechanicsCase bounce(double edge_m, const std::string& name) {
  constexpr double kRestitution = 0.5, kHeight = 0.1;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(0.0);
    scene.motion.restitution = kRestitution;
    scene.add_fixed_box({0.1, 0.1, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    const Vec3 half_m = Vec3::Constant(0.5 * edge_m);
    const int cube = scene.add_box(half_m, {Mat3::Identity(), {0, 0, half_m.z() + kHeight}});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    const auto height = [&] {
      return engine->state().X_WB[static_cast<std::size_t>(cube)].p.z() - half_m.z();
    };
    const double fall_s = std::sqrt(2.0 * kHeight / kGravity);
    run(*engine, fall_s * (1.0 + 0.2 * kRestitution));
    double highest = 0.0;
    for (double t = 0.0; t < 1.8 * kRestitution * fall_s; t += kMechanicsStep_s) {
      highest = std::max(highest, height());
      engine->step();
    }
    return highest / kHeight;
  };
  return {.name = name,
          .law = "e²",
          .unit = "",
          .right = kRestitution * kRestitution,
          .bounds = {.constraint = 1e-5, .penalty = 1e-5},
          .free = seen};
}

/// The first of three cubes hits two that touch; the last one leaves with its speed.
MechanicsCase cradle() {
  constexpr double kSpeed = 0.5, kHalf = 0.01;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.motion.restitution = 1.0;
    const Vec3 half_m = Vec3::Constant(kHalf);
    scene.add_box(half_m, {Mat3::Identity(), {-0.05, 0, 0}}, {{kSpeed, 0, 0}, Vec3::Zero()});
    scene.add_box(half_m, {Mat3::Identity(), {0, 0, 0}});
    const int last = scene.add_box(half_m, {Mat3::Identity(), {2.0 * kHalf, 0, 0}});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 0.3);
    return engine->state().V_WB[static_cast<std::size_t>(last)].v.x();
  };
  return {.name = "Newton's cradle of three cubes, speed of the last",
          .law = "v",
          .unit = "m/s",
          .right = kSpeed,
          .bounds = {.constraint = 1e-6, .penalty = 1e-6},
          .free = seen};
}

struct AfterImpact {
  double energy = 0.0;                // as a share of before [-]
  double spin_a = 0.0, spin_b = 0.0;  // about z [rad/s]
};

constexpr double kBallRadius = 0.015, kBallSpeed = 0.5;

/// Two balls of facets, without friction, meet beside their centres.
AfterImpact meet(MakeMotion make) {
  MechanicsScene scene;
  scene.motion.restitution = 1.0;
  const Polytope ball = make_icosphere(2, kBallRadius);
  scene.add(ball, {Mat3::Identity(), {-0.06, 0, 0}}, {{kBallSpeed, 0, 0}, Vec3::Zero()});
  scene.add(ball, {Mat3::Identity(), {0, kBallRadius, 0}});
  const auto engine = make(scene.motion, kMechanicsStep_s);
  run(*engine, 0.3);
  const WorldState state = engine->state();
  const auto energy = [&](std::size_t i) {
    return kinetic_energy(scene.motion.world.bodies[i], state.X_WB[i], state.V_WB[i]);
  };
  const double before = 0.5 * scene.motion.world.bodies[0].mass_kg * kBallSpeed * kBallSpeed;
  return {(energy(0) + energy(1)) / before, state.V_WB[0].w.z(), state.V_WB[1].w.z()};
}

std::vector<MechanicsCase> oblique_impact() {
  return {{.name = "elastic oblique impact of two balls of 320 facets, energy",
           .law = "1",
           .unit = "",
           .right = 1.0,
           .bounds = {.constraint = 1e-6, .penalty = 1e-6},
           .free = [](MakeMotion make) { return meet(make).energy; }},
          {.name = "... difference of their spins",
           .law = "0",
           .unit = "rad/s",
           .right = 0.0,
           .bounds = {.constraint = 1e-6, .penalty = 1e-6 /* rad/s */},
           .free = [](MakeMotion make) {
             const AfterImpact after = meet(make);
             return after.spin_a - after.spin_b;
           }}};
}

}  // namespace

std::vector<MechanicsCase> impact_cases() {
  std::vector<MechanicsCase> cases = {bounce(0.02, "cube of 20 mm bounces, e = 0.5, apex"),
                                      bounce(0.001, "... of 1 mm"), cradle()};
  for (MechanicsCase& at : oblique_impact()) cases.push_back(std::move(at));
  return cases;
}

}  // namespace tactum::bench
