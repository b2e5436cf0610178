#include "tactum/mesh/array_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "tactum/base/hash.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kName = 24;
constexpr std::uint32_t kByteOrder = 0x01020304;

struct Header {
  std::array<char, kMagicBytes> magic{};
  std::uint32_t version = 0;
  std::uint32_t byte_order = kByteOrder;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;
};
static_assert(sizeof(Header) == 32);

struct Record {
  std::array<char, kName> name{};
  std::uint32_t element = 0;
  std::uint32_t zero = 0;
  std::uint64_t count = 0;
};
static_assert(sizeof(Record) == 40);

constexpr std::size_t filled_up(std::size_t size) { return (size + 7) / 8 * 8; }

/// Of the header but its checksum, and the body.
std::uint64_t checksum(Header header, std::string_view body) {
  header.checksum = 0;
  Hash hash;
  hash.add_bytes(&header, sizeof header);
  hash.add_bytes(body.data(), body.size());
  return hash.value();
}

struct HeaderFault {
  std::string found;     ///< empty when the header is right
  std::string expected;  ///< empty: a file of this kind
};
HeaderFault fault_in_header(std::string_view bytes, std::string_view magic, std::uint32_t version) {
  Header header;
  if (bytes.size() < sizeof header || bytes.substr(0, magic.size()) != magic)
    return {"other bytes at the beginning", ""};
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order != kByteOrder) return {"the byte order of another machine", "little-endian"};
  if (header.version != version)
    return {fmt::format("version {} of the format", header.version),
            fmt::format("version {}: prepare it again", version)};
  if (header.size != bytes.size())
    return {fmt::format("{} bytes", bytes.size()), fmt::format("{}: it was cut short or grew", header.size)};
  if (const std::uint64_t found = checksum(header, bytes.substr(sizeof header)); found != header.checksum)
    return {fmt::format("a checksum of {:016x}", found),
            fmt::format("{:016x}: bytes were changed", header.checksum)};
  return {};
}

/// Whether what complete_polytope() found can be computed with: edges with a length, faces with a normal.
bool usable(const Polytope& piece) {
  const auto long_enough = [](const Polytope::Edge& edge) { return edge.length > 0.0; };
  const auto has_normal = [](const Polytope::Face& face) {
    return face.normal.allFinite() && !face.normal.isZero();
  };
  return std::all_of(piece.edges.begin(), piece.edges.end(), long_enough) &&
         std::all_of(piece.faces.begin(), piece.faces.end(), has_normal);
}

/// The corners and loops of many pieces, one behind the other, and how far they are taken.
struct StoredPieces {
  std::vector<std::int32_t> vertex_counts, face_counts;  ///< of each piece
  std::vector<std::int32_t> loop_counts;                 ///< of each face
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> loops;
  std::size_t vertex = 0, face = 0, slot = 0;  ///< where the next piece begins

  bool used_up() const {
    return vertex == vertices.size() && face == loop_counts.size() && slot == loops.size();
  }

  /// What is wrong with piece i; empty when nothing is.
  std::string next_piece(std::size_t i, Polytope& piece) {
    const std::int32_t corners = vertex_counts[i];
    if (corners < 3 || corners > std::numeric_limits<std::uint16_t>::max() ||
        vertices.size() - vertex < static_cast<std::size_t>(corners))
      return fmt::format("{} vertices", corners);
    const auto first = vertices.begin() + static_cast<std::ptrdiff_t>(vertex);
    piece.vertices.assign(first, first + corners);
    vertex += static_cast<std::size_t>(corners);
    if (std::string fault = take_faces(face_counts[i], corners, piece); !fault.empty()) return fault;
    const char* why = nullptr;
    if (!complete_polytope(piece, &why)) return why;
    if (piece.flat) {  // one plane, exactly: as flat_polygon() makes it
      piece.faces[1].normal = -piece.faces[0].normal;
      piece.faces[1].offset = -piece.faces[0].offset;
    }
    return usable(piece) ? "" : "no extent";
  }

 private:
  std::string take_faces(std::int32_t faces, std::int32_t corners, Polytope& piece) {
    if (faces < 2 || loop_counts.size() - face < static_cast<std::size_t>(faces))
      return fmt::format("{} faces", faces);
    for (std::int32_t f = 0; f < faces; ++f) {
      const std::int32_t count = loop_counts[face++];
      if (count < 3 || loops.size() - slot < static_cast<std::size_t>(count))
        return fmt::format("a face of {} corners", count);
      piece.faces.push_back({Vec3::Zero(), 0.0, static_cast<int>(piece.face_vertices.size()), count});
      for (std::int32_t k = 0; k < count; ++k) {
        const std::int32_t corner = loops[slot++];
        if (corner < 0 || corner >= corners) return fmt::format("corner {}", corner);
        piece.face_vertices.push_back(corner);
      }
    }
    return {};
  }
};

}  // namespace

void ArrayWriter::put(std::string_view name, std::size_t element, std::size_t count, const void* data) {
  Record record;
  std::copy_n(name.data(), std::min(name.size(), kName), record.name.data());
  record.element = static_cast<std::uint32_t>(element);
  record.count = count;
  body_.append(reinterpret_cast<const char*>(&record), sizeof record);
  if (count > 0) body_.append(static_cast<const char*>(data), element * count);
  body_.resize(filled_up(body_.size()), '\0');
}

