#include "viewer/server/history.h"

#include <algorithm>

#include "viewer/server/wire.h"

namespace tactum {

int chart_sample_size(int posed) noexcept { return sample_size() + 2 + posed * FrameSample::kPoseNumbers; }

std::uint64_t History::newcomers_place() const noexcept {
  const std::uint64_t early = end_ > kForNewcomers ? end_ - kForNewcomers : 0;
  return std::max(early, first_);
}

std::optional<std::uint64_t> History::place_of(std::uint64_t frame) const noexcept {
  for (std::uint64_t place = end_; place-- > std::max(oldest(), first_);)
    if (samples_[place % kRoom].frame.index == frame) return place;
  return std::nullopt;
}

History::Rows History::write_rows(std::uint64_t& place, std::uint64_t& dropped, std::string& out) const {
  if (place < oldest()) {
    dropped += oldest() - place;
    place = oldest();
  }
  const std::size_t count = end_ - place;
  const int numbers = sample_size();
  // One message has rows of one run, whose bodies are the same in all.
  const int posed = count > 0 ? samples_[place % kRoom].frame.posed : 0;
  for (std::size_t i = 0; i < count; ++i, ++place) {
    const ChartSample& sample = samples_[place % kRoom];
    wire::put(out, static_cast<std::uint32_t>(sample.frame.index));
    for (int k = 0; k < numbers; ++k) wire::put(out, sample.frame.values[static_cast<std::size_t>(k)]);
    wire::put(out, sample.frame_time_s);
    wire::put(out, sample.wakeup_latency_s);
    for (int k = 0; k < posed * FrameSample::kPoseNumbers; ++k)
      wire::put(out, sample.frame.poses[static_cast<std::size_t>(k)]);
  }
  return {static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(chart_sample_size(posed))};
}

}  // namespace tactum
