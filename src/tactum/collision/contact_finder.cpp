#include "tactum/collision/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/manifold.h"
#include "tactum/collision/seams.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// Boxes and lists of near pairs are grown by this share of the smaller body's radius beyond the tolerance:
/// more means they are renewed less often but hold more pairs.
constexpr double kSlack = 0.02;

/// Below every odometer reading less a tolerance.
constexpr double kAlwaysDue = -1e300;

/// The axis-aligned box around a turned box.
Aabb turned(const Aabb& box, const Pose& X, double grown) {
  const Vec3 center = X * box.center();
  const Vec3 half = X.R.cwiseAbs() * box.half() + Vec3::Constant(grown);
  return {center - half, center + half};
}

/// How far any point within `radius` of the origin has moved: the origin's way plus the chord of the turn,
/// whose matrix difference has Frobenius norm sqrt(2) chord / radius.
double displacement(const Pose& from, const Pose& to, double radius) {
  return (to.p - from.p).norm() + radius * (to.R - from.R).norm() / std::sqrt(2.0);
}

bool inside(const Aabb& small, const Aabb& large) {
  return (small.min.array() >= large.min.array()).all() && (small.max.array() <= large.max.array()).all();
}

}  // namespace

ContactFinder::ContactFinder(std::vector<CollisionBody> bodies, std::span<const Pose> X_WB,
                             const ContactFinderRooms& rooms)
    : bodies_(std::move(bodies)), last_X_WB_(X_WB.begin(), X_WB.end()), sweep_([&] {
        for (Index i = 0; i < bodies_.size(); ++i) {
          const Part& part = *bodies_[i].part;
          double radius = 0.0;
          Aabb box;
          for (const Vec3& vertex : part.surface.vertices) {
            radius = std::max(radius, vertex.norm());
            box.extend(vertex);
          }
          radius_.push_back(radius);
          part_box_.push_back(box);
          slack_.push_back(kSlack * radius);
          fat_box_.push_back(turned(box, X_WB[i], slack_.back()));
        }
        return SweepAndPrune(fat_box_);
      }()) {
  travel_.assign(bodies_.size(), 0.0);
  lists_.resize(bodies_.size() * bodies_.size());
  pairs_.reserve(rooms.pairs);
  renewed_.reserve(rooms.pairs);
  due_.reserve(rooms.pairs);
  patches_.reserve(rooms.patches);
  candidates_.reserve(rooms.patches);
  minima_.reserve(rooms.minima);
  reduction_scratch_.reserve(rooms.minima);
  kept_minima_ = rooms.kept_minima;
}

void ContactFinder::find_near_pairs(std::span<const Pose> X_WB, std::span<const double> reach,
                                    double min_tolerance) noexcept {
  work_ = {};
  work_.bodies = static_cast<int>(bodies_.size());
  reach_ = reach;
  min_tolerance_ = min_tolerance;
  ++frame_;
  move_boxes(X_WB);
  const bool lists_hold = std::all_of(sweep_.pairs().begin(), sweep_.pairs().end(), [&](const auto& pair) {
    return list_holds(list_of(pair.a, pair.b), pair.a, pair.b);
  });
  if (!lists_hold) renew_lists(X_WB);
  for (const SweepAndPrune::Pair& near : sweep_.pairs())
    work_.rooms_full |= list_of(near.a, near.b).cut_short;
  work_.near_pairs = static_cast<int>(pairs_.size());
}

void ContactFinder::find_patches(std::span<const Pose> X_WB, int budget, PatchPoints points) noexcept {
  points_ = points;
  patches_.clear();
  candidates_.clear();
  due_.clear();
  for (Index i = 0; i < pairs_.size(); ++i) {
    Pair& pair = pairs_[i];
    const bool was_in_contact = std::exchange(pair.in_contact, false);
    if (pair.free_until - odometers(pair.body_a, pair.body_b) <= tolerance(pair.body_a, pair.body_b))
      due_.push_back({static_cast<std::int32_t>(i), was_in_contact, pair.last_checked});
  }
  const int checked = prioritise(due_, budget);
  work_.unchecked = static_cast<int>(due_.size()) - checked;
  for (int i = 0; i < checked; ++i) test(pairs_[Index(due_[Index(i)].pair)], X_WB);
  if (!candidates_.empty()) work_.rooms_full |= !settle_seams(candidates_, X_WB, patches_);
  for (const SweepAndPrune::Pair& near : sweep_.pairs())
    if (meet_by_surfaces(near.a, near.b)) test_surfaces(near.a, near.b, X_WB);
  work_.patches = static_cast<int>(patches_.size());
}

