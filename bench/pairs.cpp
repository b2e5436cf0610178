#include "bench/pairs.h"

#include <algorithm>
#include <utility>

namespace tactum::bench {
namespace {

using Progress = std::function<void(const std::string&)>;

/// Our engine gets every pose; this only bounds a run in which it fails.
constexpr double kOurBudget_s = 20.0;
constexpr double kEdgePairs_per_s = 1e8;
constexpr int kQuickFrames = 200;
constexpr const char* kDeep = "deep";
constexpr std::uint64_t kSeed = 7;

/// The state common to the runs of both commands: the meter and the report that grows.
class PairsRun {
 public:
  explicit PairsRun(const PairsOptions& options) : options_(options), meter_(options.replays) {}

  bool skips(const Pair& pair) const {
    const bool is_quick = pair.name() == "box/box" || pair.name() == "sphere162/sphere162";
    return !wanted(options_.shapes, pair.name()) || (options_.quick && options_.shapes.empty() && !is_quick);
  }

  int frames() const { return options_.quick ? kQuickFrames : options_.frames; }

  /// Measures all engines on one recording.
  void measure_all(const Pair& pair, const Regime& regime, const Recording& recording,
                   std::unique_ptr<Engine> (*make_ours)()) {
    const Shape& a = shape(pair.a);
    const Shape& b = shape(pair.b);
    const double referee_s = options_.quick ? 0.1 : options_.referee_s;
    const std::vector<Truth> truth = truths(a, b, recording, referee_s * kEdgePairs_per_s);
    report_.recorded += static_cast<long>(truth.size());
    report_.proved += std::count_if(truth.begin(), truth.end(), [](const Truth& one) { return one.proved; });

    const auto measure = [&](Engine& engine, const std::string& name, double budget_s) {
      Row row = meter_.measure(engine, recording, truth, regime.cold, budget_s);
      row.shape_a = pair.a;
      row.shape_b = pair.b;
      row.vertices = std::max(a.vertices(), b.vertices());
      row.regime = regime.name;
      row.engine = name;
      report_.rows.push_back(row);
    };
    if (wanted(options_.engines, kOurs)) {
      const std::unique_ptr<Engine> ours = make_ours();
      ours->hold(a, b);
      measure(*ours, kOurs, kOurBudget_s);
    }
    for (const EngineEntry& entry : peers()) {
      if (!wanted(options_.engines, entry.name)) continue;
      const std::unique_ptr<Engine> peer = entry.make();
      const bool answers = regime.overlapping() ? peer->reports_depths() : peer->reports_distances();
      if (answers && peer->hold(a, b))
        measure(*peer, entry.name, options_.quick ? 0.01 : options_.peer_budget_s);
    }
  }

  PairsReport finish() {
    report_.how = meter_.describe();
    return std::move(report_);
  }

 private:
  const PairsOptions& options_;
  Meter meter_;
  PairsReport report_;
};

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

std::span<const Pair> depth_pairs() {
  static const std::vector<Pair> list = {
      {"box", "box"},       {"prism16", "prism16"},     {"sphere42", "sphere42"}, {"prism64", "prism64"},
      {"box", "hull200"},   {"sphere162", "sphere162"}, {"hull200", "hull200"},   {"hull500", "hull500"},
      {"needle", "needle"}, {"plate", "plate"},         {"needle", "plate"},      {"needle", "box"},
      {"plate", "box"},     {"spindle162", "sphere42"}};
  return list;
}

const std::vector<Regime>& depth_regimes() {
  static const std::vector<Regime> list = [] {
    std::vector<Regime> all = regimes();
    std::erase_if(all, [](const Regime& regime) { return !regime.overlapping(); });
    all.push_back({kDeep, -1.0, 0.0});
    return all;
  }();
  return list;
}

std::vector<std::string> engine_names() {
  std::vector<std::string> names = {kOurs};
  for (const EngineEntry& peer : peers()) names.push_back(peer.name);
  return names;
}

PairsReport bench_pairs(const PairsOptions& options, const Progress& progress) {
  PairsRun run(options);
  for (const Pair& pair : distance_pairs()) {
    if (run.skips(pair)) continue;
    progress(pair.name());
    for (const Regime& regime : regimes()) {
      if (!wanted(options.regimes, regime.name)) continue;
      const Recording recording = record(shape(pair.a), shape(pair.b), regime, run.frames(), kSeed);
      run.measure_all(pair, regime, recording, make_closest_features);
    }
  }
  return run.finish();
}

PairsReport bench_penetration(const PairsOptions& options, const Progress& progress) {
  PairsRun run(options);
  for (const Pair& pair : depth_pairs()) {
    if (run.skips(pair)) continue;
    progress(pair.name());
    for (const Regime& regime : depth_regimes()) {
      if (!wanted(options.regimes, regime.name)) continue;
      const Shape& a = shape(pair.a);
      const Shape& b = shape(pair.b);
      const Recording recording = regime.name == kDeep ? record_deep(a, b, run.frames(), kSeed)
                                                       : record(a, b, regime, run.frames(), kSeed);
      run.measure_all(pair, regime, recording, make_penetration);
    }
  }
  return run.finish();
}

}  // namespace tactum::bench
