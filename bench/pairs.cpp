/// What the queries of one pair of convex pieces cost: closest features tracked and cold, overlapping pairs,
/// contact patches, times of impact. Every number is the least of five identical replays of a pose; the
/// clock's own cost (about 25 ns) is in it.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "tactum/base/random.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/manifold.h"
#include "tactum/collision/penetration.h"
#include "tactum/collision/time_of_impact.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

constexpr int kReplays = 5;
constexpr double kFrame = 1e-3;  // [s]

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// A hand's motion: up to 0.1 m/s and 2 rad/s, another way every 100 frames, kept between two distances from
/// A.
std::vector<Pose> motion(int frames, double nearest, double farthest) {
  Random random(5);
  std::vector<Pose> poses;
  Pose X{Mat3::Identity(), {0.0, 0.0, 0.5 * (nearest + farthest)}};
  Twist V;
  for (int i = 0; i < frames; ++i) {
    if (i % 100 == 0) {
      V.v = random_vector(random, 0.1);
      V.w = random_vector(random, 2.0);
    }
    X = advanced(X, V, kFrame);
    const double distance = X.p.norm();
    X.p *= std::clamp(distance, nearest, farthest) / distance;
    poses.push_back(X);
  }
  return poses;
}

/// Times query(i) for every i, after reset(), `kReplays` times over.
void measure(const std::string& what, std::size_t count, const std::function<void()>& reset,
             const std::function<void(std::size_t)>& query) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> ns(count, 1e12);
  for (int replay = 0; replay < kReplays; ++replay) {
    reset();
    for (std::size_t i = 0; i < count; ++i) {
      const auto start = Clock::now();
      query(i);
      const auto end = Clock::now();
      ns[i] = std::min(ns[i], std::chrono::duration<double, std::nano>(end - start).count());
    }
  }
  std::sort(ns.begin(), ns.end());
  fmt::print("{:<52} {:>8.0f} {:>8.0f} {:>8.0f} {:>8.0f}\n", what, ns[count / 2], ns[count * 99 / 100],
             ns[count * 999 / 1000], ns.back());
}

void closest(const std::string& name, const Polytope& A, const Polytope& B) {
  const double reach = A.radius + B.radius;
  const auto apart = motion(20000, 1.02 * reach, 1.5 * reach);
  const auto inside = motion(20000, 0.3 * reach, 0.5 * reach);
  PairCache cache;
  const auto reset = [&] { cache = {}; };
  measure(name + ", apart, tracked", apart.size(), reset,
          [&](std::size_t i) { closest_features(A, B, apart[i], cache); });
  measure(name + ", apart, cold", 4000, reset, [&](std::size_t i) {
    cache = {};
    closest_features(A, B, apart[i], cache);
  });
  measure(name + ", overlapping, tracked", inside.size(), reset,
          [&](std::size_t i) { closest_features(A, B, inside[i], cache); });
  measure(name + ", overlapping, penetration alone, tracked", inside.size(), reset,
          [&](std::size_t i) { penetration_depth(A, B, inside[i], cache); });
  measure(name + ", overlapping, cold", 1000, reset, [&](std::size_t i) {
    cache = {};
    closest_features(A, B, inside[i], cache);
  });
}

void patches(const std::string& name, const Polytope& A, const Polytope& B, double height) {
  Random random(6);
  std::vector<Pose> poses;
  std::vector<PairDistance> answers;
  for (int i = 0; i < 4000; ++i) {
    const Mat3 R =
        exp_rotation(random_vector(random, 1e-3)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3)));
    poses.push_back({R, {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), -height - 2e-5}});
    PairCache cache;
    answers.push_back(closest_features(A, B, poses.back(), cache));
  }
  Manifold patch;
  measure(
      name + ", contact patch face on face", poses.size(), [] {},
      [&](std::size_t i) { contact_manifold(A, B, poses[i], answers[i], 1e-4, patch); });
}

void impacts(const std::string& name, const Polytope& A, const Polytope& B) {
  const double reach = A.radius + B.radius;
  const auto poses = motion(4000, 0.8 * reach, 1.1 * reach);
  PairCache cache;
  measure(
      name + ", time of impact over a frame", poses.size(), [&] { cache = {}; },
      [&](std::size_t i) {
        time_of_impact(A, {}, {}, B, poses[i], {-0.5 * poses[i].p.normalized(), {2.0, 1.0, 0.0}}, kFrame,
                       1e-5, cache);
      });
}

}  // namespace
}  // namespace tactum

int main() {
  using namespace tactum;
  fmt::print("{:<52} {:>8} {:>8} {:>8} {:>8}\n", "[ns]", "median", "p99", "p99.9", "max");
  const Polytope box = make_box({0.02, 0.025, 0.03});
  closest("boxes", box, box);
  for (int level : {2, 3, 4}) {
    const Polytope sphere = make_icosphere(level, 0.025);
    closest(fmt::format("spheres of {}", sphere.vertices.size()), sphere, sphere);
  }
  patches("boxes", box, box, 0.06);
  const Polytope prism = make_prism(64, 0.02, 0.03);
  patches("64-gons", prism, prism, 0.03);
  impacts("boxes", box, box);
  impacts("spheres of 642", make_icosphere(3, 0.025), make_icosphere(3, 0.025));
  return 0;
}
