#include "tactum/recording/mcap_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tactum/recording/byte_io.h"
#include "tactum/recording/compression.h"
#include "tactum/recording/crc32.h"

namespace tactum::inline v0_1 {
namespace {

using mcap::Op;

/// A record as it stands in the file.
std::string record_of(Op op, std::string_view content) {
  std::string record;
  ByteWriter out(record);
  out.number(static_cast<std::uint8_t>(op));
  out.number(static_cast<std::uint64_t>(content.size()));
  out.bytes(content);
  return record;
}

void put_texts(ByteWriter& out, const mcap::Texts& texts) {
  std::string entries;
  ByteWriter inner(entries);
  for (const auto& [key, value] : texts) {
    inner.text(key);
    inner.text(value);
  }
  out.text(entries);
}

std::string schema_record(std::uint16_t id, const mcap::Schema& schema) {
  std::string content;
  ByteWriter out(content);
  out.number(id);
  out.text(schema.name);
  out.text(schema.encoding);
  out.text(schema.data);
  return record_of(Op::kSchema, content);
}

std::string channel_record(std::uint16_t id, const mcap::Channel& channel) {
  std::string content;
  ByteWriter out(content);
  out.number(id);
  out.number(channel.schema);
  out.text(channel.topic);
  out.text(channel.encoding);
  put_texts(out, channel.metadata);
  return record_of(Op::kChannel, content);
}

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::open(const std::string& path, const std::string& profile,
                                                     const std::string& library) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0)
    return Error{"cannot write the recording", std::strerror(errno), "a file that can be written", path};
  std::unique_ptr<McapWriter> writer(new McapWriter(path, file));
  std::string header;
  ByteWriter out(header);
  out.text(profile);
  out.text(library);
  writer->write(mcap::kMagic);
  writer->write_record(Op::kHeader, header);
  if (writer->trouble()) return *writer->trouble();
  return writer;
}

McapWriter::~McapWriter() {
  if (file_ >= 0) ::close(file_);
}

void McapWriter::fail(const std::string& what, const std::string& found) {
  if (trouble_) return;
  trouble_ = Error{what, found, fmt::format("a recording that goes on beyond {} bytes", offset_), path_};
}

void McapWriter::write(std::string_view bytes) {
  while (!bytes.empty() && !trouble_) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return fail("cannot write more of the recording", std::strerror(errno));
    const std::string_view taken = bytes.substr(0, static_cast<std::size_t>(written));
    crc_ = crc32(taken, crc_);
    offset_ += taken.size();
    bytes.remove_prefix(taken.size());
  }
}

void McapWriter::write_record(Op op, std::string_view content) { write(record_of(op, content)); }

std::uint16_t McapWriter::add_schema(mcap::Schema schema) {
  schemas_.push_back(std::move(schema));
  const auto id = static_cast<std::uint16_t>(schemas_.size());
  chunk_ += schema_record(id, schemas_.back());
  return id;
}

std::uint16_t McapWriter::add_channel(mcap::Channel channel) {
  channels_.push_back(std::move(channel));
  index_.emplace_back();
  sequence_.push_back(0);
  counts_.push_back(0);
  const auto id = static_cast<std::uint16_t>(channels_.size());
  chunk_ += channel_record(id, channels_.back());
  return id;
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view data) {
  if (trouble_) return;
  const std::size_t place = channel - 1u;
  const bool first =
      std::all_of(index_.begin(), index_.end(), [](const auto& entries) { return entries.empty(); });
  first_ns_ = first ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = first ? time_ns : std::max(last_ns_, time_ns);
  index_[place].push_back({time_ns, chunk_.size()});
  ++counts_[place];
  ByteWriter out(chunk_);
  out.number(static_cast<std::uint8_t>(Op::kMessage));
  out.number(static_cast<std::uint64_t>(22 + data.size()));
  out.number(channel);
  out.number(sequence_[place]++);
  out.number(time_ns);
  out.number(time_ns);
  out.bytes(data);
}

/// The MessageIndex records of the chunk, the first of which stands at `at`, and the map to them.
void McapWriter::add_message_indexes(std::string& offsets, std::string& records, std::uint64_t at) {
  ByteWriter map(offsets);
  for (std::size_t place = 0; place < index_.size(); ++place) {
    if (index_[place].empty()) continue;
    std::string entries;
    ByteWriter entry(entries);
    for (const Indexed& message : index_[place]) {
      entry.number(message.time_ns);
      entry.number(message.offset);
    }
    std::string content;
    ByteWriter out(content);
    out.number(static_cast<std::uint16_t>(place + 1));
    out.text(entries);
    map.number(static_cast<std::uint16_t>(place + 1));
    map.number(at + records.size());
    records += record_of(Op::kMessageIndex, content);
    index_[place].clear();
  }
}

