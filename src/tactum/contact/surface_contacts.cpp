/// The half of the contact finder (contact_finder.h) for bodies that are tested by their surfaces.

#include <algorithm>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/contact/revolved_contact.h"
#include "tactum/surface/surface_path.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// How deep surfaces may cross in the penalty response and still be told apart, as a fraction of the smaller
/// part's size. Walls thinner than that may be pushed through; the constraint response lets nothing cross.
constexpr double kSurfaceDepth = 0.02;

/// Surfaces that are in each other when they become near are pushed apart up to this depth, in the same way.
constexpr double kOverlapDepth = 0.1;

/// In so many tests of a path it is found whether two surfaces that become near have crossed.
constexpr int kMostOverlapTests = 1 << 14;

/// At the end of a step only gaps below this fraction of the tolerance are searched: the others are open. It
/// must not be below half the skin, which a gap may have to keep (constraint_trial.cpp): a tolerance is four
/// skins at least (kBoundMargin in constraint.cpp), so it is 0.6 skins at least.
constexpr double kWatched = 0.15;

/// A ball meets a surface where the surface is nearest to its centre, which a tetrahedron of this size stands
/// for, as a fraction of the radius; the cones are inflated by as much, for normals on the border of two.
constexpr double kCoreSize = 1e3 * tolerances::kSameNormal;

/// For surfaces that were apart the first query is how far, up to so many tolerances: until they moved that
/// far they need no other query.
constexpr double kFarther = 8.0;

/// Where the path of a step of the grasped part cannot be proven, poses on it are tested for crossings
/// (constraint.cpp). So only minima nearer than this fraction of the larger part's size are contacts, if
/// there are some: on a thread, where all flanks face each other, several times as many are within the length
/// of a fast step.
constexpr double kUnprovenMargin = 1e-3;

/// The cones of surfaces are inflated by the turn of free bodies in a frame, up to the most that a query
/// takes [rad].
constexpr double kMostInflation = 0.1;

/// Whether two minima are on one face of B, or on one edge or corner of it.
bool same_on_b(const SurfaceMinimum& one, const SurfaceMinimum& other, const SurfaceTree& b) noexcept {
  if (one.b.kind != other.b.kind) return false;
  if (one.b.kind != FeatureKind::kFace) return one.b.index == other.b.index;
  return b.group_of(one.b.index) == b.group_of(other.b.index);
}

}  // namespace

SurfaceTree ContactFinder::core_of(const CollisionBody& body) {
  if (body.rounds.size() != 1 || body.rounds[0].kind != RoundKind::kSphere) return {};
  TriangleMesh mesh;
  for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
    mesh.vertices.emplace_back(body.rounds[0].center + kCoreSize * body.rounds[0].radius_m * corner);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return SurfaceTree(mesh);
}

/// The contacts of a ball with a surface, each with its exact gap. False where neither body is a ball.
bool ContactFinder::test_ball(int a, int b, const Pose& X_AB, double margin) noexcept {
  const bool ball_is_a = !cores_[Index(a)].empty();
  const bool ball_is_b = !cores_[Index(b)].empty();
  if (!ball_is_a && !ball_is_b) return false;
  if (ball_is_a && ball_is_b) {
    test_balls(a, b, X_AB, margin);
    return true;
  }
  const int ball = ball_is_a ? a : b;
  const SurfaceTree& surface = bodies_[Index(ball_is_a ? b : a)].part->tree;
  const RoundPiece& round = bodies_[Index(ball)].rounds[0];
  const Pose X = ball_is_a ? X_AB : X_AB.inverse();  // of the surface, in the ball
  const MinimaQuery query{.max_distance = round.radius_m + margin, .depth = 0.0, .cone_inflation = kCoreSize};
  const MinimaWork found = surface_minima(cores_[Index(ball)], surface, X, query, minima_);
  work_.minima += found.minima;
  work_.feature_steps += found.feature_pairs;
  if (found.full) drop(a, b);
  const auto known = [&](Index i) {
    return std::any_of(minima_.begin(), minima_.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const SurfaceMinimum& m) { return same_on_b(m, minima_[i], surface); });
  };
  for (Index i = 0; i < minima_.size(); ++i) {
    SurfaceMinimum m = minima_[i];
    if (known(i)) continue;
    const Vec3 apart = round.center - m.p_b;
    if (m.b.kind != FeatureKind::kFace) m.normal = apart.normalized();
    m.distance = m.normal.dot(apart) - round.radius_m;
    m.p_a = round.center - round.radius_m * m.normal;
    m.p_b = m.p_a - m.distance * m.normal;
    m.a = {FeatureKind::kVertex, 0};
    m.triangle_a = 0;
    if (!(m.distance < margin)) continue;
    if (!ball_is_a) {
      m = {.distance = m.distance,
           .p_a = X_AB * m.p_b,
           .p_b = X_AB * m.p_a,
           .normal = rotated(X_AB.R, -m.normal),
           .a = m.b,
           .b = m.a,
           .triangle_a = m.triangle_b,
           .triangle_b = m.triangle_a};
    }
    m.round = true;
    if (add_surface_patch(a, b, m, false, margin) == nullptr) break;
  }
  return true;
}

