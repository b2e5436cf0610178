#include "tactum/scene/field_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "tactum/mesh/mapped_file.h"
#include "tactum/scene/toml_reader.h"

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

constexpr int kFieldSchema = 1;
constexpr std::size_t kMostHeaderBytes = 1 << 16;

struct Header {
  std::string data;
  GridShape shape;
  bool single = false;
  bool big_endian = false;
  double unit_N = 1.0;

  std::size_t bytes() const { return 3 * shape.count() * (single ? sizeof(float) : sizeof(double)); }
};

/// Reads whole numbers, and none that an int cannot represent: their range is checked with the shape.
std::array<int, 3> read_nodes(const TomlReader& root, const char* key) {
  const Vec3 read = root.vector3(key);
  std::array<int, 3> nodes{0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    if (!(read[i] == std::floor(read[i]) && std::abs(read[i]) < 1e9)) {
      root.fail(key, fmt::format("\"{}\" in {} must be counts", key, root.section()),
                fmt::format("{}", read[i]), "a whole number");
      return nodes;
    }
    nodes[static_cast<std::size_t>(i)] = static_cast<int>(read[i]);
  }
  return nodes;
}

Header read_header(const TomlReader& root) {
  Header header;
  root.integer("schema", {}, kFieldSchema, kFieldSchema);
  header.data = root.text("data");
  header.shape.nodes = read_nodes(root, "nodes");
  header.shape.spacing = root.vector3("spacing_m");
  header.shape.origin = root.vector3("origin_m", Vec3::Zero());
  header.single = root.choice("type", {}, {"float32", "float64"}) == "float32";
  header.big_endian = root.choice("byte_order", "little", {"little", "big"}) == "big";
  root.integer("components", {}, 3, 3);
  header.unit_N = root.number("unit_N", 1.0);
  if (root.errors()) return header;
  if (const Result<void> fine = check_shape(header.shape); !fine)
    root.fail(fine.error().what.find("nodes") != std::string::npos ? "nodes" : "spacing_m", fine.error().what,
              fine.error().found, fine.error().expected);
  return header;
}

/// Numbers of one byte order, times the unit. `bytes` need not be aligned.
template <class Number, class Bits>
std::vector<Number> numbers_from(std::string_view bytes, bool swapped, double unit_N) {
  std::vector<Number> numbers;
  numbers.reserve(bytes.size() / sizeof(Number));
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Number)) {
    Bits bits = 0;
    std::memcpy(&bits, bytes.data() + at, sizeof(Bits));
    if (swapped) {
      Bits turned = 0;
      for (std::size_t i = 0; i < sizeof(Bits); ++i)
        turned = static_cast<Bits>(turned << 8 | (bits >> 8 * i & 0xff));
      bits = turned;
    }
    numbers.push_back(static_cast<Number>(unit_N * static_cast<double>(std::bit_cast<Number>(bits))));
  }
  return numbers;
}

}  // namespace

Result<FieldGrid> read_field_file(const std::string& header_path, double edge_m) {
  const Result<MappedFile> text = MappedFile::open(header_path);
  if (!text) return text.error();
  if (text->bytes().size() > kMostHeaderBytes)
    return Error{"cannot read the field", "more than 64 kB", "the header of a field (.toml)", header_path};
  toml::table document;
  try {
    document = toml::parse(text->bytes(), header_path);
  } catch (const toml::parse_error& error) {
    return Error{"not TOML", std::string(error.description()), "", place(header_path, error.source().begin)};
  }
  FirstError errors;
  const TomlReader root(
      document, header_path, "",
      {"schema", "data", "nodes", "spacing_m", "origin_m", "type", "byte_order", "components", "unit_N"},
      errors);
  const Header header = read_header(root);
  if (errors) return errors.error();

  const std::string data_path = (fs::path(header_path).parent_path() / header.data).string();
  const Result<MappedFile> data = MappedFile::open(data_path);
  if (!data) return data.error();
  if (data->bytes().size() != header.bytes())
    return Error{
        "the data of a field has the wrong size", fmt::format("{} bytes", data->bytes().size()),
        fmt::format("{} for {} x {} x {} nodes of three {}", header.bytes(), header.shape.nodes[0],
                    header.shape.nodes[1], header.shape.nodes[2], header.single ? "float32" : "float64"),
        data_path};
  const bool swapped = header.big_endian != (std::endian::native == std::endian::big);
  FieldGrid::Samples samples;
  if (header.single) {
    samples = numbers_from<float, std::uint32_t>(data->bytes(), swapped, header.unit_N);
  } else {
    samples = numbers_from<double, std::uint64_t>(data->bytes(), swapped, header.unit_N);
  }
  Result<FieldGrid> grid = FieldGrid::make(header.shape, std::move(samples), edge_m);
  if (grid) return grid;
  Error error = grid.error();
  error.where = error.where.empty() ? data_path : data_path + ": " + error.where;
  return error;
}

Result<void> write_field_file(const std::string& header_path, const GridShape& shape,
                              const FieldGrid::Samples& samples) {
  static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");
  const fs::path data = fs::path(header_path).replace_extension(".raw");
  const std::string_view bytes = std::visit(
      [](const auto& numbers) {
        return std::string_view(reinterpret_cast<const char*>(numbers.data()),
                                numbers.size() * sizeof(numbers[0]));
      },
      samples);
  if (data == fs::path(header_path))
    return Error{"the header and the data would be one file", header_path, "a name that ends in .toml", ""};
  if (const Result<void> written = write_whole_file(data.string(), bytes); !written) return written;
  std::string name;  // as TOML has it
  for (const char c : data.filename().string())
    name += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return write_whole_file(
      header_path,
      fmt::format(
          "schema = 1\ndata = \"{}\"\nnodes = [{}, {}, {}]\nspacing_m = [{}, {}, {}]\n"
          "origin_m = [{}, {}, {}]\ntype = \"{}\"\nbyte_order = \"little\"\ncomponents = 3\nunit_N = 1\n",
          name, shape.nodes[0], shape.nodes[1], shape.nodes[2], shape.spacing.x(), shape.spacing.y(),
          shape.spacing.z(), shape.origin.x(), shape.origin.y(), shape.origin.z(),
          std::holds_alternative<std::vector<float>>(samples) ? "float32" : "float64"));
}

}  // namespace tactum::inline v0_1
