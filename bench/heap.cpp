#include "bench/heap.h"

#include <fmt/format.h>

#include <cmath>

#include "tactum/base/random.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::bench {
namespace {

constexpr double kWidth_m = 0.005;  // of a jack's arms
constexpr double kArm_m = 0.015;
constexpr double kTip = 0.6;         // width of an arm's end, as a fraction of the arm's
constexpr double kPitch_m = 0.0375;  // between the jacks before they fall: no two can touch, however turned
constexpr double kWall_m = 0.02;
constexpr double kDensity_kg_per_m3 = 1200.0;
constexpr double kFriction = 0.3;
constexpr double kSettled = 0.4;  // the heap's height, as a fraction of the jacks' lattice before they fell

using Cloud = std::vector<Vec3>;

/// A frustum along `axis` from `from` to `to`, square, so wide at its ends.
Cloud frustum(const Vec3& axis, double from, double to, double width, double end_width) {
  const Vec3 u(axis.y(), axis.z(), axis.x());
  const Vec3 v = axis.cross(u);
  Cloud cloud;
  for (const auto& [at, wide] : {std::pair(from, width), std::pair(to, end_width)})
    for (const double s : {-0.5, 0.5})
      for (const double t : {-0.5, 0.5}) cloud.push_back(at * axis + (s * u + t * v) * wide);
  return cloud;
}

/// A box about its centre.
Result<std::shared_ptr<const Part>> box_part(const Vec3& size) {
  Result<Part> part =
      part_from_clouds({make_box(0.5 * size).vertices}, {.density_kg_per_m3 = kDensity_kg_per_m3});
  if (!part) return part.error();
  return std::make_shared<const Part>(std::move(*part));
}

/// Floor and walls around the inside of the bin, whose floor is at z = 0.
Result<void> add_bin(double width, double height, World& world) {
  const double across = width + 2.0 * kWall_m;
  const double off = 0.5 * (width + kWall_m);
  const struct {
    const char* name;
    Vec3 size, center;
  } boards[] = {
      {"floor", {across, across, kWall_m}, {0.0, 0.0, -0.5 * kWall_m}},
      {"left wall", {kWall_m, across, height}, {-off, 0.0, 0.5 * height}},
      {"right wall", {kWall_m, across, height}, {off, 0.0, 0.5 * height}},
      {"near wall", {width, kWall_m, height}, {0.0, -off, 0.5 * height}},
      {"far wall", {width, kWall_m, height}, {0.0, off, 0.5 * height}},
  };
  for (const auto& board : boards) {
    Result<std::shared_ptr<const Part>> part = box_part(board.size);
    if (!part) return part.error();
    const Result<int> added = world.add({.name = board.name,
                                         .part = std::move(*part),
                                         .X_WP = {Mat3::Identity(), board.center},
                                         .joint = {.kind = JointKind::kFixed}});
    if (!added) return added.error();
  }
  return {};
}

/// Down into the heap, a square through it, and up again. `depth` is from the start to the lowest place.
std::shared_ptr<const HandMotion> stirring(double depth, double radius, double calm_s) {
  auto motion = std::make_shared<ScriptedMotion>();
  const auto to = [&](double time, double x, double y, double z) {
    motion->move_to(time, {Mat3::Identity(), {x, y, z}});
  };
  motion->hold(calm_s);
  to(0.8, 0.0, 0.0, -depth);
  to(0.4, radius, 0.0, -depth);
  to(0.4, radius, radius, -depth);
  to(0.7, -radius, radius, -depth);
  to(0.7, -radius, -radius, -depth);
  to(0.6, 0.0, 0.0, 0.0);
  motion->hold(calm_s);
  return motion;
}

}  // namespace

Result<Part> make_jack(double width_m, double arm_m) {
  std::vector<Cloud> pieces;
  const double half = 0.5 * width_m;
  pieces.push_back(frustum(Vec3::UnitX(), -half, 0.0, width_m, width_m));
  pieces.push_back(frustum(Vec3::UnitX(), 0.0, half, width_m, width_m));
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      for (int k = 0; k < 3; ++k) {
        const double from = half + k * arm_m / 3.0;
        pieces.push_back(frustum(sign * Vec3::Unit(axis), from, from + arm_m / 3.0, width_m,
                                 k == 2 ? kTip * width_m : width_m));
      }
  return part_from_clouds(pieces, {.density_kg_per_m3 = kDensity_kg_per_m3});
}

Result<Scene> heap_scene(const HeapOptions& options) {
  Result<Part> made = make_jack(kWidth_m, kArm_m);
  if (!made) return made.error();
  const auto jack = std::make_shared<const Part>(std::move(*made));

  Scene scene;
  scene.name = "heap";
  scene.description = fmt::format("{} jacks of 20 pieces fall into a bin and are stirred", options.bodies);
  World& world = scene.world;
  world.gravity_W = {0.0, 0.0, -9.81};
  const int across = static_cast<int>(options.width_m / kPitch_m);
  const int layers = (options.bodies + across * across - 1) / (across * across);
  const double top = (layers + 1) * kPitch_m;
  const Result<int> jack_in_hand =
      world.add({.name = "held jack", .part = jack, .X_WP = {Mat3::Identity(), {0.0, 0.0, top}}});
  if (!jack_in_hand) return jack_in_hand.error();
  if (const Result<void> bin = add_bin(options.width_m, top, world); !bin) return bin.error();
  Random random(options.seed);
  for (int i = 0; i < options.bodies; ++i) {
    const auto coordinate = [&](int k) { return (k - 0.5 * (across - 1)) * kPitch_m; };
    const Vec3 p(coordinate(i % across), coordinate(i / across % across),
                 (i / (across * across) + 0.5) * kPitch_m);
    const double x = random.uniform(-1.0, 1.0);
    const double y = random.uniform(-1.0, 1.0);
    const Vec3 turn(x, y, random.uniform(-1.0, 1.0));
    const Result<int> added =
        world.add({.name = fmt::format("jack {}", i + 1), .part = jack, .X_WP = {exp_rotation(turn), p}});
    if (!added) return added.error();
  }

  const int bodies = static_cast<int>(world.bodies.size());
  FrameSettings& settings = scene.settings;
  settings.tool.body = *jack_in_hand;
  settings.workspace.X_WD.p = world.bodies[0].X_WB.p;
  settings.shading.on = false;
  settings.friction = {std::vector<double>(world.bodies.size() * world.bodies.size(), kFriction), bodies};
  settings.budget.max_contact_points = 100 * bodies;
  settings.budget.capacity = {.pairs = std::size_t(400 * bodies), .patches = std::size_t(100 * bodies)};
  scene.device = "premium-1.5-6dof";
  scene.grip = "medium";
  // So deep that the jack is covered by the heap's upper layers, and its arms stay off the floor.
  const double lowest = std::max(kSettled * layers * kPitch_m - kArm_m, kArm_m + 2.0 * kWidth_m);
  scene.hand = stirring(top - lowest, 0.3 * options.width_m, options.calm_s);
  return scene;
}

}  // namespace tactum::bench