/// The contact of two balls, on the line of their centres.
void ContactFinder::test_balls(int a, int b, const Pose& X_AB, double margin) noexcept {
  const RoundPiece& ball_a = bodies_[Index(a)].rounds[0];
  const RoundPiece& ball_b = bodies_[Index(b)].rounds[0];
  const Vec3 center_b = X_AB * ball_b.center;
  const Vec3 apart = ball_a.center - center_b;
  const double between = apart.norm();
  minima_.clear();
  if (!(between > 0.0) || between - ball_a.radius_m - ball_b.radius_m >= margin) return;
  SurfaceMinimum& m = minima_.emplace_back();
  m.normal = apart / between;
  m.distance = between - ball_a.radius_m - ball_b.radius_m;
  m.p_a = ball_a.center - ball_a.radius_m * m.normal;
  m.p_b = center_b + ball_b.radius_m * m.normal;
  m.a = m.b = {FeatureKind::kVertex, 0};
  m.triangle_a = m.triangle_b = 0;
  m.round = true;
  ++work_.minima;
  add_surface_patch(a, b, m, false, margin);
}

/// Makes the minima of turned parts those of their circles, each once, and leaves out what is not nearer than
/// the margin.
void ContactFinder::take_revolved(int a, int b, const Pose& X_AB, double margin) noexcept {
  const auto side = [&](int body) {
    const CollisionBody& of = bodies_[Index(body)];
    return RevolvedSide{of.part->tree, of.revolution.circles.empty() ? nullptr : &of.revolution};
  };
  const RevolvedSide side_a = side(a);
  const RevolvedSide side_b = side(b);
  if (side_a.revolution == nullptr && side_b.revolution == nullptr) return;
  const double same = tolerances::kCoplanarMeshOffset * std::max(side_a.tree.size(), side_b.tree.size());
  Index kept = 0;
  for (const SurfaceMinimum& found : minima_) {
    SurfaceMinimum m = found;
    const bool round = meet_revolved(side_a, side_b, X_AB, margin, m);
    const auto known = [&](const SurfaceMinimum& other) {
      return other.round && (other.p_a - m.p_a).norm() < same && (other.p_b - m.p_b).norm() < same;
    };
    const auto end = minima_.begin() + static_cast<std::ptrdiff_t>(kept);
    if (!(m.distance < margin) || (round && std::any_of(minima_.begin(), end, known))) continue;
    minima_[kept++] = m;
  }
  minima_.resize(kept);
}

/// Leaves the minima that carry a contact as all of them do, at the front; returns how many.
std::size_t ContactFinder::reduce_minima(int a, int b, double margin) noexcept {
  Index kept = minima_.size();
  if (kept > kept_minima_) {
    reduction_scratch_.resize(kept);  // within what was reserved
    Vec3 center = Vec3::Zero();
    for (const SurfaceMinimum& minimum : minima_) center += minimum.p_a / double(minima_.size());
    const double radius = radius_[Index(a)] + radius_[Index(b)];
    const ReductionReport reduced =
        reduce_contacts(minima_, reduction_scratch_, kept_minima_,
                        {.center = center, .max_translation = margin, .max_rotation = margin / radius});
    kept = Index(reduced.kept);
    work_.dropped_minima += reduced.dropped;
    work_.dropped_error = std::max(work_.dropped_error, reduced.largest_error);
  }
  return kept;
}

