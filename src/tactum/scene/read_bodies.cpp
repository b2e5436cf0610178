#include <fmt/format.h>

#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

constexpr int kMostFieldPoints = 10'000;  // of a body
constexpr double kWaterDensity = 1000.0;  // of a part whose file says nothing [kg/m^3]

/// The keys of a joint and for which kinds they are.
struct JointKey {
  const char* name;
  const char* kinds;
};
constexpr JointKey kJointKeys[] = {
    {"axis", "hinge, slider"},
    {"anchor_m", "hinge, ball"},
    {"damping_Nms", "hinge, ball"},
    {"damping_Ns_per_m", "slider"},
    {"friction_Nm", "hinge"},
    {"friction_N", "slider"},
    {"stiffness_Nm_per_rad", "hinge"},
    {"stiffness_N_per_m", "slider"},
    {"rest_deg", "hinge"},
    {"rest_m", "slider"},
    {"limits_deg", "hinge"},
    {"limits_m", "slider"},
    {"swing_deg", "ball"},
};

bool is_for(const JointKey& key, const std::string& kind) {
  return std::string_view(key.kinds).find(kind) != std::string_view::npos;
}

/// What a joint does to its motion, where `turns` tells torques and angles from forces and ways.
void read_joint_action(const TomlReader& table, bool turns, Joint& joint) {
  const double unit = turns ? radians(1.0) : 1.0;
  joint.damping = table.number(turns ? "damping_Nms" : "damping_Ns_per_m", 0.0, kNotNegative);
  if (joint.kind == JointKind::kBall) {
    joint.upper = table.has("swing_deg") ? radians(table.number("swing_deg", {}, {0.0, 180.0})) : joint.upper;
    return;
  }
  joint.friction = table.number(turns ? "friction_Nm" : "friction_N", 0.0, kNotNegative);
  joint.stiffness = table.number(turns ? "stiffness_Nm_per_rad" : "stiffness_N_per_m", 0.0, kNotNegative);
  joint.rest = unit * table.number(turns ? "rest_deg" : "rest_m", 0.0);
  const char* const limits = turns ? "limits_deg" : "limits_m";
  if (!table.has(limits)) return;
  const std::vector<double> ends = table.numbers(limits, 2);
  if (table.errors()) return;
  joint.lower = unit * ends[0];
  joint.upper = unit * ends[1];
  if (!(joint.lower <= 0.0 && joint.upper >= 0.0 && joint.lower < joint.upper))
    table.fail(limits, "the limits do not hold the joint as it stands, at 0",
               fmt::format("{} to {}", ends[0], ends[1]), "a negative and a positive one, or 0");
}

Joint read_joint(const TomlReader& body, const Pose& X_WP) {
  Joint joint;
  if (!body.has("joint")) return joint;
  const TomlReader table =
      body.table("joint", {"kind", "axis", "anchor_m", "damping_Nms", "damping_Ns_per_m", "friction_Nm",
                           "friction_N", "stiffness_Nm_per_rad", "stiffness_N_per_m", "rest_deg", "rest_m",
                           "limits_deg", "limits_m", "swing_deg"});
  const std::string kind = table.choice("kind", {}, {"free", "fixed", "hinge", "slider", "ball"});
  for (const JointKey& key : kJointKeys)
    if (table.has(key.name) && !is_for(key, kind))
      table.fail(key.name,
                 fmt::format("\"{}\" in {} is not for this kind of joint", key.name, table.section()), kind,
                 key.kinds);
  if (table.errors()) return joint;
  joint.kind = kind == "fixed"    ? JointKind::kFixed
               : kind == "hinge"  ? JointKind::kHinge
               : kind == "slider" ? JointKind::kSlider
               : kind == "ball"   ? JointKind::kBall
                                  : JointKind::kFree;
  if (joint.kind == JointKind::kFree || joint.kind == JointKind::kFixed) return joint;
  if (joint.kind != JointKind::kBall) joint.axis_W = X_WP.R * table.unit_vector3("axis");
  if (joint.kind != JointKind::kSlider) joint.anchor_W = X_WP * table.vector3("anchor_m", Vec3::Zero());
  read_joint_action(table, joint.kind != JointKind::kSlider, joint);
  return joint;
}

