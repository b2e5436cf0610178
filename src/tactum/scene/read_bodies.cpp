#include <fmt/format.h>

#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

constexpr double kWaterDensity = 1000.0;  // of a part whose file says nothing [kg/m^3]

Joint read_joint(const TomlReader& body, const Pose& X_WP) {
  Joint joint;
  if (!body.has("joint")) return joint;
  const TomlReader table = body.table("joint", {"kind", "axis", "anchor_m", "damping_Nms", "friction_Nm"});
  const std::string kind = table.choice("kind", {}, {"free", "fixed", "hinge"});
  if (kind != "hinge") {
    for (const char* key : {"axis", "anchor_m", "damping_Nms", "friction_Nm"})
      if (table.has(key))
        table.fail(key, fmt::format("\"{}\" in {} is for hinges only", key, table.section()), kind, "hinge");
    joint.kind = kind == "fixed" ? JointKind::kFixed : JointKind::kFree;
    return joint;
  }
  joint.kind = JointKind::kHinge;
  joint.axis_W = X_WP.R * table.unit_vector3("axis");
  joint.anchor_W = X_WP * table.vector3("anchor_m", Vec3::Zero());
  joint.damping_Nms = table.number("damping_Nms", 0.0, kNotNegative);
  joint.friction_Nm = table.number("friction_Nm", 0.0, kNotNegative);
  return joint;
}

/// The part, its mass and the body's place, from the shape and either a mass or a density.
void read_solid(const TomlReader& reader, const Shape& shape, const Pose& X_WP, Body& body, Vec3& p_BP) {
  const bool weighed = reader.has("mass_kg");
  if (weighed && reader.has("density_kg_per_m3")) {
    reader.fail("mass_kg", "two masses in " + reader.section(), "mass_kg and density_kg_per_m3",
                "one of them");
    return;
  }
  const double density = reader.number("density_kg_per_m3", kWaterDensity, kPositive);
  const double mass = weighed ? reader.number("mass_kg", {}, kPositive) : 0.0;
  if (reader.errors()) return;
  const Result<Vec3> center = centre_of_mass(shape);
  if (!center) return reader.fail("part", center.error().message());
  Result<std::shared_ptr<const Part>> part = part_about(*center, shape, density);
  if (!part) return reader.fail("part", part.error().message());

  body.part = std::move(*part);
  const double factor = weighed ? mass / body.part->mass.mass : 1.0;
  body.mass_kg = factor * body.part->mass.mass;
  body.inertia_B = factor * body.part->mass.inertia;
  body.X_WB = {X_WP.R, X_WP * *center};
  p_BP = -*center;
}

void read_body(const TomlReader& reader, const SearchFolders& folders, Scene& scene) {
  Body body;
  body.name = reader.text("name");
  for (const Body& other : scene.world.bodies)
    if (other.name == body.name)
      reader.fail("name", "two bodies of one name", fmt::format("\"{}\"", body.name), "a name of its own");
  if (body.name.empty())
    reader.fail("name", "a body without a name in " + reader.section(), "\"\"", "a text");

  const Vec3 p_WP = reader.vector3("pos_m", Vec3::Zero());
  const Pose X_WP{reader.rotation(), p_WP};
  body.joint = read_joint(reader, X_WP);
  const Shape shape = read_shape(reader, folders);
  if (reader.errors()) return;
  Vec3 p_BP = Vec3::Zero();
  read_solid(reader, shape, X_WP, body, p_BP);
  if (reader.errors()) return;
  for (const std::string& remark : body.part->remarks)
    scene.remarks.push_back(fmt::format("{} ({}): {}", body.name, shape.file, remark));
  scene.p_BP.push_back(p_BP);
  scene.materials.push_back(reader.text("material", ""));
  scene.world.bodies.push_back(std::move(body));
}

}  // namespace

void read_bodies(const TomlReader& root, const SearchFolders& folders, Scene& scene) {
  const auto readers = root.tables("body", {"name", "part", "pos_m", "quat_wxyz", "rpy_deg", "mass_kg",
                                            "density_kg_per_m3", "joint", "material"});
  if (readers.empty()) root.fail(nullptr, "the scene has no [[body]]", "none", "at least one");
  for (const TomlReader& reader : readers) read_body(reader, folders, scene);
}

int body_called(const TomlReader& reader, const char* key, const World& world) {
  const std::string name = reader.text(key);
  std::vector<std::string> names;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    names.push_back(world.bodies[b].name);
    if (names.back() == name) return static_cast<int>(b);
  }
  const std::string nearest = nearest_word(name, names);
  reader.fail(key, fmt::format("no body of this name, in {}", reader.section()), fmt::format("\"{}\"", name),
              nearest.empty() ? "the name of a [[body]]" : fmt::format("\"{}\"", nearest));
  return -1;
}

}  // namespace tactum
