#include "bench/impact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tactum/base/random.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/time_of_impact.h"
#include "tactum/math/screw.h"

namespace tactum::bench {
namespace {

constexpr double kFrame_s = 1e-3;
constexpr double kTarget_m = 5e-6;

class Impact final : public Engine {
 public:
  bool hold(const Shape& a, const Shape& b) override {
    a_ = &a.polytope;
    b_ = &b.polytope;
    return true;
  }
  void forget() override { cache_ = {}; }
  void place(const Recording& recording, std::size_t i) override {
    X_AB_ = recording.poses[i];
    V_AB_ = recording.twists[i];
  }
  void query() override {
    found = time_of_impact(*a_, {}, {}, *b_, X_AB_, V_AB_, kFrame_s, kTarget_m, cache_);
  }
  Answer answer() const override {
    return {found.status != ImpactStatus::kBounded, found.closest.distance, found.steps};
  }

  TimeOfImpact found;

 private:
  const Polytope* a_ = nullptr;
  const Polytope* b_ = nullptr;
  Pose X_AB_;
  Twist V_AB_;
  PairCache cache_;
};

/// Up to 1 m/s at A and 0.3 m/s beside it, and up to 5 rad/s about each axis.
void add_twists(Recording& recording) {
  Random random(13);
  for (const PairDistance& answer : recording.answers) {
    Twist V;
    V.v = random.uniform(0.1, 1.0) * answer.normal;
    for (int k = 0; k < 3; ++k) V.v[k] += random.uniform(-0.3, 0.3);
    for (int k = 0; k < 3; ++k) V.w[k] = random.uniform(-5.0, 5.0);
    recording.twists.push_back(V);
  }
}

/// The gap during a frame, and when it first falls to the target: sampled at many instants, then bisected.
class Watch {
 public:
  Watch(const Shape& a, const Shape& b, const Pose& X_AB, const Twist& V_AB)
      : a_(a.polytope), b_(b.polytope), X_AB_(X_AB), V_AB_(V_AB) {}

  double gap(double time_s) {
    return closest_features(a_, b_, advanced(X_AB_, V_AB_, time_s), cache_).distance;
  }
  std::optional<double> first_contact() {
    constexpr int kInstants = 200, kBisections = 40;
    double clear = 0.0;
    for (int i = 0; i <= kInstants; ++i) {
      double met = kFrame_s * i / kInstants;
      if (gap(met) > kTarget_m) {
        clear = met;
        continue;
      }
      for (int k = 0; k < kBisections; ++k) {
        const double middle = 0.5 * (clear + met);
        (gap(middle) > kTarget_m ? clear : met) = middle;
      }
      return met;
    }
    return std::nullopt;
  }

 private:
  const Polytope& a_;
  const Polytope& b_;
  const Pose& X_AB_;
  const Twist& V_AB_;
  PairCache cache_;
};

void judge(const TimeOfImpact& found, Watch watch, ImpactRow& row) {
  const std::optional<double> contact = watch.first_contact();
  if (found.status == ImpactStatus::kBounded) return;  // counted as missed
  const bool hit = found.status != ImpactStatus::kMiss;
  if (contact && !hit) ++row.disagreements;
  if (!hit) return;
  ++row.hits;
  const double gap_m = watch.gap(found.time);
  row.row.max_error_m = std::max(row.row.max_error_m, std::abs(gap_m - kTarget_m));
  if (!contact) return;  // a graze between the instants: the gap has decided whether it is one
  row.late_s = std::max(row.late_s, found.time - *contact);
  row.early_s = std::max(row.early_s, *contact - found.time);
}

ImpactRow measure(Meter& meter, const Pair& pair, int frames) {
  const Shape& a = shape(pair.a);
  const Shape& b = shape(pair.b);
  Recording recording = record(a, b, {"approach", 0.05e-3, 0.8e-3}, frames, 12);
  add_twists(recording);
  Impact engine;
  engine.hold(a, b);
  ImpactRow row;
  // Answers are judged below, at the time found, not at the recorded pose.
  constexpr double kAnything = std::numeric_limits<double>::infinity();
  const std::vector<Truth> any(recording.poses.size(), Truth{-kAnything, kAnything, false});
  row.row = meter.measure(engine, recording, any, false, 10.0);
  row.row.shape_a = pair.a;
  row.row.shape_b = pair.b;
  row.row.vertices = std::max(a.vertices(), b.vertices());
  row.row.regime = "approach";
  row.row.engine = kOurs;
  engine.forget();
  for (std::size_t i = 0; i < recording.poses.size(); ++i) {
    engine.place(recording, i);
    engine.query();
    judge(engine.found, Watch(a, b, recording.poses[i], recording.twists[i]), row);
  }
  return row;
}

}  // namespace

std::span<const Pair> impact_pairs() {
  static const std::vector<Pair> list = {
      {"box", "box"},           {"prism64", "prism64"},        {"sphere642", "sphere642"},
      {"hull2000", "hull2000"}, {"needle", "needle"},          {"needle", "plate"},
      {"plate", "box"},         {"sphere10242", "sphere10242"}};
  return list;
}

ImpactReport bench_impact(const PairsOptions& options,
                          const std::function<void(const std::string&)>& progress) {
  Meter meter(options.replays);
  ImpactReport report;
  for (const Pair& pair : impact_pairs()) {
    if (!wanted(options.shapes, pair.name())) continue;
    progress(pair.name());
    report.rows.push_back(measure(meter, pair, options.quick ? 100 : options.frames));
  }
  report.how = meter.describe();
  return report;
}

Table table_of(const ImpactReport& report) {
  Table table;
  const auto time_s = [](double value) { return time_text(value * 1e9); };
  table.rows.push_back({"pair", "vertices", "median", "p99", "p99.9", "max", "steps", "missed", "hits",
                        "mistaken", "late", "early", "gap off target"});
  for (const ImpactRow& one : report.rows)
    table.rows.push_back(
        {one.row.shape_a + "/" + one.row.shape_b, fmt::to_string(one.row.vertices),
         time_text(one.row.median_ns), time_text(one.row.p99_ns), time_text(one.row.p999_ns),
         time_text(one.row.max_ns), fmt::format("{:.1f}/{}", one.row.steps_mean, one.row.steps_max),
         fmt::to_string(one.row.missed), fmt::to_string(one.hits), fmt::to_string(one.disagreements),
         time_s(one.late_s), time_s(one.early_s), length_text(one.row.max_error_m)});
  return table;
}

nlohmann::ordered_json to_json(const ImpactRow& row) {
  nlohmann::ordered_json json = to_json(row.row);
  json["hits"] = row.hits;
  json["disagreements"] = row.disagreements;
  json["late_s"] = row.late_s;
  json["early_s"] = row.early_s;
  return json;
}

}  // namespace tactum::bench
