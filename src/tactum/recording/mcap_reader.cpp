#include "tactum/recording/mcap_reader.h"

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

constexpr std::uint64_t kMessageHead = 22;  // bytes of a message before its data

/// A record where it stands.
struct Record {
  Op op{};
  std::uint64_t offset = 0;
  std::string_view content;
};

/// The walk through one file. Each function returns false when the reading is over; end_ then says why.
class Walk {
 public:
  Walk(const McapSource& source, const std::string& name, McapVisitor& visitor)
      : source_(source), name_(name), visitor_(visitor) {}

  McapEnd run() {
    if (read_magic("the first")) {
      end_.good_to = at_;
      while (next()) {
      }
    }
    return std::move(end_);
  }
  McapTables& tables() { return tables_; }

  /// One chunk alone.
  Result<void> run_chunk(std::uint64_t offset) {
    at_ = offset;
    begun_ = true;
    std::string head;
    bool taken = fetch(at_, mcap::kRecordHead, head);
    if (taken) {
      ByteReader in(head);
      Record record{static_cast<Op>(in.number<std::uint8_t>()), at_, {}};
      taken = fetch(at_ + mcap::kRecordHead, in.number<std::uint64_t>(), content_);
      record.content = content_;
      taken = taken && (record.op == Op::kChunk ? take_chunk(record)
                                                : wrong(record, "the place", "that of a chunk", "a Chunk"));
    }
    if (!taken) return *end_.wrong;
    return {};
  }

 private:
  bool wrong(const Record& record, const std::string& what, const std::string& found,
             const std::string& expected) {
    end_.wrong = Error{fmt::format("{} of a {} record", what, mcap::name_of(record.op)), found, expected,
                       fmt::format("{}, byte {}", name_, record.offset)};
    return false;
  }
  bool cut(const std::string& found) {
    end_.cut = true;
    end_.wrong = Error{"the file was cut, or a length in it is damaged", found, "a whole record",
                       fmt::format("{}, byte {}", name_, end_.good_to)};
    return false;
  }
  bool fetch(std::uint64_t offset, std::uint64_t size, std::string& bytes) {
    if (offset > source_.size() || size > source_.size() - offset)
      return cut(fmt::format("{} bytes of {}", source_.size() - std::min(offset, source_.size()), size));
    if (source_.read(offset, static_cast<std::size_t>(size), bytes)) return true;
    end_.wrong = Error{"cannot read the file", "a read error", "a readable file",
                       fmt::format("{}, byte {}", name_, offset)};
    return false;
  }
  bool read_magic(const char* which) {
    std::string magic;
    if (!fetch(at_, mcap::kMagic.size(), magic)) return false;
    if (magic != mcap::kMagic) {
      end_.wrong = Error{fmt::format("{} eight bytes are not those of an MCAP file", which), "others",
                         "\\x89MCAP0\\r\\n", fmt::format("{}, byte {}", name_, at_)};
      return false;
    }
    crc_ = crc32(magic, crc_);
    at_ += magic.size();
    return true;
  }

  bool next();
  bool take(const Record& record);
  bool take_end(const Record& record);
  bool take_footer(const Record& record);
  bool take_attachment(const Record& record);
  bool take_chunk(const Record& record);
  bool take_index(const Record& record);
  bool take_records(const Record& chunk, std::string_view records);
  bool take_schema(const Record& record);
  bool take_channel(const Record& record);
  bool take_message(const Record& chunk, const Record& record, std::uint64_t place);
  bool obeyed(const Result<void>& visited) {
    if (!visited) end_.wrong = visited.error();
    return static_cast<bool>(visited);
  }

