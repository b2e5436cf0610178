/// The first step of the contact finder (contact_finder.h): which bodies, and which of their pieces, are
/// near.

#include <algorithm>
#include <numbers>
#include <utility>

#include "tactum/contact/contact_finder.h"
#include "tactum/contact/motion_bound.h"
#include "tactum/geometry/mesh_report.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Boxes and lists of near pairs are grown by this fraction of the smaller body's radius beyond the
/// tolerance: with more they are renewed less often but hold more pairs.
constexpr double kBoxGrowth = 0.05;

/// Pairs of triangles that are remembered as contacts: where a part lies on a face wound the wrong way, some.
constexpr Index kMostMet = 256;
/// Pairs of surfaces that were in each other when they became near.
constexpr Index kMostOverlaps = 64;

/// For so long no proof is tried after one that took too many tests.
constexpr double kUnproven_s = 1.0;

/// Whether a surface is closed, in one piece and wound outward: only then is every place where something can
/// touch it in a normal cone.
bool closed_outward(const Part& part) {
  if (part.surface.triangles.empty()) return false;
  const MeshReport report = report_mesh(part.surface, 0.0);
  return report.closed && report.oriented && report.components == 1 && report.volume > 0.0;
}

/// The axis-aligned box around a turned box.
Aabb turned(const Aabb& box, const Pose& X, double grown) {
  const Vec3 center = X * box.center();
  const Vec3 half = X.R.cwiseAbs() * box.half() + Vec3::Constant(grown);
  return {center - half, center + half};
}

bool inside(const Aabb& small, const Aabb& large) {
  return (small.min.array() >= large.min.array()).all() && (small.max.array() <= large.max.array()).all();
}

}  // namespace

ContactFinder::ContactFinder(std::vector<CollisionBody> bodies, std::span<const Pose> X_WB,
                             const ContactFinderCapacity& capacity, double dt_s, double scale)
    : bodies_(std::move(bodies)),
      turn_(bodies_.size(), 0.0),
      last_X_WB_(X_WB.begin(), X_WB.end()),
      sweep_([&] {
        for (Index i = 0; i < bodies_.size(); ++i) {
          const Part& part = *bodies_[i].part;
          double radius = 0.0;
          Aabb box;
          for (const Vec3& vertex : part.surface.vertices) {
            radius = std::max(radius, vertex.norm());
            box.extend(vertex);
          }
          double bulge = bodies_[i].revolution.bulge_m;
          for (const RoundPiece& round : bodies_[i].rounds) bulge = std::max(bulge, round.bulge_m);
          radius_.push_back(radius);
          bulge_.push_back(bulge);
          cores_.push_back(core_of(bodies_[i]));
          trusted_.push_back(closed_outward(part) ? 1 : 0);
          turned_.push_back(bodies_[i].moves && trusted_.back() != 0 && !part.is_surface() &&
                            bodies_[i].rounds.empty() && !bodies_[i].revolution.circles.empty());
          part_box_.push_back({box.min - Vec3::Constant(bulge), box.max + Vec3::Constant(bulge)});
          box_growth_.push_back(kBoxGrowth * radius);
          fat_box_.push_back(turned(part_box_.back(), X_WB[i], box_growth_.back()));
        }
        return SweepAndPrune(fat_box_);
      }()),
      flush_bodies_(bodies_.size(), capacity.patches),
      steady_(dt_s, scale),
      head_start_(frames_in(kHeadStart_s, dt_s)) {
  unproven_frames_ = frames_in(kUnproven_s, dt_s);
  travel_.assign(bodies_.size(), 0.0);
  paths_.resize(bodies_.size());
  met_.reserve(kMostMet);
  overlaps_.reserve(kMostOverlaps);
  lists_.resize(sweep_.room());
  pairs_.reserve(capacity.pairs);
  renewed_.reserve(capacity.pairs);
  near_pieces_.reserve(capacity.pairs);
  priority_.reserve(bodies_.size());
  motion_bound_.reserve(bodies_.size());
  due_.reserve(capacity.pairs);
  emitted_.reserve(capacity.pairs);
  blocked_.assign(bodies_.size(), 0);
  patches_.reserve(capacity.patches);
  candidates_.reserve(capacity.patches);
  internal_.reserve(capacity.patches);
  candidate_order_.reserve(capacity.patches);
  minima_.reserve(capacity.minima);
  reduction_scratch_.reserve(capacity.minima);
  kept_minima_ = capacity.kept_minima;
}

void ContactFinder::find_near_pairs(std::span<const Pose> X_WB, std::span<const double> motion_bound,
                                    double min_tolerance) noexcept {
  work_ = {};
  work_.bodies = static_cast<int>(bodies_.size());
  motion_bound_.assign(motion_bound.begin(), motion_bound.end());  // within what was reserved
  min_tolerance_ = min_tolerance;
  ++frame_;
  move_boxes(X_WB);
  const bool lists_hold = std::all_of(sweep_.pairs().begin(), sweep_.pairs().end(),
                                      [&](const auto& near) { return list_holds(near); });
  if (!lists_hold) renew_lists(X_WB);
  work_.near_pairs = static_cast<int>(pairs_.size());
}

