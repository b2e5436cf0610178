#include "tactum/mesh/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

namespace tactum::inline v0_1::detail {
namespace {

using nlohmann::json;

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr int kMaxNodeDepth = 256;                // assimp walks nodes by recursion

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

void append_word(std::string& bytes, std::uint32_t word) {
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// The member as an array; an empty one when it is missing or something else.
const json& list(const json& object, const char* key) {
  static const json kNone = json::array();
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_array() ? *found : kNone;
}

/// The member as a whole number from 0, or the fallback when it is missing; nothing when it is something
/// else.
std::optional<std::uint64_t> whole(const json& object, const char* key,
                                   std::optional<std::uint64_t> fallback = {}) {
  if (!object.is_object()) return {};
  const auto found = object.find(key);
  if (found == object.end()) return fallback;
  if (!found->is_number_unsigned()) return {};
  return found->get<std::uint64_t>();
}

std::string text(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Base64 without line breaks; nothing on a character that is none of it.
std::optional<std::string> decoded_base64(std::string_view code) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (char c : code) {
    if (c == '=') break;
    static constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return {};
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFF;
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xFF);
    }
  }
  return bytes;
}

class GltfReducer {
 public:
  explicit GltfReducer(MeshBuilder& builder) : builder_(builder) {}

  Result<std::string> reduce(std::string_view bytes) {
    if (Result<void> done = split(bytes); !done) return done.error();
    if (Result<void> done = check_version(); !done) return done.error();
    if (Result<void> done = read_buffers(); !done) return done.error();
    if (Result<void> done = reduce_meshes(); !done) return done.error();
    if (Result<void> done = reduce_nodes(); !done) return done.error();
    return glb();
  }

 private:
  Error wrong(const std::string& found, const std::string& expected, const std::string& place = {}) const {
    return builder_.error("the glTF file is broken", found, expected, place);
  }

  /// JSON text and binary chunk of a GLB, or the whole as JSON.
  Result<void> split(std::string_view bytes) {
    std::string_view text = bytes;
    if (bytes.size() >= 4 && word_at(bytes, 0) == kGlbMagic) {
      builder_.report().format = "GLB";
      if (bytes.size() < 20)
        return wrong(std::to_string(bytes.size()) + " bytes", "a GLB header of 20 bytes");
      if (word_at(bytes, 4) != 2)
        return wrong("version " + std::to_string(word_at(bytes, 4)), "version 2", at_byte(4));
      const std::size_t length = word_at(bytes, 12);
      if (word_at(bytes, 16) != kJsonChunk || length > bytes.size() - 20) {
        return wrong("a first chunk of " + std::to_string(length) + " bytes", "a JSON chunk inside the file",
                     at_byte(12));
      }
      text = bytes.substr(20, length);
      const std::size_t next = 20 + length;
      if (bytes.size() >= next + 8 && word_at(bytes, next + 4) == kBinChunk) {
        if (word_at(bytes, next) > bytes.size() - next - 8) {
          return wrong("a binary chunk of " + std::to_string(word_at(bytes, next)) + " bytes",
                       "one inside the file", at_byte(next));
        }
        chunk_ = bytes.substr(next + 8, word_at(bytes, next));
      }
    } else {
      builder_.report().format = "glTF";
    }
    document_ = json::parse(text, nullptr, false);
    if (document_.is_discarded() || !document_.is_object())
      return wrong("no JSON object", "a glTF 2.0 document");
    return {};
  }

  Result<void> check_version() {
    const auto asset = document_.find("asset");
    const std::string version = asset == document_.end() ? "" : text(*asset, "version");
    if (version.substr(0, 2) != "2.") return wrong("version " + in_quotes(version), "version 2.x", "asset");
    for (const json& extension : list(document_, "extensionsRequired")) {
      const std::string name = extension.is_string() ? extension.get<std::string>() : "";
      const bool is_looks_only = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_");
      if (is_looks_only) continue;
      return builder_.error("the glTF file needs an extension that is not supported", in_quotes(name),
                            "plain positions and indices (export without compression)", "extensionsRequired");
    }
    return {};
  }

