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

/// Keywords come in any case, closing ones in one word or two, and any number of them in a line. What stands
/// behind `solid` and `endsolid` is a name up to the end of its line.
class TextReader {
 public:
  TextReader(std::string_view text, MeshBuilder& builder) : words_(text), builder_(builder) {}

  Result<void> read() {
    builder_.report().format = "STL (text)";
    for (std::string_view word = words_.next(); !word.empty(); word = words_.next()) {
      if (Result<void> done = read_word(word); !done) return done;
    }
    if (state_ == State::kFacet || state_ == State::kLoop) return wrong("the end of the file", "endfacet");
    if (state_ == State::kSolid) builder_.report().remarks.emplace_back("The file ends without endsolid.");
    return {};
  }

 private:
  enum class State { kOutside, kSolid, kFacet, kLoop };

  Result<void> read_word(std::string_view word) {
    switch (state_) {
      case State::kOutside:
        if (same_word(word, "solid")) return begin_solid();
        if (same_word(word, "facet")) return begin_facet();
        return wrong(in_quotes(word), "solid");
      case State::kSolid:
        if (same_word(word, "facet")) return begin_facet();
        if (same_word(word, "solid")) return begin_solid();
        if (Result<void> closed = close(word, "solid", "facet or endsolid"); !closed) return closed;
        words_.skip_line();  // its name
        state_ = State::kOutside;
        return {};
      case State::kFacet:
        if (same_word(word, "outer")) return begin_loop();
        state_ = State::kSolid;
        return close(word, "facet", "outer loop or endfacet");
      case State::kLoop:
        if (same_word(word, "vertex")) return read_vertex();
        if (Result<void> closed = close(word, "loop", "vertex or endloop"); !closed) return closed;
        state_ = State::kFacet;
        return builder_.add_polygon(corners_, place());
    }
    return {};
  }

  /// The name ends with the line, or where the first facet begins in it.
  Result<void> begin_solid() {
    std::string_view name;
    std::string_view word = words_.next_in_line();
    const char* const start = word.data();
    for (; !word.empty(); word = words_.next_in_line()) {
      if (same_word(word, "facet")) {
        const std::string_view after = words_.next_in_line();
        if (same_word(after, "normal")) {
          builder_.begin_group(name);
          return begin_facet();
        }
        if (!after.empty()) word = after;
      }
      name = {start, static_cast<std::size_t>(word.data() + word.size() - start)};
    }
    builder_.begin_group(name);
    state_ = State::kSolid;
    return {};
  }

  /// The normal is not used, so that what is written for it does not matter.
  Result<void> begin_facet() {
    state_ = State::kFacet;
    for (std::string_view word = words_.next_in_line(); !word.empty(); word = words_.next_in_line()) {
      if (same_word(word, "outer")) return begin_loop();
    }
    return {};
  }

  Result<void> begin_loop() {
    const std::string_view word = words_.next();
    if (!same_word(word, "loop")) return wrong("outer and then " + in_quotes(word), "outer loop");
    corners_.clear();
    state_ = State::kLoop;
    return {};
  }

  /// `endNAME` or `end NAME`.
  Result<void> close(std::string_view word, std::string_view name, const char* expected) {
    if (same_word(word.substr(0, 3), "end")) {
      if (same_word(word.substr(3), name)) return {};
      if (word.size() == 3) {
        const std::string_view second = words_.next();
        return same_word(second, name) ? Result<void>()
                                       : wrong("end and then " + in_quotes(second), expected);
      }
    }
    return wrong(in_quotes(word), expected);
  }

  Result<void> read_vertex() {
    Vec3 point;
    for (double& coordinate : point) {
      const std::string_view word = words_.next();
      if (!parse_number(word, coordinate)) {
        return wrong(word.empty() ? "the end of the file" : in_quotes(word), "vertex X Y Z");
      }
    }
    corners_.push_back(builder_.vertex_count());
    return builder_.add_vertex(point, place());
  }

  std::string place() const { return at_line(words_.line_number()); }
  Error wrong(const std::string& found, const std::string& expected) const {
    return builder_.error("the text STL is broken", found, expected, place());
  }

  WordReader words_;
  MeshBuilder& builder_;
  std::vector<int> corners_;
  State state_ = State::kOutside;
};

/// Whether a keyword of a text stands behind the place of a binary count, and before any zero byte.
bool has_keyword(std::string_view bytes) {
  std::string_view head = bytes.substr(0, 1024);
  head = head.substr(0, head.find('\0'));
  if (head.size() <= kHeaderBytes && head.size() < bytes.size()) return false;
  WordReader words(head);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (same_word(word, "facet") || same_word(word, "vertex")) return true;
  }
  return false;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes &&
         kHeaderBytes + kTriangleBytes * declared_triangles(bytes) == bytes.size();
}

Result<void> read_stl(std::string_view bytes, MeshBuilder& builder) {
  if (is_binary_stl(bytes)) return read_binary(bytes, builder);
  // Binary headers may begin with "solid" too, but hold zero bytes somewhere in the count or the numbers.
  const std::size_t zero = bytes.find('\0');
  const std::string_view first = WordReader(bytes).next();
  const bool is_solid = same_word(first, "solid") || same_word(first, "facet");
  if (zero == std::string_view::npos && (is_solid || has_keyword(bytes))) {
    return TextReader(bytes, builder).read();
  }
  if (zero != std::string_view::npos && is_solid && has_keyword(bytes)) {
    return builder.error("the text STL is broken", "a zero byte", "text only", at_byte(zero));
  }
  if (zero != std::string_view::npos && bytes.size() >= kHeaderBytes) return read_binary(bytes, builder);
  return builder.error("the file is no STL",
                       std::to_string(bytes.size()) + " bytes that begin with " + in_quotes(first),
                       "a text STL, which begins with solid, or a binary one of at least 84 bytes");
}

}  // namespace tactum::inline v0_1::detail
