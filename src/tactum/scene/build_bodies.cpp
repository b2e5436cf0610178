#include <fmt/format.h>

#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kWaterDensity = 1000.0;  // of a part whose description gives none [kg/m^3]

void set_limits(const std::optional<Interval>& limits, Joint& joint) {
  if (!limits) return;
  joint.lower = limits->lower;
  joint.upper = limits->upper;
}

/// Joints in the world, from those in the part's frame P.
class JointMaker {
 public:
  explicit JointMaker(const Pose& X_WP) : X_WP_(X_WP) {}

  Joint operator()(const FreeJoint&) const { return {}; }
  Joint operator()(const FixedJoint&) const {
    Joint made;
    made.kind = JointKind::kFixed;
    return made;
  }
  Joint operator()(const HingeJoint& joint) const {
    Joint made;
    made.kind = JointKind::kHinge;
    made.axis_W = X_WP_.R * (joint.axis / joint.axis.norm());
    made.anchor_W = X_WP_ * joint.anchor_m;
    made.damping = joint.damping_Nms;
    made.friction = joint.friction_Nm;
    made.stiffness = joint.stiffness_Nm_per_rad;
    made.rest = joint.rest_rad;
    set_limits(joint.limits_rad, made);
    return made;
  }
  Joint operator()(const SliderJoint& joint) const {
    Joint made;
    made.kind = JointKind::kSlider;
    made.axis_W = X_WP_.R * (joint.axis / joint.axis.norm());
    made.damping = joint.damping_Ns_per_m;
    made.friction = joint.friction_N;
    made.stiffness = joint.stiffness_N_per_m;
    made.rest = joint.rest_m;
    set_limits(joint.limits_m, made);
    return made;
  }
  Joint operator()(const BallJoint& joint) const {
    Joint made;
    made.kind = JointKind::kBall;
    made.anchor_W = X_WP_ * joint.anchor_m;
    made.damping = joint.damping_Nms;
    if (joint.swing_rad) made.upper = *joint.swing_rad;
    return made;
  }

 private:
  const Pose& X_WP_;
};

/// The points where force fields act: a number of them spread over the surface, or each by itself.
std::vector<FieldPoint> field_points(const BodyDescription& body, const Part& part) {
  if (body.field_points.count) return spread_over(part.surface, *body.field_points.count);
  std::vector<FieldPoint> points;
  const double share = 1.0 / static_cast<double>(body.field_points.listed.size());
  for (const SamplePoint& point : body.field_points.listed)
    points.push_back({point.pos_m - part.origin, point.weight.value_or(share)});
  return points;
}

/// The first key that only a body that moves may have; null when there is none.
const char* key_of_moving_body(const BodyDescription& body) {
  if (!body.V_WB.v.isZero(0.0)) return "velocity_m_per_s";
  if (!body.V_WB.w.isZero(0.0)) return "angular_velocity_rad_per_s";
  if (!body.load.constant.f.isZero(0.0)) return "force_N";
  if (!body.load.constant.t.isZero(0.0)) return "torque_Nm";
  if (body.load.damping_Ns_per_m != 0.0) return "damping_Ns_per_m";
  if (body.load.damping_Nms_per_rad != 0.0) return "angular_damping_Nms_per_rad";
  return nullptr;
}

/// Checks names, velocity and load.
void check_body(SceneBuilder& builder, const std::string& path, const BodyDescription& body,
                const World& world) {
  for (const Body& other : world.bodies)
    if (other.name == body.name)
      builder.fail(item_path(path, "name"), "two bodies of one name", fmt::format("\"{}\"", body.name),
                   "a name of its own");
  const char* const moving = key_of_moving_body(body);
  if (moving != nullptr && std::holds_alternative<FixedJoint>(body.joint) &&
      parent_of(body.joint).parent.empty())
    builder.fail(item_path(path, moving),
                 body.V_WB.v.isZero(0.0) && body.V_WB.w.isZero(0.0) ? "a fixed body has a load"
                                                                    : "a fixed body has a velocity",
                 fmt::format("\"{}\"", body.name), "a body that moves");
}

/// The body that another one is placed on, by its index; -1 and the error where there is none before it.
int body_below(SceneBuilder& builder, const std::string& path, const BodyDescription& body,
               const World& world) {
  std::vector<Placement> placements;
  for (const BodyDescription& other : builder.description().bodies)
    placements.push_back({other.name, other.on});
  const std::string item = item_path(path, "on");
  if (const auto fault = order_error(placements, world.bodies.size(), "body")) {
    builder.fail(item, *fault);
    return -1;
  }
  return builder.find_body(item, body.on, world);
}

void build_body(SceneBuilder& builder, const std::string& path, const BodyDescription& body, Scene& scene) {
  BodySpec spec;
  spec.name = body.name;
  check_body(builder, path, body, scene.world);
  // Described in the world, or in the frame of the part it is placed on.
  spec.X_WP = body.X_OP;
  if (!body.on.empty()) {
    const int on = body_below(builder, path, body, scene.world);
    if (on < 0) return;
    const Body& below = scene.world.bodies[static_cast<std::size_t>(on)];
    spec.X_WP = part_pose(below, below.X_WB) * spec.X_WP;
  }
  spec.V_WB = body.V_WB;
  if (parent_of(body.joint).parent.empty()) spec.joint = std::visit(JointMaker(spec.X_WP), body.joint);
  spec.load = body.load;
  spec.material = body.material;
  const std::string item = item_path(path, "part");
  const Shape shape =
      body.part ? build_shape(builder, item, *body.part) : build_components(builder, path, body);
  if (builder.errors()) return;
  Result<std::shared_ptr<const Part>> part = part_of(shape, body.density_kg_per_m3.value_or(kWaterDensity),
                                                     body.mass.inertial ? &*body.mass.inertial : nullptr);
  if (!part) return builder.fail(item, part.error().message());
  spec.part = std::move(*part);
  spec.mass_kg = body.mass.mass_kg;
  spec.field_points = field_points(body, *spec.part);
  for (const std::string& remark : spec.part->notes.remarks)
    scene.remarks.push_back(fmt::format("{} ({}): {}", spec.name, shape.file, remark));
  if (const Result<int> added = scene.world.add(spec); !added) builder.fail(path, added.error());
}

/// Joins a body to its parent, which may stand before or behind it.
void build_pair_joint(SceneBuilder& builder, const std::string& path, const BodyDescription& body,
                      World& world) {
  const JointParent to = parent_of(body.joint);
  if (to.parent.empty()) return;
  const std::string item = item_path(item_path(path, "joint"), "parent");
  const int number = builder.find_body(item, body.name, world);
  const int parent = builder.find_body(item, to.parent, world);
  if (number < 0 || parent < 0) return;
  const Body& what = world.bodies[static_cast<std::size_t>(number)];
  const Joint joint = std::visit(JointMaker(part_pose(what, what.X_WB)), body.joint);
  if (const Result<void> joined = world.join(number, parent, joint, to.contact); !joined)
    builder.fail(item, joined.error());
}

}  // namespace

void build_bodies(SceneBuilder& builder, Scene& scene) {
  std::size_t index = 0;
  for (const BodyDescription& body : builder.description().bodies)
    build_body(builder, item_path("", "body", index++), body, scene);
  if (builder.errors()) return;
  index = 0;
  for (const BodyDescription& body : builder.description().bodies)
    build_pair_joint(builder, item_path("", "body", index++), body, scene.world);
}

}  // namespace tactum::inline v0_1
