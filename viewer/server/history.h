#pragma once
/// The samples of the last seconds (kRoom), kept once for all pages. A page has a place in it; a page that
/// was slow gets everything since then, in order, with the number of those it is too late for.

#include <cstdint>
#include <optional>
#include <vector>

#include "tactum/telemetry/frame_feed.h"

namespace tactum {

/// A frame as charts see it: FrameSample with the times on the loop's clock.
struct ChartSample {
  FrameSample frame;
  float frame_time_s = 0.0F;      ///< of the whole frame; not a number when it was not measured [s]
  float wakeup_latency_s = 0.0F;  ///< begun after its deadline by; not a number on a virtual clock [s]
};

/// Numbers a sample has on the wire: those of the frame, the two times, and the poses of so many bodies.
int chart_sample_size(int posed = 0) noexcept;

class History {
 public:
  static constexpr std::size_t kRoom = 1u << 14;      ///< sixteen seconds at 1 kHz
  static constexpr std::size_t kForNewcomers = 8000;  ///< samples a new page is given

  History() : samples_(kRoom) {}

  void add(const ChartSample& sample) noexcept { samples_[end_++ % kRoom] = sample; }
  /// One past the newest; places count from the beginning of all.
  std::uint64_t end() const noexcept { return end_; }
  std::uint64_t oldest() const noexcept { return end_ > kRoom ? end_ - kRoom : 0; }
  std::uint64_t newcomers_place() const noexcept;
  /// The place of a frame's sample, of the newest where there are several; nothing when it is not here.
  std::optional<std::uint64_t> place_of(std::uint64_t frame) const noexcept;
  /// A new run begins: later pages do not get the samples before.
  void cut() noexcept { first_ = end_; }

  struct Rows {
    std::uint32_t count = 0, numbers = 0;  ///< rows, and numbers in each
  };
  /// Appends the samples from `place` to the newest as rows: frame index (u32), then the numbers (f32). Moves
  /// `place` behind them and adds to `dropped` the number it was too late for. All of them, however many: a
  /// page that gets the newest picture needs the numbers of its frame beside it.
  Rows write_rows(std::uint64_t& place, std::uint64_t& dropped, std::string& out) const;

 private:
  std::vector<ChartSample> samples_;
  std::uint64_t end_ = 0;
  std::uint64_t first_ = 0;  // of this run
};

}  // namespace tactum
