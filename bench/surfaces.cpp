#include "bench/surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "bench/clock.h"
#include "bench/surfaces_pairs.h"
#include "tactum/surface/surface_minima.h"

namespace tactum::bench {
namespace {

constexpr double kConeInflation_rad = 4e-3;

double ns_between(const FineClock& clock, std::uint64_t start) { return clock.ns(clock.stop() - start); }

/// Mean over as many of the poses as fit into the budget, spread over the motion.
double mean_ns(const FineClock& clock, SurfacePeer& peer, const std::vector<Pose>& poses, double budget_s) {
  double sum_ns = 0.0;
  int asked = 0;
  constexpr std::size_t kStride = 7;
  for (std::size_t i = 0; i < poses.size() && sum_ns < 1e9 * budget_s; ++i, ++asked) {
    const std::uint64_t start = clock.start();
    peer.query(poses[i * kStride % poses.size()]);
    sum_ns += ns_between(clock, start);
  }
  return sum_ns / std::max(asked, 1);
}

void measure(const FineClock& clock, const SurfacePair& pair, int replays, SurfacesRow& row) {
  const std::uint64_t start = clock.start();
  const SurfaceTree a(pair.a);
  const SurfaceTree b(pair.b);
  row.build_s = 1e-9 * ns_between(clock, start);
  row.triangles_a = a.triangle_count();
  row.triangles_b = b.triangle_count();
  row.bytes_per_triangle =
      std::max(double(a.memory()) / row.triangles_a, double(b.memory()) / row.triangles_b);
  row.frames = static_cast<int>(pair.X_AB.size());
  std::vector<SurfaceMinimum> minima;
  minima.reserve(1 << 16);
  std::vector<double> fastest(pair.X_AB.size(), 1e18);
  const MinimaQuery query{row.tolerance_m, 0.0, kConeInflation_rad};
  for (int replay = 0; replay < replays; ++replay) {
    for (std::size_t i = 0; i < pair.X_AB.size(); ++i) {
      const std::uint64_t from = clock.start();
      const MinimaWork work = surface_minima(a, b, pair.X_AB[i], query, minima);
      fastest[i] = std::min(fastest[i], ns_between(clock, from));
      if (replay > 0) continue;
      row.minima_mean += work.minima;
      row.minima_max = std::max(row.minima_max, work.minima);
      row.leaf_pairs_mean += work.leaf_pairs;
      row.feature_pairs_mean += work.feature_pairs;
    }
  }
  for (double* sum : {&row.minima_mean, &row.leaf_pairs_mean, &row.feature_pairs_mean}) *sum /= row.frames;
  std::sort(fastest.begin(), fastest.end());
  const auto at = [&](double share) { return fastest[std::size_t(share * double(fastest.size() - 1))]; };
  row.mean_ns = std::accumulate(fastest.begin(), fastest.end(), 0.0) / row.frames;
  row.p50_ns = at(0.5);
  row.p99_ns = at(0.99);
  row.p999_ns = at(0.999);
  row.max_ns = fastest.back();
}

std::string ratio_text(double peer_ns, double own_ns) {
  return peer_ns > 0.0 ? fmt::format("{} ({:.0f}x)", time_text(peer_ns), peer_ns / own_ns) : "-";
}

}  // namespace

std::vector<std::string> surface_pair_names() {
  std::vector<std::string> names;
  for (const SurfacePairEntry& entry : surface_pairs()) names.push_back(entry.name);
  return names;
}

SurfacesReport bench_surfaces(const SurfacesOptions& options,
                              const std::function<void(const std::string&)>& progress) {
  const FineClock clock;
  SurfacesReport report;
  std::string absent;
  for (const SurfacePairEntry& entry : surface_pairs()) {
    const auto& asked = options.pairs;
    if (!asked.empty() && std::find(asked.begin(), asked.end(), entry.name) == asked.end()) continue;
    if (options.quick && entry.large) continue;
    progress(entry.name);
    const std::optional<SurfacePair> pair = entry.make(options);
    if (!pair) {
      absent += (absent.empty() ? "" : ", ") + entry.name;
      continue;
    }
    SurfacesRow row;
    row.pair = entry.name;
    row.tolerance_m = entry.tolerance_m;
    measure(clock, *pair, options.replays, row);
    [[maybe_unused]] const auto ask = [&](const std::unique_ptr<SurfacePeer>& peer) {
      return mean_ns(clock, *peer, pair->X_AB, options.quick ? 0.0 : options.peer_budget_s);
    };
#ifdef TACTUM_PEER_FCL
    row.fcl_mean_ns = ask(make_fcl_surfaces(pair->a, pair->b, entry.tolerance_m));
#endif
#ifdef TACTUM_PEER_BULLET
    row.gimpact_mean_ns = ask(make_gimpact_surfaces(pair->a, pair->b, entry.tolerance_m));
#endif
    report.rows.push_back(row);
  }
  report.how = fmt::format(
      "All minima within the tolerance, cones inflated by {} mrad; each pose counts with its fastest of {} "
      "replays. FCL: "
      "distance of two BVHModel<OBBRSS>, asked once a pose, mean. Clock: {}.",
      1e3 * kConeInflation_rad, options.replays, clock.describe());
  if (!absent.empty()) report.how += fmt::format(" Not measured, for the data is absent: {}.", absent);
  return report;
}

Table table_of(const SurfacesReport& report) {
  Table table;
  table.rows.push_back({"pair", "triangles", "within", "minima", "leaf pairs", "feature pairs", "mean", "p50",
                        "p99", "p99.9", "max", "bytes a triangle", "FCL distance", "GImpact"});
  for (const SurfacesRow& row : report.rows) {
    table.rows.push_back(
        {row.pair, fmt::format("{} / {}", row.triangles_a, row.triangles_b), length_text(row.tolerance_m),
         fmt::format("{:.0f} / {}", row.minima_mean, row.minima_max),
         fmt::format("{:.0f}", row.leaf_pairs_mean), fmt::format("{:.0f}", row.feature_pairs_mean),
         time_text(row.mean_ns), time_text(row.p50_ns), time_text(row.p99_ns), time_text(row.p999_ns),
         time_text(row.max_ns), fmt::format("{:.0f}", row.bytes_per_triangle),
         ratio_text(row.fcl_mean_ns, row.mean_ns), ratio_text(row.gimpact_mean_ns, row.mean_ns)});
  }
  return table;
}

nlohmann::ordered_json to_json(const SurfacesRow& row) {
  return {{"pair", row.pair},
          {"triangles_a", row.triangles_a},
          {"triangles_b", row.triangles_b},
          {"tolerance_m", row.tolerance_m},
          {"frames", row.frames},
          {"minima_mean", row.minima_mean},
          {"minima_max", row.minima_max},
          {"leaf_pairs_mean", row.leaf_pairs_mean},
          {"feature_pairs_mean", row.feature_pairs_mean},
          {"mean_ns", row.mean_ns},
          {"p50_ns", row.p50_ns},
          {"p99_ns", row.p99_ns},
          {"p999_ns", row.p999_ns},
          {"max_ns", row.max_ns},
          {"bytes_per_triangle", row.bytes_per_triangle},
          {"build_s", row.build_s},
          {"fcl_mean_ns", row.fcl_mean_ns},
          {"gimpact_mean_ns", row.gimpact_mean_ns}};
}

}  // namespace tactum::bench
