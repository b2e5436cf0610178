#include "tactum/contact/contact_finder.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/manifold.h"
#include "tactum/contact/motion_bound.h"
#include "tactum/contact/round_contact.h"
#include "tactum/contact/seams.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Below every accumulated motion less a tolerance.
constexpr double kAlwaysDue = -1e300;

/// A budget is ample when every due pair can be tested so many times: once when it is found, and at trial
/// poses.
constexpr std::size_t kAmple = 4;

/// An answer holds while the motion since is no more than this fraction of the distance; of an overlap, while
/// there was none.
constexpr double kKnownShare = 0.05;

}  // namespace

void ContactFinder::list_due_pairs() noexcept {
  due_.clear();
  for (Index i = 0; i < pairs_.size(); ++i) {
    Pair& pair = pairs_[i];
    if (pair.free_until - accumulated_motion(pair.body_a, pair.body_b) >
            facet_tolerance(pair.body_a, pair.body_b) ||
        rolls_by_circles(pair.body_a, pair.body_b)) {
      pair.in_contact = false;
    } else {
      due_.push_back({static_cast<std::int32_t>(i), priority_of(pair.body_a, pair.body_b), pair.in_contact,
                      pair.last_checked});
    }
  }
}

void ContactFinder::find_patches(std::span<const Pose> X_WB, int budget, PatchPoints points,
                                 std::span<const std::uint8_t> priority) noexcept {
  points_ = points;
  priority_.assign(priority.begin(), priority.end());
  tests_left_ = budget;
  patches_.clear();
  candidates_.clear();
  internal_.clear();
  emitted_.clear();
  std::fill(blocked_.begin(), blocked_.end(), 0);
  block_unlisted();
  list_due_pairs();
  budget_limited_ = kAmple * due_.size() > static_cast<Index>(std::max(budget, 0));
  // Pairs whose answer still holds are removed before the list is sorted.
  const int may_test = budget_limited_ ? skip_still_valid(X_WB) : budget;
  const int checked = prioritise(due_, may_test, head_start_);
  work_.due = static_cast<int>(due_.size());
  for (int i = 0; i < work_.due; ++i) {
    const std::int32_t number = due_[Index(i)].pair;
    Pair& pair = pairs_[Index(number)];
    if (i < checked) {
      pair.last_checked = frame_;
    } else {
      const double until = pair.free_until - accumulated_motion(pair.body_a, pair.body_b);
      skip(pair.body_a, pair.body_b, until, pair.last_checked);
      if (!pair.in_contact || !pair.last.certified) continue;
    }
    emitted_.push_back(number);
  }
  // In the order of the pairs, which is that of the last frame's patches.
  if (budget_limited_) std::sort(emitted_.begin(), emitted_.end());
  for (const std::int32_t number : emitted_) {
    Pair& pair = pairs_[Index(number)];
    const Pose X_AB = relative_pose(X_WB[Index(pair.body_a)], X_WB[Index(pair.body_b)]);
    if (pair.last_checked == frame_) {
      test(pair, X_AB);
    } else {
      PairDistance last = pair.last.found;
      // Of a pair that was apart only a bound is known.
      const double bound = pair.free_until - accumulated_motion(pair.body_a, pair.body_b);
      last.distance = last.distance > 0.0 ? std::max(bound, 0.0) : std::min(bound, last.distance);
      emit_patch(pair, last, X_AB);
    }
  }
  settle_candidates(X_WB);
  for (const bool grasped : {true, false})
    for (const SweepAndPrune::Pair& near : sweep_.pairs())
      if (may_touch(near) && meet_by_surfaces(near.a, near.b) && of_grasped(near.a, near.b) == grasped)
        test_surfaces(near, X_WB);
  leave_out_implied(X_WB);
  work_.patches = static_cast<int>(patches_.size());
}

/// Leaves out the contacts with walls between the pieces of one part.
void ContactFinder::settle_candidates(std::span<const Pose> X_WB) noexcept {
  settle_closest_points(internal_, X_WB, patches_);
  candidate_order_.clear();
  for (SeamCandidate& candidate : candidates_) candidate_order_.push_back(&candidate);
  if (!settle_seams(candidate_order_, X_WB, patches_))
    for (const SeamCandidate& candidate : candidates_) drop(candidate.a.body, candidate.b.body);
}

