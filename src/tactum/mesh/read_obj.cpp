#include <limits>

#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// Wavefront OBJ: `v`, `f`, `o`, `g`; points and lines are counted, normals, textures and materials ignored.
/// Indices start at 1; negative ones count back from the last vertex read. Lines of a kind that the format
/// does not have are passed over and told, unless numbers stand in them: a vertex left out would shift all
/// indices.

namespace tactum::inline v0_1::detail {
namespace {

class ObjReader {
 public:
  ObjReader(std::string_view text, MeshBuilder& builder) : lines_(text, true), builder_(builder) {}

  Result<void> read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (Result<void> done = read_line(line); !done) return done;
    }
    if (unknown_ > 0) {
      builder_.report().remarks.push_back(
          std::to_string(unknown_) + " lines of a kind unknown here were passed over, the first is line " +
          std::to_string(first_unknown_) + ".");
    }
    return {};
  }

 private:
  Result<void> read_line(std::string_view line) {
    if (const std::size_t comment = line.find('#'); comment != std::string_view::npos)
      line = line.substr(0, comment);
    Tokens tokens(line);
    const std::string_view kind = tokens.next();
    if (kind.empty()) return {};
    if (kind == "v") return read_vertex(tokens);
    if (kind == "f" || kind == "fo") return read_face(tokens);
    if (kind == "o" || kind == "g") {
      builder_.begin_group(tokens.remainder());
    } else if (kind == "p") {
      ++builder_.report().points_dropped;
    } else if (kind == "l") {
      ++builder_.report().lines_dropped;
    } else if (!is_known(kind)) {
      return pass_over(kind, tokens);
    }
    return {};
  }

  static bool is_known(std::string_view kind) {
    for (std::string_view known : {"vn", "vt", "vp", "s", "usemtl", "mtllib", "usemap", "maplib"}) {
      if (kind == known) return true;
    }
    return false;
  }

  /// Statements of the format about curves, surfaces and display, in which numbers may stand.
  static bool is_of_the_format(std::string_view kind) {
    for (std::string_view known :
         {"cstype",   "deg",      "bmat", "step",       "curv",      "curv2", "surf",  "parm",
          "trim",     "hole",     "scrv", "sp",         "end",       "con",   "mg",    "bevel",
          "c_interp", "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech", "stech", "call",
          "csh",      "bsp",      "bzp",  "cdc",        "cdp",       "res"}) {
      if (kind == known) return true;
    }
    return false;
  }

  Result<void> pass_over(std::string_view kind, Tokens tokens) {
    int words = 0;
    bool all_numbers = true;
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
      double number = 0.0;
      all_numbers = all_numbers && parse_number(word.substr(0, word.find('/')), number);
      ++words;
    }
    if (all_numbers && words >= 2 && !is_of_the_format(kind)) {
      return builder_.error("a line of numbers is of no known kind", in_quotes(kind),
                            "v, f or another word of the format", at_line(lines_.line_number()));
    }
    if (unknown_++ == 0) first_unknown_ = lines_.line_number();
    return {};
  }

  Result<void> read_vertex(Tokens& tokens) {
    Vec3 point;
    for (double& coordinate : point) {
      const std::string_view word = tokens.next();
      if (!parse_number(word, coordinate)) {
        return builder_.error("a vertex cannot be read",
                              word.empty() ? "fewer than three numbers" : in_quotes(word), "v X Y Z",
                              at_line(lines_.line_number()));
      }
    }
    return builder_.add_vertex(point, at_line(lines_.line_number()));
  }

  Result<void> read_face(Tokens& tokens) {
    corners_.clear();
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
      long long index = 0;
      if (!parse_number(word.substr(0, word.find('/')), index)) {
        return builder_.error("a face cannot be read", in_quotes(word), "corners as V, V/T, V//N or V/T/N",
                              at_line(lines_.line_number()));
      }
      const long long vertex = index > 0 ? index - 1 : builder_.vertex_count() + index;
      if (index == 0 || index < -builder_.vertex_count() || vertex >= builder_.vertex_count()) {
        return builder_.error("a face refers to a vertex that is not there",
                              "vertex " + std::to_string(index),
                              "1 to " + std::to_string(builder_.vertex_count()) + ", or as many back from -1",
                              at_line(lines_.line_number()));
      }
      corners_.push_back(static_cast<int>(vertex));
    }
    return builder_.add_polygon(corners_, at_line(lines_.line_number()));
  }

  LineReader lines_;
  MeshBuilder& builder_;
  std::vector<int> corners_;
  int unknown_ = 0;
  int first_unknown_ = 0;
};

}  // namespace

Result<void> read_obj(std::string_view text, MeshBuilder& builder) {
  builder.report().format = "OBJ";
  return ObjReader(text, builder).read();
}

}  // namespace tactum::inline v0_1::detail
