/// The half of the contact finder (contact_finder.h) for bodies that are tested by their surfaces.

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/contact/contact_finder.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// How deep surfaces may cross in the penalty response and still be told apart, as a fraction of the smaller
/// part's size. Walls thinner than that may be pushed through; the constraint response lets nothing cross.
constexpr double kSurfaceDepth = 0.02;

/// At the end of a step only gaps below this fraction of the tolerance are searched: the others are open. It
/// must not be below half the skin, which a gap may have to keep (constraint_trial.cpp): a tolerance is four
/// skins at least (kBoundMargin in constraint.cpp), so it is 0.6 skins at least.
constexpr double kWatched = 0.15;

/// For surfaces that were apart the first query is how far, up to so many tolerances: until they moved that
/// far they need no other query.
constexpr double kFarther = 8.0;

}  // namespace

void ContactFinder::test_surfaces(const SweepAndPrune::Pair& near, std::span<const Pose> X_WB) noexcept {
  const int a = near.a;
  const int b = near.b;
  if (!bodies_[Index(a)].moves && !bodies_[Index(b)].moves) return;
  const double margin = tolerance(a, b);
  BodyPair& list = list_of(near);
  if (list.free_until - accumulated_motion(a, b) > margin) return;
  if (tests_left_ <= 0) return skip(a, b, list.free_until - accumulated_motion(a, b), frame_);
  --tests_left_;
  ++work_.exact_tests;
  const Part& part_a = *bodies_[Index(a)].part;
  const Part& part_b = *bodies_[Index(b)].part;
  // Where nothing may cross, a distance below zero is rounding.
  const bool may_cross = over_areas(a, b);
  const MinimaQuery query{
      .max_distance = margin,
      .depth = may_cross ? kSurfaceDepth * std::min(part_a.size, part_b.size) : kWatched * margin,
      .cone_inflation = tolerances::kConeInflation};
  const Pose X_AB = relative_pose(X_WB[Index(a)], X_WB[Index(b)]);
  if (list.apart) {
    MinimaQuery farther = query;
    farther.max_distance *= kFarther;
    MinimaWork work;
    const double clearance = surface_clearance(part_a.tree, part_b.tree, X_AB, farther, work);
    ++work_.surface_queries;
    work_.feature_steps += work.feature_pairs;
    list.free_until = accumulated_motion(a, b) + clearance;
    if (clearance > margin) return;
  }
  const MinimaWork found = surface_minima(part_a.tree, part_b.tree, X_AB, query, minima_);
  ++work_.surface_queries;
  work_.minima += found.minima;
  work_.feature_steps += found.feature_pairs;
  if (found.full) drop(a, b);
  list.apart = minima_.empty();
  list.free_until = accumulated_motion(a, b) + (list.apart ? margin : 0.0);
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

void ContactFinder::add_surface_patch(int a, int b, const SurfaceMinimum& minimum, bool second_end,
                                      double margin) noexcept {
  if (patches_.size() == patches_.capacity()) return drop(a, b);
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
  patch.distance = minimum.distance;
  patch.tolerance = margin;
  patch.manifold.normal = minimum.normal;
  patch.manifold.a = minimum.a;
  patch.manifold.b = minimum.b;
  patch.manifold.points.push_back(
      {minimum.p_a, minimum.p_b, minimum.distance, 1.0, point_id(minimum.a, minimum.b, second_end ? 1 : 0)});
}

void ContactFinder::surface_distances_at(std::span<const ContactPatch> patches, std::span<const Pose> X_WB,
                                         std::span<double> distance, std::span<GapAnswer> asked,
                                         int keep_back) noexcept {
  std::fill(asked.begin(), asked.end(), tests_left_ > keep_back ? GapAnswer::kProven : GapAnswer::kUnknown);
  if (tests_left_ <= keep_back) return;
  --tests_left_;
  const ContactPatch& first = patches.front();
  const Part& part_a = *bodies_[Index(first.body_a)].part;
  const Part& part_b = *bodies_[Index(first.body_b)].part;
  const MinimaQuery query{
      .max_distance = kWatched * first.tolerance, .depth = first.tolerance, .cone_inflation = 0.0};
  const Pose X_AB = relative_pose(X_WB[Index(first.body_a)], X_WB[Index(first.body_b)]);
  if (surface_minima(part_a.tree, part_b.tree, X_AB, query, minima_).full) {
    work_.capacity_reached = true;
    std::fill(asked.begin(), asked.end(), GapAnswer::kUnknown);  // those without room may be closed
    return;
  }
  std::fill(distance.begin(), distance.end(), query.max_distance);
  const auto nearest = std::min_element(patches.begin(), patches.end(),
                                        [](const auto& p, const auto& q) { return p.distance < q.distance; });
  for (const SurfaceMinimum& minimum : minima_) {
    auto same = std::find_if(patches.begin(), patches.end(), [&](const ContactPatch& patch) {
      return patch.manifold.a == minimum.a && patch.manifold.b == minimum.b;
    });
    if (same == patches.end()) same = nearest;
    const Index number = Index(same - patches.begin());
    asked[number] = GapAnswer::kExact;
    double& d = distance[number];
    d = std::min(d, minimum.distance);
  }
}

}  // namespace tactum::inline v0_1
