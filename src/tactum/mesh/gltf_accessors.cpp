#include "tactum/mesh/gltf_accessors.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace tactum::inline v0_1::detail::gltf {
namespace {

/// Bytes of a number; zero when the component is none of the format's.
std::uint64_t size_of(std::uint64_t component) {
  switch (component) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T value_at(const std::string& bytes, std::uint64_t i) {
  T value{};
  std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
  return value;
}

/// A whole number as the extension has it: as it is, or as a fraction of the type's largest.
template <class T>
float quantized(const std::string& bytes, std::uint64_t i, bool normalized) {
  const auto value = static_cast<float>(value_at<T>(bytes, i));
  if (!normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float coordinate(const std::string& bytes, std::uint64_t component, std::uint64_t i, bool normalized) {
  switch (component) {
    case kByte:
      return quantized<std::int8_t>(bytes, i, normalized);
    case kUnsignedByte:
      return quantized<std::uint8_t>(bytes, i, normalized);
    case kShort:
      return quantized<std::int16_t>(bytes, i, normalized);
    case kUnsignedShort:
      return quantized<std::uint16_t>(bytes, i, normalized);
    default:
      return value_at<float>(bytes, i);
  }
}

std::uint32_t whole_at(const std::string& bytes, std::uint64_t component, std::uint64_t i) {
  return component == kUnsignedByte    ? value_at<std::uint8_t>(bytes, i)
         : component == kUnsignedShort ? value_at<std::uint16_t>(bytes, i)
                                       : value_at<std::uint32_t>(bytes, i);
}

bool is_unsigned(std::uint64_t component) {
  return component == kUnsignedByte || component == kUnsignedShort || component == kUnsignedInt;
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

/// An address with %XX as the bytes they stand for (RFC 3986); a percent sign without two hexadecimal digits
/// stands for itself.
std::string decoded_percents(std::string_view uri) {
  std::string bytes;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const std::string_view code = uri.substr(i + 1, 2);
    const bool is_code = uri[i] == '%' && code.size() == 2 &&
                         std::from_chars(code.data(), code.data() + 2, value, 16).ptr == code.data() + 2;
    bytes += is_code ? static_cast<char>(value) : uri[i];
    if (is_code) i += 2;
  }
  return bytes;
}

}  // namespace

const json& list(const json& object, const char* key) {
  static const json kNone = json::array();
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_array() ? *found : kNone;
}

std::optional<std::uint64_t> whole(const json& object, const char* key,
                                   std::optional<std::uint64_t> fallback) {
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

Error broken(const MeshBuilder& builder, const std::string& found, const std::string& expected,
             const std::string& place) {
  return builder.error("the glTF file is broken", found, expected, place);
}

Result<void> Accessors::read_buffers(std::string_view chunk) {
  constexpr std::size_t kMostBuffers = 64;  // each is bounded by itself; exporters write one
  const json& buffers = list(document_, "buffers");
  if (buffers.size() > kMostBuffers)
    return wrong(std::to_string(buffers.size()) + " buffers", "at most " + std::to_string(kMostBuffers),
                 "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string place = "buffer " + std::to_string(i);
    const std::optional<std::uint64_t> length = whole(buffers[i], "byteLength");
    if (!length) return wrong("no byteLength", "a whole number", place);
    const std::string uri = text(buffers[i], "uri");
    if (uri.empty()) {
      buffers_.emplace_back(i == 0 ? chunk : std::string_view());
    } else {
      Result<std::string> bytes = buffer_bytes(uri, place);
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

Result<std::string> Accessors::buffer_bytes(const std::string& uri, const std::string& place) const {
  if (!uri.starts_with("data:")) return file_beside(uri, place);
  const std::size_t comma = uri.find(";base64,");
  const auto bytes =
      comma == std::string::npos ? std::nullopt : decoded_base64(std::string_view(uri).substr(comma + 8));
  if (!bytes) return wrong("a data address that cannot be decoded", "base64", place);
  return *bytes;
}

/// The bytes of a file named by a relative address that stays inside the glTF's own folder. Programs that do
/// not encode a percent sign in a name are understood where only that name is there.
Result<std::string> Accessors::file_beside(const std::string& uri, const std::string& place) const {
  const std::filesystem::path folder = std::filesystem::path(builder_.file()).parent_path();
  std::error_code trouble;
  std::filesystem::path path;
  for (const std::string& name : {uri, decoded_percents(uri)}) {
    const std::filesystem::path relative(name);
    const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
    const bool is_name = name.find(':') == std::string::npos && name.find('\0') == std::string::npos;
    if (relative.is_absolute() || climbs || !is_name) {
      return wrong("the address " + in_quotes(uri), "a file in the same folder or below", place);
    }
    if (path.empty() || std::filesystem::exists(folder / relative, trouble)) path = folder / relative;
  }
  const std::uintmax_t size = std::filesystem::file_size(path, trouble);
  if (trouble || size > builder_.options().max_bytes) {
    return wrong(trouble ? "no file " + in_quotes(decoded_percents(uri))
                         : "a file of " + std::to_string(size) + " bytes",
                 "a readable file within the size limit", place);
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) {
    return wrong("a file that cannot be read: " + in_quotes(uri), "a readable file", place);
  }
  return bytes;
}

/// The entries of a view one behind the other, every byte of them inside view and buffer.
Result<std::string> Accessors::packed(const Range& range, const std::string& place) const {
  const json& views = list(document_, "bufferViews");
  if (range.view >= views.size())
    return wrong("bufferView " + std::to_string(range.view), "one that is there", place);
  const json& view = views[range.view];
  const auto buffer = whole(view, "buffer");
  const auto start = whole(view, "byteOffset", 0);
  const auto length = whole(view, "byteLength");
  const auto stride = whole(view, "byteStride", range.size);
  const bool is_view = buffer && *buffer < buffers_.size() && start && length && stride &&
                       *length <= buffers_[*buffer].size() && *start <= buffers_[*buffer].size() - *length &&
                       *stride >= range.size && *stride <= 252;
  if (!is_view) return wrong("a bufferView outside its buffer", "byteOffset + byteLength inside it", place);
  const std::uint64_t room = range.offset <= *length ? *length - range.offset : 0;
  if (range.count == 0 || room < range.size || (range.count - 1) > (room - range.size) / *stride) {
    return wrong(std::to_string(range.count) + " entries in " + std::to_string(room) + " bytes",
                 "entries that fit", place);
  }
  const char* from = buffers_[*buffer].data() + *start + range.offset;
  std::string bytes;
  bytes.reserve(range.count * range.size);
  for (std::uint64_t i = 0; i < range.count; ++i) bytes.append(from + i * *stride, range.size);
  return bytes;
}

Result<Accessors::Entries> Accessors::entries(std::uint64_t index, const char* type,
                                              const std::string& place) const {
  const json& accessors = list(document_, "accessors");
  if (index >= accessors.size())
    return wrong("accessor " + std::to_string(index), "one that is there", place);
  const json& entry = accessors[index];
  const std::string where = place + ", accessor " + std::to_string(index);
  const auto offset = whole(entry, "byteOffset", 0);
  const auto component = whole(entry, "componentType");
  const auto count = whole(entry, "count");
  if (!offset || !component || !count) {
    return wrong("an accessor that lacks a number", "componentType and count", where);
  }
  if (text(entry, "type") != type) return wrong("type " + in_quotes(text(entry, "type")), type, where);
  const bool is_points = std::string_view(type) == "VEC3";
  const bool is_fit =
      is_points ? size_of(*component) > 0 && *component != kUnsignedInt : is_unsigned(*component);
  if (!is_fit) {
    return wrong("componentType " + std::to_string(*component),
                 "floats, bytes or shorts for points, unsigned for indices", where);
  }
  const std::uint64_t size = size_of(*component) * (is_points ? 3 : 1);
  Entries out{{}, *count, *component, entry.value("normalized", json(false)) == json(true)};
  const bool is_sparse = entry.contains("sparse");
  if (entry.contains("bufferView") || !is_sparse) {
    const auto view = whole(entry, "bufferView");
    if (!view) return wrong("an accessor without bytes", "bufferView or sparse", where);
    Result<std::string> bytes = packed({*view, *offset, *count, size}, where);
    if (!bytes) return bytes.error();
    out.bytes = std::move(*bytes);
  } else {
    // Nothing in the file bounds this count.
    if (*count > static_cast<std::uint64_t>(builder_.options().max_vertices))
      return wrong(std::to_string(*count) + " entries",
                   "at most " + std::to_string(builder_.options().max_vertices), where);
    out.bytes.assign(*count * size, '\0');
  }
  if (!is_sparse) return out;
  if (Result<void> done = apply_sparse(entry["sparse"], out, size, where + ", sparse"); !done)
    return done.error();
  return out;
}

/// Puts the entries that differ from the accessor's own in their places.
Result<void> Accessors::apply_sparse(const json& sparse, Entries& entries, std::uint64_t size,
                                     const std::string& place) const {
  const auto count = whole(sparse, "count");
  const json& places = sparse.is_object() && sparse.contains("indices") ? sparse["indices"] : json();
  const json& values = sparse.is_object() && sparse.contains("values") ? sparse["values"] : json();
  const auto places_view = whole(places, "bufferView");
  const auto places_offset = whole(places, "byteOffset", 0);
  const auto component = whole(places, "componentType");
  const auto values_view = whole(values, "bufferView");
  const auto values_offset = whole(values, "byteOffset", 0);
  if (!count || !places_view || !places_offset || !component || !is_unsigned(*component) || !values_view ||
      !values_offset) {
    return wrong("sparse changes that lack a number", "count, indices and values", place);
  }
  const Result<std::string> at = packed({*places_view, *places_offset, *count, size_of(*component)}, place);
  if (!at) return at.error();
  const Result<std::string> changed = packed({*values_view, *values_offset, *count, size}, place);
  if (!changed) return changed.error();
  for (std::uint64_t i = 0; i < *count; ++i) {
    const std::uint32_t to = whole_at(*at, *component, i);
    if (to >= entries.count) {
      return wrong("entry " + std::to_string(to), "0 to " + std::to_string(entries.count - 1), place);
    }
    std::memcpy(entries.bytes.data() + to * size, changed->data() + i * size, size);
  }
  return {};
}

Result<std::vector<float>> Accessors::points(std::uint64_t index, const std::string& place) const {
  const Result<Entries> found = entries(index, "VEC3", place);
  if (!found) return found.error();
  std::vector<float> points(found->count * 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = coordinate(found->bytes, found->component, i, found->normalized);
  return points;
}

Result<std::vector<std::uint32_t>> Accessors::indices(std::uint64_t index, const std::string& place) const {
  const Result<Entries> found = entries(index, "SCALAR", place);
  if (!found) return found.error();
  std::vector<std::uint32_t> indices(found->count);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = whole_at(found->bytes, found->component, i);
  return indices;
}

}  // namespace tactum::inline v0_1::detail::gltf
