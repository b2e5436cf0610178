#pragma once
/// Statistics of durations that are recorded in the loop and read afterwards: mean, p50, p99, p99.9, max.
///
/// Durations fall into bins whose width is 1/128 to 1/256 of their value: a power of two, divided in 128
/// equal parts. A quantile is given as the middle of its bin, so it is right to 0.4 %; mean, min, max and
/// count are exact. Counting up to 2^40 ns (18 minutes) takes 35 KB, set aside at construction. `add` is
/// about 2 ns.
///
/// A quantile q of n durations is the smallest duration that at least ceil(q n) of them do not exceed.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tactum::inline v0_1 {

/// A summary of many durations.
struct Summary {
  std::uint64_t count = 0;
  double mean_ns = 0.0;  ///< [ns]
  double p50_ns = 0.0;   ///< [ns]
  double p99_ns = 0.0;   ///< [ns]
  double p999_ns = 0.0;  ///< [ns]
  double max_ns = 0.0;   ///< [ns]
};

class DurationHistogram {
 public:
  /// Largest relative error of a quantile.
  static constexpr double kRelativeError = 1.0 / 256.0;

  DurationHistogram();
  /// Negative durations count as zero; above 2^40 ns they fall into the last bin.
  void add(std::int64_t duration_ns) noexcept;
  /// Adds everything that `other` has recorded.
  void merge(const DurationHistogram& other) noexcept;
  void clear() noexcept;

  std::uint64_t count() const noexcept { return count_; }
  double mean_ns() const noexcept;              ///< 0 when nothing was recorded [ns]
  double quantile_ns(double q) const noexcept;  ///< q in [0, 1]; 0 when nothing was recorded [ns]
  Summary summary() const noexcept;

 private:
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  std::uint64_t sum_ns_ = 0;
  std::uint64_t min_ns_ = 0;
  std::uint64_t max_ns_ = 0;
};

/// The fastest time of each frame over identical replays: the time of the frame itself, without delays by the
/// rest of the machine. Replays must compute the same frames for this to mean anything.
class MinimumOfReplays {
 public:
  explicit MinimumOfReplays(std::size_t frames) : least_ns_(frames, kNever) {}
  /// Ignores frames beyond the number given at construction.
  void add(std::size_t frame, std::int64_t duration_ns) noexcept;
  /// Over the frames that were recorded at least once; exact.
  Summary summary() const;
  double at_ns(std::size_t frame) const { return static_cast<double>(least_ns_[frame]); }  ///< [ns]

 private:
  static constexpr std::int64_t kNever = INT64_MAX;
  std::vector<std::int64_t> least_ns_;
};

/// The exact summary of samples that were kept.
Summary summary_of(std::vector<std::int64_t> durations_ns);

/// One line of a table of stages.
struct StageSummary {
  std::string name;
  Summary summary;
};

/// Aligned columns in microseconds, a heading first, one line a stage.
std::string table_of(std::span<const StageSummary> stages);

}  // namespace tactum::inline v0_1
