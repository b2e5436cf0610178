#pragma once
/// One engine on one recording: the cost of a query and its error. Every pose is replayed several times while
/// the core is ours alone and counts with its fastest (`Readings`), so that disturbances by the rest of the
/// machine are left out; the cost of reading the clock, measured in the same way on an engine that does
/// nothing, is subtracted.

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/clock.h"
#include "bench/engine.h"
#include "bench/referee.h"

namespace tactum::bench {

struct Row {
  std::string shape_a, shape_b;
  int vertices = 0;  ///< of the larger piece
  std::string regime, engine;
  int frames = 0;                                                     ///< queries; slow engines get fewer
  double median_ns = 0.0, p99_ns = 0.0, p999_ns = 0.0, max_ns = 0.0;  ///< [ns]
  double shared_core = 0.0;  ///< of the queries, those that had too few replays on a core of our own [0..1]
  double batched_ns = 0.0;   ///< mean over the whole recording between two readings of the clock [ns]
  double max_error_m = 0.0;  ///< against the referee, of the queries answered [m]
  int missed = 0;            ///< not answered, not certified (ours), or contact and no contact mistaken
  int depths_checked = 0;    ///< overlapping poses of which the referee proved the depth
  int depths_wrong = 0;      ///< ... where the answer is not the global minimum, to a micrometre
  double steps_mean = 0.0;   ///< ours only
  int steps_max = 0;         ///< ours only
  /// Every query answered, and right to a micrometre.
  bool accurate() const { return missed == 0 && max_error_m <= kAccurate_m; }
  static constexpr double kAccurate_m = 1e-6;
};

/// The keys are the members' names.
nlohmann::ordered_json to_json(const Row& row);

/// The cost of one thing when nothing disturbs it, by a clock that moves in steps. A duration between two of
/// them reads now as the one, now as the other, with the right mean: so the mean of the readings within a
/// step of the fastest.
class Readings {
 public:
  explicit Readings(double step_ns) : step_ns_(step_ns) {}
  void add(double ns);
  int count() const { return count_; }
  /// At least one reading has been added.
  double ns() const { return least_ns_ + step_ns_ * next_ / (least_ + next_); }

 private:
  double step_ns_;
  double least_ns_ = std::numeric_limits<double>::infinity();
  int least_ = 0, next_ = 0;  // readings of the least, and of a step more
  int count_ = 0;
};

class Meter {
 public:
  explicit Meter(int replays);
  /// With a function for whether the core is ours alone, which is called before and after some queries.
  Meter(int replays, std::function<bool()> core_is_ours);
  /// The engine has been given the pair. `cold`: it is reset before each query. Engines get as many of the
  /// poses as fit into `budget_s`; on a core that others use it takes up to kPatience_ns longer.
  Row measure(Engine& engine, const Recording& recording, const std::vector<Truth>& truth, bool cold,
              double budget_s);
  /// The method behind the numbers: "each the fastest of 5 replays ...", and how many of the queries measured
  /// up to now did not have as many on a core that was ours alone.
  std::string describe() const;

  /// Replays go on until each pose has had its number on a core of ours: up to so many times that number in
  /// all, or so long.
  static constexpr int kPatience = 40;
  static constexpr double kPatience_ns = 2e9;

 private:
  struct Times {
    std::vector<double> ns;  ///< of each pose, the clock's cost still in it [ns]
    std::size_t shared = 0;  ///< poses that had fewer replays on a core of ours: the fastest of all counts
  };
  Times undisturbed(Engine& engine, const Recording& recording, std::size_t count, bool cold);
  double batched_ns(Engine& engine, const Recording& recording, std::size_t count, bool cold) const;

  FineClock clock_;
  int replays_;
  std::function<bool()> core_is_ours_;
  std::size_t measured_ = 0, shared_ = 0;  // queries
  double overhead_ns_ = 0.0;
};

}  // namespace tactum::bench
