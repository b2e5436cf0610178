#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tactum/geometry/mesh_import.h"
#include "tactum/geometry/primitives.h"
#include "tactum/scene/gear.h"
#include "tactum/scene/generated_parts.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

using Pieces = Result<std::vector<Polytope>>;

Vec3 positive_vector3(const TomlReader& reader, const char* key) {
  const Vec3 read = reader.vector3(key);
  if (reader.has(key) && !(read.minCoeff() > 0.0)) {
    reader.fail(key, fmt::format("\"{}\" in {} is out of range", key, reader.section()),
                fmt::format("[{}, {}, {}]", read.x(), read.y(), read.z()), "three numbers above 0");
    return Vec3::Ones();
  }
  return reader.has(key) ? read : Vec3::Ones();
}

Pieces read_gear(const TomlReader& part) {
  const TomlReader table = part.table("gear", {"teeth", "module_m", "pressure_angle_deg", "addendum",
                                               "dedendum", "face_width_m", "backlash_m", "flank_facets"});
  Gear gear;
  gear.teeth = table.integer("teeth", gear.teeth, 1, 400);
  gear.module_m = table.number("module_m", gear.module_m, kPositive);
  gear.pressure_angle_rad = radians(table.number("pressure_angle_deg", 20.0, {10.0, 30.0}));
  gear.addendum = table.number("addendum", gear.addendum, kPositive);
  gear.dedendum = table.number("dedendum", gear.dedendum, kPositive);
  gear.face_width_m = table.number("face_width_m", gear.face_width_m, kPositive);
  gear.backlash_m = table.number("backlash_m", gear.backlash_m, kNotNegative);
  gear.flank_facets = table.integer("flank_facets", gear.flank_facets, 2, 64);
  return gear_pieces(gear);
}

Pieces read_peg(const TomlReader& part) {
  const TomlReader table = part.table("peg", {"sides", "width_m", "depth_m", "length_m", "chamfer_m"});
  Peg peg;
  peg.sides = table.integer("sides", peg.sides, 0, 256);
  peg.width_m = table.number("width_m", peg.width_m, kPositive);
  peg.depth_m = table.number("depth_m", peg.depth_m, kPositive);
  peg.length_m = table.number("length_m", peg.length_m, kPositive);
  peg.chamfer_m = table.number("chamfer_m", peg.chamfer_m, kNotNegative);
  return peg_pieces(peg);
}

Pieces read_hole_block(const TomlReader& part) {
  const TomlReader table = part.table("hole_block", {"sides", "peg_width_m", "peg_depth_m", "clearance_m",
                                                     "wall_m", "hole_depth_m", "floor_m"});
  HoleBlock block;
  block.sides = table.integer("sides", block.sides, 0, 256);
  block.peg_width_m = table.number("peg_width_m", block.peg_width_m, kPositive);
  block.peg_depth_m = table.number("peg_depth_m", block.peg_depth_m, kPositive);
  block.clearance_m = table.number("clearance_m", block.clearance_m, kNotNegative);
  block.wall_m = table.number("wall_m", block.wall_m, kPositive);
  block.hole_depth_m = table.number("hole_depth_m", block.hole_depth_m, kPositive);
  block.floor_m = table.number("floor_m", block.floor_m, kNotNegative);
  return hole_block_pieces(block);
}

Pieces read_box(const TomlReader& part) {
  const TomlReader table = part.table("box", {"size_m"});
  return std::vector<Polytope>{make_box(0.5 * positive_vector3(table, "size_m"))};
}

Pieces read_sphere(const TomlReader& part) {
  const TomlReader table = part.table("sphere", {"radius_m", "subdivisions"});
  const double radius = table.number("radius_m", {}, kPositive);
  const int subdivisions = table.integer("subdivisions", 2, 0, 5);
  return std::vector<Polytope>{make_icosphere(subdivisions, radius > 0.0 ? radius : 1.0)};
}