  Result<void> read_buffers() {
    const json& buffers = list(document_, "buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::string place = "buffer " + std::to_string(i);
      const std::optional<std::uint64_t> length = whole(buffers[i], "byteLength");
      if (!length) return wrong("no byteLength", "a whole number", place);
      const std::string uri = text(buffers[i], "uri");
      if (uri.empty()) {
        buffers_.emplace_back(i == 0 ? chunk_ : std::string_view());
      } else if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(";base64,");
        const auto bytes = comma == std::string::npos
                               ? std::nullopt
                               : decoded_base64(std::string_view(uri).substr(comma + 8));
        if (!bytes) return wrong("a data address that cannot be decoded", "base64", place);
        buffers_.push_back(*bytes);
      } else {
        Result<std::string> bytes = file_beside(uri, place);
        if (!bytes) return bytes.error();
        buffers_.push_back(std::move(*bytes));
      }
      if (*length > buffers_.back().size()) {
        return wrong(std::to_string(buffers_.back().size()) + " bytes",
                     "the " + std::to_string(*length) + " declared", place);
      }
    }
    return {};
  }

  /// The bytes of a file named by a relative address that stays inside the glTF's own folder.
  Result<std::string> file_beside(const std::string& uri, const std::string& place) const {
    const std::filesystem::path relative(uri);
    const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
    if (relative.is_absolute() || climbs || uri.find(':') != std::string::npos) {
      return wrong("the address " + in_quotes(uri), "a file in the same folder or below", place);
    }
    const std::filesystem::path path = std::filesystem::path(builder_.file()).parent_path() / relative;
    std::error_code trouble;
    const std::uintmax_t size = std::filesystem::file_size(path, trouble);
    if (trouble || size > builder_.options().max_bytes) {
      return wrong(trouble ? "no file " + in_quotes(uri) : "a file of " + std::to_string(size) + " bytes",
                   "a readable file within the size limit", place);
    }
    std::ifstream file(path, std::ios::binary);
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) {
      return wrong("a file that cannot be read: " + in_quotes(uri), "a readable file", place);
    }
    return bytes;
  }

  struct Accessor {
    const char* bytes = nullptr;
    std::uint64_t count = 0;
    std::uint64_t stride = 0;  ///< [bytes]
    std::uint64_t component = 0;
  };

  /// The accessor's place in memory, every byte of it inside its view and buffer.
  Result<Accessor> accessor(std::uint64_t index, const char* type, const std::string& place) const {
    const json& accessors = list(document_, "accessors");
    if (index >= accessors.size())
      return wrong("accessor " + std::to_string(index), "one that is there", place);
    const json& entry = accessors[index];
    const std::string where = place + ", accessor " + std::to_string(index);
    const auto view_index = whole(entry, "bufferView");
    const auto offset = whole(entry, "byteOffset", 0);
    const auto component = whole(entry, "componentType");
    const auto count = whole(entry, "count");
    const json& views = list(document_, "bufferViews");
    if (!view_index || *view_index >= views.size() || !offset || !component || !count ||
        entry.contains("sparse")) {
      return wrong("an accessor that is sparse or lacks a number", "bufferView, componentType and count",
                   where);
    }
    if (text(entry, "type") != type) return wrong("type " + in_quotes(text(entry, "type")), type, where);
    const bool is_points = std::string_view(type) == "VEC3";
    const std::uint64_t size = is_points ? 12 : *component == 5121 ? 1 : *component == 5123 ? 2 : 4;
    const bool is_fit =
        is_points ? *component == 5126 : *component == 5121 || *component == 5123 || *component == 5125;
    if (!is_fit)
      return wrong("componentType " + std::to_string(*component), "floats for points, unsigned for indices",
                   where);
    const json& view = views[*view_index];
    const auto buffer = whole(view, "buffer");
    const auto view_offset = whole(view, "byteOffset", 0);
    const auto view_length = whole(view, "byteLength");
    const auto stride = whole(view, "byteStride", size);
    const bool is_view = buffer && *buffer < buffers_.size() && view_offset && view_length && stride &&
                         *view_length <= buffers_[*buffer].size() &&
                         *view_offset <= buffers_[*buffer].size() - *view_length && *stride >= size &&
                         *stride <= 252;
    if (!is_view) return wrong("a bufferView outside its buffer", "byteOffset + byteLength inside it", where);
    const std::uint64_t room = *offset <= *view_length ? *view_length - *offset : 0;
    if (*count == 0 || room < size || (*count - 1) > (room - size) / *stride) {
      return wrong(std::to_string(*count) + " entries in " + std::to_string(room) + " bytes",
                   "entries that fit", where);
    }
    return Accessor{buffers_[*buffer].data() + *view_offset + *offset, *count, *stride, *component};
  }

  Result<void> reduce_meshes() {
    const json& meshes = list(document_, "meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      json primitives = json::array();
      std::uint64_t vertices = 0;
      const json& given = list(meshes[i], "primitives");
      for (std::size_t k = 0; k < given.size(); ++k) {
        const std::string place = "mesh " + std::to_string(i) + ", primitive " + std::to_string(k);
        Result<void> done = reduce_primitive(given[k], place, primitives, vertices);
        if (!done) return done;
      }
      mesh_vertices_.push_back(vertices);
      out_mesh_.push_back(primitives.empty() ? -1 : static_cast<int>(out_["meshes"].size()));
      if (!primitives.empty())
        out_["meshes"].push_back({{"name", text(meshes[i], "name")}, {"primitives", primitives}});
    }
    return {};
  }

  Result<void> reduce_primitive(const json& given, const std::string& place, json& primitives,
                                std::uint64_t& vertices) {
    const std::uint64_t mode = whole(given, "mode", 4).value_or(99);
    if (mode == 0) ++builder_.report().points_dropped;
    if (mode >= 1 && mode <= 3) ++builder_.report().lines_dropped;
    if (mode < 4) return {};
    const auto attributes = given.is_object() ? given.find("attributes") : given.end();
    const auto position =
        mode > 6 || attributes == given.end() ? std::nullopt : whole(*attributes, "POSITION");
    if (!position)
      return wrong("a primitive without points or of unknown mode", "attributes.POSITION", place);
    const Result<Accessor> points = accessor(*position, "VEC3", place);
    if (!points) return points.error();
    const int points_out = append(*points, 12);
    json primitive = {{"mode", mode}, {"attributes", {{"POSITION", points_out}}}};
    std::uint64_t corners = points->count;
    if (given.contains("indices")) {
      const auto index = whole(given, "indices");
      const Result<Accessor> indices =
          index ? accessor(*index, "SCALAR", place) : wrong("no number", "an accessor", place);
      if (!indices) return indices.error();
      const std::uint64_t size = indices->component == 5121 ? 1 : indices->component == 5123 ? 2 : 4;
      for (std::uint64_t i = 0; i < indices->count; ++i) {
        std::uint32_t value = 0;
        std::memcpy(&value, indices->bytes + i * indices->stride, size);
        if (value >= points->count) {
          return wrong("index " + std::to_string(value), "0 to " + std::to_string(points->count - 1), place);
        }
      }
      primitive["indices"] = append(*indices, size);
      corners = indices->count;
    }
    const std::uint64_t remainder = mode == 4 ? corners % 3 : 0;
    if (corners < 3 || remainder != 0) {
      return wrong(std::to_string(corners) + " corners", "three for each triangle", place);
    }
    vertices += std::max(points->count, corners);
    primitives.push_back(primitive);
    return {};
  }

  /// Copies the entries, tightly packed, behind the new buffer, and gives the number of the new accessor.
  int append(const Accessor& from, std::uint64_t size) {
    const std::size_t start = bin_.size();
    for (std::uint64_t i = 0; i < from.count; ++i) bin_.append(from.bytes + i * from.stride, size);
    out_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bin_.size() - start}});
    bin_.resize((bin_.size() + 3) / 4 * 4, '\0');
    out_["accessors"].push_back({{"bufferView", out_["bufferViews"].size() - 1},
                                 {"byteOffset", 0},
                                 {"componentType", from.component},
                                 {"count", from.count},
                                 {"type", size == 12 ? "VEC3" : "SCALAR"}});
    return static_cast<int>(out_["accessors"].size()) - 1;
  }

  Result<void> reduce_nodes() {
    const json& nodes = list(document_, "nodes");
    std::vector<int> parents(nodes.size(), -1);
    std::uint64_t instanced = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::string place = "node " + std::to_string(i);
      json node = {{"name", text(nodes[i], "name")}};
      if (Result<void> done = copy_transform(nodes[i], node, place); !done) return done;
      for (const json& child : list(nodes[i], "children")) {
        const bool is_node = child.is_number_unsigned() && child.get<std::uint64_t>() < nodes.size();
        if (!is_node || parents[child.get<std::size_t>()] >= 0)
          return wrong("a bad child", "a tree of nodes", place);
        parents[child.get<std::size_t>()] = static_cast<int>(i);
        node["children"].push_back(child);
      }
      if (nodes[i].contains("mesh")) {
        const auto mesh = whole(nodes[i], "mesh");
        if (!mesh || *mesh >= out_mesh_.size())
          return wrong("a bad mesh number", "a mesh that is there", place);
        if (out_mesh_[*mesh] >= 0) node["mesh"] = out_mesh_[*mesh];
        instanced += mesh_vertices_[*mesh];
        if (instanced > 3 * static_cast<std::uint64_t>(builder_.options().max_vertices)) {
          return wrong("too many copies of meshes", "fewer vertices in all", place);
        }
      }
      out_["nodes"].push_back(node);
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      int depth = 0;
      for (int at = static_cast<int>(i); at >= 0; at = parents[at]) {
        if (++depth > kMaxNodeDepth) return wrong("nodes in a ring or too deep", "a shallow tree", "nodes");
      }
    }
    return choose_roots(parents);
  }

  /// The nodes of the scene to show; without scenes all that have no parent; without nodes one for each mesh.
  Result<void> choose_roots(const std::vector<int>& parents) {
    json roots = json::array();
    const json& scenes = list(document_, "scenes");
    if (!scenes.empty()) {
      const auto chosen = whole(document_, "scene", 0);
      if (!chosen || *chosen >= scenes.size())
        return wrong("a bad scene number", "a scene that is there", "scene");
      for (const json& root : list(scenes[*chosen], "nodes")) {
        const bool is_root = root.is_number_unsigned() && root.get<std::uint64_t>() < parents.size() &&
                             parents[root.get<std::size_t>()] < 0 &&
                             std::find(roots.begin(), roots.end(), root) == roots.end();
        if (!is_root)
          return wrong("a bad root node", "nodes without parents", "scene " + std::to_string(*chosen));
        roots.push_back(root);
      }
    } else {
      for (std::size_t i = 0; i < parents.size(); ++i) {
        if (parents[i] < 0) roots.push_back(i);
      }
    }
    for (std::size_t i = 0; parents.empty() && i < out_["meshes"].size(); ++i) {
      out_["nodes"].push_back({{"mesh", i}});
      roots.push_back(i);
    }
    out_["scene"] = 0;
    out_["scenes"] = json::array({{{"nodes", roots}}});
    return {};
  }

  Result<void> copy_transform(const json& from, json& to, const std::string& place) const {
    static constexpr std::pair<const char*, std::size_t> kKeys[] = {
        {"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}};
    for (const auto& [key, size] : kKeys) {
      if (!from.is_object() || !from.contains(key)) continue;
      const json& numbers = list(from, key);
      bool is_fit = numbers.size() == size;
      for (const json& number : numbers) {
        is_fit = is_fit && number.is_number() &&
                 std::abs(number.get<double>()) <= builder_.options().max_coordinate;
      }
      if (!is_fit)
        return wrong("a bad " + std::string(key), std::to_string(size) + " plausible numbers", place);
      to[key] = numbers;
    }
    return {};
  }

  std::string glb() {
    out_["asset"] = {{"version", "2.0"}};
    out_["buffers"] = json::array({{{"byteLength", bin_.size()}}});
    std::string text = out_.dump(-1, ' ', false, json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bytes;
    append_word(bytes, kGlbMagic);
    append_word(bytes, 2);
    append_word(bytes, static_cast<std::uint32_t>(28 + text.size() + bin_.size()));
    append_word(bytes, static_cast<std::uint32_t>(text.size()));
    append_word(bytes, kJsonChunk);
    bytes += text;
    append_word(bytes, static_cast<std::uint32_t>(bin_.size()));
    append_word(bytes, kBinChunk);
    return bytes + bin_;
  }

  MeshBuilder& builder_;
  json document_;
  std::string_view chunk_;
  std::vector<std::string> buffers_;
  json out_ = json::object();
  std::string bin_;
  std::vector<int> out_mesh_;                 ///< number in the output of each mesh, -1 when it is empty
  std::vector<std::uint64_t> mesh_vertices_;  ///< of each mesh
};

}  // namespace

Result<std::string> reduced_glb(std::string_view bytes, MeshBuilder& builder) {
  return GltfReducer(builder).reduce(bytes);
}

}  // namespace tactum::inline v0_1::detail
