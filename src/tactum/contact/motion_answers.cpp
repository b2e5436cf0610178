/// The answers of the contact finder about motions (gap_oracle.h).

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"
#include "tactum/collision/time_of_impact.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/contact/round_contact.h"
#include "tactum/contact/seams.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A piece, and its motion.
struct MovingPiece {
  const Polytope& P;
  const Pose& X_W;
  const Twist& V_W;

  /// The greatest distance that a point of the piece moves along unit `n_W` in `dt`.
  double farthest_along(const Vec3& n_W, double dt) const noexcept {
    const Vec3 center = rotated(X_W.R, P.extent.center);
    const double turning = n_W.cross(V_W.w).norm() * P.extent.radius;
    const double curving = 0.5 * V_W.w.squaredNorm() * (center.norm() + P.extent.radius);
    return dt * (n_W.dot(velocity_at(V_W, center)) + turning + dt * curving);
  }
};

/// Steps allowed for a pair. A slow roll just over a surface would take many, and its impact is then early.
constexpr int kMostSteps = 16;

/// A body slides along another where it comes nearer by less than this fraction of the gap in a frame.
constexpr double kSlides = 0.01;

/// How long the gap that is left at a hit takes to close; 0 where there was no hit, or nothing approaches.
/// The gap is so small that the motion is a line, and where the search stops in it depends on how parts are
/// cut.
double time_to_close(const TimeOfImpact& impact, const MovingPiece& A, const MovingPiece& B) noexcept {
  if (impact.status != ImpactStatus::kHit) return 0.0;
  const Pose X_WA = advanced(A.X_W, A.V_W, impact.time);
  const Pose X_WB = advanced(B.X_W, B.V_W, impact.time);
  const Vec3 p_W = X_WA * impact.closest.p_a;
  const Vec3 n_W = rotated(X_WA.R, impact.closest.normal);
  const double closing = n_W.dot(velocity_at(B.V_W, p_W - X_WB.p) - velocity_at(A.V_W, p_W - X_WA.p));
  return closing > 0.0 ? impact.closest.distance / closing : 0.0;
}

/// Two pieces that move without turning, or turn about the centre of a ball, which changes nothing.
struct Passage {
  RoundSide a, b;
  const Pose &X_WA, &X_W_B;
  Vec3 v_a, v_b;          // [m/s]
  PairDistance at_start;  // of the facets

  struct Gap {
    double distance = 0.0, rate = 0.0;  // [m, m/s]
  };
  /// After `t` seconds; of curved surfaces. False where the facets are the contact.
  bool gap_at(double t, Gap& gap) const noexcept {
    const Pose X_AB = relative_pose({X_WA.R, X_WA.p + t * v_a}, {X_W_B.R, X_W_B.p + t * v_b});
    PairDistance found = at_start;
    StaticVector<ContactPoint, Manifold::kMostPoints> points;
    if (!meet_round(a, b, X_AB, 0.0, found, points)) return false;
    gap = {found.distance, rotated(X_WA.R, found.normal).dot(v_a - v_b)};
    return true;
  }
  /// Whether the gap stays above `gap_m`: it is a convex function of time, so its tangents are below it, and
  /// the lowest place of two of them is where it is looked at next.
  bool stays_open(double dt_s, double gap_m, int most_steps, int& steps) const noexcept {
    double from_s = 0.0;
    double to_s = dt_s;
    Gap from, to;
    steps = 2;
    if (!gap_at(from_s, from) || !gap_at(to_s, to)) return false;
    for (; from.distance > gap_m && to.distance > gap_m && steps < most_steps; ++steps) {
      if (from.rate >= 0.0 || to.rate <= 0.0) return true;
      const double t =
          (to.distance - from.distance + from.rate * from_s - to.rate * to_s) / (from.rate - to.rate);
      if (from.distance + from.rate * (t - from_s) > gap_m) return true;
      Gap between;
      if (!gap_at(t, between)) return false;
      (between.rate < 0.0 ? from : to) = between;
      (between.rate < 0.0 ? from_s : to_s) = t;
    }
    return false;
  }
};

/// Whether a body's motion is a translation for its gaps: it does not turn, or is a ball about its origin.
bool only_moves_along(const CollisionBody& body, const RoundPiece* round, const Twist& V) noexcept {
  if (V.w.isZero(0.0)) return true;
  return round != nullptr && round->kind == RoundKind::kSphere &&
         round->center.norm() < tolerances::kCertificate * body.part->size;
}

}  // namespace

