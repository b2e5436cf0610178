#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// OFF: the word, the counts of vertices, faces and edges, then a line each; # begins a comment.

namespace tactum::inline v0_1::detail {
namespace {

class OffReader {
 public:
  OffReader(std::string_view text, MeshBuilder& builder)
      : text_size_(text.size()), lines_(text), builder_(builder) {}

  Result<void> read() {
    std::string_view line;
    if (!next_line(line)) return wrong("an empty file", "OFF");
    Tokens tokens(line);
    if (const std::string_view word = tokens.next(); word != "OFF") return wrong(in_quotes(word), "OFF");
    if (tokens.remainder().empty()) {
      if (!next_line(line)) return wrong("the end of the file", "the counts of vertices, faces and edges");
      tokens = Tokens(line);
    }
    unsigned long long vertices = 0;
    unsigned long long faces = 0;
    const bool counted = parse_number(tokens.next(), vertices) && parse_number(tokens.next(), faces);
    if (!counted) return wrong(in_quotes(line), "the counts of vertices, faces and edges");
    // A vertex takes at least "0 0 0\n", a face "0\n": counts that cannot be true are refused here.
    if (vertices > text_size_ / 6 || faces > text_size_ / 2) {
      return wrong(std::to_string(vertices) + " vertices and " + std::to_string(faces) +
                       " faces in a file of " + std::to_string(text_size_) + " bytes",
                   "counts that fit the file");
    }
    for (unsigned long long i = 0; i < vertices; ++i) {
      if (Result<void> done = read_vertex(); !done) return done;
    }
    for (unsigned long long i = 0; i < faces; ++i) {
      if (Result<void> done = read_face(); !done) return done;
    }
    return {};
  }

 private:
  bool next_line(std::string_view& line) {
    while (lines_.next(line)) {
      line = line.substr(0, line.find('#'));
      if (!Tokens(line).next().empty()) return true;
    }
    return false;
  }

  Result<void> read_vertex() {
    std::string_view line;
    if (!next_line(line)) return wrong("the end of the file", "a vertex");
    Tokens tokens(line);
    Vec3 point;
    for (double& coordinate : point) {
      if (!parse_number(tokens.next(), coordinate)) return wrong(in_quotes(line), "a vertex X Y Z");
    }
    return builder_.add_vertex(point, at_line(lines_.line_number()));
  }

  Result<void> read_face() {
    std::string_view line;
    if (!next_line(line)) return wrong("the end of the file", "a face");
    Tokens tokens(line);
    unsigned count = 0;
    if (!parse_number(tokens.next(), count) || count > line.size() / 2)
      return wrong(in_quotes(line), "N and N indices");
    std::vector<int> corners(count);
    for (int& corner : corners) {
      if (!parse_number(tokens.next(), corner)) return wrong(in_quotes(line), "N and N indices");
    }
    return builder_.add_polygon(corners, at_line(lines_.line_number()));
  }

  Error wrong(const std::string& found, const std::string& expected) const {
    return builder_.error("the OFF file is broken", found, expected, at_line(lines_.line_number()));
  }

  std::size_t text_size_;
  LineReader lines_;
  MeshBuilder& builder_;
};

}  // namespace

Result<void> read_off(std::string_view text, MeshBuilder& builder) {
  builder.report().format = "OFF";
  return OffReader(text, builder).read();
}

}  // namespace tactum::inline v0_1::detail
