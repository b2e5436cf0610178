#pragma once
/// The run of a recording, computed again frame by frame, forth and back.

#include <functional>
#include <memory>
#include <string>

#include "tactum/recording/recorded_scene.h"
#include "tactum/recording/recording_tape.h"

namespace tactum::inline v0_1 {

class ReplayedRun {
 public:
  /// Errors of RecordingTape::open(), and a scene that does not build. The run stands before its first frame.
  /// `source` must outlive it.
  static Result<std::unique_ptr<ReplayedRun>> open(const McapSource& source, const std::string& name,
                                                   const ReplayOptions& options);

  const RecordingTape& tape() const noexcept { return *tape_; }
  const RecordedScene& scene() const noexcept { return scene_; }
  const Simulation& simulation() const noexcept { return *scene_.simulation; }

  /// The frame that step() computes next.
  std::uint64_t next_index() const noexcept { return next_; }
  /// Goes to where step() computes this frame, or the nearest one that is there: from the last snapshot
  /// before it, or from here where that is nearer. Cost: a read of some chunks, and the frames between.
  Result<void> seek(std::uint64_t index);
  /// The last snapshot at or before a frame, as a number of tape().snapshots(); -1: there is none, or this
  /// replay cannot go on from them, as with another response.
  int snapshot_before(std::uint64_t index) const noexcept;
  /// Goes to the frame that begins with a snapshot; -1: to the first of all.
  Result<void> restore(int snapshot);
  /// Computes the next frame; what was recorded of it, null behind the last one. Before it, `begin` sees the
  /// recorded frame while state and settings are those that the frame before it has left: none of its
  /// commands is carried out yet.
  Result<const TapeFrame*> step(const std::function<void(const TapeFrame&)>& begin = nullptr);

 private:
  ReplayedRun(std::unique_ptr<RecordingTape> tape, ReplayOptions options)
      : tape_(std::move(tape)), options_(std::move(options)) {}
  Result<void> begin();
  Result<void> restore_start();
  Result<void> compute(const TapeFrame& frame);
  Result<void> take_over(const std::string& message);

  std::unique_ptr<RecordingTape> tape_;
  ReplayOptions options_;
  RecordedScene scene_;
  FrameSettings settings_;  // before the first frame, as the state is
  SafetySettings safety_;
  std::string state_;
  std::vector<HandSample> samples_;  // of every hand, where there are several
  std::vector<Wrench> wrenches_;
  std::uint64_t next_ = 0;
  bool usable_ = false;       // it can go on from the recorded snapshots
  bool needs_state_ = false;  // the next frame's snapshot must be taken over first
};

}  // namespace tactum::inline v0_1
