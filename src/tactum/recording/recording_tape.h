#pragma once
/// A recording to be read frame by frame, from any of its snapshots. Opening it reads the file once, with
/// every check; from then on one chunk at a time is in memory.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/recording_visitor.h"

namespace tactum::inline v0_1 {

/// A frame as it was recorded, with what came before it.
struct TapeFrame {
  std::vector<RecordedCommand> commands;  ///< carried out before it
  std::string snapshot;                   ///< the message of the state it begins with; empty: none is there
  RecordedInput input;
  std::vector<RecordedHand> others;  ///< of the second hand and all after it
  std::vector<double> report;        ///< put_report()
};

/// A place from which a replay can begin.
struct TapeSnapshot {
  std::uint64_t index = 0;  ///< the frame that begins with it
  std::size_t chunk = 0;    ///< in which its message stands
};

class RecordingTape final : private RecordingVisitor {
 public:
  /// An error where the file has no head, or its files are not the recorded ones. Damage behind the head is
  /// end(): the frames before it are there. `source` must outlive the tape; `name` is for errors.
  static Result<std::unique_ptr<RecordingTape>> open(const McapSource& source, const std::string& name);

  using RecordingVisitor::head;
  using RecordingVisitor::name;
  /// The content of the recorded files, by attachment. May be moved away.
  std::map<std::string, std::string>& files() noexcept { return files_; }
  /// How the file ended.
  const McapEnd& end() const noexcept { return end_; }

  /// The first frame, and one past the last before frames are missing or the file ends.
  std::uint64_t first() const noexcept { return first_; }
  std::uint64_t past() const noexcept { return past_; }
  /// The frame before which some are missing: nothing from there on is read.
  const std::optional<std::uint64_t>& gap() const noexcept { return gap_; }
  /// In rising order.
  const std::vector<TapeSnapshot>& snapshots() const noexcept { return snapshots_; }

  /// next() gives the first frame; or the one that begins with the snapshot, which has it with it.
  void rewind();
  void go_to(const TapeSnapshot& snapshot);
  /// Null behind the last frame. It stays until the next call.
  Result<const TapeFrame*> next();

 private:
  RecordingTape(const McapSource& source, const std::string& name)
      : RecordingVisitor(name), source_(source) {}
  Result<void> begin(Files files) override;
  Result<void> command(const RecordedCommand& command) override;
  Result<void> input(const RecordedInput& input) override;
  Result<void> hand(const RecordedHand& hand) override;
  Result<void> report(const std::vector<double>& numbers) override;
  Result<void> snapshot(const RecordedSnapshot& snapshot) override;
  std::size_t this_chunk();

  const McapSource& source_;
  Files files_;
  McapTables tables_;
  McapEnd end_;
  bool sound_ = false;                 // its head, and its files are the recorded ones
  bool indexed_ = false;               // the file has been read once
  std::vector<std::uint64_t> chunks_;  // their places in the file
  std::vector<TapeSnapshot> snapshots_;
  std::uint64_t first_ = 0, past_ = 0;
  bool any_ = false;
  std::optional<std::uint64_t> gap_;
  // Of the chunks read on from where next() is.
  std::size_t chunk_ = 0;          // the next to be read
  std::uint64_t from_ = 0;         // frames before this one are passed over
  std::vector<TapeFrame> frames_;  // the last of them may lack what stands in the next chunk
  std::size_t at_ = 0;             // the next of them
  TapeFrame coming_;               // commands and snapshot of the frame that follows
};

}  // namespace tactum::inline v0_1