void ArrayWriter::operator()(std::string_view name, const std::vector<std::string>& texts) {
  std::string joined;
  for (const std::string& text : texts) joined.append(text).push_back('\0');
  (*this)(name, joined);
}

void ArrayWriter::operator()(std::string_view name, const std::vector<Polytope>& pieces) {
  std::vector<std::int32_t> vertex_counts, face_counts, loop_counts, loops;
  std::vector<Vec3> vertices;
  for (const Polytope& piece : pieces) {
    vertex_counts.push_back(static_cast<std::int32_t>(piece.vertices.size()));
    face_counts.push_back(static_cast<std::int32_t>(piece.faces.size()));
    for (const Polytope::Face& face : piece.faces) loop_counts.push_back(face.count);
    vertices.insert(vertices.end(), piece.vertices.begin(), piece.vertices.end());
    loops.insert(loops.end(), piece.face_vertices.begin(), piece.face_vertices.end());
  }
  (*this)(name, vertex_counts);
  (*this)(name, face_counts);
  (*this)(name, loop_counts);
  (*this)(name, vertices);
  (*this)(name, loops);
}

std::string ArrayWriter::finish(std::string_view magic, std::uint32_t version) && {
  Header header;
  std::copy_n(magic.data(), std::min(magic.size(), kMagicBytes), header.magic.data());
  header.version = version;
  header.size = sizeof header + body_.size();
  header.checksum = checksum(header, body_);
  std::string block(reinterpret_cast<const char*>(&header), sizeof header);
  return block.append(body_);
}

ArrayReader::ArrayReader(std::string_view bytes, std::string_view magic, std::uint32_t version,
                         std::string what, std::string where)
    : what_(std::move(what)), where_(std::move(where)) {
  if (HeaderFault fault = fault_in_header(bytes, magic, version); !fault.found.empty()) {
    const std::string expected = fault.expected.empty() ? fmt::format("a {} file", what_) : fault.expected;
    error_ = Error{fmt::format("the {} cannot be read", what_), fault.found, expected, where_};
    return;
  }
  rest_ = bytes.substr(sizeof(Header));
}

void ArrayReader::refuse(std::string_view name, std::string_view found) {
  if (error_) return;
  error_ = Error{fmt::format("the {} cannot be read", what_), fmt::format("{} in \"{}\"", found, name),
                 "what was written by `tactum prepare`", where_};
}

std::string_view ArrayReader::take(std::string_view name, std::size_t element) {
  if (error_) return {};
  Record record;
  if (rest_.size() < sizeof record) return refuse(name, "the end of the file"), std::string_view{};
  std::memcpy(&record, rest_.data(), sizeof record);
  rest_.remove_prefix(sizeof record);
  Record wanted;
  std::copy_n(name.data(), std::min(name.size(), kName), wanted.name.data());
  if (record.name != wanted.name) return refuse(name, "another array"), std::string_view{};
  if (record.element != element || record.zero != 0)
    return refuse(name, fmt::format("elements of {} bytes", record.element)), std::string_view{};
  if (record.count > rest_.size() / element || filled_up(record.count * element) > rest_.size())
    return refuse(name, fmt::format("{} elements, more than the file holds", record.count)),
           std::string_view{};
  const std::string_view data = rest_.substr(0, record.count * element);
  rest_.remove_prefix(filled_up(data.size()));
  return data;
}

void ArrayReader::operator()(std::string_view name, std::string& text) { text = take(name, 1); }

void ArrayReader::operator()(std::string_view name, std::vector<std::string>& texts) {
  std::string_view joined = take(name, 1);
  while (!joined.empty()) {
    const std::size_t end = joined.find('\0');
    if (end == std::string_view::npos) return refuse(name, "a text without an end");
    texts.emplace_back(joined.substr(0, end));
    joined.remove_prefix(end + 1);
  }
}

void ArrayReader::operator()(std::string_view name, std::vector<Polytope>& pieces) {
  StoredPieces stored;
  (*this)(name, stored.vertex_counts);
  (*this)(name, stored.face_counts);
  (*this)(name, stored.loop_counts);
  (*this)(name, stored.vertices);
  (*this)(name, stored.loops);
  if (error_) return;
  if (stored.vertex_counts.size() != stored.face_counts.size())
    return refuse(name, "counts that do not fit together");
  for (std::size_t i = 0; i < stored.vertex_counts.size(); ++i) {
    Polytope piece;
    if (const std::string fault = stored.next_piece(i, piece); !fault.empty())
      return refuse(name, fmt::format("{} in piece {}", fault, i));
    pieces.push_back(std::move(piece));
  }
  if (!stored.used_up()) refuse(name, "more than its pieces need");
}

Result<void> ArrayReader::finish() {
  if (!error_ && !rest_.empty()) refuse("end", fmt::format("{} bytes more", rest_.size()));
  if (error_) return *error_;
  return {};
}

}  // namespace tactum::inline v0_1
