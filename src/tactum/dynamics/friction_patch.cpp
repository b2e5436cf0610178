#include "tactum/dynamics/friction_patch.h"

#include <cmath>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// row * x + other * y, of rows on the same bodies.
QpRow combined(double x, const QpRow& row, double y, const QpRow& other) noexcept {
  QpRow sum = row;
  for (Index r = 0; r < 2; ++r)
    for (Index i = 0; i < QpRow::kLongestRun; ++i)
      sum.runs[r].g[i] = x * row.runs[r].g[i] + y * other.runs[r].g[i];
  sum.offset = x * row.offset + y * other.offset;
  return sum;
}

}  // namespace

PatchMotion motion_of(const FrictionPatch& patch, const Vec3& along_W,
                      const ContactProblem& problem) noexcept {
  PatchMotion motion;
  const Vec3& n = patch.place.n_BA_W;
  motion.along_W = along_W;
  motion.across_W = n.cross(along_W);
  const auto row = [&](const Vec3& force, const Vec3& torque) {
    return problem.row_of(patch.surfaces.body_a, patch.surfaces.body_b,
                          {patch.place.centre_W, force, torque});
  };
  motion.off = row(n, Vec3::Zero());
  motion.along = row(motion.along_W, Vec3::Zero());
  motion.across = row(motion.across_W, Vec3::Zero());
  motion.about = row(Vec3::Zero(), n);
  return motion;
}

void turn_directions(const Vec3& along_W, PatchMotion& motion) noexcept {
  const double cosine = along_W.dot(motion.along_W);
  const double sine = along_W.dot(motion.across_W);
  const QpRow along = motion.along;
  motion.along = combined(cosine, along, sine, motion.across);
  motion.across = combined(cosine, motion.across, -sine, along);
  motion.across_W = cosine * motion.across_W - sine * motion.along_W;
  motion.along_W = along_W;
}

QpCone cone_of(const FrictionPatch& patch) noexcept {
  const PatchMotion& motion = patch.motion;
  return {.off = motion.off,
          .along = motion.along,
          .across = motion.across,
          .about = motion.about,
          .slope = patch.coefficient,
          .twist = patch.coefficient * patch.place.radius_m};
}

Push cone_edge(const FrictionPatch& patch, Index k) noexcept {
  Push push{patch.place.centre_W, patch.place.n_BA_W, Vec3::Zero()};
  if (k >= QpCone::kAround) {
    const double sense = k == QpCone::kAround ? 1.0 : -1.0;
    push.torque = -sense * patch.coefficient * patch.place.radius_m * patch.place.n_BA_W;
    return push;
  }
  const QpCone::Direction d = QpCone::direction(k);
  push.force -= patch.coefficient * (d.cosine * patch.motion.along_W + d.sine * patch.motion.across_W);
  return push;
}

Slide slide_of(const FrictionPatch& patch, const ContactProblem& problem) noexcept {
  Slide slide;
  const PatchMotion& motion = patch.motion;
  slide.displacement = problem.opening(motion.along) * motion.along_W +
                       problem.opening(motion.across) * motion.across_W + patch.anchor.apart_W;
  slide.lift = problem.opening(motion.off) + patch.place.gap_m;
  slide.turn = problem.opening(motion.about);
  return slide;
}

}  // namespace tactum::inline v0_1
