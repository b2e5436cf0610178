#include "tactum/mesh/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "tactum/mesh/gltf_accessors.h"

namespace tactum::inline v0_1::detail {
namespace {

using gltf::list;
using gltf::text;
using gltf::whole;
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

/// The corners of the triangles of a strip (mode 5) or a fan (mode 6). Triangles with two equal corners only
/// lead from one part of a strip to the next.
std::vector<std::uint32_t> unrolled(const std::vector<std::uint32_t>& corners, std::uint64_t mode) {
  std::vector<std::uint32_t> triangles;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    std::uint32_t a = mode == 5 ? corners[i - 2] : corners[0];
    std::uint32_t b = corners[i - 1];
    const std::uint32_t c = corners[i];
    if (a == b || b == c || c == a) continue;
    if (mode == 5 && i % 2 == 1) std::swap(a, b);
    triangles.insert(triangles.end(), {a, b, c});
  }
  return triangles;
}

class GltfReducer {
 public:
  explicit GltfReducer(MeshBuilder& builder) : builder_(builder) {}

  Result<std::string> reduce(std::string_view bytes) {
    if (Result<void> done = split(bytes); !done) return done.error();
    if (Result<void> done = check_version(); !done) return done.error();
    if (Result<void> done = accessors_.read_buffers(chunk_); !done) return done.error();
    if (Result<void> done = reduce_meshes(); !done) return done.error();
    if (Result<void> done = reduce_nodes(); !done) return done.error();
    for (const auto& [index, accessor] : points_)
      builder_.report().unused_vertices +=
          static_cast<int>(std::count(accessor.used.begin(), accessor.used.end(), false));
    return glb();
  }

 private:
  /// The points of an accessor, and which of them a triangle uses.
  struct Points {
    std::vector<float> coordinates;
    std::vector<bool> used;
  };

  Error wrong(const std::string& found, const std::string& expected, const std::string& place = {}) const {
    return gltf::broken(builder_, found, expected, place);
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
      if (is_looks_only || name == "KHR_mesh_quantization") continue;
      return builder_.error("the glTF file needs an extension that is not supported", in_quotes(name),
                            "plain positions and indices (export without compression)", "extensionsRequired");
    }
    return {};
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
    const Result<Points*> points = points_of(*position, place);
    if (!points) return points.error();
    Result<std::vector<std::uint32_t>> corners = corners_of(given, (*points)->used.size(), place);
    if (!corners) return corners.error();
    if (corners->size() < 3 || (mode == 4 && corners->size() % 3 != 0)) {
      return wrong(std::to_string(corners->size()) + " corners", "three for each triangle", place);
    }
    if (mode != 4) *corners = unrolled(*corners, mode);
    if (corners->empty()) return {};
    vertices += corners->size();
    all_vertices_ += corners->size();
    if (all_vertices_ > 3 * static_cast<std::uint64_t>(builder_.options().max_vertices))
      return wrong("too many vertices in all meshes", "fewer", place);
    const std::vector<float> used = used_points(**points, *corners);
    const int points_out = append(used.data(), used.size(), 3, gltf::kFloat);
    const int corners_out = append(corners->data(), corners->size(), 1, gltf::kUnsignedInt);
    primitives.push_back({{"mode", 4}, {"attributes", {{"POSITION", points_out}}}, {"indices", corners_out}});
    return {};
  }

  /// The points of an accessor, read once: many primitives may share one.
  Result<Points*> points_of(std::uint64_t index, const std::string& place) {
    const auto known = points_.find(index);
    if (known != points_.end()) return &known->second;
    Result<std::vector<float>> read = accessors_.points(index, place);
    if (!read) return read.error();
    all_points_ += read->size() / 3;
    // An accessor without bytes of its own may have any number of points in a small file.
    if (all_points_ > static_cast<std::uint64_t>(builder_.options().max_vertices))
      return wrong("too many points in all accessors",
                   "at most " + std::to_string(builder_.options().max_vertices), place);
    const std::size_t count = read->size() / 3;
    return &points_.emplace(index, Points{std::move(*read), std::vector<bool>(count)}).first->second;
  }

  /// The points that the corners name, in the order of their accessor; the corners name places among these
  /// then. Else each of many primitives that share an accessor would carry all its points.
  static std::vector<float> used_points(Points& points, std::vector<std::uint32_t>& corners) {
    std::vector<std::uint32_t> named = corners;
    std::sort(named.begin(), named.end());
    named.erase(std::unique(named.begin(), named.end()), named.end());
    std::vector<float> coordinates;
    coordinates.reserve(3 * named.size());
    for (const std::uint32_t point : named) {
      points.used[point] = true;
      const auto first = points.coordinates.begin() + 3 * static_cast<std::ptrdiff_t>(point);
      coordinates.insert(coordinates.end(), first, first + 3);
    }
    for (std::uint32_t& corner : corners)
      corner =
          static_cast<std::uint32_t>(std::lower_bound(named.begin(), named.end(), corner) - named.begin());
    return coordinates;
  }

  /// The indices of a primitive; without any, its points in order.
  Result<std::vector<std::uint32_t>> corners_of(const json& given, std::size_t points,
                                                const std::string& place) const {
    if (!given.contains("indices")) {
      std::vector<std::uint32_t> all(points);
      std::iota(all.begin(), all.end(), 0u);
      return all;
    }
    const auto index = whole(given, "indices");
    if (!index) return wrong("no number", "an accessor", place);
    Result<std::vector<std::uint32_t>> corners = accessors_.indices(*index, place);
    if (!corners) return corners;
    for (const std::uint32_t corner : *corners) {
      if (corner >= points)
        return wrong("index " + std::to_string(corner), "0 to " + std::to_string(points - 1), place);
    }
    return corners;
  }

  /// Writes numbers of four bytes behind the new buffer, and gives the number of the new accessor.
  int append(const void* numbers, std::size_t count, std::size_t in_entry, gltf::Component component) {
    const std::size_t start = bin_.size();
    bin_.append(static_cast<const char*>(numbers), 4 * count);
    out_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", start}, {"byteLength", 4 * count}});
    out_["accessors"].push_back({{"bufferView", out_["bufferViews"].size() - 1},
                                 {"byteOffset", 0},
                                 {"componentType", static_cast<std::uint64_t>(component)},
                                 {"count", count / in_entry},
                                 {"type", in_entry == 3 ? "VEC3" : "SCALAR"}});
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
  gltf::Accessors accessors_{document_, builder_};
  json out_ = json::object();
  std::string bin_;
  std::map<std::uint64_t, Points> points_;    ///< of each accessor that a primitive has named
  std::uint64_t all_points_ = 0;              ///< in them
  std::vector<int> out_mesh_;                 ///< number in the output of each mesh, -1 when it is empty
  std::vector<std::uint64_t> mesh_vertices_;  ///< of each mesh
  std::uint64_t all_vertices_ = 0;
};

}  // namespace

Result<std::string> reduced_glb(std::string_view bytes, MeshBuilder& builder) {
  return GltfReducer(builder).reduce(bytes);
}

}  // namespace tactum::inline v0_1::detail
