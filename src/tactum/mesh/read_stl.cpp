#include <bit>
#include <cstdint>
#include <cstring>

#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// STL. Binary: 80 bytes, a count, then 50 bytes a triangle (normal, three vertices, two bytes). Text: solid
/// / facet normal / outer loop / vertex ... Stored normals are ignored: the corners' order gives the same.

namespace tactum::inline v0_1::detail {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary readers copy little-endian numbers as they are");

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;

std::uint64_t declared_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

Result<void> read_binary(std::string_view bytes, MeshBuilder& builder) {
  builder.report().format = "STL (binary)";
  const std::uint64_t count = declared_triangles(bytes);
  const std::uint64_t needed = kHeaderBytes + kTriangleBytes * count;
  if (needed > bytes.size()) {
    return builder.error(
        "the file is cut short or its count is wrong", std::to_string(bytes.size()) + " bytes",
        std::to_string(needed) + " bytes for the " + std::to_string(count) + " triangles it declares",
        at_byte(80));
  }
  if (needed < bytes.size()) {
    builder.report().remarks.push_back(std::to_string(bytes.size() - needed) +
                                       " bytes behind the last triangle were passed over.");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t start = kHeaderBytes + kTriangleBytes * i;
    float numbers[12];
    std::memcpy(numbers, bytes.data() + start, sizeof numbers);
    std::vector<int> corners(3);
    for (int k = 0; k < 3; ++k) {
      const Vec3 point = Eigen::Map<const Eigen::Vector3f>(numbers + 3 + 3 * k).cast<double>();
      corners[k] = builder.vertex_count();
      if (Result<void> done = builder.add_vertex(point, at_byte(start)); !done) return done;
    }
    if (Result<void> done = builder.add_polygon(corners, at_byte(start)); !done) return done;
  }
  return {};
}

class TextReader {
 public:
  TextReader(std::string_view text, MeshBuilder& builder) : lines_(text), builder_(builder) {}

  Result<void> read() {
    builder_.report().format = "STL (text)";
    std::string_view line;
    while (lines_.next(line)) {
      Tokens tokens(line);
      const std::string_view word = tokens.next();
      if (word.empty()) continue;
      if (Result<void> done = read_line(word, tokens); !done) return done;
    }
    if (state_ == State::kFacet || state_ == State::kLoop) return wrong("the end of the file", "endfacet");
    if (state_ == State::kSolid) builder_.report().remarks.emplace_back("The file ends without endsolid.");
    return {};
  }

 private:
  enum class State { kOutside, kSolid, kFacet, kLoop };

  Result<void> read_line(std::string_view word, Tokens& tokens) {
    switch (state_) {
      case State::kOutside:
        if (word != "solid") return wrong(in_quotes(word), "solid");
        builder_.begin_group(tokens.remainder());
        state_ = State::kSolid;
        return {};
      case State::kSolid:
        if (word != "facet" && word != "endsolid") return wrong(in_quotes(word), "facet or endsolid");
        state_ = word == "facet" ? State::kFacet : State::kOutside;
        return {};
      case State::kFacet:
        if (word != "outer" && word != "endfacet") return wrong(in_quotes(word), "outer loop or endfacet");
        state_ = word == "outer" ? State::kLoop : State::kSolid;
        corners_.clear();
        return {};
      case State::kLoop:
        if (word == "vertex") return read_vertex(tokens);
        if (word != "endloop") return wrong(in_quotes(word), "vertex or endloop");
        state_ = State::kFacet;
        return builder_.add_polygon(corners_, at_line(lines_.line_number()));
    }
    return {};
  }

  Result<void> read_vertex(Tokens& tokens) {
    Vec3 point;
    for (double& coordinate : point) {
      const std::string_view word = tokens.next();
      if (!parse_number(word, coordinate)) {
        return wrong(word.empty() ? "fewer than three numbers" : in_quotes(word), "vertex X Y Z");
      }
    }
    corners_.push_back(builder_.vertex_count());
    return builder_.add_vertex(point, at_line(lines_.line_number()));
  }

  Error wrong(const std::string& found, const std::string& expected) const {
    return builder_.error("the text STL is broken", found, expected, at_line(lines_.line_number()));
  }

  LineReader lines_;
  MeshBuilder& builder_;
  std::vector<int> corners_;
  State state_ = State::kOutside;
};

}  // namespace

Result<void> read_stl(std::string_view bytes, MeshBuilder& builder) {
  const bool has_header = bytes.size() >= kHeaderBytes;
  if (has_header && kHeaderBytes + kTriangleBytes * declared_triangles(bytes) == bytes.size()) {
    return read_binary(bytes, builder);
  }
  // Binary headers may begin with "solid" too, but hold zero bytes somewhere in the count or the numbers.
  if (Tokens(bytes.substr(0, kHeaderBytes)).next() == "solid" && bytes.find('\0') == std::string_view::npos) {
    return TextReader(bytes, builder).read();
  }
  if (has_header) return read_binary(bytes, builder);
  return builder.error("the file is no STL",
                       std::to_string(bytes.size()) + " bytes that do not begin with solid",
                       "a text STL, or a binary one of at least 84 bytes");
}

}  // namespace tactum::inline v0_1::detail
