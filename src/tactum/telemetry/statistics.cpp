#include "tactum/telemetry/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

// Bins: durations below 2 * kParts have one each; above, every power of two has kParts of them.
constexpr int kPartBits = 7;
constexpr std::uint64_t kParts = std::uint64_t{1} << kPartBits;
constexpr int kLargestBits = 40;
constexpr std::uint64_t kLargest = (std::uint64_t{1} << kLargestBits) - 1;

std::size_t bin_of(std::uint64_t duration) {
  duration = std::min(duration, kLargest);
  if (duration < 2 * kParts) return duration;
  const int shift = static_cast<int>(std::bit_width(duration)) - (kPartBits + 1);
  return static_cast<std::size_t>(shift) * kParts + (duration >> shift);
}

constexpr std::size_t kBins = static_cast<std::size_t>(kLargestBits - kPartBits - 1) * kParts + 2 * kParts;

/// The middle of the whole numbers that fall into a bin.
double middle_of(std::size_t bin) {
  if (bin < 2 * kParts) return static_cast<double>(bin);
  const auto shift = static_cast<int>(bin / kParts) - 1;
  const std::uint64_t low = (bin - static_cast<std::size_t>(shift) * kParts) << shift;
  const std::uint64_t width = std::uint64_t{1} << shift;
  return static_cast<double>(low) + 0.5 * static_cast<double>(width - 1);
}

/// How many durations must not exceed the quantile.
std::uint64_t rank_of(double q, std::uint64_t count) {
  const double wanted = std::ceil(std::clamp(q, 0.0, 1.0) * static_cast<double>(count));
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(wanted), 1, count);
}

}  // namespace

DurationHistogram::DurationHistogram() : bins_(kBins, 0) {}

void DurationHistogram::add(std::int64_t duration_ns) noexcept {
  const std::uint64_t duration = duration_ns > 0 ? static_cast<std::uint64_t>(duration_ns) : 0;
  ++bins_[bin_of(duration)];
  min_ns_ = count_ == 0 ? duration : std::min(min_ns_, duration);
  max_ns_ = std::max(max_ns_, duration);
  sum_ns_ += duration;
  ++count_;
}

void DurationHistogram::merge(const DurationHistogram& other) noexcept {
  if (other.count_ == 0) return;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) bins_[bin] += other.bins_[bin];
  min_ns_ = count_ == 0 ? other.min_ns_ : std::min(min_ns_, other.min_ns_);
  max_ns_ = std::max(max_ns_, other.max_ns_);
  sum_ns_ += other.sum_ns_;
  count_ += other.count_;
}

void DurationHistogram::clear() noexcept {
  std::fill(bins_.begin(), bins_.end(), 0);
  count_ = sum_ns_ = min_ns_ = max_ns_ = 0;
}

double DurationHistogram::mean_ns() const noexcept {
  return count_ == 0 ? 0.0 : static_cast<double>(sum_ns_) / static_cast<double>(count_);
}

double DurationHistogram::quantile_ns(double q) const noexcept {
  if (count_ == 0) return 0.0;
  const std::uint64_t rank = rank_of(q, count_);
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen >= rank)
      return std::clamp(middle_of(bin), static_cast<double>(min_ns_), static_cast<double>(max_ns_));
  }
  return static_cast<double>(max_ns_);
}

Summary DurationHistogram::summary() const noexcept {
  return {count_,
          mean_ns(),
          quantile_ns(0.5),
          quantile_ns(0.99),
          quantile_ns(0.999),
          static_cast<double>(max_ns_)};
}

void MinimumOfReplays::add(std::size_t frame, std::int64_t duration_ns) noexcept {
  if (frame < least_ns_.size()) least_ns_[frame] = std::min(least_ns_[frame], duration_ns);
}

Summary MinimumOfReplays::summary() const {
  std::vector<std::int64_t> recorded;
  for (const std::int64_t least : least_ns_)
    if (least != kNever) recorded.push_back(least);
  return summary_of(std::move(recorded));
}

Summary summary_of(std::vector<std::int64_t> durations_ns) {
  if (durations_ns.empty()) return {};
  std::sort(durations_ns.begin(), durations_ns.end());
  const std::uint64_t count = durations_ns.size();
  const auto quantile = [&](double q) { return static_cast<double>(durations_ns[rank_of(q, count) - 1]); };
  double sum = 0.0;
  for (const std::int64_t duration : durations_ns) sum += static_cast<double>(duration);
  return {count,        sum / static_cast<double>(count), quantile(0.5), quantile(0.99), quantile(0.999),
          quantile(1.0)};
}

std::string table_of(std::span<const StageSummary> stages) {
  std::size_t width = std::string_view("stage").size();
  for (const StageSummary& stage : stages) width = std::max(width, stage.name.size());
  std::string table = fmt::format("{:<{}}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}\n", "stage", width,
                                  "count", "mean us", "p50 us", "p99 us", "p99.9 us", "max us");
  const auto us = [](double ns) { return ns * 1e-3; };
  for (const auto& [name, s] : stages)
    table += fmt::format("{:<{}}  {:>9}  {:>9.3f}  {:>9.3f}  {:>9.3f}  {:>9.3f}  {:>9.3f}\n", name, width,
                         s.count, us(s.mean_ns), us(s.p50_ns), us(s.p99_ns), us(s.p999_ns), us(s.max_ns));
  return table;
}

}  // namespace tactum::inline v0_1
