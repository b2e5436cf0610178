#pragma once
/// What writer and reader of MCAP files (mcap.dev/spec) have in common: the records' codes and the small
/// ones' contents.
///
///   magic  Header  { Attachment | Metadata | Chunk { MessageIndex } }  DataEnd
///   { Schema | Channel | Statistics | ChunkIndex | AttachmentIndex | MetadataIndex }  { SummaryOffset }
///   Footer  magic
///
/// A record is its code (one byte), the length of its content (eight), and the content. A chunk holds Schema,
/// Channel and Message records, compressed, and their CRC-32.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace tactum::inline v0_1::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kRecordHead = 9;  ///< bytes before a record's content

enum class Op : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kAttachment = 9,
  kAttachmentIndex = 10,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15
};

/// "Chunk", for errors.
const char* name_of(Op op) noexcept;

/// No chunk of ours is larger before it is compressed; a reader takes none that says it is [bytes].
inline constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 26;

using Texts = std::map<std::string, std::string>;

struct Schema {
  std::string name;      ///< "tactum/Frame"
  std::string encoding;  ///< "ros1msg" or "jsonschema"
  std::string data;      ///< the definition
};

struct Channel {
  std::uint16_t schema = 0;  ///< 0: none
  std::string topic;         ///< "/tactum/frame"
  std::string encoding;      ///< of the messages: "ros1" or "json"
  Texts metadata;
};

struct Attachment {
  std::string name;
  std::string media_type;
  std::string data;
};

}  // namespace tactum::inline v0_1::mcap
