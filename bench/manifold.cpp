#include "bench/manifold.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "tactum/base/frame_rate.h"
#include "tactum/collision/manifold.h"
#include "tactum/contact/steady_contact.h"

namespace tactum::bench {
namespace {

constexpr double kTolerance_m = 0.1e-3;

/// The patch alone: the closest features are given.
class Patch final : public Engine {
 public:
  bool hold(const Shape& a, const Shape& b) override {
    a_ = &a.polytope;
    b_ = &b.polytope;
    return true;
  }
  void forget() override {}
  void place(const Recording& recording, std::size_t i) override {
    X_AB_ = &recording.poses[i];
    closest_ = &recording.answers[i];
  }
  void query() override { contact_manifold(*a_, *b_, *X_AB_, *closest_, kTolerance_m, patch_); }
  Answer answer() const override { return {!patch_.points.empty(), closest_->distance, 0}; }

 private:
  const Polytope* a_ = nullptr;
  const Polytope* b_ = nullptr;
  const Pose* X_AB_ = nullptr;
  const PairDistance* closest_ = nullptr;
  Manifold patch_;
};

struct Centres {
  Vec3 centroid, pressure;
};

std::optional<Centres> centres_of(const Manifold& patch) {
  Vec3 centroid = Vec3::Zero();
  Vec3 pressure = Vec3::Zero();
  double weight = 0.0;
  double force = 0.0;
  for (const ContactPoint& point : patch.points) {
    const Vec3 middle = 0.5 * (point.p_a + point.p_b);
    const double share = point.weight * std::max(0.0, kTolerance_m - point.distance);
    centroid += point.weight * middle;
    weight += point.weight;
    pressure += share * middle;
    force += share;
  }
  if (!(weight > 0.0) || !(force > 0.0)) return std::nullopt;
  return Centres{centroid / weight, pressure / force};
}

void measure_steadiness(const Shape& a, const Shape& b, const Recording& recording, ManifoldRow& row) {
  std::optional<Centres> last;
  std::optional<Centres> last_shown;
  SteadyContact memory;
  std::vector<double> steps;
  for (std::size_t i = 0; i < recording.poses.size(); ++i) {
    Manifold patch;
    contact_manifold(a.polytope, b.polytope, recording.poses[i], recording.answers[i], kTolerance_m, patch);
    const std::optional<Centres> now = centres_of(patch);
    if (now && last) {
      steps.push_back((now->centroid - last->centroid).norm());
      row.pressure_max_m = std::max(row.pressure_max_m, (now->pressure - last->pressure).norm());
    }
    last = now;
    steady_centroid(recording.poses[i], patch, SteadyLimits(kReferenceStep_s), memory);
    const std::optional<Centres> shown = centres_of(patch);
    if (shown && last_shown)
      row.shown_max_m = std::max(row.shown_max_m, (shown->centroid - last_shown->centroid).norm());
    last_shown = shown;
  }
  std::sort(steps.begin(), steps.end());
  if (steps.empty()) return;
  row.centroid_p999_m = steps[steps.size() * 999 / 1000];
  row.centroid_max_m = steps.back();
}

}  // namespace

std::span<const Pair> patch_pairs() {
  static const std::vector<Pair> list = {
      {"box", "box"},       {"prism16", "prism16"}, {"prism64", "prism64"}, {"box", "prism64"},
      {"plate", "plate"},   {"plate", "box"},       {"needle", "plate"},    {"needle", "needle"},
      {"box", "sphere162"}, {"box", "hull2000"},    {"hull200", "hull200"}, {"sphere642", "sphere642"}};
  return list;
}

ManifoldReport bench_manifold(const PairsOptions& options,
                              const std::function<void(const std::string&)>& progress) {
  Meter meter(options.replays);
  ManifoldReport report;
  for (const Pair& pair : patch_pairs()) {
    if (!wanted(options.shapes, pair.name())) continue;
    progress(pair.name());
    const Shape& a = shape(pair.a);
    const Shape& b = shape(pair.b);
    for (const Rest rest : {Rest::kSliding, Rest::kRocking}) {
      const Recording recording = record_rest(a, b, rest, options.quick ? 200 : options.frames, 11);
      Patch engine;
      engine.hold(a, b);
      ManifoldRow row;
      row.row = meter.measure(engine, recording, truths(a, b, recording), false, 10.0);
      row.row.shape_a = pair.a;
      row.row.shape_b = pair.b;
      row.row.vertices = std::max(a.vertices(), b.vertices());
      row.row.regime = rest == Rest::kSliding ? "sliding" : "rocking";
      row.row.engine = kOurs;
      measure_steadiness(a, b, recording, row);
      report.rows.push_back(row);
    }
  }
  report.how = meter.describe();
  return report;
}

Table table_of(const ManifoldReport& report) {
  Table table;
  table.left = 2;
  table.rows.push_back({"pair", "regime", "vertices", "median", "p99", "p99.9", "max", "missed",
                        "centroid p99.9", "centroid max", "pressure max", "shown max"});
  for (const ManifoldRow& one : report.rows)
    table.rows.push_back(
        {one.row.shape_a + "/" + one.row.shape_b, one.row.regime, fmt::to_string(one.row.vertices),
         time_text(one.row.median_ns), time_text(one.row.p99_ns), time_text(one.row.p999_ns),
         time_text(one.row.max_ns), fmt::to_string(one.row.missed), length_text(one.centroid_p999_m),
         length_text(one.centroid_max_m), length_text(one.pressure_max_m), length_text(one.shown_max_m)});
  return table;
}

nlohmann::ordered_json to_json(const ManifoldRow& row) {
  nlohmann::ordered_json json = to_json(row.row);
  json["centroid_p999_m"] = row.centroid_p999_m;
  json["centroid_max_m"] = row.centroid_max_m;
  json["pressure_max_m"] = row.pressure_max_m;
  json["shown_max_m"] = row.shown_max_m;
  return json;
}

}  // namespace tactum::bench
