#include "bench/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tactum::bench {
namespace {

/// Costs what the call of an engine costs.
class Nothing final : public Engine {
 public:
  bool hold(const Shape&, const Shape&) override { return true; }
  void forget() override {}
  void place(const Recording&, std::size_t) override {}
  void query() override { ++calls_; }
  Answer answer() const override { return {calls_ > 0, 0.0, 0}; }

 private:
  int calls_ = 0;
};

/// The smallest value that at least a share q of all do not exceed; `sorted` is not empty.
double quantile(const std::vector<double>& sorted, double q) {
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
  return sorted[std::min(sorted.size(), std::max<std::size_t>(rank, 1)) - 1];
}

void judge(const Answer& answer, const Truth& truth, Row& row) {
  const bool apart_for_contact = answer.distance > 0.0 && truth.high < -Row::kAccurate_m;
  const bool contact_for_apart = answer.distance <= 0.0 && truth.low > Row::kAccurate_m;
  if (!answer.answered || !std::isfinite(answer.distance) || apart_for_contact || contact_for_apart)
    ++row.missed;
  else
    row.max_error_m = std::max(row.max_error_m, truth.error_of(answer.distance));
  if (truth.proved && truth.high < 0.0) {
    ++row.depths_checked;
    if (answer.answered && truth.error_of(answer.distance) > Row::kAccurate_m) ++row.depths_wrong;
  }
  row.steps_mean += answer.steps;
  row.steps_max = std::max(row.steps_max, answer.steps);
}

}  // namespace

void Readings::add(double ns) {
  constexpr double kSame = 0.5;  // of a step
  const double above = ns - least_ns_;
  if (above < -kSame * step_ns_) {
    next_ = above > -(1.0 + kSame) * step_ns_ ? least_ : 0;
    least_ = 1;
    least_ns_ = ns;
  } else if (above < kSame * step_ns_) {
    ++least_;
  } else if (above < (1.0 + kSame) * step_ns_) {
    ++next_;
  }
}

nlohmann::ordered_json to_json(const Row& row) {
  nlohmann::ordered_json json = {
      {"shape_a", row.shape_a},     {"shape_b", row.shape_b},       {"vertices", row.vertices},
      {"regime", row.regime},       {"engine", row.engine},         {"frames", row.frames},
      {"median_ns", row.median_ns}, {"p99_ns", row.p99_ns},         {"p999_ns", row.p999_ns},
      {"max_ns", row.max_ns},       {"batched_ns", row.batched_ns}, {"max_error_m", row.max_error_m},
      {"missed", row.missed}};
  if (row.depths_checked > 0) {
    json["depths_checked"] = row.depths_checked;
    json["depths_wrong"] = row.depths_wrong;
  }
  if (row.engine == kOurs) {
    json["steps_mean"] = row.steps_mean;
    json["steps_max"] = row.steps_max;
  }
  return json;
}

Meter::Meter(int replays) : replays_(replays) {
  constexpr std::size_t kCalls = 10000;
  Nothing nothing;
  std::vector<double> empty = undisturbed_ns(nothing, {}, kCalls, false);
  std::sort(empty.begin(), empty.end());
  overhead_ns_ = std::accumulate(empty.begin() + kCalls / 4, empty.end() - kCalls / 4, 0.0) / (kCalls / 2);
}

std::string Meter::describe() const {
  return fmt::format(
      "Each query is the fastest of {} replays of its pose by {}; {:.1f} ns that reading it costs are taken "
      "off.",
      replays_, clock_.describe(), overhead_ns_);
}

std::vector<double> Meter::undisturbed_ns(Engine& engine, const Recording& recording, std::size_t count,
                                          bool cold) const {
  std::vector<Readings> readings(count, Readings(clock_.step_ns()));
  for (int replay = 0; replay < replays_; ++replay) {
    engine.forget();
    engine.place(recording, 0);
    engine.query();  // the start from nothing is not one of the tracked queries
    for (std::size_t i = 0; i < count; ++i) {
      if (cold) engine.forget();
      engine.place(recording, i);
      const std::uint64_t start = clock_.start();
      engine.query();
      const std::uint64_t stop = clock_.stop();
      readings[i].add(clock_.ns(stop - start));
    }
  }
  std::vector<double> ns;
  ns.reserve(count);
  for (const Readings& of_pose : readings) ns.push_back(of_pose.ns());
  return ns;
}

double Meter::batched_ns(Engine& engine, const Recording& recording, std::size_t count, bool cold) const {
  const auto sweep_ns = [&](bool ask) {
    double least = std::numeric_limits<double>::infinity();
    for (int replay = 0; replay < replays_; ++replay) {
      engine.forget();
      engine.place(recording, 0);
      engine.query();
      const std::uint64_t start = clock_.start();
      for (std::size_t i = 0; i < count; ++i) {
        if (cold) engine.forget();
        engine.place(recording, i);
        if (ask) engine.query();
      }
      least = std::min(least, clock_.ns(clock_.stop() - start));
    }
    return least / static_cast<double>(count);
  };
  const double placed = sweep_ns(false);
  return std::max(0.0, sweep_ns(true) - placed);
}

Row Meter::measure(Engine& engine, const Recording& recording, const std::vector<Truth>& truth, bool cold,
                   double budget_s) const {
  Row row;
  // Answers first, as many as half the budget allows: the replays of the batch and of each pose share the
  // rest.
  const double share_ns = budget_s * 1e9 / (2 * replays_ + 1);
  std::size_t count = 0;
  double spent_ns = 0.0;
  engine.forget();
  for (; count < recording.poses.size() && (spent_ns < share_ns || count < 10); ++count) {
    if (cold) engine.forget();
    engine.place(recording, count);
    const std::uint64_t start = clock_.start();
    engine.query();
    spent_ns += clock_.ns(clock_.stop() - start);
    judge(engine.answer(), truth[count], row);
  }
  row.frames = static_cast<int>(count);
  row.steps_mean /= static_cast<double>(count);

  std::vector<double> ns = undisturbed_ns(engine, recording, count, cold);
  for (double& value : ns) value = std::max(0.0, value - overhead_ns_);
  std::sort(ns.begin(), ns.end());
  row.median_ns = quantile(ns, 0.5);
  row.p99_ns = quantile(ns, 0.99);
  row.p999_ns = quantile(ns, 0.999);
  row.max_ns = ns.back();
  row.batched_ns = batched_ns(engine, recording, count, cold);
  return row;
}

}  // namespace tactum::bench