double ContactFinder::depth_along(int patch, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept {
  const ContactPatch& at = patches_[Index(patch)];
  if (at.of_surfaces || tests_left_ <= 0) return 0.0;
  --tests_left_;
  const Part& part_a = *bodies_[Index(at.body_a)].part;
  const Part& part_b = *bodies_[Index(at.body_b)].part;
  const Pose& X_WA = X_WB[Index(at.body_a)];
  const Pose X_AB = relative_pose(X_WA, X_WB[Index(at.body_b)]);
  const Vec3 direction = rotated_back(X_WA.R, direction_W);
  const PairDistance exit = tactum::depth_along(part_a.pieces[Index(at.piece_a)],
                                                part_b.pieces[Index(at.piece_b)], X_AB, direction);
  if (!exit.certified()) return 0.0;
  if (is_true_contact(part_a, at.piece_a, part_b, at.piece_b, X_AB, exit)) return -exit.distance;
  const double across = at.manifold.normal.dot(direction);
  return across > 0.0 ? -at.distance / across : 0.0;
}

FirstImpact ContactFinder::first_impact(std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                                        double dt_s) noexcept {
  FirstImpact first{dt_s, true};
  for (const std::int32_t number : emitted_) {
    Pair& pair = pairs_[Index(number)];
    const PairDistance& found = pair.last.found;
    const Index a = Index(pair.body_a);
    const Index b = Index(pair.body_b);
    if (!pair.in_contact || found.distance <= 0.0 || !turns_in(dt_s, V_WB[a], V_WB[b])) continue;
    const MovingPiece A{bodies_[a].part->pieces[Index(pair.piece_a)], X_WB[a], V_WB[a]};
    const MovingPiece B{bodies_[b].part->pieces[Index(pair.piece_b)], X_WB[b], V_WB[b]};
    const double target = tolerances::kImpactGap * std::max(A.P.extent.size, B.P.extent.size);
    if (pair.last_checked == frame_) {  // else the normal is that of an earlier frame, and proves nothing
      const Vec3 n = rotated(A.X_W.R, found.normal);
      const double nearer = A.farthest_along(-n, first.time_s) + B.farthest_along(n, first.time_s);
      if (found.distance - nearer > target) continue;
    }
    if (tests_left_ <= 0) {
      first.complete = false;
      break;
    }
    const TimeOfImpact impact = time_of_impact(A.P, A.X_W, A.V_W, B.P, B.X_W, B.V_W, first.time_s, target,
                                               pair.cache, std::min(tests_left_, kMostSteps));
    tests_left_ -= impact.steps;
    if (impact.status == ImpactStatus::kMiss) continue;
    first.time_s = std::min(first.time_s, impact.time + time_to_close(impact, A, B));
  }
  return first;
}

/// Whether two pieces slide along each other, on lines or while they turn about the normal, as a body passes
/// through a gap as narrow as one likes.
bool ContactFinder::slides(const ContactPatch& at, std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                           double dt_s) noexcept {
  if (tests_left_ <= 0) return false;
  const Index a = Index(at.body_a);
  const Index b = Index(at.body_b);
  const auto path = [&](Index body) {
    const RelativeMotion motion{X_WB[body], V_WB[body] * dt_s, X_WB[body].p};
    return path_of(static_cast<int>(body), motion, motion.at(1.0));
  };
  --tests_left_;
  const Pair& pair = pairs_[Index(at.pair)];
  if (path_free(pair, path(a), path(b)) < 1.0) return false;
  const Pose X_WA = advanced(X_WB[a], V_WB[a], dt_s);
  PairCache cache = pair.cache;
  const PairDistance end =
      closest_features(bodies_[a].part->pieces[Index(at.piece_a)], bodies_[b].part->pieces[Index(at.piece_b)],
                       relative_pose(X_WA, advanced(X_WB[b], V_WB[b], dt_s)), cache);
  const Vec3 n = rotated(X_WA.R, end.normal);
  double closing = n.dot(V_WB[b].v - V_WB[a].v);
  for (const Index body : {a, b}) closing += n.cross(V_WB[body].w).norm() * radius_[body];
  return end.certified() && end.distance > 0.0 && closing * dt_s < kSlides * end.distance;
}

Passing ContactFinder::passes(int patch, std::span<const Pose> X_WB, std::span<const Twist> V_WB, double dt_s,
                              double gap_m) noexcept {
  const ContactPatch& at = patches_[Index(patch)];
  if (at.of_surfaces || tests_left_ <= 0) return Passing::kNot;
  const Index a = Index(at.body_a);
  const Index b = Index(at.body_b);
  const bool turns = !V_WB[a].w.isZero(0.0) || !V_WB[b].w.isZero(0.0);
  const RoundPiece* const round_a = bodies_[a].round(at.piece_a);
  const RoundPiece* const round_b = bodies_[b].round(at.piece_b);
  if (at.round && only_moves_along(bodies_[a], round_a, V_WB[a]) &&
      only_moves_along(bodies_[b], round_b, V_WB[b])) {
    const Passage passage{{bodies_[a].part->pieces[Index(at.piece_a)], round_a},
                          {bodies_[b].part->pieces[Index(at.piece_b)], round_b},
                          X_WB[a],
                          X_WB[b],
                          V_WB[a].v,
                          V_WB[b].v,
                          pairs_[Index(at.pair)].last.found};
    int steps = 0;
    const bool open = passage.stays_open(dt_s, gap_m, std::min(tests_left_, kMostSteps), steps);
    tests_left_ -= steps;
    return !open ? Passing::kNot : turns ? Passing::kApart : Passing::kSlides;
  }
  if (!at.round && !turns) return slides(at, X_WB, V_WB, dt_s) ? Passing::kSlides : Passing::kNot;
  const TimeOfImpact impact = time_of_impact(bodies_[a].part->pieces[Index(at.piece_a)], X_WB[a], V_WB[a],
                                             bodies_[b].part->pieces[Index(at.piece_b)], X_WB[b], V_WB[b],
                                             dt_s, gap_m + (at.round ? bulge(at.body_a, at.body_b) : 0.0),
                                             pairs_[Index(at.pair)].cache, std::min(tests_left_, kMostSteps));
  tests_left_ -= impact.steps;
  if (impact.status == ImpactStatus::kMiss) return turns ? Passing::kApart : Passing::kSlides;
  return !at.round && slides(at, X_WB, V_WB, dt_s) ? Passing::kSlides : Passing::kNot;
}

}  // namespace tactum::inline v0_1