  const McapSource& source_;
  const std::string& name_;
  McapVisitor& visitor_;
  McapEnd end_;
  std::uint64_t at_ = 0;
  std::uint32_t crc_ = 0;  // from the start of the file, then from that of the summary
  bool begun_ = false;     // the Header was there
  bool in_summary_ = false;
  std::uint64_t summary_start_ = 0;
  std::string content_;
  McapTables tables_;
  std::map<std::uint16_t, std::string>
      index_;                                 // entries that the last chunk's MessageIndex records must have
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  // of the chunk
  bool any_ = false;                          // ... which has messages
};

bool Walk::next() {
  std::string head;
  if (!fetch(at_, mcap::kRecordHead, head)) return false;
  ByteReader in(head);
  Record record{static_cast<Op>(in.number<std::uint8_t>()), at_, {}};
  const auto size = in.number<std::uint64_t>();
  if (record.op != Op::kAttachment && size > 2 * mcap::kLargestChunk)
    return wrong(record, "the length", fmt::format("{} bytes", size),
                 fmt::format("at most {}", 2 * mcap::kLargestChunk));
  if (!fetch(at_ + mcap::kRecordHead, size, content_)) return false;
  record.content = content_;
  if (!begun_ && record.op != Op::kHeader) return wrong(record, "the place", "the first", "a Header first");
  if (record.op == Op::kFooter) return take_footer(record);
  if (record.op == Op::kDataEnd) return take_end(record);
  crc_ = crc32(content_, crc32(head, crc_));
  at_ += mcap::kRecordHead + size;
  if (!in_summary_ && !take(record)) return false;  // the summary repeats what was read; its checksum counts
  end_.good_to = at_;
  return true;
}

bool Walk::take(const Record& record) {
  switch (record.op) {
    case Op::kHeader:
      if (begun_) return wrong(record, "the place", "a second", "one at the start");
      return begun_ = true;
    case Op::kSchema:
      return take_schema(record);
    case Op::kChannel:
      return take_channel(record);
    case Op::kChunk:
      return take_chunk(record);
    case Op::kMessageIndex:
      return take_index(record);
    case Op::kAttachment:
      return take_attachment(record);
    case Op::kMetadata:
      return true;
    case Op::kMessage:
      return wrong(record, "the place", "outside of a chunk", "in a chunk, under its checksum");
    default:
      if (static_cast<unsigned>(record.op) >= 0x80) return true;  // the format leaves these to anybody
      return wrong(record, "the code", fmt::format("{}", static_cast<unsigned>(record.op)),
                   "a record that belongs before the summary");
  }
}

bool Walk::take_end(const Record& record) {
  ByteReader in(record.content);
  const auto crc = in.number<std::uint32_t>();
  if (in_summary_ || !in.good() || !in.done()) return wrong(record, "the content", "another", "a checksum");
  if (crc != crc_)
    return wrong(
        record, "the checksum", fmt::format("{:08x}", crc),
        fmt::format("{:08x}: a byte before it is not as it was written, in a Header, a Metadata or an "
                    "index",
                    crc_));
  at_ += mcap::kRecordHead + record.content.size();
  end_.good_to = summary_start_ = at_;
  crc_ = 0;
  return in_summary_ = true;
}

bool Walk::take_footer(const Record& record) {
  if (!in_summary_) return wrong(record, "the place", "before the end of the data", "after it");
  ByteReader in(record.content);
  const auto start = in.number<std::uint64_t>();
  const auto offsets = in.number<std::uint64_t>();
  const auto crc = in.number<std::uint32_t>();
  if (!in.good() || !in.done())
    return wrong(record, "the content", fmt::format("{} bytes", record.content.size()), "20 bytes");
  std::string checked(1, static_cast<char>(record.op));
  ByteWriter out(checked);
  out.number(static_cast<std::uint64_t>(record.content.size()));
  out.number(start);
  out.number(offsets);
  crc_ = crc32(checked, crc_);
  if (crc != crc_)
    return wrong(record, "the checksum of the summary", fmt::format("{:08x}", crc),
                 fmt::format("{:08x}: a byte from {} on is not as it was written", crc_, summary_start_));
  if (start != summary_start_)
    return wrong(record, "the start of the summary", fmt::format("{}", start),
                 fmt::format("{}", summary_start_));
  at_ += mcap::kRecordHead + record.content.size();
  end_.good_to = at_;
  if (!read_magic("the last")) return false;
  if (at_ != source_.size())
    return wrong(record, "the place", fmt::format("{} more bytes behind it", source_.size() - at_),
                 "the end of the file");
  end_.good_to = at_;
  end_.complete = true;
  return false;
}

