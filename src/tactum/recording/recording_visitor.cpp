#include "tactum/recording/recording_visitor.h"

#include <fmt/format.h>

#include "tactum/base/hash.h"
#include "tactum/recording/frame_numbers.h"

namespace tactum::inline v0_1 {

Result<void> RecordingVisitor::attachment(mcap::Attachment attachment, std::uint64_t offset) {
  if (begun()) return {};  // of another program: a recording has its files before its head
  if (files_.contains(attachment.name))
    return Error{"an Attachment stands twice", attachment.name, "each once",
                 fmt::format("{}, byte {}", name_, offset)};
  places_[attachment.name] = offset;
  files_[attachment.name] = std::move(attachment.data);
  return {};
}

Result<void> RecordingVisitor::check_files() {
  for (const RecordedFile& file : head_->files) {
    const auto found = files_.find(file.attachment);
    if (found == files_.end())
      return Error{"a file of the recording is missing", file.attachment, "an Attachment of this name",
                   name_};
    Hash hash;
    hash.add_bytes(found->second.data(), found->second.size());
    if (hash.value() != file.hash)
      return Error{fmt::format("\"{}\" is not the file that was recorded", file.attachment),
                   fmt::format("hash {:016x}", hash.value()), fmt::format("{:016x}", file.hash),
                   fmt::format("{}, byte {}", name_, places_[file.attachment])};
  }
  return {};
}

Result<void> RecordingVisitor::message(const McapMessage& message) {
  const std::string& topic = message.channel.topic;
  const std::string where = fmt::format("{}, byte {}, {}", name_, message.chunk_offset, topic);
  const auto broken = [&](const char* expected) {
    return Error{"a message is of another form", fmt::format("{} bytes", message.data.size()), expected,
                 where};
  };
  chunk_offset_ = message.chunk_offset;
  if (topic == recording::kRun) {
    if (reads_again_) return {};
    if (begun()) return Error{"there is a second head", "", "one", where};
    Result<RunHead> head = read_head(message.data, where);
    if (!head) return head.error();
    head_ = std::move(*head);
    if (Result<void> sound = check_files(); !sound) return sound;
    return begin(std::move(files_));
  }
  if (!topic.starts_with("/tactum/")) return {};
  if (!begun()) return Error{"a frame comes before the head", "", "/tactum/run first", where};
  if (topic == recording::kInput) {
    RecordedInput read;
    return recording::read_input(message.data, read) ? input(read) : broken("a tactum/Input");
  }
  if (topic == recording::kHand) {
    const bool one = recording::read_hand(message.data, hand_) && hand_.hand >= 1 &&
                     hand_.hand <= head_->other_devices.size();
    return one ? hand(hand_) : broken("a tactum/Hand of one of the devices");
  }
  if (topic == recording::kCommand) {
    RecordedCommand read;
    return recording::read_command(message.data, read) ? command(read) : broken("a tactum/Command");
  }
  if (topic == recording::kContacts)
    return recording::read_contacts(message.data, contacts_) ? contacts(contacts_)
                                                             : broken("a tactum/Contacts");
  if (topic == recording::kSnapshot) {
    RecordedSnapshot read;
    return recording::read_snapshot_message(message.data, read) ? snapshot(read)
                                                                : broken("a tactum/Snapshot");
  }
  const bool is_report = topic == recording::kReport;
  if (!is_report && topic != recording::kFrame) return {};
  numbers_.resize(is_report ? report_numbers().size() : head_->columns.size());
  if (!recording::read_numbers(message.data, numbers_))
    return broken(is_report ? "the fields of this program's report" : "a number for each column");
  return is_report ? report(numbers_) : row(numbers_);
}

McapEnd read_recording(const McapSource& source, RecordingVisitor& visitor, McapTables* tables) {
  McapEnd end = read_mcap(source, visitor.name(), visitor, tables);
  if (!visitor.begun() && !end.wrong)
    end.wrong =
        Error{"there is no run in the file", "another MCAP file", "a recording of Tactum", visitor.name()};
  if (!visitor.begun()) end.complete = false;
  return end;
}

}  // namespace tactum::inline v0_1
