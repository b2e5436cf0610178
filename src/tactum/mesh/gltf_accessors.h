#pragma once
/// Buffers and accessors of a glTF: its numbers, every byte of them checked to lie inside its buffer.
///
/// Positions are floats, or the bytes and shorts of KHR_mesh_quantization. An accessor may have a stride of
/// its own, sparse changes, and no buffer beneath these.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/mesh/mesh_builder.h"

namespace tactum::inline v0_1::detail::gltf {

using nlohmann::json;

/// The types of numbers, as componentType gives them.
enum Component : std::uint64_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

/// The member as an array; an empty one when it is missing or something else.
const json& list(const json& object, const char* key);

/// The member as a whole number from 0, or the fallback when it is missing; nothing when it is something
/// else.
std::optional<std::uint64_t> whole(const json& object, const char* key,
                                   std::optional<std::uint64_t> fallback = {});

/// The member as a string; an empty one when it is missing or something else.
std::string text(const json& object, const char* key);

Error broken(const MeshBuilder& builder, const std::string& found, const std::string& expected,
             const std::string& place);

class Accessors {
 public:
  /// The document, which must outlive this, and the builder, for the file's name and limits.
  Accessors(const json& document, const MeshBuilder& builder) : document_(document), builder_(builder) {}

  /// Reads all buffers: the binary chunk of a GLB, data addresses, files beside the glTF.
  Result<void> read_buffers(std::string_view chunk);

  /// x, y, z of every point.
  Result<std::vector<float>> points(std::uint64_t index, const std::string& place) const;

  Result<std::vector<std::uint32_t>> indices(std::uint64_t index, const std::string& place) const;

 private:
  /// Entries as they stand in the file, one behind the other.
  struct Entries {
    std::string bytes;
    std::uint64_t count = 0;
    std::uint64_t component = 0;
    bool normalized = false;
  };
  /// `count` entries of `size` bytes in a view.
  struct Range {
    std::uint64_t view = 0, offset = 0, count = 0, size = 0;
  };

  Error wrong(const std::string& found, const std::string& expected, const std::string& place) const {
    return broken(builder_, found, expected, place);
  }
  Result<std::string> buffer_bytes(const std::string& uri, const std::string& place) const;
  Result<std::string> file_beside(const std::string& uri, const std::string& place) const;
  Result<std::string> packed(const Range& range, const std::string& place) const;
  Result<Entries> entries(std::uint64_t index, const char* type, const std::string& place) const;
  Result<void> apply_sparse(const json& sparse, Entries& entries, std::uint64_t size,
                            const std::string& place) const;

  const json& document_;
  const MeshBuilder& builder_;
  std::vector<std::string> buffers_;
};

}  // namespace tactum::inline v0_1::detail::gltf