/// Leaves out the contacts that contacts with other bodies imply. Surfaces whose forces are taken over areas,
/// which may cross, are left as they are.
void ContactFinder::leave_out_implied(std::span<const Pose> X_WB) noexcept {
  const auto stays = [&](const ContactPatch& patch) {
    return patch.of_surfaces && over_areas(patch.body_a, patch.body_b);
  };
  for (ContactPatch& patch : patches_) patch.implied |= stays(patch);  // such a contact is not looked at
  flush_bodies_.mark_implied(bodies_, X_WB, patches_);
  for (ContactPatch& patch : patches_) {
    if (stays(patch)) patch.implied = false;
    if (patch.pair >= 0) pairs_[Index(patch.pair)].implied = patch.implied;
  }
  if (points_ == PatchPoints::kQuadrature)
    patches_.erase(std::remove_if(patches_.begin(), patches_.end(),
                                  [&](const ContactPatch& patch) {
                                    return patch.implied && over_areas(patch.body_a, patch.body_b);
                                  }),
                   patches_.end());
}

std::uint8_t ContactFinder::priority_of(int a, int b) const noexcept {
  return priority_.empty() ? priority::kOther : std::min(priority_[Index(a)], priority_[Index(b)]);
}

/// How far a contact of two bodies may move in a frame.
const SteadyLimits& ContactFinder::steady_limits(int a, int b) const noexcept {
  const auto is_pushed = [&](int body) {
    return bodies_[Index(body)].moves && priority_[Index(body)] != priority::kGrasped;
  };
  return !priority_.empty() && (is_pushed(a) || is_pushed(b)) ? not_steady_ : steady_;
}

/// A lower bound of the pair's distance: an answer less the motion of the smaller body since, relative to the
/// other one.
double ContactFinder::bound_at(const Pair& pair, const Answer& answer, const Pose& X_AB) const noexcept {
  if (!answer.certified) return kAlwaysDue;
  const double radius_a = radius_[Index(pair.body_a)];
  const double radius_b = radius_[Index(pair.body_b)];
  const double moved = radius_b <= radius_a ? displacement(answer.X_AB, X_AB, radius_b)
                                            : displacement(answer.X_AB.inverse(), X_AB.inverse(), radius_a);
  return answer.found.distance - moved;
}

/// Removes the pairs whose last answer still holds from those that are due. Returns how many of the others
/// may be tested.
int ContactFinder::skip_still_valid(std::span<const Pose> X_WB) noexcept {
  int grasped = 0;
  const auto needs_no_test = [&](const DuePair& due) {
    Pair& pair = pairs_[Index(due.pair)];
    const Pose X_AB = relative_pose(X_WB[Index(pair.body_a)], X_WB[Index(pair.body_b)]);
    double bound = bound_at(pair, pair.last, X_AB);
    if (const double on_trial = bound_at(pair, pair.trial, X_AB); on_trial > bound) {
      pair.last = pair.trial;
      bound = on_trial;
    }
    // Measured between the two poses, the motion is less than the accumulated one.
    const double here = accumulated_motion(pair.body_a, pair.body_b);
    pair.free_until = std::max(pair.free_until, here + bound);
    if (pair.free_until - here > facet_tolerance(pair.body_a, pair.body_b)) {
      pair.in_contact = false;
      return true;
    }
    const double found = pair.last.found.distance;
    if (pair.last.certified && bound >= found - kKnownShare * std::max(found, 0.0)) {
      emitted_.push_back(due.pair);
      return true;
    }
    grasped += due.priority == priority::kGrasped ? 1 : 0;
    return false;
  };
  due_.erase(std::remove_if(due_.begin(), due_.end(), needs_no_test), due_.end());
  work_.known = static_cast<int>(emitted_.size());
  return std::min(tests_left_, grasped + std::max(0, tests_left_ - grasped) / 2);
}

/// Counts a pair that is not tested in this frame, and blocks its bodies where that is not safe: where they
/// may move by `gap`, a lower bound of the distance of their facets [m], in this frame.
void ContactFinder::skip(int a, int b, double gap, std::int64_t last_checked) noexcept {
  const auto moves_by = [&](int body) {
    return bodies_[Index(body)].moves ? motion_bound_[Index(body)] : 0.0;
  };
  ++work_.unchecked;
  if (gap > moves_by(a) + moves_by(b) + bulge(a, b)) return;
  ++work_.left_unproven;
  work_.left_of_grasped += of_grasped(a, b) ? 1 : 0;
  if (last_checked >= 0)
    work_.longest_unchecked = std::max(work_.longest_unchecked, static_cast<int>(frame_ - last_checked));
  blocked_[Index(a)] = blocked_[Index(b)] = 1;
}

