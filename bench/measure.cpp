#include "bench/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "bench/core_width.h"
#include "bench/quantile.h"

namespace tactum::bench {
namespace {

/// An engine that does nothing, to measure the cost of a call.
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
  ++count_;
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
  nlohmann::ordered_json json = {{"shape_a", row.shape_a},         {"shape_b", row.shape_b},
                                 {"vertices", row.vertices},       {"regime", row.regime},
                                 {"engine", row.engine},           {"frames", row.frames},
                                 {"median_ns", row.median_ns},     {"p99_ns", row.p99_ns},
                                 {"p999_ns", row.p999_ns},         {"max_ns", row.max_ns},
                                 {"shared_core", row.shared_core}, {"batched_ns", row.batched_ns},
                                 {"max_error_m", row.max_error_m}, {"missed", row.missed}};
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

Meter::Meter(int replays) : Meter(replays, [core = CoreWidth()]() mutable { return core.is_ours(); }) {}

Meter::Meter(int replays, std::function<bool()> core_is_ours)
    : replays_(replays), core_is_ours_(std::move(core_is_ours)) {
  constexpr std::size_t kCalls = 10000;
  Nothing nothing;
  std::vector<double> empty = undisturbed(nothing, {}, kCalls, false).ns;
  std::sort(empty.begin(), empty.end());
  overhead_ns_ = std::accumulate(empty.begin() + kCalls / 4, empty.end() - kCalls / 4, 0.0) / (kCalls / 2);
}

std::string Meter::describe() const {
  return fmt::format(
      "Each query is the fastest of {} replays of its pose by {}; {:.1f} ns that reading it costs are taken "
      "off. Replays count while the core is ours alone; {:.3g} % of the queries had too few of those, and "
      "all of theirs count.",
      replays_, clock_.describe(), overhead_ns_,
      measured_ == 0 ? 0.0 : 100.0 * static_cast<double>(shared_) / static_cast<double>(measured_));
}

Meter::Times Meter::undisturbed(Engine& engine, const Recording& recording, std::size_t count, bool cold) {
  // The core is tested every so many poses, or so much time, whichever is less.
  constexpr std::size_t kMostPoses = 32;
  constexpr double kMost_ns = 20e3;
  std::vector<Readings> ours(count, Readings(clock_.step_ns()));
  std::vector<Readings> all = ours;
  const auto seen_enough = [&] {
    return std::all_of(ours.begin(), ours.end(), [&](const Readings& r) { return r.count() == replays_; });
  };
  const std::uint64_t begin = clock_.start();
  const auto has_patience = [&](int replay) {
    return replay < kPatience * replays_ && clock_.ns(clock_.stop() - begin) < kPatience_ns;
  };
  for (int replay = 0; replay < replays_ || (has_patience(replay) && !seen_enough()); ++replay) {
    engine.forget();
    engine.place(recording, 0);
    engine.query();  // the cold start is not one of the tracked queries
    bool was_ours = core_is_ours_();
    // A test of the core disturbs the query after it a little: in every replay others come after one.
    std::size_t most = 1 + static_cast<std::size_t>(replay) * 7 % kMostPoses;
    for (std::size_t first = 0; first < count; most = kMostPoses) {
      double ns[kMostPoses];
      const std::uint64_t block = clock_.start();
      std::uint64_t stop = block;
      std::size_t i = first;
      for (; i < count && i - first < most && clock_.ns(stop - block) < kMost_ns; ++i) {
        if (cold) engine.forget();
        engine.place(recording, i);
        const std::uint64_t start = clock_.start();
        engine.query();
        stop = clock_.stop();
        ns[i - first] = clock_.ns(stop - start);
      }
      const bool is_ours = core_is_ours_();
      for (std::size_t k = first; k < i; ++k) {
        all[k].add(ns[k - first]);
        // More readings would give a smaller least: no pose has more than the others, and no engine's.
        if (was_ours && is_ours && ours[k].count() < replays_) ours[k].add(ns[k - first]);
      }
      was_ours = is_ours;
      first = i;
    }
  }
  Times times;
  times.ns.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool shared = ours[i].count() < replays_;
    times.ns.push_back(shared ? all[i].ns() : ours[i].ns());
    if (shared) ++times.shared;
  }
  return times;
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
                   double budget_s) {
  Row row;
  // Answers first, as many as half the budget allows: the replays of the batch and of each pose, when none
  // is disturbed, share the rest.
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

  auto [ns, shared] = undisturbed(engine, recording, count, cold);
  measured_ += count;
  shared_ += shared;
  row.shared_core = static_cast<double>(shared) / static_cast<double>(count);
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
