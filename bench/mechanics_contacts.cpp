#include "bench/mechanics_scene.h"
#include "tactum/geometry/hull.h"
#include "tactum/math/screw.h"

namespace tactum::bench {
namespace {

double x_of(const MotionEngine& engine, int body) {
  return engine.state().X_WB[static_cast<std::size_t>(body)].p.x();
}

/// A block slides to rest over a floor of so many boxes side by side.
MechanicsCase slide(int tiles) {
  constexpr double kSpeed = 1.5, kFriction = 0.2, kLength = 0.96, kHalf = 0.01;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(0.0);
    scene.motion.friction = kFriction;
    const Vec3 half_m(0.5 * kLength / tiles, 0.1, 0.02);
    for (int i = 0; i < tiles; ++i)
      scene.add_fixed_box(half_m, {Mat3::Identity(), {(2 * i + 1) * half_m.x() - 0.1, 0, -0.02}});
    const int block = scene.add_box(Vec3::Constant(kHalf), {Mat3::Identity(), {0, 0, kHalf}},
                                    {{kSpeed, 0, 0}, Vec3::Zero()});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 1.2);
    return x_of(*engine, block);
  };
  return {.name = tiles == 1 ? "block slides to rest" : "... over " + std::to_string(tiles) + " tiles",
          .law = "v² / (2 µ g)",
          .unit = "m",
          .right = kSpeed * kSpeed / (2.0 * kFriction * kGravity),
          .bounds = {.constraint = 1e-5, .penalty = 1e-5},
          .free = seen};
}

/// A block on an incline whose slope is `share` times that at which it begins to slide, after a second.
MechanicsCase incline(double share) {
  constexpr double kFriction = 0.3, kHalf = 0.01;
  const double slope = std::atan(share * kFriction);
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(slope);
    scene.motion.friction = kFriction;
    scene.add_fixed_box({0.5, 0.1, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    const int block = scene.add_box(Vec3::Constant(kHalf), {Mat3::Identity(), {0, 0, kHalf}});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 1.0);
    return x_of(*engine, block);
  };
  const bool slides = share > 1.0;
  const double right = 0.5 * kGravity * (std::sin(slope) - kFriction * std::cos(slope));
  return {.name = slides ? "block on an incline, tan a = 1.02 µ" : "block on an incline, tan a = 0.99 µ",
          .law = slides ? "g (sin a - µ cos a) t² / 2" : "stays",
          .unit = "m",
          .right = slides ? right : 0.0,
          .bounds = {.constraint = slides ? 1e-4 : 1e-9, .penalty = slides ? 1e-4 : 1e-9 /* m */},
          .free = seen};
}

/// Ten cubes on each other: how high the top one is after two seconds, or what the floor carries.
MechanicsCase stack(bool load) {
  constexpr double kHalf = 0.02;
  constexpr int kCubes = 10;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(0.0);
    scene.motion.friction = 0.5;
    const int floor = scene.add_fixed_box({0.2, 0.2, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    for (int i = 0; i < kCubes; ++i)
      scene.add_box(Vec3::Constant(kHalf), {Mat3::Identity(), {0, 0, (2 * i + 1) * kHalf}});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 2.0);
    return load ? mean_load_N(*engine, floor) : engine->state().X_WB.back().p.z() + kHalf;
  };
  const double edge = 2.0 * kHalf;
  return {.name = load ? "... load on the floor" : "stack of ten cubes, height after 2 s",
          .law = load ? "10 m g" : "10 a",
          .unit = load ? "N" : "m",
          .right = load ? kCubes * 1000.0 * edge * edge * edge * kGravity : kCubes * edge,
          .bounds = {.constraint = 1e-5, .penalty = 1e-5},
          .free = seen};
}