void ContactFinder::move_boxes(std::span<const Pose> X_WB) noexcept {
  bool moved = false;
  for (Index i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].moves) continue;
    travel_[i] += displacement(last_X_WB_[i], X_WB[i], radius_[i]);
    last_X_WB_[i] = X_WB[i];
    const double needed = std::max(reach_[i], min_tolerance_);
    const Aabb tight = turned(part_box_[i], X_WB[i], needed);
    if (inside(tight, fat_box_[i])) continue;
    fat_box_[i] = turned(part_box_[i], X_WB[i], needed + slack_[i]);
    sweep_.move(static_cast<int>(i), fat_box_[i]);
    moved = true;
  }
  if (!moved) return;
  sweep_.update();
  work_.broad_phase_runs = 1;
}

double ContactFinder::tolerance(int a, int b) const noexcept {
  const auto reach_of = [&](int body) { return bodies_[Index(body)].moves ? reach_[Index(body)] : 0.0; };
  return std::max(min_tolerance_, reach_of(a) + reach_of(b));
}

bool ContactFinder::list_holds(const BodyPair& list, int a, int b) const noexcept {
  if (!bodies_[Index(a)].moves && !bodies_[Index(b)].moves) return true;
  return list.renewal == renewal_ && odometers(a, b) - list.odometers + tolerance(a, b) <= list.reach;
}

void ContactFinder::renew_lists(std::span<const Pose> X_WB) noexcept {
  work_.broad_phase_runs = 1;
  renewed_.clear();
  for (const SweepAndPrune::Pair& near : sweep_.pairs()) {
    if (!bodies_[Index(near.a)].moves && !bodies_[Index(near.b)].moves) continue;
    BodyPair& list = list_of(near.a, near.b);
    const Index first = renewed_.size();
    if (list_holds(list, near.a, near.b)) {
      const Index room = renewed_.capacity() - renewed_.size();
      list.cut_short = list.cut_short || Index(list.count) > room;
      for (Index i = 0; i < std::min(Index(list.count), room); ++i)
        renewed_.push_back(pairs_[Index(list.first) + i]);
    } else {
      const BodyPair old = list;
      list.odometers = odometers(near.a, near.b);
      list.reach = tolerance(near.a, near.b) + std::min(slack_[Index(near.a)], slack_[Index(near.b)]);
      list.cut_short =
          !collect(near.a, near.b, relative_pose(X_WB[Index(near.a)], X_WB[Index(near.b)]), list.reach);
      inherit(old, first);
    }
    list.first = static_cast<std::int32_t>(first);
    list.count = static_cast<std::int32_t>(renewed_.size() - first);
    list.renewal = renewal_ + 1;
  }
  ++renewal_;  // a pair of bodies that is not near now has an older number, and no list any more
  pairs_.swap(renewed_);
}

/// False when the room did not suffice.
bool ContactFinder::collect(int a, int b, const Pose& X_AB, double reach) noexcept {
  if (meet_by_surfaces(a, b)) return true;
  const Index first = renewed_.size();
  const bool complete =
      for_each_pair_within(bodies_[Index(a)].part->hierarchy, bodies_[Index(b)].part->hierarchy, X_AB, reach,
                           [&](int piece_a, int piece_b) {
                             if (renewed_.size() == renewed_.capacity()) return false;
                             Pair pair;
                             pair.body_a = a;
                             pair.body_b = b;
                             pair.piece_a = piece_a;
                             pair.piece_b = piece_b;
                             renewed_.push_back(pair);
                             return true;
                           });
  std::sort(renewed_.begin() + static_cast<std::ptrdiff_t>(first), renewed_.end(),
            [](const Pair& p, const Pair& q) {
              return p.piece_a != q.piece_a ? p.piece_a < q.piece_a : p.piece_b < q.piece_b;
            });
  return complete;
}

/// Hands the caches of the old list on: both are sorted, so one walk along both suffices.
void ContactFinder::inherit(const BodyPair& old, std::size_t first) noexcept {
  Index from = Index(old.first);
  const Index end = from + Index(old.count);
  for (Index to = first; to < renewed_.size(); ++to) {
    const auto key = std::pair(renewed_[to].piece_a, renewed_[to].piece_b);
    while (from < end && std::pair(pairs_[from].piece_a, pairs_[from].piece_b) < key) ++from;
    if (from < end && std::pair(pairs_[from].piece_a, pairs_[from].piece_b) == key)
      renewed_[to] = pairs_[from];
  }
}

