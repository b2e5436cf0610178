/// The answer of the contact finder about paths (GapOracle::prove_paths).

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/collision/convex_path.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/surface/surface_path.h"
#include "tactum/surface/triangle_pair.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// A pair's motion is looked at in stretches of no more than this turn where one body stands, and of no more
/// than this where both move: the pivot of the one goes on an arc as the other sees it [rad].
constexpr double kMostTurn = 1.0;
constexpr double kMostTurnOfBoth = 0.25;
/// Below this a turn is the shortest one between two poses; beyond, its full turns are counted [rad].
constexpr double kShortestTurn = 2.0;

/// The motion that takes a body from one pose to another, turning about a pivot as `turn` says.
RelativeMotion motion_of(const Pose& from, const Pose& to, const Vec3& turn, const Vec3& pivot) noexcept {
  RelativeMotion motion = motion_between(from, to, pivot);
  const double angle = turn.norm();
  if (angle < kShortestTurn) return motion;
  const Vec3 axis = turn / angle;
  const double about = turn_about(to.R * from.R.transpose(), axis);
  motion.by.w = axis * (about + 2.0 * kPi * std::round((angle - about) / (2.0 * kPi)));
  return motion;
}

/// How far a point within `radius` of `center` may go along unit `n`.
double farthest_along(const Vec3& n, const RelativeMotion& motion, const Vec3& center,
                      double radius) noexcept {
  return n.dot(motion.displacement(center)) + n.cross(motion.by.w).norm() * radius +
         0.5 * motion.curving(n, center, radius);
}

/// A triangle of a part at a pose.
TrianglePoints triangle_of(const Part& part, int triangle, const Pose& X) noexcept {
  const Triangle& corners = part.tree.triangle(triangle);
  return {X * part.tree.vertex(int(corners[0])), X * part.tree.vertex(int(corners[1])),
          X * part.tree.vertex(int(corners[2]))};
}

/// The fraction of a relative motion that is free, in stretches: `free_of` a stretch is the fraction of it.
template <class Path, class FreeOf>
double free_in_stretches(const Path& a, const Path& b, const FreeOf& free_of) noexcept {
  const bool both = a.travel > 0.0 && b.travel > 0.0;
  const double turn = a.motion.by.w.norm() + b.motion.by.w.norm();
  const int stretches = 1 + static_cast<int>(turn / (both ? kMostTurnOfBoth : kMostTurn));
  const Path& turning = b.travel > 0.0 ? b : a;
  const Vec3 pivot_T = turning.motion.X_AB.inverse() * turning.motion.pivot;  // in the body that turns
  Pose from = relative_pose(a.at(0.0), b.at(0.0));
  for (int k = 0; k < stretches; ++k) {
    const double s = (k + 1.0) / stretches;
    const Pose to = relative_pose(a.at(s), b.at(s));
    const Vec3 pivot_A = b.travel > 0.0 ? from * pivot_T : pivot_T;
    const double free = free_of(motion_between(from, to, pivot_A));
    if (free < 1.0) return (k + free) / stretches;
    from = to;
  }
  return 1.0;
}

}  // namespace

/// Of two pieces.
double ContactFinder::path_free(const Pair& pair, const BodyPath& a, const BodyPath& b) const noexcept {
  const PairDistance& found = pair.last.found;
  if (!(found.distance > 0.0)) return 1.0;
  const bool found_here = pair.last_checked == frame_ && pair.last.certified;
  if (found_here && a.travel + b.travel < found.distance) return 1.0;
  const Polytope& A = bodies_[Index(pair.body_a)].part->pieces[Index(pair.piece_a)];
  const Polytope& B = bodies_[Index(pair.body_b)].part->pieces[Index(pair.piece_b)];
  if (found_here) {
    const Pose& X_WA = a.motion.X_AB;
    const Vec3 n = rotated(X_WA.R, found.normal);
    const double nearer = farthest_along(-n, a.motion, X_WA * A.extent.center, A.extent.radius) +
                          farthest_along(n, b.motion, b.motion.X_AB * B.extent.center, B.extent.radius);
    if (nearer < found.distance) return 1.0;
  }
  return free_in_stretches(
      a, b, [&](const RelativeMotion& motion) { return convex_path_free(A, B, motion, pair.cache); });
}

