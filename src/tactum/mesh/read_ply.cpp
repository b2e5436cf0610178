#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// PLY, text and binary of both byte orders. The header lists elements (vertex, face, ...) and their
/// properties; of vertices x, y, z are taken, of faces the list vertex_indices or vertex_index, of triangle
/// strips (tristrips) the same list, everything else is ignored. The rows of a text stand in a line each, or
/// anyhow.

namespace tactum::inline v0_1::detail {
namespace {

static_assert(std::endian::native == std::endian::little);

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct TypeName {
  std::string_view name;
  Type type;
  std::size_t size;  ///< [bytes]
};
constexpr std::array<TypeName, 16> kTypes = {{{"char", Type::kInt8, 1},
                                              {"int8", Type::kInt8, 1},
                                              {"uchar", Type::kUint8, 1},
                                              {"uint8", Type::kUint8, 1},
                                              {"short", Type::kInt16, 2},
                                              {"int16", Type::kInt16, 2},
                                              {"ushort", Type::kUint16, 2},
                                              {"uint16", Type::kUint16, 2},
                                              {"int", Type::kInt32, 4},
                                              {"int32", Type::kInt32, 4},
                                              {"uint", Type::kUint32, 4},
                                              {"uint32", Type::kUint32, 4},
                                              {"float", Type::kFloat, 4},
                                              {"float32", Type::kFloat, 4},
                                              {"double", Type::kDouble, 8},
                                              {"float64", Type::kDouble, 8}}};

const TypeName* find_type(std::string_view name) {
  const auto* found =
      std::find_if(kTypes.begin(), kTypes.end(), [name](const TypeName& t) { return t.name == name; });
  return found == kTypes.end() ? nullptr : found;
}

struct Property {
  std::string_view name;
  const TypeName* type = nullptr;
  const TypeName* count_type = nullptr;  ///< of lists; null for single values
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  const Property* find(std::string_view property) const {
    for (const Property& p : properties) {
      if (p.name == property) return &p;
    }
    return nullptr;
  }
};

enum class Encoding { kText, kLittle, kBig };

template <class T>
double number_at(const char* bytes, bool swapped) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swapped) std::reverse(raw.begin(), raw.end());
  T value{};
  std::memcpy(&value, raw.data(), sizeof(T));
  return static_cast<double>(value);
}

double number_at(const char* bytes, Type type, bool swapped) {
  switch (type) {
    case Type::kInt8:
      return number_at<std::int8_t>(bytes, swapped);
    case Type::kUint8:
      return number_at<std::uint8_t>(bytes, swapped);
    case Type::kInt16:
      return number_at<std::int16_t>(bytes, swapped);
    case Type::kUint16:
      return number_at<std::uint16_t>(bytes, swapped);
    case Type::kInt32:
      return number_at<std::int32_t>(bytes, swapped);
    case Type::kUint32:
      return number_at<std::uint32_t>(bytes, swapped);
    case Type::kFloat:
      return number_at<float>(bytes, swapped);
    case Type::kDouble:
      return number_at<double>(bytes, swapped);
  }
  return 0.0;
}

constexpr int kNewStrip = -1;  // among the corners of strips

class PlyReader {
 public:
  PlyReader(std::string_view bytes, MeshBuilder& builder) : bytes_(bytes), lines_(bytes), builder_(builder) {}

