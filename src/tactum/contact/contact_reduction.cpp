#include "tactum/contact/contact_reduction.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactum::inline v0_1 {
namespace {

constexpr double kFarthest = 1e300;

using Scratch = std::span<ReductionScratch>;
using Index = std::size_t;

/// The smaller of the error of `dropped` so far and of the most by which a step can overstep `dropped` when
/// it oversteps `kept` by nothing. Most prove to be the larger one without a root.
double lowered_error(const ReductionScratch& dropped, const ReductionScratch& kept) noexcept {
  const double nearer = std::max(0.0, kept.distance - dropped.distance);
  const double left = dropped.error - nearer;
  const double push_sq = (dropped.push - kept.push).squaredNorm();
  const double turn_sq = (dropped.turn - kept.turn).squaredNorm();
  if (!(left > 0.0) || push_sq >= left * left || turn_sq >= left * left) return dropped.error;
  return std::min(dropped.error, nearer + std::sqrt(push_sq) + std::sqrt(turn_sq));
}

/// Whether two are so far apart that a minimum within `error` of one is no nearer to the other: the triangle
/// inequality.
bool far_apart(const ReductionScratch& a, const ReductionScratch& b, double error) noexcept {
  const double least_sq = 4.0 * error * error;
  return (a.push - b.push).squaredNorm() >= least_sq || (a.turn - b.turn).squaredNorm() >= least_sq;
}

/// The one of two candidates with the larger error; ties go to the lower index; -1 is none.
int farther(Scratch all, int a, int b) noexcept {
  if (a < 0 || b < 0) return std::max(a, b);
  const double of_a = all[Index(a)].error, of_b = all[Index(b)].error;
  if (of_a != of_b) return of_a > of_b ? a : b;
  return std::min(a, b);
}

void put(Scratch all, int candidate, Index group) noexcept {
  all[Index(candidate)].next = all[group].first;
  all[group].first = candidate;
  all[group].farthest = farther(all, all[group].farthest, candidate);
}

/// Compares the candidates of a group with the one kept last, which is dropped from the list; those that are
/// nearer to it than to their own move to the group `kept_last`.
void share_out(Scratch all, Index group, Index kept_last) noexcept {
  const int kept = all[kept_last].chosen;
  int next = std::exchange(all[group].first, -1);
  all[group].farthest = -1;
  while (next >= 0) {
    const int candidate = std::exchange(next, all[Index(next)].next);
    if (candidate == kept) continue;
    const double before = all[Index(candidate)].error;
    double& error = all[Index(candidate)].error;
    error = lowered_error(all[Index(candidate)], all[Index(kept)]);
    put(all, candidate, error < before ? kept_last : group);
  }
}

/// Keeps the nearest; all others form its group.
void keep_nearest(std::span<const SurfaceMinimum> minima, Scratch all,
                  const ReductionBounds& bounds) noexcept {
  Index nearest = 0;
  for (Index i = 0; i < minima.size(); ++i) {
    const SurfaceMinimum& minimum = minima[i];
    if (minimum.distance < minima[nearest].distance) nearest = i;
    all[i] = {.error = kFarthest,
              .push = minimum.normal * bounds.max_translation,
              .turn = (minimum.p_b - bounds.center).cross(minimum.normal) * bounds.max_rotation,
              .distance = minimum.distance};
  }
  all[0].chosen = static_cast<int>(nearest);
  for (Index i = 0; i < minima.size(); ++i) {
    if (i == nearest) continue;
    all[i].error = lowered_error(all[i], all[nearest]);
    put(all, static_cast<int>(i), 0);
  }
}

/// Puts the kept ones first, in the order of their choice.
void move_kept_first(std::span<SurfaceMinimum> minima, Scratch all, Index kept) noexcept {
  for (Index rank = 0; rank < kept; ++rank) {
    Index from = Index(all[rank].chosen);
    while (from < rank) from = Index(all[from].went);  // it was exchanged for one that was kept earlier
    std::swap(minima[rank], minima[from]);
    std::swap(all[rank].error, all[from].error);
    all[rank].went = static_cast<int>(from);
  }
}

}  // namespace

ReductionReport reduce_contacts(std::span<SurfaceMinimum> minima, std::span<ReductionScratch> scratch,
                                std::size_t room, const ReductionBounds& bounds) noexcept {
  const Scratch all = scratch.first(minima.size());
  ReductionReport report;
  report.dropped = static_cast<int>(minima.size());
  if (minima.empty() || room == 0) {
    for (ReductionScratch& one : all) one.error = kFarthest;
    report.largest_error = minima.empty() ? 0.0 : kFarthest;
    return report;
  }
  keep_nearest(minima, all, bounds);
  const Index most = std::min(room, minima.size());
  Index kept = 1;
  for (; kept < most; ++kept) {
    int next = -1;
    for (Index group = 0; group < kept; ++group) next = farther(all, next, all[group].farthest);
    if (all[Index(next)].error <= bounds.enough) break;
    all[kept].chosen = next;
    for (Index group = 0; group < kept; ++group) {
      if (all[group].first < 0) continue;
      const double error = all[Index(all[group].farthest)].error;
      if (all[group].farthest != next && far_apart(all[Index(all[group].chosen)], all[Index(next)], error))
        continue;
      share_out(all, group, kept);
    }
  }
  report.kept = static_cast<int>(kept);
  report.dropped -= report.kept;
  for (Index group = 0; group < kept; ++group)
    if (all[group].farthest >= 0)
      report.largest_error = std::max(report.largest_error, all[Index(all[group].farthest)].error);
  move_kept_first(minima, all, kept);
  return report;
}

}  // namespace tactum::inline v0_1
