#include "tactum/contact/steady_contact.h"

#include <algorithm>
#include <cmath>

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {
namespace {

/// The depth along unit `n`, at the point of `found`.
PairDistance depth_across(const PairView& pair, const PairDistance& found, const Vec3& n) noexcept {
  PairDistance result = found;
  int a = vertex_of(pair.A, found.a);
  int b = vertex_of(pair.B, found.b);
  result.normal = n;
  result.distance = pair.separation(n, a, b);
  result.a = {FeatureKind::kVertex, a};
  result.b = {FeatureKind::kVertex, b};
  result.p_b = found.p_b + n * n.dot(pair.vertex_b(b) - found.p_b);
  result.p_a = result.p_b + n * result.distance;
  return result;
}

/// The last normal, in A's frame, as the body carries it that takes it nearer to `found`: the normal of a
/// face turns with that face's body, however fast.
Vec3 carried_normal(const Vec3& found, const Pose& X_AB, const SteadyContact& last) noexcept {
  const Vec3 by_B = rotated(X_AB.R, last.normal_B);
  return last.normal_A.dot(found) >= by_B.dot(found) ? last.normal_A : by_B;
}

void remember_normal(const Vec3& n, const Pose& X_AB, SteadyContact& last) noexcept {
  last.normal_A = n;
  last.normal_B = rotated_back(X_AB.R, n);
}

/// A centroid that is farther away than it goes in this time approaches that distance with kCatchUp_s: the
/// force of a long part that comes down on one end, and then lies flat, would otherwise act at that end for
/// more than a second, and tip the part over.
constexpr double kLag_s = 0.4;
constexpr double kCatchUp_s = 0.005;

/// How far the centroid moves in a frame when it is `length` away [m].
double centroid_step(double length, const SteadyLimits& limits) noexcept {
  const double dt_s = limits.turn_rad / kNormalTurnRate;
  const double too_far = length - limits.step_m * (kLag_s / dt_s);
  return too_far > 0.0 ? limits.step_m + too_far * std::min(1.0, dt_s / kCatchUp_s) : limits.step_m;
}

}  // namespace

PairDistance steady_depth(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& found,
                          const SteadyLimits& limits, SteadyContact& last) noexcept {
  const Vec3 from = carried_normal(found.normal, X_AB, last);
  remember_normal(found.normal, X_AB, last);
  if (found.distance >= 0.0 || from.isZero() || from.dot(found.normal) >= limits.cosine) return found;
  const Vec3 toward = found.normal - from * from.dot(found.normal);
  const double sine = toward.norm();
  if (sine < tolerances::kParallelSine) return found;  // opposite: no shortest path between
  const PairView pair(A, B, X_AB);
  const Vec3 n = from * limits.cosine + toward * (limits.sine / sine);
  const PairDistance between = depth_across(pair, found, n.normalized());
  const PairDistance start = depth_across(pair, found, from);
  if (between.distance < kDeepestDetour * std::min(start.distance, found.distance)) return found;
  remember_normal(between.normal, X_AB, last);
  return between;
}

void steady_centroid(const Pose& X_AB, Manifold& patch, const SteadyLimits& limits,
                     SteadyContact& last) noexcept {
  if (patch.points.empty()) {
    last.has_centroid = false;
    return;
  }
  Vec3 centroid = Vec3::Zero();
  for (const ContactPoint& point : patch.points) centroid += 0.5 * point.weight * (point.p_a + point.p_b);
  if (last.has_centroid) {
    const Vec3 displacement = 0.5 * (last.centroid_A + X_AB * last.centroid_B) - centroid;
    const Vec3 back = displacement - patch.normal * patch.normal.dot(displacement);
    const double length = back.norm();
    const double step = centroid_step(length, limits);
    if (length > step) {
      const Vec3 shift = back * (1.0 - step / length);
      for (ContactPoint& point : patch.points) {
        point.p_a += shift;
        point.p_b += shift;
      }
      centroid += shift;
    }
  }
  last.centroid_A = centroid;
  last.centroid_B = X_AB.R.transpose() * (centroid - X_AB.p);
  last.has_centroid = true;
}

}  // namespace tactum::inline v0_1
