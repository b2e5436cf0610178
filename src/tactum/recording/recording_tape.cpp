#include "tactum/recording/recording_tape.h"

#include <fmt/format.h>

#include <utility>

namespace tactum::inline v0_1 {

Result<std::unique_ptr<RecordingTape>> RecordingTape::open(const McapSource& source,
                                                           const std::string& name) {
  std::unique_ptr<RecordingTape> tape(new RecordingTape(source, name));
  tape->end_ = read_recording(source, *tape, &tape->tables_);
  tape->indexed_ = true;
  tape->read_again();
  if (!tape->sound_) return *tape->end_.wrong;
  while (!tape->snapshots_.empty() && tape->snapshots_.back().index >= tape->past_)
    tape->snapshots_.pop_back();
  tape->rewind();
  return tape;
}

Result<void> RecordingTape::begin(Files files) {
  files_ = std::move(files);
  sound_ = true;
  return {};
}

/// The number of the chunk whose messages are being read, while the file is read for the first time.
std::size_t RecordingTape::this_chunk() {
  if (chunks_.empty() || chunks_.back() != chunk_offset()) chunks_.push_back(chunk_offset());
  return chunks_.size() - 1;
}

Result<void> RecordingTape::command(const RecordedCommand& command) {
  if (indexed_)
    coming_.commands.push_back(command);
  else
    this_chunk();
  return {};
}

Result<void> RecordingTape::input(const RecordedInput& input) {
  if (!indexed_) {
    this_chunk();
    if (any_ && input.tick.index != past_ && !gap_) gap_ = input.tick.index;
    if (!any_) first_ = past_ = input.tick.index;
    any_ = true;
    return {};
  }
  frames_.push_back(std::exchange(coming_, {}));
  frames_.back().input = input;
  return {};
}

Result<void> RecordingTape::hand(const RecordedHand& hand) {
  if (!indexed_) {
    this_chunk();
    return {};
  }
  if (frames_.empty()) return {};
  std::vector<RecordedHand>& others = frames_.back().others;
  if (hand.index != frames_.back().input.tick.index || hand.hand != others.size() + 1)
    return Error{"a hand is not that of its frame", fmt::format("hand {} of frame {}", hand.hand, hand.index),
                 fmt::format("hand {} of frame {}", others.size() + 1, frames_.back().input.tick.index),
                 name()};
  others.push_back(hand);
  return {};
}

Result<void> RecordingTape::report(const std::vector<double>& numbers) {
  if (!indexed_ && any_ && !gap_)
    ++past_;  // a frame counts when all of it is there
  else if (indexed_ && !frames_.empty())
    frames_.back().report = numbers;
  return {};
}

Result<void> RecordingTape::snapshot(const RecordedSnapshot& snapshot) {
  if (indexed_)
    coming_.snapshot = recording::snapshot_message(snapshot);
  else if (!gap_ && (!any_ || snapshot.index == past_))
    snapshots_.push_back({snapshot.index, this_chunk()});
  return {};
}

void RecordingTape::rewind() {
  chunk_ = at_ = 0;
  from_ = first_;
  frames_.clear();
  coming_ = {};
}

void RecordingTape::go_to(const TapeSnapshot& snapshot) {
  rewind();
  chunk_ = snapshot.chunk;
  from_ = snapshot.index;
}

Result<const TapeFrame*> RecordingTape::next() {
  while (from_ < past_) {
    // A frame's report may stand in the chunk behind that of its input.
    const bool waits = at_ + 1 == frames_.size() && frames_[at_].report.empty() && chunk_ < chunks_.size();
    if (at_ < frames_.size() && !waits) {
      const TapeFrame& frame = frames_[at_++];
      if (frame.input.tick.index < from_) continue;
      from_ = frame.input.tick.index + 1;
      return &frame;
    }
    if (chunk_ >= chunks_.size()) break;
    frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ = 0;
    const Result<void> read = read_mcap_chunk(source_, name(), tables_, chunks_[chunk_++], *this);
    if (read) continue;
    // What ended the first reading ends this one at the same message; the frames before it are there.
    chunk_ = chunks_.size();
    if (!end_.wrong) return read.error();
  }
  return nullptr;
}

}  // namespace tactum::inline v0_1