/// The part and either a mass or a density.
void read_solid(const TomlReader& reader, const Shape& shape, BodySpec& spec) {
  const bool weighed = reader.has("mass_kg");
  if (weighed && reader.has("density_kg_per_m3")) {
    reader.fail("mass_kg", "two masses in " + reader.section(), "mass_kg and density_kg_per_m3",
                "one of them");
    return;
  }
  const double density = reader.number("density_kg_per_m3", kWaterDensity, kPositive);
  const double mass = weighed ? reader.number("mass_kg", {}, kPositive) : 0.0;
  if (reader.errors()) return;
  Result<std::shared_ptr<const Part>> part = part_of(shape, density);
  if (!part) return reader.fail("part", part.error().message());
  spec.part = std::move(*part);
  if (weighed) spec.mass_kg = mass;
}

/// Where force fields act: so many points over the surface, or each told by itself.
void read_field_points(const TomlReader& reader, const Vec3& p_BP, BodySpec& spec) {
  const auto points = reader.tables("field_point", {"pos_m", "weight"});
  for (const TomlReader& point : points)
    spec.field_points.push_back(
        {p_BP + point.vector3("pos_m"), point.number("weight", 1.0 / static_cast<double>(points.size()))});
  if (!reader.has("field_points")) return;
  const int count = reader.integer("field_points", {}, 1, kMostFieldPoints);
  if (!points.empty())
    return reader.fail("field_points", "two sets of sample points in " + reader.section(),
                       "field_points and field_point", "one of them");
  if (!reader.errors()) spec.field_points = spread_over(spec.part->surface, count);
}

void read_body(const TomlReader& reader, const SearchFolders& folders, Scene& scene) {
  BodySpec spec;
  spec.name = reader.text("name");
  for (const Body& other : scene.world.bodies)
    if (other.name == spec.name)
      reader.fail("name", "two bodies of one name", fmt::format("\"{}\"", spec.name), "a name of its own");
  if (spec.name.empty())
    reader.fail("name", "a body without a name in " + reader.section(), "\"\"", "a text");

  // Told in the world, or in the frame of the part it stands on.
  spec.X_WP = {reader.rotation(), reader.vector3("pos_m", Vec3::Zero())};
  if (reader.has("on")) {
    const int on = body_called(reader, "on", scene.world);
    if (on < 0) return;
    const Body& below = scene.world.bodies[static_cast<std::size_t>(on)];
    spec.X_WP = part_pose(below, below.X_WB) * spec.X_WP;
  }
  spec.joint = read_joint(reader, spec.X_WP);
  spec.material = reader.text("material", "");
  const Shape shape =
      reader.has("component") ? read_components(reader, folders) : read_shape(reader, folders);
  if (reader.errors()) return;
  read_solid(reader, shape, spec);
  if (reader.errors()) return;
  read_field_points(reader, -spec.part->origin, spec);
  if (reader.errors()) return;
  for (const std::string& remark : spec.part->notes.remarks)
    scene.remarks.push_back(fmt::format("{} ({}): {}", spec.name, shape.file, remark));
  if (const Result<int> added = scene.world.add(spec); !added)
    reader.fail(nullptr, added.error().what, added.error().found, added.error().expected);
}

}  // namespace

void read_bodies(const TomlReader& root, const SearchFolders& folders, Scene& scene) {
  const auto readers =
      root.tables("body", {"name", "part", "pos_m", "quat_wxyz", "rpy_deg", "mass_kg", "density_kg_per_m3",
                           "joint", "material", "on", "component", "field_points", "field_point"});
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