/// Flags that a contact of two bodies finds no room. Nothing keeps them apart there, so they may not move.
void ContactFinder::drop(int a, int b) noexcept {
  work_.capacity_reached = true;
  blocked_[Index(a)] = blocked_[Index(b)] = 1;
}

/// Blocks the bodies whose near pairs found no room on the lists; all of them, where it is not known which
/// bodies are near.
void ContactFinder::block_unlisted() noexcept {
  for (const SweepAndPrune::Pair& near : sweep_.pairs())
    if (list_of(near).cut_short) drop(near.a, near.b);
  if (sweep_.missing() == 0) return;
  work_.capacity_reached = true;
  std::fill(blocked_.begin(), blocked_.end(), 1);
}

double ContactFinder::tolerance(int a, int b) const noexcept {
  const auto bound_of = [&](int body) {
    return bodies_[Index(body)].moves ? motion_bound_[Index(body)] : 0.0;
  };
  return std::max(min_tolerance_, bound_of(a) + bound_of(b));
}

void ContactFinder::answer(Pair& pair, const Pose& X_AB, Answer& into) noexcept {
  into.found =
      closest_features(bodies_[Index(pair.body_a)].part->pieces[Index(pair.piece_a)],
                       bodies_[Index(pair.body_b)].part->pieces[Index(pair.piece_b)], X_AB, pair.cache);
  into.X_AB = X_AB;
  into.certified = into.found.certified();
  --tests_left_;
}

void ContactFinder::test(Pair& pair, const Pose& X_AB) noexcept {
  pair.implied = false;
  answer(pair, X_AB, pair.last);
  pair.trial.certified = false;
  ++work_.exact_tests;
  work_.feature_steps += pair.last.found.steps;
  if (!pair.last.certified) ++work_.uncertified;
  // An answer that is not certified proves nothing: the pair is due again in the next frame.
  pair.free_until = pair.last.certified
                        ? accumulated_motion(pair.body_a, pair.body_b) + pair.last.found.distance
                        : kAlwaysDue;
  emit_patch(pair, pair.last.found, X_AB);
}

/// What was found, as it is settled with the contacts of the pieces beside (seam_settler.h).
SeamCandidate ContactFinder::candidate_of(Pair& pair, const PairDistance& found,
                                          bool internal) const noexcept {
  SeamCandidate candidate;
  candidate.a = {pair.body_a, pair.piece_a, bodies_[Index(pair.body_a)].part};
  candidate.b = {pair.body_b, pair.piece_b, bodies_[Index(pair.body_b)].part};
  candidate.pair = static_cast<int>(&pair - pairs_.data());
  candidate.shown = &pair.shown;
  candidate.limits = &steady_limits(pair.body_a, pair.body_b);
  candidate.margin = tolerance(pair.body_a, pair.body_b);
  candidate.found = found;
  candidate.internal = internal;
  return candidate;
}