bool Walk::take_attachment(const Record& record) {
  ByteReader in(record.content);
  in.number<std::uint64_t>();
  in.number<std::uint64_t>();
  mcap::Attachment attachment;
  attachment.name = in.text();
  attachment.media_type = in.text();
  attachment.data = in.bytes(in.number<std::uint64_t>());
  const std::string_view checked = record.content.substr(0, in.at());
  const auto crc = in.number<std::uint32_t>();
  if (!in.good() || !in.done()) return wrong(record, "a length", "beyond its end", "one within it");
  if (crc != crc32(checked))
    return wrong(record, fmt::format("the checksum (\"{}\")", attachment.name), fmt::format("{:08x}", crc),
                 fmt::format("{:08x}", crc32(checked)));
  return obeyed(visitor_.attachment(std::move(attachment), record.offset));
}

bool Walk::take_chunk(const Record& record) {
  ByteReader in(record.content);
  const auto first = in.number<std::uint64_t>(), last = in.number<std::uint64_t>();
  const auto size = in.number<std::uint64_t>();
  const auto crc = in.number<std::uint32_t>();
  const std::string_view compression = in.text();
  const std::string_view packed = in.bytes(in.number<std::uint64_t>());
  if (!in.good() || !in.done()) return wrong(record, "a length", "beyond its end", "one within it");
  if (size > mcap::kLargestChunk)
    return wrong(record, "the uncompressed size", fmt::format("{}", size),
                 fmt::format("at most {}", mcap::kLargestChunk));
  index_.clear();
  any_ = false;
  std::optional<std::string> records;
  if (compression == kCompression)
    records = decompressed(packed, static_cast<std::size_t>(size));
  else if (compression.empty() && packed.size() == size)
    records = std::string(packed);
  else
    return wrong(record, "the compression", "another, or another size", "zstd, or none");
  if (!records)
    return wrong(record, "the compressed data", "other bytes", "those of zstd, of the size it has");
  if (crc != crc32(*records))
    return wrong(record, "the checksum", fmt::format("{:08x}", crc), fmt::format("{:08x}", crc32(*records)));
  if (!take_records(record, *records)) return false;
  if (any_ && (first != first_ns_ || last != last_ns_))
    return wrong(record, "the time", fmt::format("{} to {} ns", first, last),
                 fmt::format("{} to {} ns", first_ns_, last_ns_));
  return true;
}

bool Walk::take_records(const Record& chunk, std::string_view records) {
  ByteReader in(records);
  while (!in.done()) {
    const std::uint64_t place = in.at();
    Record record{static_cast<Op>(in.number<std::uint8_t>()), chunk.offset, {}};
    record.content = in.bytes(in.number<std::uint64_t>());
    if (!in.good())
      return wrong(chunk, "a record", fmt::format("beyond its end, at {} in it", place), "whole records");
    bool taken = true;
    if (record.op == Op::kSchema)
      taken = take_schema(record);
    else if (record.op == Op::kChannel)
      taken = take_channel(record);
    else if (record.op == Op::kMessage)
      taken = take_message(chunk, record, place);
    if (!taken) return false;
  }
  return true;
}

bool Walk::take_schema(const Record& record) {
  ByteReader in(record.content);
  const auto id = in.number<std::uint16_t>();
  mcap::Schema schema{std::string(in.text()), std::string(in.text()), std::string(in.text())};
  if (!in.good() || !in.done() || id == 0) return wrong(record, "the content", "broken", "a schema");
  tables_.schemas.try_emplace(id, std::move(schema));
  return true;
}

