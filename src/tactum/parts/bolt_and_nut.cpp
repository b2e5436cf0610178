#include "tactum/parts/bolt_and_nut.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "tactum/parts/thread_sheet.h"

namespace tactum::inline v0_1 {
namespace {

using detail::ThreadColumn;
using detail::ThreadRims;
using Hexagon = std::array<int, 6>;

/// Everything in one place: the profile in steps of P / n, so that its corners are whole numbers.
struct Thread {
  MetricScrew screw;
  int turn = 0;           ///< steps a turn: n
  double step_m = 0.0;    ///< P / n [m]
  double crest_m = 0.0;   ///< radius of ridge (bolt) or groove (nut) [m]
  double minor_m = 0.0;   ///< radius between the ridges [m]
  double length_m = 0.0;  ///< of a bolt [m]

  int half_crest() const { return turn / 16; }     // half of P / 8
  int half_foot() const { return 6 * turn / 16; }  // ... and both flanks of 5/16 P

  /// Radius so many steps from the middle of the ridge.
  double radius(int offset) const {
    const int from_middle = std::abs(offset);
    if (from_middle <= half_crest()) return crest_m;
    if (from_middle >= half_foot()) return minor_m;
    const double along = static_cast<double>(from_middle - half_crest()) / (half_foot() - half_crest());
    return crest_m + along * (minor_m - crest_m);
  }
};

Result<Thread> thread_of(const ScrewShape& shape, bool nut) {
  const Result<MetricScrew> screw = metric_screw(shape.size);
  if (!screw) return screw.error();
  const Result<ThreadFit> fit = screw_fit(shape);
  if (!fit) return fit.error();
  if (shape.facets_per_turn < 16 || shape.facets_per_turn > 256 || shape.facets_per_turn % 16 != 0)
    return Error{"the screw's number of facets per turn cannot be", fmt::format("{}", shape.facets_per_turn),
                 "a multiple of 16 from 16 to 256", ""};
  const double pitch = screw->pitch_m;
  if (!nut && !(shape.length_m >= 3.0 * pitch && shape.length_m <= 100.0 * pitch))
    return Error{"the bolt's length cannot be", fmt::format("{} m", shape.length_m),
                 fmt::format("{} to {} m (3 to 100 pitches)", 3.0 * pitch, 100.0 * pitch), ""};
  // The nut's facets touch the circles, the bolt's corners lie on them.
  const double deviation = nut ? fit->nut_m : fit->bolt_m;
  const double outside = nut ? 1.0 / std::cos(kPi / shape.facets_per_turn) : 1.0;
  return Thread{*screw,
                shape.facets_per_turn,
                pitch / shape.facets_per_turn,
                0.5 * (screw->major_m + deviation) * outside,
                0.5 * (screw->minor_m() + deviation) * outside,
                shape.length_m};
}

std::vector<ThreadColumn> bolt_columns(const Thread& thread) {
  std::vector<ThreadColumn> columns(static_cast<std::size_t>(thread.turn),
                                    {{detail::kLowEnd, thread.minor_m, 0.0}});
  const int first = thread.turn / 2;
  const int last = static_cast<int>(std::floor(thread.length_m / thread.step_m)) - thread.turn / 2;
  const double rise = 0.5 * thread.turn;
  for (int i = first; i <= last; ++i) {
    const double height = std::min({1.0, (i - first) / rise, (last - i) / rise});
    const double crest = thread.minor_m + height * (thread.crest_m - thread.minor_m);
    const int column = i % thread.turn;
    for (const int offset :
         {-thread.half_foot(), -thread.half_crest(), thread.half_crest(), thread.half_foot()}) {
      const double radius = std::abs(offset) == thread.half_foot() ? thread.minor_m : crest;
      columns[static_cast<std::size_t>(column)].push_back(
          {i - column + offset, radius, (i + offset) * thread.step_m});
    }
  }
  for (ThreadColumn& column : columns) column.push_back({detail::kHighEnd, thread.minor_m, thread.length_m});
  return columns;
}

std::vector<ThreadColumn> nut_columns(const Thread& thread, int height) {
  std::vector<ThreadColumn> columns;
  for (int k = 0; k < thread.turn; ++k) {
    ThreadColumn column;
    for (int z = 0; z <= height; ++z) {
      const int past = (z - k + 2 * thread.turn) % thread.turn;  // the last ridge's middle
      const int offset = past <= thread.turn / 2 ? past : past - thread.turn;
      const bool corner = std::abs(offset) == thread.half_foot() || std::abs(offset) == thread.half_crest();
      if (!corner && z != 0 && z != height) continue;
      const int end = z == 0 ? detail::kLowEnd : detail::kHighEnd;
      column.push_back({corner ? z - k : end, thread.radius(offset), z * thread.step_m});
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

Hexagon add_hexagon(double across_flats, double z, TriangleMesh& mesh) {
  Hexagon corners{};
  for (int i = 0; i < 6; ++i) {
    const double radius = across_flats / std::sqrt(3.0);
    corners[i] = static_cast<int>(mesh.vertices.size());
    mesh.vertices.emplace_back(radius * std::cos(kPi * i / 3.0), radius * std::sin(kPi * i / 3.0), z);
  }
  return corners;
}

void add_triangle(int a, int b, int c, bool upward, TriangleMesh& mesh) {
  if (upward) {
    mesh.triangles.push_back({a, b, c});
  } else {
    mesh.triangles.push_back({a, c, b});
  }
}

/// The flat face between a hexagon and the rim of a sheet: each corner sees the sixth of the rim before it.
void add_annulus(const Hexagon& outer, const std::vector<int>& rim, bool upward, TriangleMesh& mesh) {
  const int count = static_cast<int>(rim.size());
  const auto at = [&](int k) { return rim[static_cast<std::size_t>((k + count) % count)]; };
  int begin = 11 * count / 12 - count;
  for (int i = 0; i < 6; ++i) {
    const int end = (2 * i + 1) * count / 12;
    for (int k = begin; k < end; ++k) add_triangle(at(k), outer[i], at(k + 1), upward, mesh);
    add_triangle(outer[i], outer[(i + 1) % 6], at(end), upward, mesh);
    begin = end;
  }
}

void add_walls(const Hexagon& low, const Hexagon& high, TriangleMesh& mesh) {
  for (int i = 0; i < 6; ++i) {
    const int next = (i + 1) % 6;
    mesh.triangles.push_back({low[i], low[next], high[next]});
    mesh.triangles.push_back({low[i], high[next], high[i]});
  }
}

}  // namespace

Result<ThreadFit> screw_fit(const ScrewShape& shape) {
  if (!shape.clearance_m) return thread_fit(shape.size, shape.tolerance_class);
  const Result<MetricScrew> screw = metric_screw(shape.size);
  if (!screw) return screw.error();
  const double most = screw->pitch_m / 8.0;  // half the profile's depth cannot be had at 0.27 pitches
  if (!(*shape.clearance_m >= 0.0 && *shape.clearance_m <= most))
    return Error{"the thread's clearance cannot be", fmt::format("{} m", *shape.clearance_m),
                 fmt::format("0 to {} m (an eighth of the pitch)", most), ""};
  return thread_fit_with(*shape.clearance_m);
}

Result<TriangleMesh> bolt_mesh(const ScrewShape& shape) {
  const Result<Thread> thread = thread_of(shape, false);
  if (!thread) return thread.error();
  TriangleMesh mesh;
  const ThreadRims rims = detail::add_thread_sheet(bolt_columns(*thread), thread->turn, false, mesh);
  const int tip = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0, 0.0, thread->length_m);
  for (std::size_t k = 0; k < rims.high.size(); ++k)
    add_triangle(tip, rims.high[k], rims.high[(k + 1) % rims.high.size()], true, mesh);
  const Hexagon seat = add_hexagon(thread->screw.across_flats_m, 0.0, mesh);
  const Hexagon end = add_hexagon(thread->screw.across_flats_m, -thread->screw.head_height_m, mesh);
  add_annulus(seat, rims.low, true, mesh);
  add_walls(end, seat, mesh);
  for (int i = 1; i < 5; ++i) add_triangle(end[0], end[i], end[i + 1], false, mesh);
  return mesh;
}

Result<TriangleMesh> nut_mesh(const ScrewShape& shape) {
  const Result<Thread> thread = thread_of(shape, true);
  if (!thread) return thread.error();
  const int height = static_cast<int>(std::lround(thread->screw.nut_height_m / thread->step_m));
  TriangleMesh mesh;
  const ThreadRims rims = detail::add_thread_sheet(nut_columns(*thread, height), thread->turn, true, mesh);
  const Hexagon low = add_hexagon(thread->screw.across_flats_m, 0.0, mesh);
  const Hexagon high = add_hexagon(thread->screw.across_flats_m, height * thread->step_m, mesh);
  add_annulus(low, rims.low, false, mesh);
  add_annulus(high, rims.high, true, mesh);
  add_walls(low, high, mesh);
  return mesh;
}

}  // namespace tactum::inline v0_1
