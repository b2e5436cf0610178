#pragma once
/// A file's bytes as memory, read only, mapped by the system: nothing is read before it is accessed, and
/// nothing is stored twice. The file must not be cut shorter while it is mapped; programs that write part
/// files replace them whole (see write_whole_file).

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

class MappedFile {
 public:
  /// An error states the reason: not there, a folder, no permission, empty.
  static Result<MappedFile> open(const std::string& path);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::string_view bytes() const noexcept { return {data_, size_}; }

 private:
  MappedFile(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Writes beside the file and renames: a reader sees the old file or the new one, never half of it.
Result<void> write_whole_file(const std::string& path, std::string_view bytes);

}  // namespace tactum::inline v0_1
