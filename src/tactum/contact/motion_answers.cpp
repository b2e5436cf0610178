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
#include "tactum/surface/triangle_pair.h"

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

/// The gap of two convex shapes that move without turning, at some time, and how fast it grows.
struct MovingGap {
  double distance = 0.0, rate = 0.0;  // [m, m/s]
};

/// Whether such a gap stays above `gap_m`: it is a convex function of time, so its tangents are below it, and
/// the lowest place of two of them is where it is looked at next. `gap_at(t, gap)` is false where the gap is
/// not known.
template <class GapAt>
bool stays_open(const GapAt& gap_at, double dt_s, double gap_m, int most_steps, int& steps) noexcept {
  double from_s = 0.0;
  double to_s = dt_s;
  MovingGap from, to;
  steps = 2;
  if (!gap_at(from_s, from) || !gap_at(to_s, to)) return false;
  for (; from.distance > gap_m && to.distance > gap_m && steps < most_steps; ++steps) {
    if (from.rate >= 0.0 || to.rate <= 0.0) return true;
    const double t =
        (to.distance - from.distance + from.rate * from_s - to.rate * to_s) / (from.rate - to.rate);
    if (from.distance + from.rate * (t - from_s) > gap_m) return true;
    MovingGap between;
    if (!gap_at(t, between)) return false;
    (between.rate < 0.0 ? from : to) = between;
    (between.rate < 0.0 ? from_s : to_s) = t;
  }
  return false;
}

/// Two pieces that move without turning, or turn about the centre of a ball, which changes nothing.
struct Passage {
  RoundSide a, b;
  const Pose &X_WA, &X_W_B;
  Vec3 v_a, v_b;          // [m/s]
  PairDistance at_start;  // of the facets

  /// After `t` seconds; of curved surfaces. False where the facets are the contact.
  bool operator()(double t, MovingGap& gap) const noexcept {
    const Pose X_AB = relative_pose({X_WA.R, X_WA.p + t * v_a}, {X_W_B.R, X_W_B.p + t * v_b});
    PairDistance found = at_start;
    StaticVector<ContactPoint, Manifold::kMostPoints> points;
    if (!meet_round(a, b, X_AB, 0.0, found, points)) return false;
    gap = {found.distance, rotated(X_WA.R, found.normal).dot(v_a - v_b)};
    return true;
  }
};

/// A ball that moves without turning past a triangle.
struct PassageOfBall {
  TrianglePoints triangle;
  Vec3 center, v;  // of the ball as the triangle's body sees it [m, m/s]
  double radius_m;

  /// After `t` seconds. False where the centre is in the triangle.
  bool operator()(double t, MovingGap& gap) const noexcept {
    const Vec3 p = center + t * v;
    const Vec3 apart = p - triangle_distance({p, p, p}, triangle).p_b;
    const double distance = apart.norm();
    if (!(distance > 0.0)) return false;
    gap = {distance - radius_m, apart.dot(v) / distance};
    return true;
  }
};

bool same_twist(const Twist& one, const Twist& other) noexcept {
  return one.v == other.v && one.w == other.w;
}

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

/// The path of a body that moves for `dt_s`.
ContactFinder::BodyPath ContactFinder::path_for(int body, const Pose& X_WB, const Twist& V_WB,
                                                double dt_s) const noexcept {
  const RelativeMotion motion{X_WB, V_WB * dt_s, X_WB.p};
  return path_of(body, motion, motion.at(1.0));
}

/// Whether two bodies that are at a distance along a normal after a motion come no nearer in the next frame,
/// by what they slide along each other.
bool ContactFinder::stays_beside(const ContactPatch& at, const Vec3& n_W, double distance,
                                 std::span<const Twist> V_WB, double dt_s) const noexcept {
  double closing = n_W.dot(V_WB[Index(at.body_b)].v - V_WB[Index(at.body_a)].v);
  for (const Index body : {Index(at.body_a), Index(at.body_b)})
    closing += n_W.cross(V_WB[body].w).norm() * radius_[body];
  return distance > 0.0 && closing * dt_s < kSlides * distance;
}

/// Whether two pieces slide along each other, on lines or while they turn about the normal, as a body passes
/// through a gap as narrow as one likes.
bool ContactFinder::slides(const ContactPatch& at, std::span<const Pose> X_WB, std::span<const Twist> V_WB,
                           double dt_s) noexcept {
  if (tests_left_ <= 0) return false;
  const Index a = Index(at.body_a);
  const Index b = Index(at.body_b);
  --tests_left_;
  const Pair& pair = pairs_[Index(at.pair)];
  const Pose X_WA = advanced(X_WB[a], V_WB[a], dt_s);
  PairCache cache = pair.cache;
  const PairDistance end =
      closest_features(bodies_[a].part->pieces[Index(at.piece_a)], bodies_[b].part->pieces[Index(at.piece_b)],
                       relative_pose(X_WA, advanced(X_WB[b], V_WB[b], dt_s)), cache);
  // What lands ends inside, which the one pose tells; the proof of a path takes many.
  return end.certified() && stays_beside(at, rotated(X_WA.R, end.normal), end.distance, V_WB, dt_s) &&
         path_free(pair, path_for(at.body_a, X_WB[a], V_WB[a], dt_s),
                   path_for(at.body_b, X_WB[b], V_WB[b], dt_s)) >= 1.0;
}

