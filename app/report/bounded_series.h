#pragma once
/// What a report keeps of a run, however long it is: memory that does not grow with the number of frames.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace tactum {

/// A quantity over time as its least and largest value in each of at most kStretches equal stretches of
/// frames. When all are full, neighbours are joined, so that no peak is lost.
class BoundedSeries {
 public:
  static constexpr std::size_t kStretches = 1024;
  struct Stretch {
    double from_s = 0.0;  ///< time of its first frame [s]
    double least = 0.0;
    double largest = 0.0;
  };

  /// A value that is not finite is left out.
  void add(double time_s, double value) {
    if (!std::isfinite(value)) return;
    if (stretches_.empty() || in_last_ == frames_each_) {
      if (stretches_.size() == kStretches) join();
      stretches_.push_back({time_s, value, value});
      in_last_ = 1;
      return;
    }
    widen(stretches_.back(), value, value);
    ++in_last_;
  }
  const std::vector<Stretch>& stretches() const noexcept { return stretches_; }

 private:
  static void widen(Stretch& stretch, double least, double largest) {
    stretch.least = std::fmin(stretch.least, least);
    stretch.largest = std::fmax(stretch.largest, largest);
  }
  void join() {
    for (std::size_t i = 0; i < kStretches; i += 2) {
      Stretch joined = stretches_[i];
      widen(joined, stretches_[i + 1].least, stretches_[i + 1].largest);
      stretches_[i / 2] = joined;
    }
    stretches_.resize(kStretches / 2);
    frames_each_ *= 2;
  }

  std::vector<Stretch> stretches_;
  std::uint64_t frames_each_ = 1, in_last_ = 0;
};

/// Some of many points: the first, and from then on as many as there is room for, at equal distances.
template <std::size_t Most>
class SampledPoints {
 public:
  using Point = std::array<double, 3>;  ///< x, y and a weight
  void add(const Point& point) {
    if (seen_++ % stride_ != 0) return;
    if (points_.size() == Most) {
      for (std::size_t i = 0; 2 * i < Most; ++i) points_[i] = points_[2 * i];
      points_.resize((Most + 1) / 2);
      stride_ *= 2;
      if ((seen_ - 1) % stride_ != 0) return;
    }
    points_.push_back(point);
  }
  const std::vector<Point>& points() const noexcept { return points_; }
  std::uint64_t stride() const noexcept { return stride_; }  ///< every how manyth is kept

 private:
  std::vector<Point> points_;
  std::uint64_t seen_ = 0, stride_ = 1;
};

/// How often positive numbers came, in bins of equal ratio: sixteen to a power of ten.
class RatioBins {
 public:
  static constexpr int kInDecade = 16;
  void add(double value) {
    if (value > 0.0 && std::isfinite(value))
      ++counts_[static_cast<int>(std::floor(std::log10(value) * kInDecade))];
  }
  /// Where a bin begins; it ends where the next does.
  static double edge(int bin) { return std::pow(10.0, static_cast<double>(bin) / kInDecade); }
  const std::map<int, std::uint64_t>& counts() const noexcept { return counts_; }

 private:
  std::map<int, std::uint64_t> counts_;
};

/// Count, mean and extremes of numbers.
class RunningMean {
 public:
  void add(double value) {
    ++count_;
    sum_ += value;
    largest_ = count_ == 1 ? value : std::fmax(largest_, value);
  }
  std::uint64_t count() const noexcept { return count_; }
  double mean() const noexcept { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }
  double largest() const noexcept { return largest_; }

 private:
  std::uint64_t count_ = 0;
  double sum_ = 0.0, largest_ = 0.0;
};

}  // namespace tactum
