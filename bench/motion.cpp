#include "bench/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/base/random.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"
#include "tactum/math/screw.h"

namespace tactum::bench {
namespace {

Vec3 random_direction(Random& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double turn = random.uniform(0.0, 2.0 * kPi);
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// B beside A somewhere, apart.
Pose anywhere(const Shape& a, const Shape& b, Random& random) {
  Pose X;
  const Vec3 axis = random_direction(random);
  X.R = exp_rotation(random.uniform(0.0, kPi) * axis);
  const double radius = a.polytope.extent.radius + b.polytope.extent.radius;
  X.p = a.polytope.extent.center + 1.1 * radius * random_direction(random) - X.R * b.polytope.extent.center;
  return X;
}

/// 0.1-0.5 mm and 1-3 mrad a frame, in another direction every 100 frames.
struct HandSway {
  Vec3 step = Vec3::Zero();  ///< [m]
  Vec3 turn = Vec3::Zero();  ///< [rad]

  void move(int frame, Pose& X, Random& random) {
    constexpr int kFramesOneDirection = 100;
    if (frame % kFramesOneDirection == 0) {
      const double length_m = random.uniform(0.1e-3, 0.5e-3);
      step = length_m * random_direction(random);
      const double angle_rad = random.uniform(1e-3, 3e-3);
      turn = angle_rad * random_direction(random);
    }
    X = renormalized(advanced(X, {step, turn}, 1.0));
  }
};

/// The least n . v of the vertices.
double lowest(const Polytope& P, const Vec3& n) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& v : P.vertices) least = std::min(least, n.dot(v));
  return least;
}

/// The least width across a face.
double thickness(const Polytope& P) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : P.faces) least = std::min(least, face.offset - lowest(P, face.normal));
  return least;
}

/// The gap, and between pieces that overlap the best of a tracked and a fresh search: of small pieces, the
/// global minimum.
PairDistance gap_of(const Shape& a, const Shape& b, const Pose& X, PairCache& cache) {
  const PairDistance tracked = closest_features(a.polytope, b.polytope, X, cache);
  if (tracked.distance >= 0.0) return tracked;
  PairCache fresh;
  const PairDistance found = penetration_depth(a.polytope, b.polytope, X, fresh);
  if (found.distance <= tracked.distance) return tracked;
  cache = fresh;
  return found;
}

/// Moves B along the normal until the gap is `wanted`, to a hundredth of it. Each move makes the gap at least
/// as large as wanted (across this normal it then is), so this closes in from above.
PairDistance steer(const Shape& a, const Shape& b, double wanted_m, Pose& X, PairCache& cache) {
  constexpr int kMostMoves = 60;
  PairDistance found = gap_of(a, b, X, cache);
  for (int i = 0; i < kMostMoves && std::abs(found.distance - wanted_m) > 0.01 * std::abs(wanted_m); ++i) {
    X.p += (found.distance - wanted_m) * found.normal;  // from B to A
    found = gap_of(a, b, X, cache);
  }
  return found;
}

}  // namespace

const std::vector<Regime>& regimes() {
  static const std::vector<Regime> list = {{"near", 0.1e-3, 2e-3},
                                           {"touching", 1e-6, 10e-6},
                                           {"shallow", -0.5e-3, -0.05e-3},
                                           {"far", 20e-3, 60e-3},
                                           {"cold", 0.1e-3, 2e-3, true}};
  return list;
}

Recording record_deep(const Shape& a, const Shape& b, int frames, std::uint64_t seed) {
  constexpr double kMostPush_m = 0.5e-3;
  const double thick = std::min(thickness(a.polytope), thickness(b.polytope));
  Random random(seed);
  Recording recording;
  PairCache cache;
  Pose X = anywhere(a, b, random);
  steer(a, b, -0.2 * thick, X, cache);
  HandSway hand;
  for (int i = 0; i < frames; ++i) {
    hand.move(i, X, random);
    PairDistance found = gap_of(a, b, X, cache);
    const double off = found.distance - std::clamp(found.distance, -0.4 * thick, -0.02 * thick);
    if (off != 0.0) {
      X.p += std::clamp(off, -kMostPush_m, kMostPush_m) * found.normal;  // from B to A
      found = gap_of(a, b, X, cache);
    }
    if (found.distance > -0.01 * thick) found = steer(a, b, -0.05 * thick, X, cache);
    recording.answers.push_back(found);
    recording.poses.push_back(X);
  }
  return recording;
}

Recording record_rest(const Shape& a, const Shape& b, Rest rest, int frames, std::uint64_t seed) {
  constexpr int kFramesOneDirection = 20;
  constexpr double kShift_m = 0.03e-3, kTurn_rad = 1e-3, kMostTilt_rad = 10e-3, kMostOffset_m = 0.015;
  Random random(seed);
  Recording recording;
  PairCache cache;
  Pose X;
  X.p.z() = lowest(a.polytope, Vec3::UnitZ()) + lowest(b.polytope, -Vec3::UnitZ());
  Vec3 shift = Vec3::Zero();
  Vec3 turn = Vec3::Zero();
  for (int i = 0; i < frames; ++i) {
    if (i % kFramesOneDirection == 0) {
      const Vec3 direction = random_direction(random);
      const Vec3 axis = random_direction(random);
      const bool slides = rest == Rest::kSliding;
      shift = kShift_m * (slides ? Vec3(direction.x(), direction.y(), 0.0).normalized() : direction);
      turn = kTurn_rad * (slides ? Vec3(0.0, 0.0, axis.z() < 0.0 ? -1.0 : 1.0) : axis);
    }
    const Vec3 tilt = X.R.col(2).cross(Vec3::UnitZ());  // the turn of B back to flat
    if (tilt.norm() > kMostTilt_rad && turn.dot(tilt) < 0.0) turn = kTurn_rad * tilt.normalized();
    if (X.p.head<2>().norm() > kMostOffset_m && shift.head<2>().dot(X.p.head<2>()) > 0.0) shift = -shift;
    X = renormalized(advanced(X, {shift, turn}, 1.0));
    const double wanted_m = 30e-6 + 25e-6 * std::sin(2.0 * kPi * i / 90.0);  // [m]
    recording.answers.push_back(steer(a, b, wanted_m, X, cache));
    recording.poses.push_back(X);
  }
  return recording;
}

Recording record(const Shape& a, const Shape& b, const Regime& regime, int frames, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  PairCache cache;
  Pose X = anywhere(a, b, random);
  HandSway hand;
  const double middle = 0.5 * (regime.least_m + regime.most_m);
  const double swing = 0.48 * (regime.most_m - regime.least_m);
  for (int i = 0; i < frames; ++i) {
    double phase = 2.0 * kPi * i / 250.0;  // a gap of 2 mm comes and goes at 25 um a frame
    if (regime.cold) {
      X = anywhere(a, b, random);
      cache = {};
      phase = random.uniform(0.0, 2.0 * kPi);
    } else {
      hand.move(i, X, random);
    }
    recording.answers.push_back(steer(a, b, middle + swing * std::sin(phase), X, cache));
    recording.poses.push_back(X);
  }
  return recording;
}

}  // namespace tactum::bench
