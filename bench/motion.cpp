#include "bench/motion.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/random.h"
#include "tactum/collision/closest_features.h"
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
  X.R = exp_rotation(random.uniform(0.0, kPi) * random_direction(random));
  const double reach = a.polytope.radius + b.polytope.radius;
  X.p = a.polytope.center + 1.1 * reach * random_direction(random) - X.R * b.polytope.center;
  return X;
}

/// Moves B along the normal until the gap is `wanted`, to a hundredth of it. Each move makes the gap at least
/// as large as wanted (across this normal it then is), so this closes in from above.
PairDistance steer(const Shape& a, const Shape& b, double wanted_m, Pose& X, PairCache& cache) {
  constexpr int kMostMoves = 60;
  PairDistance found = closest_features(a.polytope, b.polytope, X, cache);
  for (int i = 0; i < kMostMoves && std::abs(found.distance - wanted_m) > 0.01 * std::abs(wanted_m); ++i) {
    X.p += (found.distance - wanted_m) * found.normal;  // from B to A
    found = closest_features(a.polytope, b.polytope, X, cache);
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

Recording record(const Shape& a, const Shape& b, const Regime& regime, int frames, std::uint64_t seed) {
  constexpr int kFramesOneWay = 100;
  Random random(seed);
  Recording recording;
  PairCache cache;
  Pose X = anywhere(a, b, random);
  Vec3 step = Vec3::Zero();
  Vec3 turn = Vec3::Zero();
  const double middle = 0.5 * (regime.least_m + regime.most_m);
  const double swing = 0.48 * (regime.most_m - regime.least_m);
  for (int i = 0; i < frames; ++i) {
    double phase = 2.0 * kPi * i / 250.0;  // a gap of 2 mm comes and goes at 25 um a frame
    if (regime.cold) {
      X = anywhere(a, b, random);
      cache = {};
      phase = random.uniform(0.0, 2.0 * kPi);
    } else {
      if (i % kFramesOneWay == 0) {
        const double length = random.uniform(0.1e-3, 0.5e-3);
        step = length * random_direction(random);
        const double angle = random.uniform(1e-3, 3e-3);
        turn = angle * random_direction(random);
      }
      X = renormalized(advanced(X, {step, turn}, 1.0));
    }
    recording.answers.push_back(steer(a, b, middle + swing * std::sin(phase), X, cache));
    recording.poses.push_back(X);
  }
  return recording;
}

}  // namespace tactum::bench