/// A block beyond its balance tips over its edge, which friction holds.
MechanicsCase tip() {
  constexpr double kFrom = 0.01, kTo = 0.05;  // beyond the balance [rad]
  const Vec3 half_m(0.02, 0.02, 0.06);
  const double arm = std::hypot(half_m.x(), half_m.z());
  const double balance = std::atan2(half_m.x(), half_m.z());
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(0.0);
    scene.motion.friction = 1.0;
    scene.add_fixed_box({0.3, 0.3, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    const double lean = balance + kFrom;
    const Vec3 edge(half_m.x(), 0, -half_m.z());
    const Mat3 R = exp_rotation({0, lean, 0});
    const int block = scene.add_box(half_m, {R, -(R * edge)});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    double before = kFrom;
    for (int i = 1; i < 3000; ++i) {
      engine->step();
      const Mat3 R_now = engine->state().X_WB[static_cast<std::size_t>(block)].R;
      const double beyond = std::atan2(R_now(0, 2), R_now(2, 2)) - balance;
      if (beyond >= kTo) return (i - (beyond - kTo) / (beyond - before)) * kMechanicsStep_s;
      before = beyond;
    }
    return std::numeric_limits<double>::infinity();
  };
  // About the edge: 4/3 of m arm^2.
  return {.name = "block tips over its edge, from 0.01 to 0.05 rad",
          .law = "t: cosh(t sqrt(3 g / (4 r))) = 5",
          .unit = "s",
          .right = std::acosh(kTo / kFrom) / std::sqrt(0.75 * kGravity / arm),
          .bounds = {.constraint = 1e-3, .penalty = 1e-3},
          .free = seen};
}

/// A ball of 320 facets rolls down an incline; other engines have a true ball.
MechanicsCase roll() {
  constexpr double kRadius = 0.02, kSlope = 0.1;
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(kSlope);
    scene.motion.friction = 0.5;
    scene.add_fixed_box({1.0, 0.1, 0.02}, {Mat3::Identity(), {0, 0, -0.02}});
    const int ball =
        scene.add(make_icosphere(2, kRadius), {Mat3::Identity(), {0, 0, kRadius}}, {}, {}, kRadius);
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 1.0);
    return x_of(*engine, ball);
  };
  return {.name = "ball rolls down an incline",
          .law = "5/7 g sin a t² / 2",
          .unit = "m",
          .right = 0.5 * 5.0 / 7.0 * kGravity * std::sin(kSlope),
          .bounds = {.constraint = 0.01, .penalty = 0.01},
          .free = seen};
}

/// A wedge rests between two sides without friction.
MechanicsCase wedge() {
  constexpr double kHalfAngle = 0.35, kHeight = 0.06, kHalfWidth = 0.02;
  const double half_top = kHeight * std::tan(kHalfAngle);
  const auto seen = [=](MakeMotion make) {
    MechanicsScene scene;
    scene.incline(0.0);
    // Its point at the origin; each side's face leads through it.
    std::vector<int> sides;
    for (const double sign : {-1.0, 1.0}) {
      const Mat3 R = exp_rotation({0, sign * kHalfAngle, 0});
      sides.push_back(scene.add_fixed_box({0.02, 0.05, 0.1}, {R, R * Vec3(sign * 0.02, 0, 0.04)}));
    }
    std::vector<Vec3> corners;
    for (const double y : {-kHalfWidth, kHalfWidth})
      for (const double x : {-half_top, 0.0, half_top})
        corners.emplace_back(x, y, (x == 0.0 ? -2.0 : 1.0) * kHeight / 3.0);
    scene.add(*convex_hull(corners), {Mat3::Identity(), {0, 0, 2.0 * kHeight / 3.0}});
    const auto engine = make(scene.motion, kMechanicsStep_s);
    run(*engine, 1.0);
    return mean_load_N(*engine, sides[0]);
  };
  const double mass = 1000.0 * half_top * kHeight * 2.0 * kHalfWidth;
  return {.name = "wedge between two sides, load on one",
          .law = "m g / (2 sin a)",
          .unit = "N",
          .right = mass * kGravity / (2.0 * std::sin(kHalfAngle)),
          .bounds = {.constraint = 1e-5, .penalty = 1e-5},
          .free = seen};
}

}  // namespace

std::vector<MechanicsCase> contact_cases() {
  return {slide(1), slide(24),    incline(0.99), incline(1.02), tip(),
          roll(),   stack(false), stack(true),   wedge()};
}

}  // namespace tactum::bench
