#include "tactum/import/mjcf_shapes.h"

#include <fmt/format.h>

#include <filesystem>

#include "tactum/import/mesh_paths.h"

namespace tactum::inline v0_1 {
namespace {

enum Geom { kPlane, kHfield, kSphere, kCapsule, kEllipsoid, kCylinder, kBox, kMesh };
const std::vector<std::string> kGeomWords{"plane",     "hfield",   "sphere", "capsule",
                                          "ellipsoid", "cylinder", "box",    "mesh"};

/// Half sizes as MJCF has them, and how many of them the kind needs.
struct GeomSize {
  std::vector<double> half = {0.0, 0.0, 0.0};
  std::size_t needed = 1;
};

/// From one end to the other: the pose and the half length of the geom.
void set_ends(const Attributes& of, int kind, GeomSize& size, ModelShape& shape) {
  const std::vector<double> ends = of.numbers("fromto", 6, 6);
  if (ends.empty()) return;
  const Vec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
  const double half = 0.5 * (from - to).norm();
  if (!(half > 0.0 && std::isfinite(half)) || kind == kPlane || kind == kSphere || kind == kMesh)
    return of.fail("fromto", "no length from one end to the other",
                   kGeomWords[static_cast<std::size_t>(kind)],
                   "two ends of a capsule, cylinder, ellipsoid or box");
  shape.X_LS = {rotation_to(from - to), 0.5 * (from + to)};
  const bool flat = kind == kBox || kind == kEllipsoid;
  size.half = flat ? std::vector{size.half[0], size.half[0], half} : std::vector{size.half[0], half, 0.0};
}

/// Sizes of the scene from half sizes.
void set_size(const Attributes& of, int kind, const GeomSize& size, ModelShape& shape) {
  const Vec3 half(size.half[0], size.half[1], size.half[2]);
  for (std::size_t i = 0; i < size.needed; ++i)
    if (!(size.half[i] > 0.0))
      return of.fail("size", "a geom without a size", kGeomWords[static_cast<std::size_t>(kind)],
                     fmt::format("{} numbers above 0", size.needed));
  switch (kind) {
    case kPlane:
      shape.kind = ModelShapeKind::kPlane;
      shape.size = 2.0 * half.cwiseMax(0.0);
      break;
    case kBox:
      shape.kind = ModelShapeKind::kBox;
      shape.size = 2.0 * half;
      break;
    case kEllipsoid:
      shape.kind = ModelShapeKind::kEllipsoid;
      shape.size = half;
      break;
    case kSphere:
      shape.kind = ModelShapeKind::kBall;
      shape.size = half;
      break;
    default:
      shape.kind = kind == kCapsule ? ModelShapeKind::kCapsule : ModelShapeKind::kCylinder;
      shape.size = {half.x(), 2.0 * half.y(), 0.0};
  }
}

void set_contact(const Attributes& of, ModelShape& shape) {
  const double type = of.number("contype", 1.0), affinity = of.number("conaffinity", 1.0);
  shape.felt = type != 0.0 || affinity != 0.0;
  const auto usual = [](double bits) { return bits == 0.0 || bits == 1.0; };
  if (shape.felt && !(usual(type) && usual(affinity)))
    of.log().note(of.element(),
                  "bits of contype and conaffinity beyond 1 are not honoured: it touches everything");
  std::vector<double> friction{1.0, 0.0, 0.0};
  of.overlay("friction", friction);
  shape.friction = friction[0];
  if (!(friction[0] >= 0.0))
    of.fail("friction", "a friction below 0", fmt::format("{}", friction[0]), "0 or more");
  if (friction[1] != 0.0 || friction[2] != 0.0)
    of.log().note(of.element(), "torsional and rolling friction are not honoured");
}

void set_weight(const Attributes& of, const MjcfCompiler& compiler, ModelShape& shape) {
  const double group = of.number("group", 0.0);
  shape.weighs =
      group >= compiler.least_group && group <= compiler.most_group && shape.kind != ModelShapeKind::kPlane;
  if (of.has("mass")) shape.mass_kg = of.number("mass", 0.0, kNotNegative);
  shape.density_kg_per_m3 = of.number("density", 1000.0, kNotNegative);
}

}  // namespace

MjcfMeshes::MjcfMeshes(const XmlElement& mujoco, const std::string& folder, const MjcfCompiler& compiler,
                       const MjcfDefaults& defaults, ImportLog& log) {
  for (const XmlElement* asset : mujoco.all("asset"))
    for (const XmlElement* mesh : asset->all("mesh")) {
      if (log.errors()) return;
      add(defaults.of(*mesh, "", log), folder, compiler);
    }
}

void MjcfMeshes::add(const Attributes& of, const std::string& folder, const MjcfCompiler& compiler) {
  namespace fs = std::filesystem;
  const fs::path file(of.text("file"));
  if (file.empty()) return of.fail("file", "a mesh that is not in a file", "", "file=\"NAME.stl\" or .obj");
  const std::string name = of.text("name", file.stem().string());
  const std::string inside =
      (fs::path(compiler.mesh_folder) / (compiler.strips_paths ? file.filename() : file)).string();
  const std::optional<std::string> path = find_mesh_file(inside, folder);
  if (!path)
    return of.fail("file", "the mesh is not there", fmt::format("\"{}\"", inside),
                   places_of_meshes(inside, folder));
  Asset asset{.path = *path, .scale = of.vector("scale", Vec3::Ones()), .X_GF = {}};
  if (asset.scale.cwiseAbs().minCoeff() == 0.0) of.fail("scale", "a scale of zero", "0", "any other numbers");
  const std::vector<double> quat = of.numbers("refquat", 4, 4);
  if (!quat.empty()) {
    const Quat q(quat[0], quat[1], quat[2], quat[3]);
    if (!(q.norm() > 0.0))
      return of.fail("refquat", "an orientation of length 0", "", "numbers that are not all 0");
    asset.X_GF.R = q.normalized().toRotationMatrix().transpose();
    const bool even = asset.scale.x() == asset.scale.y() && asset.scale.y() == asset.scale.z();
    if (!even && !asset.X_GF.R.isIdentity(0.0))
      return of.fail("refquat", "a mesh that is turned before each axis is scaled by its own number", "",
                     "one scale");
  }
  asset.X_GF.p = -(asset.X_GF.R * of.vector("refpos", Vec3::Zero())).cwiseProduct(asset.scale);
  if (!assets_.emplace(name, std::move(asset)).second)
    of.fail("name", "two meshes of one name", fmt::format("\"{}\"", name), "a name of its own");
}

bool MjcfMeshes::place(const std::string& name, ModelShape& shape) const {
  const auto found = assets_.find(name);
  if (found == assets_.end()) return false;
  shape.kind = ModelShapeKind::kMesh;
  shape.mesh = found->second.path;
  shape.size = found->second.scale;
  shape.X_LS = shape.X_LS * found->second.X_GF;
  return true;
}

std::vector<std::string> MjcfMeshes::names() const {
  std::vector<std::string> names;
  for (const auto& [name, unused] : assets_) names.push_back(name);
  return names;
}

std::optional<ModelShape> read_geom(const Attributes& of, const MjcfCompiler& compiler,
                                    const MjcfMeshes& meshes) {
  ModelShape shape;
  shape.at = &of.element();
  shape.name = of.text("name");
  const int kind = of.word("type", kSphere, kGeomWords);
  shape.X_LS = {rotation_of(of, compiler), of.vector("pos", Vec3::Zero())};
  if (kind == kHfield) {
    of.log().note(of.element(), "a height field is not felt");
    return std::nullopt;
  }
  if (kind == kMesh) {
    const std::string name = of.text("mesh");
    if (!meshes.place(name, shape))
      of.fail("mesh", "no mesh of this name", fmt::format("\"{}\"", name),
              one_of_meant(name, meshes.names()));
  } else {
    if (of.has("mesh"))
      of.fail("mesh", "a shape that is fitted to a mesh", kGeomWords[static_cast<std::size_t>(kind)],
              "type=\"mesh\", or a size");
    GeomSize size;
    constexpr std::size_t kNeeded[] = {0, 0, 1, 2, 3, 2, 3, 0};
    size.needed = kNeeded[kind];
    of.overlay("size", size.half);
    set_ends(of, kind, size, shape);
    set_size(of, kind, size, shape);
  }
  set_contact(of, shape);
  set_weight(of, compiler, shape);
  return shape;
}

}  // namespace tactum::inline v0_1