void ContactFinder::move_boxes(std::span<const Pose> X_WB) noexcept {
  bool moved = false;
  for (Index i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].moves) continue;
    travel_[i] += displacement(last_X_WB_[i], X_WB[i], radius_[i]);
    turn_[i] = (X_WB[i].R - last_X_WB_[i].R).norm() / std::numbers::sqrt2;
    last_X_WB_[i] = X_WB[i];
    const double needed = std::max(motion_bound_[i], min_tolerance_);
    const Aabb tight = turned(part_box_[i], X_WB[i], needed);
    if (inside(tight, fat_box_[i])) continue;
    fat_box_[i] = turned(part_box_[i], X_WB[i], needed + box_growth_[i]);
    sweep_.move(static_cast<int>(i), fat_box_[i]);
    moved = true;
  }
  if (!moved) return;
  sweep_.update();
  work_.broad_phase_runs = 1;
}

bool ContactFinder::may_touch(const SweepAndPrune::Pair& near) const noexcept {
  const CollisionBody& a = bodies_[Index(near.a)];
  const CollisionBody& b = bodies_[Index(near.b)];
  return (a.moves || b.moves) && a.no_contact_with != near.b && b.no_contact_with != near.a;
}

bool ContactFinder::list_holds(const SweepAndPrune::Pair& near) noexcept {
  if (!may_touch(near)) return true;
  const BodyPair& list = list_of(near);
  const double moved = accumulated_motion(near.a, near.b) - list.accumulated_motion;
  return list.renewal == renewal_ &&
         moved + tolerance(near.a, near.b) + greatest_bulge(near.a, near.b) <= list.range;
}

void ContactFinder::renew_lists(std::span<const Pose> X_WB) noexcept {
  work_.broad_phase_runs = 1;
  renewed_.clear();
  for (const SweepAndPrune::Pair& near : sweep_.pairs()) {
    if (!may_touch(near)) continue;
    BodyPair& list = list_of(near);
    const Index first = renewed_.size();
    if (list_holds(near)) {
      const Index room = renewed_.capacity() - renewed_.size();
      list.cut_short = list.cut_short || Index(list.count) > room;
      for (Index i = 0; i < std::min(Index(list.count), room); ++i)
        renewed_.push_back(pairs_[Index(list.first) + i]);
    } else {
      const BodyPair old = list;
      list.accumulated_motion = accumulated_motion(near.a, near.b);
      list.range = tolerance(near.a, near.b) + greatest_bulge(near.a, near.b) +
                   std::min(box_growth_[Index(near.a)], box_growth_[Index(near.b)]);
      list.cut_short =
          !collect(near.a, near.b, relative_pose(X_WB[Index(near.a)], X_WB[Index(near.b)]), list.range);
      append_pairs(near.a, near.b, old);
    }
    list.first = static_cast<std::int32_t>(first);
    list.count = static_cast<std::int32_t>(renewed_.size() - first);
    list.renewal = renewal_ + 1;
  }
  ++renewal_;  // a pair of bodies that is not near now has an older number, and no list any more
  pairs_.swap(renewed_);
}

/// The near pieces of two bodies, sorted. False when the room did not suffice.
bool ContactFinder::collect(int a, int b, const Pose& X_AB, double range) noexcept {
  near_pieces_.clear();
  if (has_surface(a, b)) return true;
  const Index room = renewed_.capacity() - renewed_.size();
  const bool complete =
      for_each_pair_within(bodies_[Index(a)].part->hierarchy, bodies_[Index(b)].part->hierarchy, X_AB, range,
                           [&](int piece_a, int piece_b) {
                             if (near_pieces_.size() == room) return false;
                             near_pieces_.emplace_back(piece_a, piece_b);
                             return true;
                           });
  std::sort(near_pieces_.begin(), near_pieces_.end());
  return complete;
}

/// Makes pairs of the near pieces. Those of the old list are kept: both are sorted, so one pass along both
/// suffices. A pair that is not on it was beyond its range.
void ContactFinder::append_pairs(int a, int b, const BodyPair& old) noexcept {
  const bool known = old.renewal == renewal_;
  Index from = known ? Index(old.first) : 0;
  const Index end = known ? from + Index(old.count) : 0;
  const auto pieces_of = [](const Pair& pair) { return std::pair(pair.piece_a, pair.piece_b); };
  for (const auto& pieces : near_pieces_) {
    while (from < end && pieces_of(pairs_[from]) < pieces) ++from;
    if (from < end && pieces_of(pairs_[from]) == pieces) {
      renewed_.push_back(pairs_[from]);
      continue;
    }
    Pair& pair = renewed_.emplace_back();
    pair.body_a = a;
    pair.body_b = b;
    pair.piece_a = pieces.first;
    pair.piece_b = pieces.second;
    if (known && !old.cut_short) pair.free_until = old.accumulated_motion + old.range;
  }
}

}  // namespace tactum::inline v0_1