void ContactFinder::test_surfaces(const SweepAndPrune::Pair& near, std::span<const Pose> X_WB) noexcept {
  const int a = near.a;
  const int b = near.b;
  if (!bodies_[Index(a)].moves && !bodies_[Index(b)].moves) return;
  double margin = tolerance(a, b);
  const double of_facets = facet_tolerance(a, b);
  BodyPair& list = list_of(near);
  list.nearest = 0.0;  // until this frame has found it
  if (list.free_until - accumulated_motion(a, b) > of_facets) return;
  if (tests_left_ <= 0) return skip(a, b, list.free_until - accumulated_motion(a, b), frame_);
  --tests_left_;
  ++work_.exact_tests;
  const Part& part_a = *bodies_[Index(a)].part;
  const Part& part_b = *bodies_[Index(b)].part;
  // Where nothing may cross, a distance below zero is rounding, or was there when the two were first near.
  const bool may_cross = over_areas(a, b);
  const double watched = kWatched * margin;
  const Pose X_AB = relative_pose(X_WB[Index(a)], X_WB[Index(b)]);
  if (!may_cross && test_ball(a, b, X_AB, margin)) {
    list.free_until = accumulated_motion(a, b) + (minima_.empty() ? margin : 0.0);
    return;
  }
  if (!may_cross && !list.looked_at) look_for_overlap(a, b, X_AB, watched);
  list.looked_at = !may_cross;
  MinimaQuery query{.max_distance = of_facets,
                    .depth = may_cross ? kSurfaceDepth * std::min(part_a.size, part_b.size)
                                       : std::max(watched, overlap(a, b)),
                    .cone_inflation = cone_inflation(a, b)};
  if (list.apart) {
    MinimaQuery farther = query;
    farther.max_distance *= kFarther;
    MinimaWork work;
    const double clearance = surface_clearance(part_a.tree, part_b.tree, X_AB, farther, work);
    ++work_.surface_queries;
    work_.feature_steps += work.feature_pairs;
    list.free_until = accumulated_motion(a, b) + clearance;
    if (clearance > of_facets) return add_met_triangles(a, b, X_AB, margin);
  }
  bool full = false;
  if (!may_cross && of_grasped(a, b) && frame_ < list.unproven_until) {
    query.max_distance = std::min(margin, kUnprovenMargin * std::max(part_a.size, part_b.size));
    full = find_minima(a, b, X_AB, query);
    if (minima_.empty() && query.max_distance < margin) {
      query.max_distance = margin;
      full = find_minima(a, b, X_AB, query);
    }
    margin = query.max_distance;
  } else {
    full = find_minima(a, b, X_AB, query);
  }
  if (full) drop(a, b);
  list.apart = minima_.empty();
  list.free_until = accumulated_motion(a, b) + (list.apart ? query.max_distance : 0.0);
  list.nearest = full ? 0.0 : query.max_distance;
  for (const SurfaceMinimum& minimum : minima_) list.nearest = std::min(list.nearest, minimum.distance);
  list.looked_at &= follow_overlap(a, b, watched);
  if (!may_cross && !of_grasped(a, b)) take_revolved(a, b, X_AB, margin);
  add_minima(a, b, margin);
  if (!may_cross) add_met_triangles(a, b, X_AB, margin);
}

/// How deep two surfaces may be found in each other that were so when they became near; else 0 [m].
double ContactFinder::overlap(int a, int b) const noexcept {
  for (const Overlap& known : overlaps_)
    if (known.body_a == a && known.body_b == b) return known.depth;
  return 0.0;
}

