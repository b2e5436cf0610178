#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// OFF: the keyword, the counts of vertices, faces and edges, then a line each; # begins a comment. Letters
/// before OFF tell what follows a vertex's coordinates in its line: ST, C and N texture coordinates, a colour
/// and a normal, which are passed over like the colours of faces. The counts may stand behind the keyword,
/// even without a blank; the number of edges may be missing, and the keyword too where the counts say enough.

namespace tactum::inline v0_1::detail {
namespace {

/// The keyword, without what is glued to it; empty when the word does not begin with one.
std::string_view off_keyword(std::string_view word) {
  for (std::string_view end : {"OFF", "off", "Off"}) {
    const std::size_t at = word.find(end);
    if (at == std::string_view::npos) continue;
    const std::string_view letters = word.substr(0, at);
    if (letters.find_first_not_of("STCN4nstc") != std::string_view::npos) continue;
    const std::string_view glued = word.substr(at + end.size());
    if (glued.find_first_not_of("0123456789") == std::string_view::npos)
      return word.substr(0, at + end.size());
  }
  return {};
}

class OffReader {
 public:
  OffReader(std::string_view text, MeshBuilder& builder)
      : text_size_(text.size()), lines_(text), builder_(builder) {}

  Result<void> read() {
    if (!next_line()) return wrong("an empty file", "OFF");
    if (Result<void> done = read_keyword(); !done) return done;
    unsigned long long vertices = 0;
    unsigned long long faces = 0;
    if (Result<void> done = read_counts(vertices, faces); !done) return done;
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
  /// Takes the keyword off the first line.
  Result<void> read_keyword() {
    Tokens tokens(line_);
    const std::string_view word = tokens.next();
    const std::string_view keyword = off_keyword(word);
    if (keyword.empty()) {
      if (are_counts(line_)) return {};
      return wrong(in_quotes(word), "OFF, COFF, NOFF, CNOFF or STOFF");
    }
    if (keyword.find('4') != std::string_view::npos || keyword.ends_with("nOFF")) {
      return builder_.error("points that are not of three dimensions are not read", in_quotes(keyword),
                            "x y z: OFF without 4 and n", at_line(lines_.line_number()));
    }
    row_ = Tokens(line_.substr(static_cast<std::size_t>(keyword.data() + keyword.size() - line_.data())));
    if (same_word(Tokens(row_).next(), "binary")) return wrong("a binary file", "the text form of OFF");
    return {};
  }

  /// The number of edges is not used. Where the other counts have a line each, it has one too.
  Result<void> read_counts(unsigned long long& vertices, unsigned long long& faces) {
    int line = 0;  // of the first count
    for (unsigned long long* count : {&vertices, &faces}) {
      const std::string_view word = next_word();
      if (!parse_number(word, *count)) {
        return wrong(word.empty() ? "the end of the file" : in_quotes(word),
                     "the counts of vertices, faces and edges");
      }
      if (line == 0) line = lines_.line_number();
    }
    if (line == lines_.line_number()) return {};
    const LineReader before = lines_;
    unsigned long long edges = 0;
    const bool counted = next_line() && parse_number(next_word(), edges) && row_.remainder().empty();
    if (!counted) lines_ = before;
    return {};
  }

  /// Two or three whole numbers and nothing else.
  static bool are_counts(std::string_view line) {
    Tokens tokens(line);
    int numbers = 0;
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
      unsigned long long number = 0;
      if (!parse_number(word, number)) return false;
      ++numbers;
    }
    return numbers == 2 || numbers == 3;
  }

  /// The next line that holds more than a comment, as `line_` and `row_`.
  bool next_line() {
    while (lines_.next(line_)) {
      line_ = line_.substr(0, line_.find('#'));
      row_ = Tokens(line_);
      if (!row_.remainder().empty()) return true;
    }
    return false;
  }

  /// The next word of the row, which goes on in the next line where it is too short.
  std::string_view next_word() {
    std::string_view word = row_.next();
    if (word.empty() && next_line()) word = row_.next();
    return word;
  }

  Result<void> read_vertex() {
    if (!next_line()) return wrong("the end of the file", "a vertex");
    Vec3 point;
    for (double& coordinate : point) {
      if (!parse_number(next_word(), coordinate)) return wrong(in_quotes(line_), "a vertex X Y Z");
    }
    return builder_.add_vertex(point, at_line(lines_.line_number()));
  }

  Result<void> read_face() {
    if (!next_line()) return wrong("the end of the file", "a face");
    unsigned count = 0;
    if (!parse_number(next_word(), count) || count > text_size_ / 2)
      return wrong(in_quotes(line_), "N and N indices");
    corners_.clear();
    for (unsigned i = 0; i < count; ++i) {
      int corner = 0;
      if (!parse_number(next_word(), corner)) return wrong(in_quotes(line_), "N and N indices");
      corners_.push_back(corner);
    }
    return builder_.add_polygon(corners_, at_line(lines_.line_number()));
  }

  Error wrong(const std::string& found, const std::string& expected) const {
    return builder_.error("the OFF file is broken", found, expected, at_line(lines_.line_number()));
  }

  std::size_t text_size_;
  LineReader lines_;
  std::string_view line_;
  Tokens row_{std::string_view()};  ///< what is left of the line
  MeshBuilder& builder_;
  std::vector<int> corners_;
};

}  // namespace

Result<void> read_off(std::string_view text, MeshBuilder& builder) {
  builder.report().format = "OFF";
  return OffReader(text, builder).read();
}

}  // namespace tactum::inline v0_1::detail
