#include "scene_of_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "commands.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;

/// A mesh with its unit, and the box around it.
struct SizedMesh {
  std::string path;
  double scale = 1.0;     ///< metres per unit [m]
  bool prepared = false;  ///< in metres; the key `scale` is not for it
  Aabb box;               ///< in the frame of the file [m]
};

std::string lower_ending(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

/// The path of a file as a scene in `folder` names it.
std::string named_from(const std::string& folder, const std::string& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return (folder.empty() ? whole : whole.lexically_proximate(fs::path(folder).lexically_normal())).string();
}

SizedMesh sized_mesh(const std::string& path, std::vector<std::string>& sentences) {
  SizedMesh mesh{path, 1.0, is_part_file(path), {}};
  if (mesh.prepared) {
    const Result<PartFile> file = load_part(path);
    if (!file) fail(file.error());
    for (const Vec3& vertex : file->part.surface.vertices) mesh.box.extend(vertex + file->origin);
    return mesh;
  }
  const Result<ImportedMesh> imported = import_mesh(path);
  if (!imported) fail(imported.error());
  const Aabb in_units = bounds(imported->mesh.vertices);
  const UnitGuess unit = unit_of(imported->report, in_units);
  mesh.scale = unit.metres_per_unit;
  mesh.box = {in_units.min * mesh.scale, in_units.max * mesh.scale};
  sentences.push_back(fmt::format("{}: taken to be in {}. {}", path, unit.name, unit.reason));
  return mesh;
}

/// A text as TOML has it, in double quotes.
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

std::string vector_text(const Vec3& v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x(), v.y(), v.z());
}

std::string body_text(const std::string& name, const std::string& folder, const SizedMesh& mesh,
                      const Vec3& p_W, bool fixed) {
  return fmt::format("\n[[body]]\nname = {}\npart = {{ mesh = {}{} }}\npos_m = {}\n{}", quoted(name),
                     quoted(named_from(folder, mesh.path)),
                     mesh.prepared ? "" : fmt::format(", scale = {}", mesh.scale), vector_text(p_W),
                     fixed ? "joint = { kind = \"fixed\" }\n" : "");
}

/// A fixed plate under z = 0, twice as wide as the mesh and a tenth as thick.
std::string plate_text(const SizedMesh& mesh) {
  const Vec3 size = mesh.box.max - mesh.box.min;
  const double width = 2.0 * std::max(size.x(), size.y());
  const double thickness = 0.1 * width;
  return fmt::format(
      "\n[[body]]\nname = \"plate\"\npart = {{ box = {{ size_m = {} }} }}\npos_m = {}\njoint = {{ kind = "
      "\"fixed\" "
      "}}\n",
      vector_text({width, width, thickness}), vector_text({0.0, 0.0, -0.5 * thickness}));
}

}  // namespace

bool is_mesh_name(const std::string& name) {
  constexpr std::array kEndings{".stl", ".obj", ".ply", ".off", ".gltf", ".glb", ".dae", ".tactum"};
  return std::find(kEndings.begin(), kEndings.end(), lower_ending(name)) != kEndings.end();
}

MeshScene scene_of_meshes(const std::vector<std::string>& meshes, const std::string& folder) {
  constexpr double kUsualSize_m = 0.1;  // a scene of this size needs no scale of the workspace
  constexpr double kPress_m = 0.003;    // how far beyond the contact the hand is led
  MeshScene scene;
  const SizedMesh moving = sized_mesh(meshes.back(), scene.sentences);
  const Vec3 size = moving.box.max - moving.box.min;
  const double scale = std::max(1.0, size.maxCoeff() / kUsualSize_m);
  const double gap = std::min(0.25 * size.maxCoeff(), 0.02 * scale);
  const std::string name = fs::path(moving.path).stem().string();
  // The middle of the moving mesh stands over the origin, or over the middle of the other one.
  const Vec3 middle = moving.box.center();
  Vec3 p_W(-middle.x(), -middle.y(), gap - moving.box.min.z());
  std::string below = "a plate", bodies;
  if (meshes.size() == 1) {
    bodies = plate_text(moving) + body_text(name == "plate" ? "part" : name, folder, moving, p_W, false);
  } else {
    const SizedMesh fixed = sized_mesh(meshes.front(), scene.sentences);
    below = fs::path(fixed.path).stem().string();
    const Vec3 centre = fixed.box.center();
    p_W += Vec3(centre.x(), centre.y(), fixed.box.max.z());
    bodies = body_text(below == name ? below + " (fixed)" : below, folder, fixed, Vec3::Zero(), true) +
             body_text(name, folder, moving, p_W, false);
  }
  const std::string moving_name = meshes.size() == 1 && name == "plate" ? "part" : name;
  const double down = gap + kPress_m * scale;
  scene.toml = fmt::format("schema = 1\ndescription = {}\n{}", quoted(name + " over " + below), bodies);
  scene.toml += fmt::format("\n[workspace]\nscale = {:.6g}\n\n[tool]\nbody = {}\ngrasp = \"centre\"\n", scale,
                            quoted(moving_name));
  scene.toml += fmt::format(
      "\n[hand]\ngrip = \"medium\"\n\n[[hand.step]]\noffset_m = {}\nduration_s = "
      "1.5\n\n[[hand.step]]\nhold_s = "
      "0.5\n",
      vector_text({0.0, 0.0, -down}));
  return scene;
}

}  // namespace tactum
