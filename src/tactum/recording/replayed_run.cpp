#include "tactum/recording/replayed_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "tactum/haptics/frame_snapshot.h"

namespace tactum::inline v0_1 {

Result<std::unique_ptr<ReplayedRun>> ReplayedRun::open(const McapSource& source, const std::string& name,
                                                       const ReplayOptions& options) {
  Result<std::unique_ptr<RecordingTape>> tape = RecordingTape::open(source, name);
  if (!tape) return tape.error();
  std::unique_ptr<ReplayedRun> run(new ReplayedRun(std::move(*tape), options));
  if (Result<void> begun = run->begin(); !begun) return begun.error();
  return run;
}

/// Builds the scene, keeps its state, and finds out whether the snapshots are of such a one.
Result<void> ReplayedRun::begin() {
  Result<RecordedScene> built = build_recorded(tape_->head(), tape_->files(), options_, tape_->name());
  if (!built) return built.error();
  tape_->files().clear();
  scene_ = std::move(*built);
  settings_ = scene_.simulation->settings();
  safety_ = scene_.safety;
  state_.resize(write_snapshot(scene_.simulation->state(), {}));
  write_snapshot(scene_.simulation->state(), state_);
  if (!tape_->snapshots().empty()) {
    tape_->go_to(tape_->snapshots().front());
    const Result<const TapeFrame*> frame = tape_->next();
    RecordedSnapshot snapshot;
    usable_ = frame && *frame != nullptr && recording::read_snapshot_message((*frame)->snapshot, snapshot) &&
              snapshot.layout == recording::layout_of_snapshots(scene_.simulation->state());
  }
  return restore(-1);
}

Result<void> ReplayedRun::restore_start() {
  scene_.simulation->settings() = settings_;
  scene_.safety = safety_;
  return scene_.simulation->restore(state_, tape_->first());
}

int ReplayedRun::snapshot_before(std::uint64_t index) const noexcept {
  if (!usable_) return -1;
  const std::vector<TapeSnapshot>& all = tape_->snapshots();
  const auto behind = std::upper_bound(all.begin(), all.end(), index,
                                       [](std::uint64_t at, const TapeSnapshot& s) { return at < s.index; });
  return static_cast<int>(behind - all.begin()) - 1;
}

Result<void> ReplayedRun::restore(int snapshot) {
  const std::vector<TapeSnapshot>& all = tape_->snapshots();
  // A recording that was begun in the middle of a run begins with a snapshot.
  if (snapshot < 0 && tape_->first() > 0) {
    if (!usable_ || all.front().index != tape_->first())
      return Error{"the recording begins in the middle of a run", "no state there that can be gone on from",
                   "a snapshot of the same response and version of the program", tape_->name()};
    snapshot = 0;
  }
  needs_state_ = snapshot >= 0;
  if (!needs_state_) {
    tape_->rewind();
    next_ = tape_->first();
    return restore_start();
  }
  tape_->go_to(all[static_cast<std::size_t>(snapshot)]);
  next_ = all[static_cast<std::size_t>(snapshot)].index;
  return {};
}

Result<void> ReplayedRun::seek(std::uint64_t index) {
  const std::uint64_t least = tape_->first();
  index = std::clamp(index, least, std::max(least, tape_->past()));
  const int snapshot = snapshot_before(index);
  const std::uint64_t from =
      snapshot < 0 ? least : tape_->snapshots()[static_cast<std::size_t>(snapshot)].index;
  if (index < next_ || from > next_)
    if (Result<void> restored = restore(snapshot); !restored) return restored;
  while (next_ < index) {
    const Result<const TapeFrame*> frame = step();
    if (!frame) return frame.error();
    if (*frame == nullptr) break;
  }
  return {};
}

Result<void> ReplayedRun::take_over(const std::string& message) {
  RecordedSnapshot snapshot;
  if (!recording::read_snapshot_message(message, snapshot))
    return Error{"a snapshot is not there any more", "", "the recording as it was", tape_->name()};
  needs_state_ = false;
  return scene_.restore(snapshot, options_, tape_->name());
}

/// The frame, of one hand or of several.
Result<void> ReplayedRun::compute(const TapeFrame& frame) {
  const std::size_t others = scene_.device_limits.size() - 1;
  if (frame.others.size() != others)
    return Error{fmt::format("frame {} lacks what came from a hand", frame.input.tick.index),
                 std::to_string(1 + frame.others.size()), std::to_string(1 + others) + " hands",
                 tape_->name()};
  if (others == 0) {
    scene_.simulation->run(frame.input.sample, frame.input.tick);
    return {};
  }
  samples_.resize(1 + others);
  wrenches_.resize(1 + others);
  static_cast<DeviceSample&>(samples_.front()) = frame.input.sample;
  samples_.front().refused = frame.input.tick.refused;
  for (std::size_t i = 0; i < others; ++i) samples_[i + 1] = frame.others[i].sample;
  scene_.simulation->run(samples_, frame.input.tick, wrenches_);
  return {};
}

Result<const TapeFrame*> ReplayedRun::step(const std::function<void(const TapeFrame&)>& begin) {
  Result<const TapeFrame*> read = tape_->next();
  if (!read || *read == nullptr) return read;
  const TapeFrame& frame = **read;
  if (needs_state_)
    if (Result<void> taken = take_over(frame.snapshot); !taken) return taken.error();
  if (begin) begin(frame);
  for (const RecordedCommand& recorded : frame.commands)  // those that lead the hand came in by the samples
    if (recorded.command.kind == SessionCommand::Kind::kSet)
      set_live(recorded.command, scene_.device_limits, scene_.simulation->settings(), scene_.safety);
  if (Result<void> computed = compute(frame); !computed) return computed.error();
  next_ = frame.input.tick.index + 1;
  return &frame;
}

}  // namespace tactum::inline v0_1
