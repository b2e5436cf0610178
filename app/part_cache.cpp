#include "part_cache.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "tactum/base/hash.h"
#include "tactum/mesh/mapped_file.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;

std::string users_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && cache[0] == '/')
    return (fs::path(cache) / "tactum").string();
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/')
    return (fs::path(home) / ".cache" / "tactum").string();
  return {};
}

/// Two hashes with different beginnings: 128 bits, so that no two meshes meet by chance.
class Key {
 public:
  Key() { second_.add(std::uint32_t{0x7ac7}); }
  void add(std::string_view bytes) {
    for (Hash* hash : {&first_, &second_}) {
      hash->add(static_cast<std::uint64_t>(bytes.size()));
      hash->add_bytes(bytes.data(), bytes.size());
    }
  }
  std::string text() const { return fmt::format("{:016x}{:016x}", first_.value(), second_.value()); }

 private:
  Hash first_;
  Hash second_;
};

}  // namespace

PartCache::PartCache(const std::string& folder) : folder_(folder.empty() ? users_folder() : folder) {}

std::string PartCache::key_of(const std::vector<std::string>& meshes, const PrepareOptions& options) const {
  if (folder_.empty()) return {};
  Key key;
  key.add(fmt::format("{} {} {:a} {} {} {:a} {} {}", kPartFileVersion, options.unit, options.scale,
                      options.pieces, options.close_holes, options.density_kg_per_m3, meshes.size(),
                      options.name));
  for (const std::string& mesh : meshes) {
    const std::string ending = fs::path(mesh).extension().string();
    if (ending == ".gltf" || ending == ".glb") return {};
    const Result<MappedFile> file = MappedFile::open(mesh);
    if (!file) return {};
    key.add(meshes.size() > 1 ? mesh : ending);  // groups are named by their files
    key.add(file->bytes());
  }
  return key.text();
}

Result<PartFile> PartCache::find(const std::string& key) const {
  if (key.empty()) return Error{"no cache", "", "", ""};
  return load_part((fs::path(folder_) / (key + ".tactum")).string());
}

void PartCache::keep(const std::string& key, const PartFile& part) const {
  if (key.empty()) return;
  std::error_code trouble;
  fs::create_directories(folder_, trouble);
  if (trouble) return;
  [[maybe_unused]] const Result<void> saved =
      save_part((fs::path(folder_) / (key + ".tactum")).string(), part);
}

}  // namespace tactum