/// The normals of the planes along which the part rides over steps between two bodies, as RiddenSteps has
/// them. Contacts without room here are met as others are.
StaticVector<Vec3, 4> ContactFinder::ridden_planes(int a, int b) const noexcept {
  StaticVector<Vec3, 4> normals;
  for (const ContactPatch& patch : patches_) {
    const Vec3& n = patch.manifold.normal;
    if (!patch.implied || patch.body_a != a || patch.body_b != b) continue;
    if (std::find(normals.begin(), normals.end(), n) == normals.end() && normals.size() < normals.capacity())
      normals.push_back(n);
  }
  return normals;
}

/// The height of a step that one of the two rides over: it is the one that moves, the smaller if both do.
double ContactFinder::ridden_height(int a, int b) const noexcept {
  double size = std::numeric_limits<double>::infinity();
  for (const CollisionBody* body : {&bodies_[Index(a)], &bodies_[Index(b)]})
    if (body->moves) size = std::min(size, body->part->size);
  return kRiddenStep * size;
}

/// Of two surfaces. The triangles that end it are contacts from the next frame on.
double ContactFinder::path_free(const SweepAndPrune::Pair& near, int most_tests, PathWork& work) noexcept {
  const BodyPath& a = paths_[Index(near.a)];
  const BodyPath& b = paths_[Index(near.b)];
  const double travel = a.travel + b.travel;
  if (overlap(near.a, near.b) > 0.0) return 1.0;
  BodyPair& list = list_of(near);
  if (trusted_[Index(near.a)] && trusted_[Index(near.b)] &&
      std::max(list.free_until - accumulated_motion(near.a, near.b), list.nearest) > travel)
    return 1.0;
  double free = 1.0;
  bool complete = frame_ >= list.unproven_until;
  if (complete) {
    const StaticVector<Vec3, 4> planes = ridden_planes(near.a, near.b);
    const RiddenSteps ridden{{planes.begin(), planes.end()}, ridden_height(near.a, near.b)};
    free = free_in_stretches(a, b, [&](const RelativeMotion& motion) {
      const SurfacePath path =
          surface_path(bodies_[Index(near.a)].part->tree, bodies_[Index(near.b)].part->tree, motion,
                       most_tests - work.tests, ridden);
      if (path.triangle_a >= 0) remember({near.a, near.b, path.triangle_a, path.triangle_b});
      work.tests += path.tests;
      complete &= path.complete;
      return path.free;
    });
    if (!complete) list.unproven_until = frame_ + unproven_frames_;
  }
  if (!complete) ++work.unproven;
  return free;
}

/// Whether two surfaces stay apart on their paths, as far as a few tests prove it.
bool ContactFinder::stay_apart(int a, int b, const BodyPath& of_a, const BodyPath& of_b) const noexcept {
  constexpr int kMostTests = 512;
  int tests = 0;
  bool complete = true;
  const double free = free_in_stretches(of_a, of_b, [&](const RelativeMotion& motion) {
    const SurfacePath path =
        surface_path(bodies_[Index(a)].part->tree, bodies_[Index(b)].part->tree, motion, kMostTests - tests);
    tests += path.tests;
    complete &= path.complete;
    return path.free;
  });
  return complete && free == 1.0;
}

ContactFinder::BodyPath ContactFinder::path_of(int body, const RelativeMotion& motion,
                                               const Pose& to) const noexcept {
  const double arm = radius_[Index(body)] + (motion.X_AB.p - motion.pivot).norm();
  return {motion, to, motion.by.v.norm() + motion.by.w.norm() * arm};
}

void ContactFinder::remember(const MetTriangles& met) noexcept {
  const auto same = [&](const MetTriangles& other) {
    return met.body_a == other.body_a && met.body_b == other.body_b && met.triangle_a == other.triangle_a &&
           met.triangle_b == other.triangle_b;
  };
  if (std::any_of(met_.begin(), met_.end(), same)) return;
  if (met_.size() == met_.capacity()) met_.erase(met_.begin(), met_.begin() + 1);
  met_.push_back(met);
}