/// The same of two surfaces: their whole paths are proven, and what is nearest at the end stays beside. All
/// contacts of two bodies have one answer, which is found once a frame.
Passing ContactFinder::surfaces_pass(const ContactPatch& at, std::span<const Pose> X_WB,
                                     std::span<const Twist> V_WB, double dt_s, double gap_m) noexcept {
  const Index a = Index(at.body_a);
  const Index b = Index(at.body_b);
  SurfacesPassed& known = surfaces_passed_;
  if (known.frame == frame_ && known.body_a == at.body_a && known.body_b == at.body_b &&
      same_twist(known.V_a, V_WB[a]) && same_twist(known.V_b, V_WB[b]))
    return known.passing;
  known = {at.body_a, at.body_b, frame_, V_WB[a], V_WB[b], Passing::kNot};
  const BodyPath of_a = path_for(at.body_a, X_WB[a], V_WB[a], dt_s);
  const BodyPath of_b = path_for(at.body_b, X_WB[b], V_WB[b], dt_s);
  if (!stay_apart(at.body_a, at.body_b, of_a, of_b)) return known.passing;
  const MinimaQuery query{
      .max_distance = tolerance(at.body_a, at.body_b), .depth = 0.0, .cone_inflation = 0.0};
  if (surface_minima(bodies_[a].part->tree, bodies_[b].part->tree, relative_pose(of_a.to, of_b.to), query,
                     minima_)
          .full)
    return known.passing;
  const bool turns = !V_WB[a].w.isZero(0.0) || !V_WB[b].w.isZero(0.0);
  const auto nearest = std::min_element(
      minima_.begin(), minima_.end(),
      [](const SurfaceMinimum& p, const SurfaceMinimum& q) { return p.distance < q.distance; });
  if (nearest == minima_.end() || (turns && nearest->distance > gap_m))
    known.passing = turns ? Passing::kApart : Passing::kSlides;
  else if (stays_beside(at, rotated(of_a.to.R, nearest->normal), nearest->distance, V_WB, dt_s))
    known.passing = Passing::kSlides;
  return known.passing;
}

/// The same of a ball and a surface, whose triangle at the contact stands for it.
Passing ContactFinder::ball_passes(const ContactPatch& at, std::span<const Pose> X_WB,
                                   std::span<const Twist> V_WB, double dt_s, double gap_m) noexcept {
  const bool ball_is_a = !cores_[Index(at.body_a)].empty();
  const Index ball = Index(ball_is_a ? at.body_a : at.body_b);
  const Index surface = Index(ball_is_a ? at.body_b : at.body_a);
  const RoundPiece& round = bodies_[ball].rounds[0];
  if (!V_WB[surface].w.isZero(0.0) || !only_moves_along(bodies_[ball], &round, V_WB[ball]))
    return Passing::kNot;
  const Pose& X_WS = X_WB[surface];
  const SurfaceTree& tree = bodies_[surface].part->tree;
  const Triangle& corners = tree.triangle(ball_is_a ? at.piece_b : at.piece_a);
  const PassageOfBall passage{
      {tree.vertex(int(corners[0])), tree.vertex(int(corners[1])), tree.vertex(int(corners[2]))},
      X_WS.inverse() * (X_WB[ball] * round.center),
      rotated_back(X_WS.R, V_WB[ball].v - V_WB[surface].v),
      round.radius_m};
  int steps = 0;
  const bool open = stays_open(passage, dt_s, gap_m, kMostSteps, steps);
  return !open ? Passing::kNot : V_WB[ball].w.isZero(0.0) ? Passing::kSlides : Passing::kApart;
}

Passing ContactFinder::passes(int patch, std::span<const Pose> X_WB, std::span<const Twist> V_WB, double dt_s,
                              double gap_m) noexcept {
  const ContactPatch& at = patches_[Index(patch)];
  if (tests_left_ <= 0) return Passing::kNot;
  const Index a = Index(at.body_a);
  const Index b = Index(at.body_b);
  if (at.of_surfaces) {
    --tests_left_;
    if (!at.round) return surfaces_pass(at, X_WB, V_WB, dt_s, gap_m);
    const bool of_ball = cores_[a].empty() != cores_[b].empty();
    return of_ball ? ball_passes(at, X_WB, V_WB, dt_s, gap_m)
                   : surfaces_pass(at, X_WB, V_WB, dt_s, gap_m + bulge(at.body_a, at.body_b));
  }
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
    const bool open = stays_open(passage, dt_s, gap_m, std::min(tests_left_, kMostSteps), steps);
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