/// Looks whether surfaces that have become near are in each other, by more than is watched anyway, and how
/// deep: the search goes twice as deep each time, until the deepest minimum lies well within.
void ContactFinder::look_for_overlap(int a, int b, const Pose& X_AB, double watched) noexcept {
  const Part& part_a = *bodies_[Index(a)].part;
  const Part& part_b = *bodies_[Index(b)].part;
  const RelativeMotion none{X_AB, {Vec3::Zero(), Vec3::Zero()}};
  if (overlap(a, b) > 0.0 || !surface_path(part_a.tree, part_b.tree, none, kMostOverlapTests).crossed) return;
  const double most = kOverlapDepth * std::min(part_a.size, part_b.size);
  double depth = watched;
  double deepest = 0.0;
  while (depth < most && (deepest == 0.0 || deepest < -0.5 * depth)) {
    depth = std::min(2.0 * depth, most);
    find_minima(a, b, X_AB, {.max_distance = 0.0, .depth = depth, .cone_inflation = 0.0});
    deepest = deepest_minimum();
  }
  if (deepest < -watched && overlaps_.size() < overlaps_.capacity()) overlaps_.push_back({a, b, depth});
}

/// Searches less deep where two surfaces have come out of each other, by the minima that were found. False
/// where these are apart: whether there are others is to be looked at.
bool ContactFinder::follow_overlap(int a, int b, double watched) noexcept {
  const auto known = std::find_if(overlaps_.begin(), overlaps_.end(),
                                  [&](const Overlap& o) { return o.body_a == a && o.body_b == b; });
  if (known == overlaps_.end()) return true;
  const double deepest = deepest_minimum();
  if (deepest < -watched) {
    known->depth = std::min(known->depth, -2.0 * deepest);
    return true;
  }
  overlaps_.erase(known, known + 1);
  return false;
}

/// The distance of the minimum that is farthest below zero; 0 where there is none [m].
double ContactFinder::deepest_minimum() const noexcept {
  double deepest = 0.0;
  for (const SurfaceMinimum& minimum : minima_) deepest = std::min(deepest, minimum.distance);
  return deepest;
}

/// By how much the cones of two surfaces are inflated: corners that the bodies may turn down in this frame
/// are contacts, too. A hand turns its part slowly, and steps that turn it farther are tested and cut; in the
/// penalty response there would be more springs where there are more contacts.
double ContactFinder::cone_inflation(int a, int b) const noexcept {
  if (of_grasped(a, b) || points_ == PatchPoints::kQuadrature) return tolerances::kConeInflation;
  return std::clamp(turn_[Index(a)] + turn_[Index(b)], tolerances::kConeInflation, kMostInflation);
}

/// The minima of two surfaces, into minima_; true where it has no room for them.
bool ContactFinder::find_minima(int a, int b, const Pose& X_AB, const MinimaQuery& query) noexcept {
  const MinimaWork found =
      surface_minima(bodies_[Index(a)].part->tree, bodies_[Index(b)].part->tree, X_AB, query, minima_);
  ++work_.surface_queries;
  work_.minima += found.minima;
  work_.feature_steps += found.feature_pairs;
  return found.full;
}

/// Makes patches of the minima.
void ContactFinder::add_minima(int a, int b, double margin) noexcept {
  const Index kept = reduce_minima(a, b, margin);
  for (Index i = 0; i < kept; ++i) {
    // Outside their true cones two edges may seem to have crossed that have not. Apart they count, however
    // near: the far end of an almost flat contact is such a pair, and the next step may find it in the cones.
    const bool edges = minima_[i].a.kind == FeatureKind::kEdge && minima_[i].b.kind == FeatureKind::kEdge;
    if (edges && !minima_[i].strict && minima_[i].distance < 0.0) continue;
    // Parallel edges have two minima, at the ends of the interval they share; they stand side by side.
    const bool second_end = i > 0 && minima_[i - 1].a == minima_[i].a && minima_[i - 1].b == minima_[i].b;
    add_surface_patch(a, b, minima_[i], second_end, margin);
  }
}