void ContactFinder::test(Pair& pair, std::span<const Pose> X_WB) noexcept {
  const Part& part_a = *bodies_[Index(pair.body_a)].part;
  const Part& part_b = *bodies_[Index(pair.body_b)].part;
  const Pose X_AB = relative_pose(X_WB[Index(pair.body_a)], X_WB[Index(pair.body_b)]);
  const Polytope& A = part_a.pieces[Index(pair.piece_a)];
  const Polytope& B = part_b.pieces[Index(pair.piece_b)];
  const PairDistance found = closest_features(A, B, X_AB, pair.cache);
  ++work_.exact_tests;
  work_.feature_steps += found.steps;
  if (!found.certified()) ++work_.uncertified;
  pair.last_checked = frame_;
  // What is not certified proves nothing: the pair is due again in the next frame.
  pair.free_until = found.certified() ? odometers(pair.body_a, pair.body_b) + found.distance : kAlwaysDue;

  const double reach = tolerance(pair.body_a, pair.body_b);
  pair.in_contact = found.distance < reach;
  if (!pair.in_contact) {
    pair.shown = {};
    return;
  }
  if (patches_.size() + candidates_.size() >= patches_.capacity()) {
    work_.rooms_full = true;
    return;
  }
  const bool seams = !part_a.true_surface.alone() || !part_b.true_surface.alone();
  const bool objected = seams && !is_true_contact(part_a, pair.piece_a, part_b, pair.piece_b, X_AB, found);
  if (seams && points_ == PatchPoints::kQuadrature) {
    SeamCandidate& candidate = candidates_.emplace_back();
    candidate.body_a = pair.body_a;
    candidate.body_b = pair.body_b;
    candidate.piece_a = pair.piece_a;
    candidate.piece_b = pair.piece_b;
    candidate.pair = static_cast<int>(&pair - pairs_.data());
    candidate.part_a = &part_a;
    candidate.part_b = &part_b;
    candidate.shown = &pair.shown;
    candidate.reach = reach;
    candidate.found = found;
    candidate.objected = objected;
    return;
  }
  ContactPatch& patch = patches_.emplace_back();
  patch.body_a = pair.body_a;
  patch.body_b = pair.body_b;
  patch.piece_a = pair.piece_a;
  patch.piece_b = pair.piece_b;
  patch.pair = static_cast<int>(&pair - pairs_.data());
  patch.facet_a = part_a.surface_group[Index(pair.piece_a)];
  patch.facet_b = part_b.surface_group[Index(pair.piece_b)];
  patch.tolerance = reach;
  if (points_ == PatchPoints::kClosest) {
    patch.distance = found.distance;
    patch.manifold.normal = found.normal;
    patch.manifold.a = found.a;
    patch.manifold.b = found.b;
    // A neighbour across the seam is nearer and carries the force: this one, without a point, is only
    // watched.
    if (!objected || found.distance <= 0.0)
      patch.manifold.points.push_back({found.p_a, found.p_b, found.distance, 1.0, 0});
    return;
  }
  const PairDistance shown = steady_depth(A, B, X_AB, found, pair.shown);
  patch.distance = shown.distance;
  contact_manifold(A, B, X_AB, shown, reach, patch.manifold);
  steady_centroid(X_AB, patch.manifold, pair.shown);
}

void ContactFinder::distances_at(std::span<const Pose> X_WB, std::span<double> distance,
                                 std::span<const char> wanted) noexcept {
  for (Index i = 0; i < patches_.size();) {
    const ContactPatch& patch = patches_[i];
    if (!wanted.empty() && wanted[i] == 0) {
      ++i;
      continue;
    }
    if (!patch.of_surfaces) {
      Pair& pair = pairs_[Index(patch.pair)];
      const Pose X_AB = relative_pose(X_WB[Index(pair.body_a)], X_WB[Index(pair.body_b)]);
      const PairDistance found =
          closest_features(bodies_[Index(pair.body_a)].part->pieces[Index(pair.piece_a)],
                           bodies_[Index(pair.body_b)].part->pieces[Index(pair.piece_b)], X_AB, pair.cache);
      distance[i] = found.certified() ? found.distance : std::min(found.distance, 0.0);
      ++i;
      continue;
    }
    Index end = i;
    while (end < patches_.size() && patches_[end].of_surfaces && patches_[end].body_a == patch.body_a &&
           patches_[end].body_b == patch.body_b)
      ++end;
    surface_distances_at({patches_.data() + i, end - i}, X_WB, distance.subspan(i, end - i));
    i = end;
  }
}

}  // namespace tactum