Pieces read_ellipsoid(const TomlReader& part) {
  const TomlReader table = part.table("ellipsoid", {"radii_m", "subdivisions"});
  const Vec3 radii = positive_vector3(table, "radii_m");
  const int subdivisions = table.integer("subdivisions", 2, 0, 5);
  return std::vector<Polytope>{make_ellipsoid(subdivisions, radii)};
}

Pieces read_prism(const TomlReader& part) {
  const TomlReader table = part.table("prism", {"sides", "radius_m", "height_m"});
  const int sides = table.integer("sides", {}, 3, 1024);
  const double radius = table.number("radius_m", {}, kPositive);
  const double height = table.number("height_m", {}, kPositive);
  if (table.errors()) return std::vector<Polytope>{};
  return std::vector<Polytope>{make_prism(sides, radius, height)};
}

struct MadeShape {
  const char* kind;
  Pieces (*read)(const TomlReader& part);
};
constexpr MadeShape kMadeShapes[] = {
    {"gear", read_gear},  {"peg", read_peg},       {"hole_block", read_hole_block},
    {"box", read_box},    {"sphere", read_sphere}, {"ellipsoid", read_ellipsoid},
    {"prism", read_prism}};
const TomlReader::Keys kPartKeys = {"mesh",       "scale", "pieces", "gear",      "peg",
                                    "hole_block", "box",   "sphere", "ellipsoid", "prism"};

void read_mesh(const TomlReader& part, const SearchFolders& folders, Shape& shape) {
  namespace fs = std::filesystem;
  const std::string name = part.text("mesh");
  ImportOptions options;
  options.scale = part.number("scale", 1.0, kPositive);
  shape.given = part.choice("pieces", "auto", {"auto", "given"}) == "given";
  if (part.errors()) return;
  std::vector<std::string> tried;
  const auto try_file = [&](const fs::path& path) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) shape.file = path.string();
    tried.push_back(path.string());
    return !shape.file.empty();
  };
  if (fs::path(name).is_absolute()) {
    try_file(name);
  } else {
    for (const std::string& folder : folders)
      if (try_file(fs::path(folder) / name)) break;
  }
  if (shape.file.empty()) {
    part.fail("mesh", "cannot find the mesh \"" + name + "\"",
              tried.empty() ? "no folder to look in" : fmt::format("no file {}", fmt::join(tried, ", nor ")),
              "the file beside the scene file or in a folder named by TACTUM_DATA (colons between)");
    return;
  }
  Result<ImportedMesh> imported = import_mesh(shape.file, options);
  if (!imported) {
    part.fail("mesh", imported.error().message());
    return;
  }
  shape.mesh = std::move(*imported);
}

}  // namespace

Shape read_shape(const TomlReader& body, const SearchFolders& folders) {
  Shape shape;
  if (!body.has("part")) {
    body.fail(nullptr, "missing key \"part\" in " + body.section(), "none",
              "a table such as { box = {...} }");
    return shape;
  }
  const TomlReader part = body.table("part", kPartKeys);
  std::vector<std::string> kinds;
  if (part.has("mesh")) kinds.push_back("mesh");
  for (const MadeShape& made : kMadeShapes)
    if (part.has(made.kind)) kinds.push_back(made.kind);
  if (kinds.size() != 1) {
    body.fail("part", fmt::format("{} must have one shape", part.section()),
              kinds.empty() ? "none" : fmt::format("{}", fmt::join(kinds, " and ")),
              "one of mesh, gear, peg, hole_block, box, sphere, ellipsoid, prism");
    return shape;
  }
  if (part.has("mesh")) {
    read_mesh(part, folders, shape);
    return shape;
  }
  for (const char* key : {"scale", "pieces"})
    if (part.has(key)) part.fail(key, fmt::format("\"{}\" is for meshes only", key), kinds.front(), "mesh");
  for (const MadeShape& made : kMadeShapes) {
    if (!part.has(made.kind)) continue;
    Pieces pieces = made.read(part);
    if (pieces) {
      shape.pieces = std::move(*pieces);
    } else {
      part.fail(made.kind, pieces.error().what, pieces.error().found, pieces.error().expected);
    }
  }
  return shape;
}

}  // namespace tactum