/// Makes contacts of the remembered triangles of two bodies; those that are no longer near are forgotten.
void ContactFinder::add_met_triangles(int a, int b, const Pose& X_AB, double margin) noexcept {
  Index kept = 0;
  for (Index i = 0; i < met_.size(); ++i) {
    const MetTriangles met = met_[i];
    met_[kept] = met;
    if (met.body_a != a || met.body_b != b) {
      ++kept;
      continue;
    }
    const PointPair nearest = triangle_distance(triangle_of(*bodies_[Index(a)].part, met.triangle_a, Pose()),
                                                triangle_of(*bodies_[Index(b)].part, met.triangle_b, X_AB));
    const double distance = std::sqrt(nearest.distance_sq);
    if (!(distance > 0.0) || distance > margin) continue;
    ++kept;
    const SurfaceMinimum contact{.distance = distance,
                                 .p_a = nearest.p_a,
                                 .p_b = nearest.p_b,
                                 .normal = (nearest.p_a - nearest.p_b) / distance,
                                 .a = {FeatureKind::kEdge, 3 * met.triangle_a},
                                 .b = {FeatureKind::kEdge, 3 * met.triangle_b},
                                 .triangle_a = met.triangle_a,
                                 .triangle_b = met.triangle_b};
    if (ContactPatch* const patch = add_surface_patch(a, b, contact, true, margin)) patch->met = true;
  }
  met_.resize(kept);
}

/// The gap of such a contact with B elsewhere: the distance of the triangles; where they cross, that along
/// the contact's normal, carried by the one body or by the other, whichever is the less negative. Carried by
/// one alone, a small turn would take the far corners of the other's triangle a long way beyond the plane.
double ContactFinder::distance_of_met(const ContactPatch& patch, const Pose& X_AB) const noexcept {
  const Index body_a = Index(patch.body_a);
  const Index body_b = Index(patch.body_b);
  const TrianglePoints a = triangle_of(*bodies_[body_a].part, patch.piece_a, Pose());
  const TrianglePoints b = triangle_of(*bodies_[body_b].part, patch.piece_b, X_AB);
  if (!triangles_cross(a, b)) return std::sqrt(triangle_distance(a, b).distance_sq);
  const auto gap = [&](const Vec3& n) {
    return std::min({n.dot(a[0]), n.dot(a[1]), n.dot(a[2])}) -
           std::max({n.dot(b[0]), n.dot(b[1]), n.dot(b[2])});
  };
  const Vec3& by_a = patch.manifold.normal;
  const Mat3 R_AB_start = relative_pose(last_X_WB_[body_a], last_X_WB_[body_b]).R;
  return std::max(gap(by_a), gap(rotated(X_AB.R, rotated_back(R_AB_start, by_a))));
}

PathWork ContactFinder::prove_paths(std::span<const Pose> X_WB, std::span<const BodyTurn> turn,
                                    std::span<const char> asked, int most_tests,
                                    std::span<double> free) noexcept {
  PathWork work;
  std::fill(free.begin(), free.end(), 1.0);
  for (Index i = 0; i < bodies_.size(); ++i) {
    const Pose& from = last_X_WB_[i];
    paths_[i] = bodies_[i].moves
                    ? path_of(int(i), motion_of(from, X_WB[i], turn[i].turn, turn[i].pivot_W), X_WB[i])
                    : BodyPath{{from, {}, from.p}, from, 0.0};
  }
  const auto moves = [&](int a, int b) {
    return (asked[Index(a)] && paths_[Index(a)].travel > 0.0) ||
           (asked[Index(b)] && paths_[Index(b)].travel > 0.0);
  };
  const auto keep = [&](int a, int b, double of_pair) {
    free[Index(a)] = std::min(free[Index(a)], of_pair);
    free[Index(b)] = std::min(free[Index(b)], of_pair);
  };
  for (const std::int32_t number : emitted_) {
    const Pair& pair = pairs_[Index(number)];
    if (!pair.implied && moves(pair.body_a, pair.body_b) && !over_areas(pair.body_a, pair.body_b))
      keep(pair.body_a, pair.body_b, path_free(pair, paths_[Index(pair.body_a)], paths_[Index(pair.body_b)]));
  }
  for (const SweepAndPrune::Pair& near : sweep_.pairs())
    if (may_touch(near) && meet_by_surfaces(near.a, near.b) && moves(near.a, near.b) &&
        !over_areas(near.a, near.b))
      keep(near.a, near.b, path_free(near, most_tests, work));
  return work;
}

}  // namespace tactum::inline v0_1
