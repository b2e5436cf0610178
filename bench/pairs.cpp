#include "bench/pairs.h"

namespace tactum::bench {
namespace {

/// Our engine is asked about every pose; this only bounds a run where it has gone wrong.
constexpr double kOurBudget_s = 20.0;

bool can_answer(const Engine& engine, const Regime& regime) {
  return regime.overlapping() ? engine.tells_depths() : engine.tells_distances();
}

}  // namespace

std::span<const Pair> distance_pairs() {
  static const std::vector<Pair> list = {{"box", "box"},
                                         {"sphere12", "sphere12"},
                                         {"prism16", "prism16"},
                                         {"sphere42", "sphere42"},
                                         {"prism64", "prism64"},
                                         {"sphere162", "sphere162"},
                                         {"hull200", "hull200"},
                                         {"sphere642", "sphere642"},
                                         {"hull2000", "hull2000"},
                                         {"sphere2562", "sphere2562"},
                                         {"sphere10242", "sphere10242"},
                                         {"hull20000", "hull20000"},
                                         {"sphere40962", "sphere40962"},
                                         {"needle", "needle"},
                                         {"plate", "plate"},
                                         {"needle", "plate"},
                                         {"spindle642", "ellipsoid642"},
                                         {"box", "sphere2562"}};
  return list;
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names = {kOurs};
  for (const EngineEntry& peer : peers()) names.push_back(peer.name);
  return names;
}

PairsReport bench_pairs(const PairsOptions& options,
                        const std::function<void(const std::string&)>& progress) {
  const Meter meter(options.replays);
  PairsReport report;
  report.how = meter.describe();
  const auto measure = [&](Engine& engine, const std::string& name, const Pair& pair, const Regime& regime,
                           const Recording& recording, const std::vector<Truth>& truth, double budget_s) {
    Row row = meter.measure(engine, recording, truth, regime.cold, budget_s);
    row.shape_a = pair.a;
    row.shape_b = pair.b;
    row.vertices = std::max(shape(pair.a).vertices(), shape(pair.b).vertices());
    row.regime = regime.name;
    row.engine = name;
    report.rows.push_back(row);
  };
  for (const Pair& pair : distance_pairs()) {
    const bool is_quick = pair.name() == "box/box" || pair.name() == "sphere162/sphere162";
    if (!wanted(options.shapes, pair.name()) || (options.quick && options.shapes.empty() && !is_quick))
      continue;
    progress(pair.name());
    const Shape& a = shape(pair.a);
    const Shape& b = shape(pair.b);
    for (const Regime& regime : regimes()) {
      if (!wanted(options.regimes, regime.name)) continue;
      const Recording recording = record(a, b, regime, options.quick ? 200 : options.frames, 7);
      const std::vector<Truth> truth = truths(a, b, recording);
      report.recorded += static_cast<long>(truth.size());
      for (const Truth& one : truth) report.proved += one.proved ? 1 : 0;
      if (wanted(options.engines, kOurs)) {
        const std::unique_ptr<Engine> ours = make_closest_features();
        ours->hold(a, b);
        measure(*ours, kOurs, pair, regime, recording, truth, kOurBudget_s);
      }
      for (const EngineEntry& entry : peers()) {
        if (!wanted(options.engines, entry.name)) continue;
        const std::unique_ptr<Engine> peer = entry.make();
        if (!can_answer(*peer, regime) || !peer->hold(a, b)) continue;
        measure(*peer, entry.name, pair, regime, recording, truth,
                options.quick ? 0.01 : options.peer_budget_s);
      }
    }
  }
  return report;
}

}  // namespace tactum::bench
