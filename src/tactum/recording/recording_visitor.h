#pragma once
/// Reads the messages of a recording: what is in an MCAP file becomes a head, files, commands and frames.
/// Everything is checked before it is passed on, and an error names the byte of its chunk, the channel and
/// what is wrong.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tactum/recording/frame_slot.h"
#include "tactum/recording/mcap_reader.h"
#include "tactum/recording/recorded_contacts.h"
#include "tactum/recording/run_head.h"

namespace tactum::inline v0_1 {

class RecordingVisitor : public McapVisitor {
 public:
  /// `name` is the file's, for errors.
  explicit RecordingVisitor(std::string name) : name_(std::move(name)) {}

  Result<void> attachment(mcap::Attachment attachment, std::uint64_t offset) final;
  Result<void> message(const McapMessage& message) final;

  /// Whether the head has been read.
  bool begun() const noexcept { return head_.has_value(); }
  const RunHead& head() const { return *head_; }
  const std::string& name() const noexcept { return name_; }

 protected:
  using Files = std::map<std::string, std::string>;  ///< content by name of the attachment

  /// The head and the files, whose content is the recorded one. Called once, first.
  virtual Result<void> begin(Files files) = 0;
  virtual Result<void> command(const RecordedCommand&) { return {}; }
  /// The messages of a frame come in this order, each once; `columns` as in RunHead.
  virtual Result<void> input(const RecordedInput&) { return {}; }
  /// Of every further hand in turn, where there are several.
  virtual Result<void> hand(const RecordedHand&) { return {}; }
  virtual Result<void> report(const std::vector<double>&) { return {}; }
  virtual Result<void> row(const std::vector<double>&) { return {}; }
  /// Last of a frame, and only of one that has some.
  virtual Result<void> contacts(const RecordedContacts&) { return {}; }
  /// Between two frames, now and then.
  virtual Result<void> snapshot(const RecordedSnapshot&) { return {}; }

  /// From here on chunks are read a second time: a head in them is the one that is known.
  void read_again() noexcept { reads_again_ = true; }
  /// Where the chunk of the message that was passed last begins in the file.
  std::uint64_t chunk_offset() const noexcept { return chunk_offset_; }

 private:
  Result<void> check_files();

  std::string name_;
  Files files_;
  std::map<std::string, std::uint64_t> places_;  // of the files, for errors
  std::optional<RunHead> head_;
  std::uint64_t chunk_offset_ = 0;
  bool reads_again_ = false;
  std::vector<double> numbers_;
  RecordedContacts contacts_;
  RecordedHand hand_;
};

/// Reads a whole recording: read_mcap(), and an error of its own where the file has no head.
McapEnd read_recording(const McapSource& source, RecordingVisitor& visitor, McapTables* tables = nullptr);

}  // namespace tactum::inline v0_1
