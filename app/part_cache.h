#pragma once
/// Parts prepared before, found again by content: the bytes of the meshes, the options that change the part,
/// and the version of the part file. So preparing again is as quick as reading the meshes once.
///
/// Entries are part files like any other, checked by their checksum when they are read; a damaged or outdated
/// one is as good as none. glTF files may refer to others, so they are not looked up. Nothing is ever
/// removed: the folder is the user's to empty.

#include <string>
#include <vector>

#include "tactum/mesh/prepare_part.h"

namespace tactum {

class PartCache {
 public:
  PartCache() = default;  ///< finds and keeps nothing
  /// In `folder`, or when it is empty in $XDG_CACHE_HOME/tactum or ~/.cache/tactum.
  explicit PartCache(const std::string& folder);

  const std::string& folder() const { return folder_; }
  /// Empty when it cannot be computed.
  std::string key_of(const std::vector<std::string>& meshes, const PrepareOptions& options) const;
  Result<PartFile> find(const std::string& key) const;
  /// Quietly does nothing where it cannot write.
  void keep(const std::string& key, const PartFile& part) const;

 private:
  std::string folder_;
};

}  // namespace tactum