/// Makes a patch of the answer, when it is within the tolerance. Of a pair that was not tested in this frame
/// the points and the normal are those of its last test, in A's frame, and the distance is a bound.
void ContactFinder::emit_patch(Pair& pair, PairDistance found, const Pose& X_AB) noexcept {
  const CollisionBody& body_a = bodies_[Index(pair.body_a)];
  const CollisionBody& body_b = bodies_[Index(pair.body_b)];
  const Part& part_a = *body_a.part;
  const Part& part_b = *body_b.part;
  const double margin = tolerance(pair.body_a, pair.body_b);
  const bool over_area = over_areas(pair.body_a, pair.body_b);
  const double of_facets = found.distance;
  StaticVector<ContactPoint, Manifold::kMostPoints> points;
  const bool apart = found.certified() && of_facets > 0.0;
  const RoundSide side_a{part_a.pieces[Index(pair.piece_a)], body_a.round(pair.piece_a)};
  const RoundSide side_b{part_b.pieces[Index(pair.piece_b)], body_b.round(pair.piece_b)};
  const bool round = !over_area && !of_grasped(pair.body_a, pair.body_b) && apart &&
                     meet_round(side_a, side_b, X_AB, margin, found, points);
  pair.in_contact = found.distance < margin;
  if (!pair.in_contact) {
    pair.shown = {};
    return;
  }
  if (patches_.size() == patches_.capacity() || candidates_.size() == candidates_.capacity() ||
      internal_.size() == internal_.capacity())
    return drop(pair.body_a, pair.body_b);
  const bool seams = !part_a.true_surface.single_piece() || !part_b.true_surface.single_piece();
  const bool internal = seams && !is_true_contact(part_a, pair.piece_a, part_b, pair.piece_b, X_AB, found);
  if (seams && over_area) {
    candidates_.push_back(candidate_of(pair, found, internal));
    return;
  }
  ContactPatch& patch = patches_.emplace_back();
  patch.body_a = pair.body_a;
  patch.body_b = pair.body_b;
  patch.piece_a = pair.piece_a;
  patch.piece_b = pair.piece_b;
  patch.pair = static_cast<int>(&pair - pairs_.data());
  patch.facets.a = part_a.groups.of_piece[Index(pair.piece_a)];
  patch.facets.b = part_b.groups.of_piece[Index(pair.piece_b)];
  patch.tolerance = margin;
  if (!over_area) {
    // A curved surface may have been put into another one, by as much as its facets are open.
    patch.distance = round ? std::max(found.distance, 0.0) : found.distance;
    patch.round = round;
    patch.manifold.normal = found.normal;
    patch.manifold.a = found.a;
    patch.manifold.b = found.b;
    patch.manifold.points.push_back({found.p_a, found.p_b, found.distance, 1.0, 0});
    if (round) patch.manifold.points = points;
    if (!internal || !(found.distance > 0.0)) return;
    SeamCandidate& candidate = internal_.emplace_back(candidate_of(pair, found, internal));
    candidate.patch = static_cast<int>(patches_.size()) - 1;
    return;
  }
  const Polytope& A = part_a.pieces[Index(pair.piece_a)];
  const Polytope& B = part_b.pieces[Index(pair.piece_b)];
  const SteadyLimits& steady = steady_limits(pair.body_a, pair.body_b);
  const PairDistance shown = steady_depth(A, B, X_AB, found, steady, pair.shown);
  patch.distance = shown.distance;
  contact_manifold(A, B, X_AB, shown, margin, patch.manifold);
  steady_centroid(X_AB, patch.manifold, steady, pair.shown);
}

int ContactFinder::distances_at(std::span<const Pose> X_WB, std::span<double> distance,
                                std::span<GapAnswer> asked, std::span<const double> enough,
                                int keep_back) noexcept {
  const int before = tests_left_;
  for (const bool grasped : {true, false}) {
    for (Index i = 0; i < patches_.size();) {
      const ContactPatch& patch = patches_[i];
      Index end = i + 1;
      while (patch.of_surfaces && end < patches_.size() && patches_[end].of_surfaces &&
             patches_[end].body_a == patch.body_a && patches_[end].body_b == patch.body_b)
        ++end;
      if (asked[i] == GapAnswer::kAsked && of_grasped(patch.body_a, patch.body_b) == grasped) {
        if (patch.of_surfaces) {
          surface_distances_at({patches_.data() + i, end - i}, X_WB, distance.subspan(i, end - i),
                               asked.subspan(i, end - i), keep_back);
        } else {
          asked[i] = distance_at(patch, X_WB, enough[i], keep_back, distance[i]);
        }
      }
      i = end;
    }
  }
  return before - tests_left_;
}

/// The distance of one patch's pieces, or a bound.
GapAnswer ContactFinder::distance_at(const ContactPatch& patch, std::span<const Pose> X_WB, double enough,
                                     int keep_back, double& distance) noexcept {
  Pair& pair = pairs_[Index(patch.pair)];
  const Pose X_AB = relative_pose(X_WB[Index(pair.body_a)], X_WB[Index(pair.body_b)]);
  if (budget_limited_) {
    distance = std::max(bound_at(pair, pair.last, X_AB), bound_at(pair, pair.trial, X_AB));
    if (distance >= enough) return GapAnswer::kProven;
  }
  if (tests_left_ <= keep_back) return GapAnswer::kUnknown;
  answer(pair, X_AB, pair.trial);
  const double found = pair.trial.found.distance;
  distance = pair.trial.certified ? found : std::min(0.0, found);  // 0 where it is not a number
  return GapAnswer::kExact;
}

}  // namespace tactum::inline v0_1
