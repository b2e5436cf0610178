#include "tactum/haptics/friction_cone.h"

#include <cmath>

namespace tactum {
namespace {

using Index = std::size_t;

}  // namespace

PatchKey key_of(const World& world, const ContactPatch& patch) noexcept {
  return {patch.body_a, patch.body_b,
          world.bodies[Index(patch.body_a)].part->surface_group[Index(patch.piece_a)],
          world.bodies[Index(patch.body_b)].part->surface_group[Index(patch.piece_b)]};
}

Push cone_edge(const FrictionPatch& patch, Index k) noexcept {
  Push push{patch.centre_W, patch.n_BA_W, Vec3::Zero()};
  if (k >= kConeDirections) {
    const double sense = k == kConeDirections ? 1.0 : -1.0;
    push.torque = -sense * patch.coefficient * patch.radius_m * patch.n_BA_W;
    return push;
  }
  const double angle = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(kConeDirections);
  const Vec3 across = patch.n_BA_W.cross(patch.along_W);
  push.force -= patch.coefficient * (std::cos(angle) * patch.along_W + std::sin(angle) * across);
  return push;
}

Slide slide_of(const FrictionPatch& patch, const ConstraintProblem& problem) noexcept {
  Slide slide;
  for (int i = 0; i < 3; ++i)
    slide.way[i] =
        problem.opening(patch.key.body_a, patch.key.body_b, {patch.centre_W, Vec3::Unit(i), Vec3::Zero()});
  slide.lift = patch.n_BA_W.dot(slide.way) + patch.gap_m;
  slide.way += patch.apart_W;
  slide.way -= patch.n_BA_W * patch.n_BA_W.dot(slide.way);
  slide.turn =
      problem.opening(patch.key.body_a, patch.key.body_b, {patch.centre_W, Vec3::Zero(), patch.n_BA_W});
  return slide;
}

}  // namespace tactum