  Result<void> read() {
    if (Result<void> done = read_header(); !done) return done;
    static constexpr std::array<const char*, 3> kNames = {"PLY (text)", "PLY (binary, little-endian)",
                                                          "PLY (binary, big-endian)"};
    builder_.report().format = kNames[static_cast<std::size_t>(encoding_)];
    position_ = end_of_header();
    words_ = WordReader(bytes_.substr(position_), lines_.line_number() + 1);
    row_a_line_ = encoding_ == Encoding::kText && has_row_in_every_line();
    for (const Element& element : elements_) {
      if (Result<void> done = check_count(element); !done) return done;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (Result<void> done = read_row(element); !done) return done;
      }
    }
    return {};
  }

 private:
  Result<void> read_header() {
    std::string_view line;
    lines_.next(line);
    if (Tokens(line).remainder() != "ply") return wrong(in_quotes(line), "ply");
    bool has_format = false;
    while (lines_.next(line)) {
      Tokens tokens(line);
      const std::string_view kind = tokens.next();
      if (kind == "end_header")
        return has_format ? Result<void>() : wrong("no format line", "format ascii 1.0 or binary");
      if (kind == "format") {
        const std::string_view name = tokens.next();
        if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian") {
          return wrong(in_quotes(name), "ascii, binary_little_endian or binary_big_endian");
        }
        encoding_ = name == "ascii"               ? Encoding::kText
                    : name == "binary_big_endian" ? Encoding::kBig
                                                  : Encoding::kLittle;
        has_format = true;
      } else if (kind == "element") {
        Element element;
        element.name = tokens.next();
        if (const std::string_view count = tokens.next(); !parse_number(count, element.count)) {
          return wrong(in_quotes(count), "element NAME COUNT");
        }
        elements_.push_back(element);
      } else if (kind == "property") {
        if (Result<void> done = read_property(tokens); !done) return done;
      } else if (kind != "comment" && kind != "obj_info" && !kind.empty()) {
        return wrong(in_quotes(kind), "element, property, comment or end_header");
      }
    }
    return wrong("the end of the file", "end_header");
  }

  Result<void> read_property(Tokens& tokens) {
    if (elements_.empty()) return wrong("a property before any element", "element first");
    Property property;
    std::string_view type = tokens.next();
    if (type == "list") {
      property.count_type = find_type(tokens.next());
      if (property.count_type == nullptr || property.count_type->type >= Type::kFloat) {
        return wrong("a list without a whole-number count", "property list COUNT_TYPE TYPE NAME");
      }
      type = tokens.next();
    }
    property.type = find_type(type);
    if (property.type == nullptr) return wrong(in_quotes(type), "a type such as float, uchar or int");
    property.name = tokens.next();
    elements_.back().properties.push_back(property);
    return {};
  }

  /// Refuses a count that the bytes left cannot hold, before anything is read or reserved for it.
  Result<void> check_count(const Element& element) {
    if (element.count > 0 && element.properties.empty()) {
      return builder_.error("the PLY header is broken",
                            "element " + in_quotes(element.name) + " without properties",
                            "at least one property");
    }
    std::uint64_t row = 0;  // least bytes of a row; a number of a text takes at least itself and a blank
    for (const Property& property : element.properties) {
      const TypeName* type = property.count_type != nullptr ? property.count_type : property.type;
      row += encoding_ == Encoding::kText ? 2 : type->size;
    }
    const std::size_t at = encoding_ == Encoding::kText ? position_ + words_.position() : position_;
    const std::uint64_t left = bytes_.size() - at + 1;  // the last blank may be missing
    if (row > 0 && element.count > left / row) {
      return builder_.error("the file is cut short or its counts are wrong",
                            std::to_string(left - 1) + " bytes left",
                            "at least " + std::to_string(row) + " bytes for each of the " +
                                std::to_string(element.count) + " rows of " + in_quotes(element.name),
                            at_byte(at));
    }
    if (element.name == "vertex") {
      for (std::string_view axis : {"x", "y", "z"}) {
        const Property* property = element.find(axis);
        if (property == nullptr || property->count_type != nullptr) {
          return builder_.error("the PLY header is broken", "no vertex property " + std::string(axis),
                                "properties x, y and z");
        }
      }
    }
    return {};
  }

  /// Where the rows begin. Behind a header whose lines end with CR alone a binary row may begin with the byte
  /// of LF.
  std::size_t end_of_header() const {
    const std::size_t end = lines_.position();
    const std::size_t first = bytes_.find_first_of("\r\n");
    const bool lone = bytes_[first] == '\r' && bytes_.substr(first, 2) != "\r\n";
    const bool taken = bytes_.substr(0, end).ends_with("\r\n");
    return lone && taken ? end - 1 : end;
  }

  /// Whether every row has a line that holds all of it. What follows in such a line is passed over; otherwise
  /// the numbers are read one after the other, whatever lines they stand in.
  bool has_row_in_every_line() const {
    LineReader lines(bytes_.substr(position_));
    for (const Element& element : elements_) {
      for (std::uint64_t i = 0; i < element.count; ++i) {
        std::string_view line;
        do {
          if (!lines.next(line)) return false;
        } while (Tokens(line).next().empty());
        if (!holds_row(Tokens(line), element)) return false;
      }
    }
    return true;
  }

  static bool holds_row(Tokens words, const Element& element) {
    for (const Property& property : element.properties) {
      const std::string_view word = words.next();
      double count = 0.0;
      if (property.count_type != nullptr && !parse_number(word, count)) count = 0.0;
      for (double i = 0.0; i < count; i += 1.0) {
        if (words.next().empty()) return false;
      }
      if (word.empty()) return false;
    }
    return true;
  }

  Result<void> read_row(const Element& element) {
    row_start_ = position_;
    Vec3 point = Vec3::Zero();
    corners_.clear();
    const bool has_corners = element.name == "face" || element.name == "tristrips";
    for (const Property& property : element.properties) {
      double value = 0.0;
      if (!next_number(property.count_type != nullptr ? *property.count_type : *property.type, value)) {
        return cut_short(element);
      }
      if (property.count_type == nullptr) {
        for (int axis = 0; axis < 3; ++axis) {
          if (property.name == std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1))
            point[axis] = value;
        }
        continue;
      }
      const bool is_corners =
          has_corners && (property.name == "vertex_indices" || property.name == "vertex_index");
      if (Result<void> done = read_list(element, property, value, is_corners); !done) return done;
    }
    const std::string at = place();
    if (row_a_line_) words_.skip_line();
    if (element.name == "vertex") return builder_.add_vertex(point, at);
    if (element.name == "tristrips") return add_strips(at);
    if (element.name == "face") return builder_.add_polygon(corners_, at);
    return {};
  }

  /// Every three neighbours of a strip are a triangle, every other one the other way round. Those with two
  /// equal corners only lead from one strip to the next.
  Result<void> add_strips(const std::string& at) {
    std::size_t begin = 0;  // of the strip
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == kNewStrip) begin = i + 1;
      if (i < begin + 2) continue;
      std::vector<int> triangle(corners_.begin() + static_cast<std::ptrdiff_t>(i) - 2,
                                corners_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      if ((i - begin) % 2 == 1) std::swap(triangle[0], triangle[1]);
      if (Result<void> done = builder_.add_polygon(triangle, at); !done) return done;
    }
    return {};
  }

  Result<void> read_list(const Element& element, const Property& property, double count, bool is_corners) {
    if (!(count >= 0.0) || count != std::floor(count))
      return builder_.error("a list has no count", std::to_string(count), "a whole number, 0 or more",
                            place());
    for (double i = 0.0; i < count; i += 1.0) {
      double value = 0.0;
      if (!next_number(*property.type, value)) return cut_short(element);
      if (!is_corners) continue;
      // Types without a sign write -1 as their largest number.
      const bool is_restart = value == -1.0 || value == std::numeric_limits<std::uint32_t>::max();
      if (is_restart && element.name == "tristrips") {
        corners_.push_back(kNewStrip);
        continue;
      }
      const bool is_index = value >= 0.0 && value < builder_.vertex_count() && value == std::floor(value);
      if (!is_index) {
        return builder_.error("a face refers to a vertex that is not there",
                              "vertex " + std::to_string(value),
                              "0 to " + std::to_string(builder_.vertex_count() - 1), place());
      }
      corners_.push_back(static_cast<int>(value));
    }
    return {};
  }

  bool next_number(const TypeName& type, double& value) {
    if (encoding_ == Encoding::kText) return parse_number(words_.next(), value);
    if (bytes_.size() - position_ < type.size) return false;
    value = number_at(bytes_.data() + position_, type.type, encoding_ == Encoding::kBig);
    position_ += type.size;
    return true;
  }

  std::string place() const {
    return encoding_ == Encoding::kText ? at_line(words_.line_number()) : at_byte(row_start_);
  }
  Error cut_short(const Element& element) const {
    return builder_.error("a row of the PLY file cannot be read", "too few numbers or no number",
                          std::to_string(element.count) + " rows of " + in_quotes(element.name), place());
  }
  Error wrong(const std::string& found, const std::string& expected) const {
    return builder_.error("the PLY header is broken", found, expected, at_line(lines_.line_number()));
  }

  std::string_view bytes_;
  LineReader lines_;  ///< of the header
  MeshBuilder& builder_;
  Encoding encoding_ = Encoding::kText;
  std::vector<Element> elements_;
  std::size_t position_ = 0;                 ///< of a binary file
  std::size_t row_start_ = 0;                ///< of a binary file
  WordReader words_{std::string_view(), 1};  ///< of a text, behind the header
  bool row_a_line_ = false;                  ///< of a text
  std::vector<int> corners_;
};

}  // namespace

Result<void> read_ply(std::string_view bytes, MeshBuilder& builder) {
  builder.report().format = "PLY";
  return PlyReader(bytes, builder).read();
}

}  // namespace tactum::inline v0_1::detail
