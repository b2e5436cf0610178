#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

const TomlReader::Keys kPartKeys = {"mesh",       "scale",  "pieces",    "gear",   "peg",
                                    "hole_block", "bolt",   "nut",       "socket", "hex_key",
                                    "box",        "sphere", "ellipsoid", "prism",  "slotted_plate"};

/// A file that `tactum prepare` wrote: in metres, and cut.
void read_prepared(const TomlReader& part, Shape& shape) {
  for (const char* key : {"scale", "pieces"}) {
    if (part.has(key))
      part.fail(key, fmt::format("\"{}\" is for meshes only", key), "a prepared part", "none of it");
  }
  Result<PartFile> file = load_part(shape.file);
  if (!file) return part.fail("mesh", file.error().message());
  shape.prepared = std::make_shared<const PartFile>(std::move(*file));
}

void read_mesh(const TomlReader& part, const SearchFolders& folders, Shape& shape) {
  const std::string name = part.text("mesh");
  ImportOptions options;
  options.scale = part.number("scale", 1.0, kPositive);
  const std::string pieces = part.choice("pieces", "auto", {"auto", "given", "solid", "surface"});
  shape.given = pieces == "given";
  shape.piece_source = pieces == "solid"     ? PieceSource::kSolid
                       : pieces == "surface" ? PieceSource::kSurface
                                             : PieceSource::kAuto;
  if (part.errors()) return;
  const Result<std::string> found = found_file(name, folders);
  if (!found)
    return part.fail("mesh", "cannot find the mesh \"" + name + "\"", found.error().found,
                     found.error().expected);
  shape.file = *found;
  if (is_part_file(shape.file)) return read_prepared(part, shape);
  Result<ImportedMesh> imported = import_mesh(shape.file, options);
  if (!imported) {
    part.fail("mesh", imported.error().message());
    return;
  }
  shape.mesh = std::move(*imported);
}

}  // namespace

Result<std::string> found_file(const std::string& name, const SearchFolders& folders) {
  namespace fs = std::filesystem;
  const SearchFolders only{""};
  std::vector<std::string> tried;
  for (const std::string& folder : fs::path(name).is_absolute() ? only : folders) {
    std::error_code ignored;
    tried.push_back((fs::path(folder) / name).string());
    if (fs::is_regular_file(tried.back(), ignored)) return tried.back();
  }
  return Error{"cannot find a file",
               tried.empty() ? "no folder to look in" : fmt::format("no file {}", fmt::join(tried, ", nor ")),
               "the file beside the scene file or in a folder named by TACTUM_DATA (colons between)", name};
}

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
  for (const std::string& made : made_shapes())
    if (part.has(made.c_str())) kinds.push_back(made);
  if (kinds.size() != 1) {
    body.fail("part", fmt::format("{} must have one shape", part.section()),
              kinds.empty() ? "none" : fmt::format("{}", fmt::join(kinds, " and ")),
              fmt::format("one of mesh, {}", fmt::join(made_shapes(), ", ")));
    return shape;
  }
  if (part.has("mesh")) {
    read_mesh(part, folders, shape);
    return shape;
  }
  for (const char* key : {"scale", "pieces"})
    if (part.has(key)) part.fail(key, fmt::format("\"{}\" is for meshes only", key), kinds.front(), "mesh");
  return read_made_shape(part, kinds.front());
}

}  // namespace tactum
