#include <fmt/format.h>

#include "tactum/scene/field_file.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

/// Sample points of a body that tells none, in a scene with fields.
constexpr int kFieldPoints = 100;
/// A scene file of a hundred bytes must not ask for more memory than this many nodes take: 0.8 GB in doubles.
constexpr std::size_t kMostSampledNodes = std::size_t{1} << 25;

/// The keys of a field and for which kinds they are.
struct FieldKey {
  const char* name;
  const char* kinds;
};
constexpr FieldKey kFieldKeys[] = {
    {"moment_Nm3", "dipole"},
    {"core_m", "dipole, vortex"},
    {"depth_J", "well"},
    {"width_m", "well"},
    {"circulation_J", "vortex"},
    {"file", "grid"},
    {"sampled", "dipole, well, vortex"},
};

template <class Number, class Shape>
FieldGrid::Samples samples_of(const Shape& formula, const GridShape& shape) {
  return sampled<Number>(shape, [&](const Vec3& p) { return value_at(formula, p).force; });
}

/// `sampled = {...}`: the formula on a grid about the field's middle, as a file would bring it.
template <class Shape>
void read_sampled(const TomlReader& reader, const Shape& formula, double edge_m, ForceField& field) {
  const TomlReader table = reader.table("sampled", {"nodes", "size_m", "type"});
  GridShape shape;
  const int nodes = table.integer("nodes", {}, 2, 512);
  const Vec3 size = table.vector3("size_m");
  const bool single = table.choice("type", "float32", {"float32", "float64"}) == "float32";
  if (table.errors()) return;
  shape.nodes = {nodes, nodes, nodes};
  if (shape.count() > kMostSampledNodes)
    return table.fail("nodes", "so many nodes take too much memory", fmt::format("{}", shape.count()),
                      fmt::format("at most {} in all", kMostSampledNodes));
  shape.spacing = size / (nodes - 1);
  shape.origin = -0.5 * size;
  if (const Result<void> fine = check_shape(shape); !fine)
    return table.fail("size_m", fine.error().what, fine.error().found, fine.error().expected);
  Result<FieldGrid> grid = FieldGrid::make(
      shape, single ? samples_of<float>(formula, shape) : samples_of<double>(formula, shape), edge_m);
  if (!grid) return table.fail("nodes", grid.error().message());
  field.shape = std::make_shared<const FieldGrid>(std::move(*grid));
}

void read_grid(const TomlReader& reader, const SearchFolders& folders, double edge_m, ForceField& field) {
  const std::string name = reader.text("file");
  if (reader.errors()) return;
  const Result<std::string> found = found_file(name, folders);
  if (!found)
    return reader.fail("file", "cannot find the field \"" + name + "\"", found.error().found,
                       found.error().expected);
  Result<FieldGrid> grid = read_field_file(*found, edge_m);
  if (!grid) return reader.fail("file", grid.error().message());
  field.shape = std::make_shared<const FieldGrid>(std::move(*grid));
}

template <class Shape>
void keep(const TomlReader& reader, const Shape& formula, double edge_m, ForceField& field) {
  field.shape = formula;
  if (reader.has("sampled") && !reader.errors()) read_sampled(reader, formula, edge_m, field);
}

ForceField read_field(const TomlReader& reader, const SearchFolders& folders) {
  ForceField field;
  const std::string kind = reader.choice("kind", {}, {"dipole", "well", "vortex", "grid"});
  for (const FieldKey& key : kFieldKeys)
    if (reader.has(key.name) && std::string_view(key.kinds).find(kind) == std::string_view::npos)
      reader.fail(key.name,
                  fmt::format("\"{}\" in {} is not for this kind of field", key.name, reader.section()), kind,
                  key.kinds);
  if (reader.has("edge_m") && kind != "grid" && !reader.has("sampled"))
    reader.fail("edge_m", "only a grid has an edge", kind, "kind = \"grid\", or sampled = {...}");
  field.X_WF.p = reader.vector3("pos_m", Vec3::Zero());
  field.X_WF.R = reader.rotation();
  field.scale = reader.number("scale", 1.0);
  field.largest_force_N = reader.number("largest_force_N", field.largest_force_N, kPositive);
  field.largest_torque_Nm = reader.number("largest_torque_Nm", field.largest_torque_Nm, kPositive);
  const double edge_m = reader.number("edge_m", 0.0, kNotNegative);
  if (kind == "grid") {
    read_grid(reader, folders, edge_m, field);
  } else if (kind == "dipole") {
    const double moment = reader.number("moment_Nm3");
    keep(reader, DipoleField{moment, reader.number("core_m", {}, kPositive)}, edge_m, field);
  } else if (kind == "well") {
    const double depth = reader.number("depth_J");
    keep(reader, WellField{depth, reader.number("width_m", {}, kPositive)}, edge_m, field);
  } else {
    const double circulation = reader.number("circulation_J");
    keep(reader, VortexField{circulation, reader.number("core_m", {}, kPositive)}, edge_m, field);
  }
  return field;
}

}  // namespace

void read_fields(const TomlReader& root, const SearchFolders& folders, Scene& scene) {
  const auto readers = root.tables(
      "field", {"kind", "file", "moment_Nm3", "core_m", "depth_J", "width_m", "circulation_J", "sampled",
                "edge_m", "pos_m", "quat_wxyz", "rpy_deg", "scale", "largest_force_N", "largest_torque_Nm"});
  for (const TomlReader& reader : readers) {
    scene.world.fields.push_back(read_field(reader, folders));
    if (reader.errors()) return;
  }
  if (readers.empty()) return;
  for (Body& body : scene.world.bodies)
    if (body.moves() && body.field_points.empty())
      body.field_points = spread_over(body.part->surface, kFieldPoints);
}

}  // namespace tactum