/// Null where there is no room for it.
ContactPatch* ContactFinder::add_surface_patch(int a, int b, const SurfaceMinimum& minimum, bool second_end,
                                               double margin) noexcept {
  if (patches_.size() == patches_.capacity()) {
    drop(a, b);
    return nullptr;
  }
  ContactPatch& patch = patches_.emplace_back();
  patch.body_a = a;
  patch.body_b = b;
  patch.piece_a = minimum.triangle_a;
  patch.piece_b = minimum.triangle_b;
  patch.of_surfaces = true;
  // The corners of one part on a face of the other are one contact, whichever of its faces they belong to.
  const auto facet = [](const SurfaceTree& tree, const Feature& feature) {
    return feature.kind == FeatureKind::kFace ? tree.group_of(feature.index) : -1;
  };
  patch.facets.a = facet(bodies_[Index(a)].part->tree, minimum.a);
  patch.facets.b = facet(bodies_[Index(b)].part->tree, minimum.b);
  patch.round = minimum.round;
  // Where a curved surface has been put into another one, the facets may still be open.
  patch.distance = minimum.round ? std::max(minimum.distance, 0.0) : minimum.distance;
  patch.tolerance = margin;
  patch.manifold.normal = minimum.normal;
  patch.manifold.a = minimum.a;
  patch.manifold.b = minimum.b;
  patch.manifold.points.push_back(
      {minimum.p_a, minimum.p_b, minimum.distance, 1.0, point_id(minimum.a, minimum.b, second_end ? 1 : 0)});
  return &patch;
}

namespace {

/// Gives all implied contacts of two surfaces the least distance of any: each has only the vertices at its
/// own features, and a part that meets a step is lifted over it by all of them.
void share_step(std::span<const ContactPatch> patches, std::span<double> distance,
                std::span<GapAnswer> asked) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < patches.size(); ++i)
    if (patches[i].implied && asked[i] == GapAnswer::kExact) least = std::min(least, distance[i]);
  for (Index i = 0; i < patches.size(); ++i) {
    if (!patches[i].implied || !(least < distance[i])) continue;
    distance[i] = least;
    asked[i] = GapAnswer::kExact;
  }
}

}  // namespace

void ContactFinder::surface_distances_at(std::span<const ContactPatch> patches, std::span<const Pose> X_WB,
                                         std::span<double> distance, std::span<GapAnswer> asked,
                                         int keep_back) noexcept {
  std::fill(asked.begin(), asked.end(), tests_left_ > keep_back ? GapAnswer::kProven : GapAnswer::kUnknown);
  if (tests_left_ <= keep_back) return;
  --tests_left_;
  const ContactPatch& first = patches.front();
  const Part& part_a = *bodies_[Index(first.body_a)].part;
  const Part& part_b = *bodies_[Index(first.body_b)].part;
  const MinimaQuery query{.max_distance = kWatched * first.tolerance,
                          .depth = std::max({first.tolerance, tolerance(first.body_a, first.body_b),
                                             overlap(first.body_a, first.body_b)}),
                          .cone_inflation = 0.0};
  const Pose X_AB = relative_pose(X_WB[Index(first.body_a)], X_WB[Index(first.body_b)]);
  if (surface_minima(part_a.tree, part_b.tree, X_AB, query, minima_).full) {
    work_.capacity_reached = true;
    std::fill(asked.begin(), asked.end(), GapAnswer::kUnknown);  // those without room may be closed
    return;
  }
  std::fill(distance.begin(), distance.end(), query.max_distance);
  for (Index i = 0; i < patches.size(); ++i) {
    if (!patches[i].met) continue;
    distance[i] = distance_of_met(patches[i], X_AB);  // of all corners of the triangles
    asked[i] = patches[i].implied ? GapAnswer::kExact : GapAnswer::kElsewhere;
  }
  const auto nearest = std::min_element(patches.begin(), patches.end(),
                                        [](const auto& p, const auto& q) { return p.distance < q.distance; });
  for (const SurfaceMinimum& minimum : minima_) {
    auto same = std::find_if(patches.begin(), patches.end(), [&](const ContactPatch& patch) {
      return patch.manifold.a == minimum.a && patch.manifold.b == minimum.b;
    });
    const bool elsewhere = same == patches.end() && !nearest->implied;
    if (same == patches.end()) same = nearest;
    const Index number = Index(same - patches.begin());
    double& d = distance[number];
    if (asked[number] == GapAnswer::kProven || minimum.distance < d)
      asked[number] = elsewhere ? GapAnswer::kElsewhere : GapAnswer::kExact;
    d = std::min(d, minimum.distance);
  }
  share_step(patches, distance, asked);
}

}  // namespace tactum::inline v0_1