void McapWriter::end_chunk() {
  if (chunk_.empty() || trouble_) return;
  struct stat status {};
  if (::fstat(file_, &status) == 0 && status.st_nlink == 0)
    return fail("the recording was removed while it was written", "no such file any more");
  const std::string packed = compressed(chunk_);
  std::string content;
  ByteWriter out(content);
  out.number(first_ns_);
  out.number(last_ns_);
  out.number(static_cast<std::uint64_t>(chunk_.size()));
  out.number(crc32(chunk_));
  out.text(kCompression);
  out.number(static_cast<std::uint64_t>(packed.size()));
  out.bytes(packed);
  const std::string chunk = record_of(Op::kChunk, content);
  std::string offsets, indexes;
  add_message_indexes(offsets, indexes, offset_ + chunk.size());

  std::string index;
  ByteWriter entry(index);
  entry.number(first_ns_);
  entry.number(last_ns_);
  entry.number(offset_);
  entry.number(static_cast<std::uint64_t>(chunk.size()));
  entry.text(offsets);
  entry.number(static_cast<std::uint64_t>(indexes.size()));
  entry.text(kCompression);
  entry.number(static_cast<std::uint64_t>(packed.size()));
  entry.number(static_cast<std::uint64_t>(chunk_.size()));
  chunk_indexes_ += record_of(Op::kChunkIndex, index);
  file_first_ns_ = chunks_ == 0 ? first_ns_ : std::min(file_first_ns_, first_ns_);
  file_last_ns_ = std::max(file_last_ns_, last_ns_);
  ++chunks_;
  chunk_.clear();
  write(chunk + indexes);
}

void McapWriter::add_attachment(const mcap::Attachment& attachment) {
  std::string content;
  ByteWriter out(content);
  out.number(std::uint64_t{0});
  out.number(std::uint64_t{0});
  out.text(attachment.name);
  out.text(attachment.media_type);
  out.number(static_cast<std::uint64_t>(attachment.data.size()));
  out.bytes(attachment.data);
  out.number(crc32(content));
  std::string index;
  ByteWriter entry(index);
  entry.number(offset_);
  entry.number(mcap::kRecordHead + content.size());
  entry.number(std::uint64_t{0});
  entry.number(std::uint64_t{0});
  entry.number(static_cast<std::uint64_t>(attachment.data.size()));
  entry.text(attachment.name);
  entry.text(attachment.media_type);
  attachment_indexes_ += record_of(Op::kAttachmentIndex, index);
  ++attachments_;
  write_record(Op::kAttachment, content);
}

void McapWriter::add_metadata(const std::string& name, const mcap::Texts& texts) {
  std::string content;
  ByteWriter out(content);
  out.text(name);
  put_texts(out, texts);
  std::string index;
  ByteWriter entry(index);
  entry.number(offset_);
  entry.number(mcap::kRecordHead + content.size());
  entry.text(name);
  metadata_indexes_ += record_of(Op::kMetadataIndex, index);
  ++metadata_;
  write_record(Op::kMetadata, content);
}

/// Appends the records of one kind to the summary, and where they stand to the offsets.
void McapWriter::add_group(std::string& summary, std::string& offsets, Op op, std::string_view records,
                           std::uint64_t start) const {
  if (records.empty()) return;
  std::string content;
  ByteWriter out(content);
  out.number(static_cast<std::uint8_t>(op));
  out.number(start + summary.size());
  out.number(static_cast<std::uint64_t>(records.size()));
  offsets += record_of(Op::kSummaryOffset, content);
  summary += records;
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  std::string by_channel;
  ByteWriter map(by_channel);
  for (std::size_t place = 0; place < counts_.size(); ++place) {
    messages += counts_[place];
    map.number(static_cast<std::uint16_t>(place + 1));
    map.number(counts_[place]);
  }
  std::string content;
  ByteWriter out(content);
  out.number(messages);
  out.number(static_cast<std::uint16_t>(schemas_.size()));
  out.number(static_cast<std::uint32_t>(channels_.size()));
  out.number(attachments_);
  out.number(metadata_);
  out.number(chunks_);
  out.number(file_first_ns_);
  out.number(file_last_ns_);
  out.text(by_channel);
  return record_of(Op::kStatistics, content);
}

void McapWriter::close() {
  if (file_ < 0) return;
  end_chunk();
  std::string end;
  ByteWriter(end).number(crc_);
  write_record(Op::kDataEnd, end);
  const std::uint64_t start = offset_;
  std::string summary, offsets, schemas, channels;
  for (std::size_t i = 0; i < schemas_.size(); ++i)
    schemas += schema_record(static_cast<std::uint16_t>(i + 1), schemas_[i]);
  for (std::size_t i = 0; i < channels_.size(); ++i)
    channels += channel_record(static_cast<std::uint16_t>(i + 1), channels_[i]);
  add_group(summary, offsets, Op::kSchema, schemas, start);
  add_group(summary, offsets, Op::kChannel, channels, start);
  add_group(summary, offsets, Op::kStatistics, statistics(), start);
  add_group(summary, offsets, Op::kChunkIndex, chunk_indexes_, start);
  add_group(summary, offsets, Op::kAttachmentIndex, attachment_indexes_, start);
  add_group(summary, offsets, Op::kMetadataIndex, metadata_indexes_, start);
  std::string footer;
  ByteWriter out(footer);
  out.number(start);
  out.number(start + summary.size());
  std::string checked = summary + offsets;  // and the footer up to its checksum
  checked +=
      record_of(Op::kFooter, footer + std::string(4, '\0')).substr(0, mcap::kRecordHead + footer.size());
  out.number(crc32(checked));
  write(summary + offsets + record_of(Op::kFooter, footer) + std::string(mcap::kMagic));
  if (::close(file_) != 0) fail("cannot end the recording", std::strerror(errno));
  file_ = -1;
}

}  // namespace tactum::inline v0_1
