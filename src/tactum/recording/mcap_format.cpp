#include "tactum/recording/mcap_format.h"

#include <iterator>

namespace tactum::inline v0_1::mcap {

const char* name_of(Op op) noexcept {
  static constexpr const char* kNames[] = {"no record",  "Header",        "Footer",          "Schema",
                                           "Channel",    "Message",       "Chunk",           "MessageIndex",
                                           "ChunkIndex", "Attachment",    "AttachmentIndex", "Statistics",
                                           "Metadata",   "MetadataIndex", "SummaryOffset",   "DataEnd"};
  const auto code = static_cast<unsigned>(op);
  return code < std::size(kNames) ? kNames[code] : "a record of another program";
}

}  // namespace tactum::inline v0_1::mcap
