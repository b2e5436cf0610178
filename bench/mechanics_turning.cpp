#include "bench/mechanics_scene.h"
#include "tactum/math/screw.h"

namespace tactum::bench {
namespace {

/// A door without friction, after ten seconds: its rate over the last step.
MechanicsCase door() {
  constexpr double kRate = 10.0;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    const Vec3 half_m(0.4, 0.02, 0.9);
    const Vec3 w(0, 0, kRate);
    const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitZ(), .anchor_W = Vec3::Zero()};
    const Vec3 p(half_m.x(), 0, 0);
    scene.add_box(half_m, {Mat3::Identity(), p}, {w.cross(p), w}, hinge);
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 10.0 - kMechanicsStep_s);
    const Mat3 before = engine->state().X_WB[0].R;
    engine->step();
    return log_rotation(engine->state().X_WB[0].R * before.transpose()).z() / kMechanicsStep_s;
  };
  return {.name = "door after 10 s",
          .law = "keeps its 10 rad/s",
          .unit = "rad/s",
          .right = kRate,
          .bounds = {.constraint = 1e-6, .penalty = 1e-6},
          .free = seen};
}

/// A pendulum let go at 60 degrees: the mean of five periods.
MechanicsCase pendulum() {
  constexpr double kArm = 0.2;
  const Vec3 half_m(0.02, 0.02, 0.05);
  const double amplitude = kPi / 3.0;
  const auto seen = [=](MakeMotion make) {
    constexpr int kPeriods = 5;
    MechanicsScene scene;
    scene.incline(0.0);
    const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = Vec3::Zero()};
    const Mat3 R = exp_rotation({0, amplitude, 0});
    scene.add_box(half_m, {R, R * Vec3(0, 0, -kArm)}, {}, hinge);
    const auto engine = make(scene.motion, kMechanicsStep_s);
    double first = 0.0, before = amplitude;
    int crossings = 0;
    for (int i = 1; i < 20000; ++i) {
      engine->step();
      const Mat3 R_now = engine->state().X_WB[0].R;
      const double angle = std::atan2(R_now(0, 2), R_now(2, 2));
      if (before > 0.0 && angle <= 0.0) {
        const double at = (i - angle / (angle - before)) * kMechanicsStep_s;
        if (crossings == 0) first = at;
        if (crossings++ == kPeriods) return (at - first) / kPeriods;
      }
      before = angle;
    }
    return std::numeric_limits<double>::infinity();
  };
  const double radius2 = (half_m.x() * half_m.x() + half_m.z() * half_m.z()) / 3.0;  // of gyration, squared
  const double length = (kArm * kArm + radius2) / kArm;
  return {.name = "pendulum from 60°, period",
          .law = "4 sqrt(l / g) K(sin 30°)",
          .unit = "s",
          .right = 4.0 * std::sqrt(length / kGravity) * std::comp_ellint_1(std::sin(0.5 * amplitude)),
          .bounds = {.constraint = 1e-5, .penalty = 1e-5},
          .free = seen};
}

struct AfterTumbling {
  double energy = 0.0;    // as a share of before [-]
  double momentum = 0.0;  // by how much it has changed, as a share of it [-]
};

/// A box that is spun about its middle axis, after ten seconds.
AfterTumbling tumble(MakeMotion make) {
  MechanicsScene scene;
  const Twist V_WB{Vec3::Zero(), {0.3, 12.0, 0.1}};
  scene.add_box({0.01, 0.02, 0.03}, {}, V_WB);
  const Body& box = scene.motion.world.bodies[0];
  const auto engine = make(scene.motion, kMechanicsStep_s);
  run(*engine, 10.0);
  const WorldState after = engine->state();
  const Vec3 L = angular_momentum(box, {}, V_WB);
  return {kinetic_energy(box, after.X_WB[0], after.V_WB[0]) / kinetic_energy(box, {}, V_WB),
          (angular_momentum(box, after.X_WB[0], after.V_WB[0]) - L).norm() / L.norm()};
}

}  // namespace

std::vector<MechanicsCase> turning_cases() {
  return {door(),
          pendulum(),
          {.name = "box tumbles for 10 s, energy",
           .law = "1",
           .unit = "",
           .right = 1.0,
           .bounds = {.constraint = 1e-6, .penalty = 1e-6},
           .free = [](MakeMotion make) { return tumble(make).energy; }},
          {.name = "... change of its angular momentum",
           .law = "0",
           .unit = "",
           .right = 0.0,
           .bounds = {.constraint = 1e-9, .penalty = 1e-9},
           .free = [](MakeMotion make) { return tumble(make).momentum; }}};
}

}  // namespace tactum::bench
