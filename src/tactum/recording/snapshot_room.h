#pragma once
/// From the loop's thread to the writer's: the state between two frames, now and then, so that a replay can
/// begin there (haptics/frame_snapshot.h). The loop copies it into room that the writer's thread has made;
/// while that room is in use, or too small, there is no snapshot, and the next frame tries again.

#include <atomic>
#include <cstdint>
#include <vector>

#include "tactum/loop/safety.h"
#include "tactum/recording/frame_slot.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

class SnapshotRoom {
 public:
  /// A state of more bytes is stored as many times more rarely.
  static constexpr double kUsual = 500e3;
  /// The copy of a state may take this part of the time from frame to frame, at kCopied_bytes_per_s; of a
  /// larger one there are no snapshots, but for that with which a recording begins in the middle of a run.
  static constexpr double kShareOfFrame = 0.2, kCopied_bytes_per_s = 4e9;

  /// `every_s`: how often, where the state is small [s]; `at_once`: the first after the next frame, else
  /// after so long. Reads no number of the state.
  SnapshotRoom(const FrameState& state, const FrameSettings& settings, double every_s, bool at_once);

  /// The loop's thread, after the frame before `next_index`: whether a snapshot was taken, for the writer.
  bool take(std::uint64_t next_index, const FrameState& state, const FrameSettings& settings,
            const SafetySettings& safety) noexcept;
  /// The writer's thread: what was taken, until release().
  const RecordedSnapshot& taken() const noexcept { return snapshot_; }
  void release() noexcept { use_.store(Use::kFree, std::memory_order_release); }
  /// The writer's thread: makes more room where that is needed.
  void make_room();
  /// A snapshot waits to be written, or for room.
  bool in_use() const noexcept {
    const Use use = use_.load(std::memory_order_acquire);
    return use == Use::kTaken || use == Use::kTooSmall;
  }
  /// The state is too large: there are no more snapshots.
  bool too_large() const noexcept { return use_.load(std::memory_order_acquire) == Use::kTooLarge; }

 private:
  enum class Use { kFree, kTaken, kTooSmall, kTooLarge };

  std::uint64_t frames_of(double seconds) const noexcept;

  double dt_s_, every_s_;
  FrameSettings seen_;  // with one hand after another in the first one's place
  std::uint64_t due_;   // the next snapshot is before this frame, or after; of the loop's thread
  std::vector<char> room_;
  RecordedSnapshot snapshot_;
  std::size_t largest_;  // bytes of a state that is copied; of the loop's thread
  std::size_t needed_ = 0;
  std::atomic<Use> use_{Use::kFree};
};

}  // namespace tactum::inline v0_1
