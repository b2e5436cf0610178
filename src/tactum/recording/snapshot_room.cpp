#include "tactum/recording/snapshot_room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/haptics/frame_snapshot.h"
#include "tactum/haptics/setting_table.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kFirstRoom = std::size_t{1} << 17;

std::size_t most_copied(double dt_s) {
  return static_cast<std::size_t>(dt_s * SnapshotRoom::kShareOfFrame * SnapshotRoom::kCopied_bytes_per_s);
}

}  // namespace

SnapshotRoom::SnapshotRoom(const FrameState& state, const FrameSettings& settings, double every_s,
                           bool at_once)
    : dt_s_(settings.dt_s),
      every_s_(every_s),
      seen_(settings),
      due_(at_once ? 0 : frames_of(every_s)),
      room_(kFirstRoom),
      largest_(at_once ? std::numeric_limits<std::size_t>::max() : most_copied(dt_s_)) {
  snapshot_.layout = recording::layout_of_snapshots(state);
  snapshot_.settings.resize(setting_table().size() * settings.hands());
}

std::uint64_t SnapshotRoom::frames_of(double seconds) const noexcept {
  return static_cast<std::uint64_t>(std::max(1.0, std::round(seconds / dt_s_)));
}

bool SnapshotRoom::take(std::uint64_t next_index, const FrameState& state, const FrameSettings& settings,
                        const SafetySettings& safety) noexcept {
  if (next_index < due_ || use_.load(std::memory_order_acquire) != Use::kFree) return false;
  const std::size_t size = write_snapshot(state, room_);
  if (size > room_.size()) {
    needed_ = size;
    use_.store(size > largest_ ? Use::kTooLarge : Use::kTooSmall, std::memory_order_release);
    return false;
  }
  largest_ = most_copied(dt_s_);
  snapshot_.index = next_index;
  snapshot_.state = {room_.data(), size};
  const std::span<const SettingInfo> table = setting_table();
  double* next = snapshot_.settings.data();
  for (const SettingInfo& setting : table) *next++ = setting.get(settings, safety);
  for (const HandSettings& other : settings.other_hands) {  // what is not a hand's own is as in the first
    static_cast<HandSettings&>(seen_) = other;
    for (const SettingInfo& setting : table) *next++ = setting.get(seen_, safety);
  }
  const std::uint64_t frames = frames_of(every_s_ * std::max(1.0, static_cast<double>(size) / kUsual));
  due_ += (next_index - due_) / frames * frames + frames;
  use_.store(Use::kTaken, std::memory_order_release);
  return true;
}

void SnapshotRoom::make_room() {
  if (use_.load(std::memory_order_acquire) != Use::kTooSmall) return;
  room_.resize(needed_ + needed_ / 4);
  release();
}

}  // namespace tactum::inline v0_1
