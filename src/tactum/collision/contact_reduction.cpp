#include "tactum/collision/contact_reduction.h"

#include <algorithm>
#include <utility>

namespace tactum {
namespace {

constexpr double kFarthest = 1e300;

/// By how much a step within the bounds can overstep `dropped` when it oversteps `kept` by nothing.
double error_of(const SurfaceMinimum& dropped, const SurfaceMinimum& kept,
                const ReductionBounds& bounds) noexcept {
  const Vec3 lever_dropped = (dropped.p_b - bounds.center).cross(dropped.normal);
  const Vec3 lever_kept = (kept.p_b - bounds.center).cross(kept.normal);
  return std::max(0.0, kept.distance - dropped.distance) +
         (dropped.normal - kept.normal).norm() * bounds.max_translation +
         (lever_dropped - lever_kept).norm() * bounds.max_rotation;
}

}  // namespace

ReductionReport reduce_contacts(std::span<SurfaceMinimum> minima, std::span<double> error, std::size_t room,
                                const ReductionBounds& bounds) noexcept {
  ReductionReport report;
  report.dropped = static_cast<int>(minima.size());
  if (minima.empty()) return report;
  std::fill(error.begin(), error.end(), kFarthest);
  const std::size_t most = std::min(room, minima.size());
  for (std::size_t kept = 0; kept < most; ++kept) {
    std::size_t next = kept;
    for (std::size_t i = kept + 1; i < minima.size(); ++i) {
      const bool better = kept == 0 ? minima[i].distance < minima[next].distance : error[i] > error[next];
      if (better) next = i;
    }
    if (kept > 0 && error[next] <= bounds.enough) break;
    std::swap(minima[kept], minima[next]);
    std::swap(error[kept], error[next]);
    for (std::size_t i = kept + 1; i < minima.size(); ++i) {
      error[i] = std::min(error[i], error_of(minima[i], minima[kept], bounds));
    }
    ++report.kept;
    --report.dropped;
  }
  for (std::size_t i = std::size_t(report.kept); i < minima.size(); ++i)
    report.largest_error = std::max(report.largest_error, error[i]);
  return report;
}

}  // namespace tactum
