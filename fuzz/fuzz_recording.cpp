/// Any bytes as a recording: once as they are, and once as the message of a run's head, which stands behind
/// checksums otherwise.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tactum/recording/export_csv.h"
#include "tactum/recording/replay.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  static std::FILE* const nowhere = std::fopen("/dev/null", "w");
  const Result<CsvExport> table = export_csv(McapBytes(bytes), "fuzzed.mcap", nowhere);
  if (!table && table.error().message().empty()) std::abort();
  // A replay of a sound file takes long; files of the corpus are a few frames.
  if (const Result<ReplayResult> run = replay(McapBytes(bytes), "fuzzed.mcap", {}); !run) {
    if (run.error().message().empty()) std::abort();
  } else if (run->end.good_to > size || run->same > run->frames) {
    std::abort();
  }
  const Result<RunHead> head = read_head(bytes, "fuzzed.mcap");
  if (head && !read_head(head_text(*head), "again.mcap")) std::abort();
  return 0;
}