bool Walk::take_channel(const Record& record) {
  ByteReader in(record.content);
  const auto id = in.number<std::uint16_t>();
  mcap::Channel channel;
  channel.schema = in.number<std::uint16_t>();
  channel.topic = in.text();
  channel.encoding = in.text();
  ByteReader texts(in.text());
  while (texts.good() && !texts.done()) {
    std::string key(texts.text());
    channel.metadata.emplace(std::move(key), std::string(texts.text()));
  }
  if (!in.good() || !in.done() || !texts.good()) return wrong(record, "the content", "broken", "a channel");
  if (channel.schema != 0 && !tables_.schemas.contains(channel.schema))
    return wrong(record, "the schema", fmt::format("{}", channel.schema), "one that stands before it");
  tables_.channels.try_emplace(id, std::move(channel));
  return true;
}

bool Walk::take_message(const Record& chunk, const Record& record, std::uint64_t place) {
  ByteReader in(record.content);
  const auto id = in.number<std::uint16_t>();
  in.number<std::uint32_t>();
  const auto time_ns = in.number<std::uint64_t>();
  in.number<std::uint64_t>();
  if (!in.good())
    return wrong(record, "the content", fmt::format("{} bytes", record.content.size()),
                 fmt::format("at least {}", kMessageHead));
  const auto channel = tables_.channels.find(id);
  if (channel == tables_.channels.end())
    return wrong(record, "the channel", fmt::format("{}", id), "one that stands before it");
  first_ns_ = any_ ? std::min(first_ns_, time_ns) : time_ns;
  last_ns_ = any_ ? std::max(last_ns_, time_ns) : time_ns;
  any_ = true;
  ByteWriter entry(index_[id]);
  entry.number(time_ns);
  entry.number(place);
  const auto schema = tables_.schemas.find(channel->second.schema);
  return obeyed(
      visitor_.message({channel->second, schema == tables_.schemas.end() ? nullptr : &schema->second, time_ns,
                        in.rest(), chunk.offset}));
}

bool Walk::take_index(const Record& record) {
  ByteReader in(record.content);
  const auto id = in.number<std::uint16_t>();
  const std::string_view entries = in.text();
  if (!in.good() || !in.done()) return wrong(record, "a length", "beyond its end", "one within it");
  const auto expected = index_.find(id);
  if (expected == index_.end() ? !entries.empty() : entries != expected->second)
    return wrong(record, fmt::format("an entry (channel {})", id), "another", "the messages of its chunk");
  return true;
}

}  // namespace

Result<McapFile> McapFile::open(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    const std::string found = file < 0 ? std::strerror(errno) : "no file";
    if (file >= 0) ::close(file);
    return Error{"cannot read the recording", found, "a file that can be read", path};
  }
  return McapFile(file, static_cast<std::uint64_t>(status.st_size));
}

McapFile::~McapFile() {
  if (file_ >= 0) ::close(file_);
}

bool McapFile::read(std::uint64_t offset, std::size_t size, std::string& bytes) const {
  bytes.resize(size);
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::pread(file_, bytes.data() + done, size - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

McapEnd read_mcap(const McapSource& source, const std::string& name, McapVisitor& visitor,
                  McapTables* tables) {
  Walk walk(source, name, visitor);
  McapEnd end = walk.run();
  if (tables != nullptr) *tables = std::move(walk.tables());
  return end;
}

Result<void> read_mcap_chunk(const McapSource& source, const std::string& name, const McapTables& tables,
                             std::uint64_t offset, McapVisitor& visitor) {
  Walk walk(source, name, visitor);
  walk.tables() = tables;
  return walk.run_chunk(offset);
}

}  // namespace tactum::inline v0_1
