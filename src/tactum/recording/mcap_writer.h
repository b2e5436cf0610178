#pragma once
/// Writes an MCAP file, only ever appending. Messages gather in memory until their chunk ends; what was
/// handed to the system by then survives the end of the program, however it ends.
///
/// The first thing that cannot be written is kept in trouble(), with a sentence; from then on nothing more is
/// written, and every call returns at once.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/recording/mcap_format.h"

namespace tactum::inline v0_1 {

class McapWriter {
 public:
  /// Makes the file anew. `profile` may be empty; `library` names the program and its version.
  static Result<std::unique_ptr<McapWriter>> open(const std::string& path, const std::string& profile,
                                                  const std::string& library);
  /// Without close() the file stays as a killed program leaves it.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Numbers from 1 on, in order.
  std::uint16_t add_schema(mcap::Schema schema);
  std::uint16_t add_channel(mcap::Channel channel);
  /// `time_ns` since the start of the run.
  void add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view data);
  /// Bytes of the chunk that is being gathered.
  std::size_t gathered() const noexcept { return chunk_.size(); }
  /// Compresses and writes what was gathered, with its index.
  void end_chunk();
  /// At once, with a checksum of its own.
  void add_attachment(const mcap::Attachment& attachment);
  void add_metadata(const std::string& name, const mcap::Texts& texts);
  /// Ends the last chunk, writes the summary, and closes the file.
  void close();

  const std::optional<Error>& trouble() const noexcept { return trouble_; }
  std::uint64_t bytes_written() const noexcept { return offset_; }

 private:
  struct Indexed {
    std::uint64_t time_ns, offset;
  };
  McapWriter(std::string path, int file) : path_(std::move(path)), file_(file) {}
  void write(std::string_view bytes);
  void write_record(mcap::Op op, std::string_view content);
  void fail(const std::string& what, const std::string& found);
  void add_message_indexes(std::string& offsets, std::string& records, std::uint64_t at);
  void add_group(std::string& summary, std::string& offsets, mcap::Op op, std::string_view records,
                 std::uint64_t start) const;
  std::string statistics() const;

  std::string path_;
  int file_ = -1;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  // of all that was written
  std::optional<Error> trouble_;
  std::vector<mcap::Schema> schemas_;
  std::vector<mcap::Channel> channels_;
  std::string chunk_;                         // the records gathered
  std::vector<std::vector<Indexed>> index_;   // of the chunk, by channel
  std::vector<std::uint32_t> sequence_;       // messages so far, by channel
  std::vector<std::uint64_t> counts_;         // the same, for the statistics
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  // of the chunk
  std::uint64_t file_first_ns_ = 0, file_last_ns_ = 0;
  std::uint32_t chunks_ = 0, attachments_ = 0, metadata_ = 0;
  std::string chunk_indexes_, attachment_indexes_, metadata_indexes_;  // records for the summary
};

}  // namespace tactum::inline v0_1
