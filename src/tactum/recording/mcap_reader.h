#pragma once
/// Reads an MCAP file from its beginning, record by record, and checks everything that can be checked: the
/// checksums of chunks, attachments, the data and the summary, and every length before it is believed. Needs
/// no summary: a file that was cut anywhere is read up to its last whole record.
///
/// Memory: one chunk and one attachment at a time, each bounded by what the file really holds and by
/// mcap::kLargestChunk.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "tactum/base/result.h"
#include "tactum/recording/mcap_format.h"

namespace tactum::inline v0_1 {

/// Bytes that a reader may ask for.
class McapSource {
 public:
  virtual ~McapSource() = default;
  virtual std::uint64_t size() const noexcept = 0;
  /// `size` bytes from `offset` on, which lie within size(); false when they cannot be had.
  virtual bool read(std::uint64_t offset, std::size_t size, std::string& bytes) const = 0;

 protected:
  McapSource() = default;
  McapSource(const McapSource&) = default;
  McapSource& operator=(const McapSource&) = default;
};

class McapBytes final : public McapSource {
 public:
  explicit McapBytes(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() const noexcept override { return bytes_.size(); }
  bool read(std::uint64_t offset, std::size_t size, std::string& bytes) const override {
    bytes.assign(bytes_.substr(offset, size));
    return true;
  }

 private:
  std::string_view bytes_;
};

class McapFile final : public McapSource {
 public:
  static Result<McapFile> open(const std::string& path);
  McapFile(McapFile&& other) noexcept : file_(other.file_), size_(other.size_) { other.file_ = -1; }
  McapFile& operator=(McapFile&&) = delete;
  ~McapFile() override;
  std::uint64_t size() const noexcept override { return size_; }
  bool read(std::uint64_t offset, std::size_t size, std::string& bytes) const override;

 private:
  McapFile(int file, std::uint64_t size) : file_(file), size_(size) {}
  int file_;
  std::uint64_t size_;
};

/// A message, while its chunk is looked at.
struct McapMessage {
  const mcap::Channel& channel;
  const mcap::Schema* schema;  ///< null where the channel has none
  std::uint64_t time_ns;
  std::string_view data;
  std::uint64_t chunk_offset;  ///< of its chunk in the file, for errors
};

/// Takes what the file holds, in its order. An error stops the reading.
class McapVisitor {
 public:
  virtual ~McapVisitor() = default;
  virtual Result<void> attachment(mcap::Attachment attachment, std::uint64_t offset) = 0;
  virtual Result<void> message(const McapMessage& message) = 0;

 protected:
  McapVisitor() = default;
  McapVisitor(const McapVisitor&) = default;
  McapVisitor& operator=(const McapVisitor&) = default;
};

/// How the reading ended.
struct McapEnd {
  bool complete = false;       ///< everything was there, and all checksums hold
  bool cut = false;            ///< the file ends before its summary does, as of a program that was killed
  std::uint64_t good_to = 0;   ///< bytes from the start that were read and are sound
  std::optional<Error> wrong;  ///< where complete is false: the record and the byte it begins at
};

/// What defines the messages of a file, so that one of its chunks can be read alone.
struct McapTables {
  std::map<std::uint16_t, mcap::Schema> schemas;
  std::map<std::uint16_t, mcap::Channel> channels;
};

/// `name` is the file's, for errors. An error of the visitor's is McapEnd::wrong, as it is. Fills `tables`
/// where they are given.
McapEnd read_mcap(const McapSource& source, const std::string& name, McapVisitor& visitor,
                  McapTables* tables = nullptr);

/// The messages of the chunk that begins at `offset`, of a file that was read before. Checks it as much.
Result<void> read_mcap_chunk(const McapSource& source, const std::string& name, const McapTables& tables,
                             std::uint64_t offset, McapVisitor& visitor);

}  // namespace tactum::inline v0_1
