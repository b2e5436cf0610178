#include "viewer/server/scene_message.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactum/drivers/registry.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/loop/safety.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/version.h"
#include "viewer/server/access.h"
#include "viewer/server/field_arrows.h"
#include "viewer/server/shape_edges.h"
#include "viewer/server/wire.h"

namespace tactum {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

OrderedJson pose_json(const Pose& X) {
  const Quat q(X.R);
  return {{"p", vector_json(X.p)}, {"q", {q.w(), q.x(), q.y(), q.z()}}};
}

/// The parts in use, each once, and which of them each body has.
struct Shapes {
  std::vector<const Part*> parts;
  std::vector<int> of_body;
};
Shapes shapes_of(const World& world) {
  Shapes shapes;
  for (const Body& body : world.bodies) {
    std::size_t i = 0;
    while (i < shapes.parts.size() && shapes.parts[i] != body.part.get()) ++i;
    if (i == shapes.parts.size()) shapes.parts.push_back(body.part.get());
    shapes.of_body.push_back(static_cast<int>(i));
  }
  return shapes;
}

const char* joint_name(JointKind kind) {
  switch (kind) {
    case JointKind::kFree:
      return "free";
    case JointKind::kFixed:
      return "fixed";
    case JointKind::kHinge:
      return "hinge";
    case JointKind::kSlider:
      return "slider";
    case JointKind::kBall:
      return "ball";
  }
  return "";
}

/// Whether the joint pushes beside leading the body: by spring, damper, friction or a stop.
bool acts(const Joint& joint) {
  return joint.stiffness > 0.0 || joint.damping > 0.0 || joint.friction > 0.0 || joint.limited();
}

OrderedJson bodies_json(const World& world) {
  const Shapes shapes = shapes_of(world);
  OrderedJson bodies = OrderedJson::array();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    OrderedJson json = {{"name", body.name},
                        {"shape", shapes.of_body[i]},
                        {"moves", body.moves()},
                        {"joint", joint_name(world.joint_of(static_cast<int>(i)).kind)},
                        {"pieces", body.part->pieces.size()},
                        {"mass_kg", body.mass_kg},
                        {"weight_N", body.moves() ? body.mass_kg * world.gravity_W.norm() : 0.0},
                        {"joint_acts", acts(world.joint_of(static_cast<int>(i)))},
                        {"load_acts", body.load.acts()},
                        {"radius_m", body.part->radius},
                        {"X_WB", pose_json(body.X_WB)}};
    if (body.joint.kind == JointKind::kHinge) {
      json["axis_W"] = vector_json(body.joint.axis_W);
      json["anchor_W"] = vector_json(body.joint.anchor_W);
    }
    bodies.push_back(json);
  }
  return bodies;
}

/// Place and force of every arrow, one after the other; as floats, which are shorter.
OrderedJson field_json(const World& world) {
  OrderedJson numbers = OrderedJson::array();
  for (const FieldArrow& arrow : field_arrows(world))
    for (const Vec3& v : {arrow.p_W, arrow.force})
      for (int i = 0; i < 3; ++i) numbers.push_back(static_cast<float>(v[i]));
  return numbers;
}

/// Null: no limit.
OrderedJson value_json(const SettingInfo& setting, const UserSettings& settings) {
  const double value = setting.get(settings.frame, settings.safety);
  return std::isfinite(value) ? OrderedJson(value) : OrderedJson();
}

OrderedJson settings_json(const ShownSettings& shown) {
  OrderedJson settings = OrderedJson::array();
  for (const SettingInfo& setting : setting_table()) {
    constexpr const char* kKinds[] = {"number", "integer", "on-off", "choice"};  // as in SettingKind
    const char* kind = kKinds[static_cast<std::size_t>(setting.kind)];
    OrderedJson choices = OrderedJson::array();
    for (const char* choice : setting.choices) choices.push_back(choice);
    settings.push_back({{"section", setting.section},
                        {"key", setting.key},
                        {"name", setting.name},
                        {"unit", setting.unit},
                        {"meaning", setting.meaning},
                        {"low", setting.low},
                        {"high", setting.high},
                        {"kind", kind},
                        {"choices", choices},
                        {"live", setting.live},
                        {"unlimited", may_be_unlimited(setting)},
                        {"usual", value_json(setting, shown.usual)},
                        {"value", value_json(setting, shown.now)}});
  }
  return settings;
}

bool can_be_led(const ShownScene& scene, std::size_t hand) {
  return hand < scene.led.size() && scene.led[hand];
}

/// The hands after the first: which body each grasps, and whether pages may lead it.
OrderedJson other_hands_json(const ShownScene& scene) {
  OrderedJson hands = OrderedJson::array();
  for (std::size_t h = 1; h < scene.settings.hands(); ++h)
    hands.push_back({{"grasped", scene.settings.hand(h).tool.body}, {"can_be_led", can_be_led(scene, h)}});
  return hands;
}

OrderedJson device_json(const ShownScene& scene, const RunFacts& facts) {
  const DeviceInfo& info = scene.device;
  OrderedJson choices = OrderedJson::array();
  for (const SimulatedDeviceModel& model : simulated_device_presets())
    choices.push_back({{"name", "pointer:" + model.name}, {"label", model.name + " (simulated)"}});
  return {{"name", facts.device},
          {"label", info.name},
          {"can_be_led", can_be_led(scene, 0)},
          {"senses_rotation", info.senses_rotation},
          {"actuates_force", info.actuates_force},
          {"actuates_torque", info.actuates_torque},
          {"max_force_N", info.max_force_N},
          {"max_torque_Nm", info.max_torque_Nm},
          {"max_stiffness_N_per_m", info.max_stiffness_N_per_m},
          {"workspace_radius_m", info.workspace_radius_m},
          {"grip", facts.grip},
          {"grips", {"loose", "medium", "firm"}},
          {"choices", choices}};
}

OrderedJson stages_json() {
  OrderedJson stages = OrderedJson::array();
  for (const WrenchStage& stage : wrench_stages())
    stages.push_back({{"key", stage.key}, {"name", stage.name}, {"meaning", stage.meaning}});
  return stages;
}

/// The channels behind the wrench stages, as ChartSample has them.
OrderedJson channels_json() {
  OrderedJson list = OrderedJson::array();
  const auto add = [&list](const std::string& key, const std::string& name, const char* unit,
                           const char* group, const char* meaning) {
    list.push_back({{"key", key}, {"name", name}, {"unit", unit}, {"group", group}, {"meaning", meaning}});
  };
  for (const Channel& channel : channels())
    add(channel.key, channel.name, channel.unit, channel.group, channel.meaning);
  for (int i = 0; i < kStageCount; ++i) {
    std::string key = stage_name(static_cast<Stage>(i));
    const std::string name = "Stage: " + key;
    for (char& letter : key) letter = letter == ' ' ? '_' : letter;
    add("stage_" + key + "_s", name, "s", "stages", "time of this stage of the frame");
  }
  add("frame_time_s", "Frame", "s", "frame", "time of the whole frame");
  add("wakeup_latency_s", "Wake-up", "s", "frame", "how late the frame began");
  return list;
}

OrderedJson flags_json() {
  OrderedJson safety = OrderedJson::array();
  for (unsigned bit = 0; bit < 24; ++bit)
    if (const std::string name = safety_flag_names(1u << bit); !name.empty())
      safety.push_back(
          {{"flag", 1u << bit}, {"name", name}, {"fault", (safety_flag::kFaults >> bit & 1u) != 0}});
  OrderedJson frame = OrderedJson::array();
  for (const FlagName& flag : frame_flag_table()) frame.push_back({{"flag", flag.flag}, {"name", flag.name}});
  return {{"safety", safety}, {"frame", frame}};
}

/// Every scene that comes with the program, and the files it needs that are not there.
OrderedJson list_of_scenes() {
  OrderedJson scenes = OrderedJson::array();
  for (const SceneEntry& scene : list_scenes()) {
    const Result<SceneDescription> description = describe_scene(scene.name);
    scenes.push_back({{"name", scene.name},
                      {"description", scene.description},
                      {"absent", description ? missing_files(*description) : std::vector<std::string>{}}});
  }
  return scenes;
}

const OrderedJson& scenes_json() {
  static const OrderedJson scenes = list_of_scenes();  // the same for every run of the program
  return scenes;
}

OrderedJson remarks_json(const std::vector<SceneRemark>& remarks) {
  OrderedJson list = OrderedJson::array();
  for (const SceneRemark& remark : remarks)
    list.push_back({{"warning", remark.warning}, {"text", remark.text}});
  return list;
}

void put(std::string& out, const Pose& X) {
  wire::put(out, X.p);
  const Quat q(X.R);
  for (double component : {q.w(), q.x(), q.y(), q.z()}) wire::put(out, static_cast<float>(component));
}

void write_shape(const Part& part, std::string& out) {
  constexpr std::uint32_t kCovered = 1u << 31;  // of a face's number: another piece lies on it
  const std::vector<DrawnEdge> edges = edges_to_draw(part);
  const std::vector<bool> covered = covered_triangles(part);
  wire::put(out, static_cast<std::uint32_t>(part.surface.vertices.size()));
  wire::put(out, static_cast<std::uint32_t>(part.surface.triangles.size()));
  wire::put(out, static_cast<std::uint32_t>(edges.size()));
  wire::put(out, static_cast<std::uint32_t>(part.is_surface() ? 1 : 0));
  for (const Vec3& vertex : part.surface.vertices) wire::put(out, vertex);
  for (const Triangle& triangle : part.surface.triangles)
    for (int corner : triangle) wire::put(out, static_cast<std::uint32_t>(corner));
  // The owner of a triangle: the surface of solid pieces is their faces in order, each a fan
  // (geometry/part.h). Of a surface, the flat faces are listed in place of pieces.
  if (part.is_surface())
    for (std::uint32_t i = 0; i < part.surface.triangles.size(); ++i) {
      wire::put(out, static_cast<std::uint32_t>(part.tree.group_of(static_cast<int>(i))));
      wire::put(out, i);
    }
  std::size_t triangle = 0;
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& piece = part.pieces[i];
    for (std::size_t face = 0; face < piece.faces.size(); ++face) {
      for (int t = 0; t + 2 < piece.faces[face].count; ++t, ++triangle) {
        wire::put(out, static_cast<std::uint32_t>(i));
        wire::put(out, static_cast<std::uint32_t>(face) | (covered[triangle] ? kCovered : 0u));
      }
    }
  }
  for (const DrawnEdge& edge : edges) {
    wire::put(out, edge.tail);
    wire::put(out, edge.head);
  }
  for (const DrawnEdge& edge : edges) wire::put(out, static_cast<std::uint32_t>(edge.kind));
}

/// A part whose surface is the pieces' own faces.
Part with_surface_of_pieces(const Part& part) {
  Part shown;
  shown.pieces = part.pieces;
  for (const Polytope& piece : part.pieces) {
    const int base = static_cast<int>(shown.surface.vertices.size());
    shown.surface.vertices.insert(shown.surface.vertices.end(), piece.vertices.begin(), piece.vertices.end());
    for (const Polytope::Face& face : piece.faces) {
      const int* loop = piece.face_vertices.data() + face.first;
      for (int i = 1; i + 1 < face.count; ++i)
        shown.surface.triangles.push_back({base + loop[0], base + loop[i], base + loop[i + 1]});
    }
  }
  return shown;
}

/// Whether the pieces' faces, as `faces` has them, are the surface's triangles one after the other.
bool same_triangles(const TriangleMesh& surface, const TriangleMesh& faces) {
  if (surface.triangles.size() != faces.triangles.size()) return false;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner)
      if (surface.vertices[surface.triangles[t][corner]] != faces.vertices[faces.triangles[t][corner]])
        return false;
  return true;
}

/// What both messages say of the settings.
OrderedJson settings_part(const ShownScene& scene, const ShownSettings& shown) {
  constexpr const char* kLevels[] = {"always", "in hand", "uncertain"};  // as in Stability
  const Coupling& coupling = shown.now.frame.coupling;
  const Stability stability = stability_of(coupling, scene.device, scene.rate_Hz);
  const bool whole_coupling = shown.usual_coupling_by_device && !shown.coupling_by_device;
  return {{"settings", settings_json(shown)},
          {"margin", margin_sentence(coupling, scene.device, scene.rate_Hz)},
          {"stability", kLevels[static_cast<std::size_t>(stability)]},
          {"coupling_by_device", shown.coupling_by_device},
          {"toml", changed_settings_toml(shown.now, shown.usual, whole_coupling)}};
}

}  // namespace

ShownScene shown_scene(const Session& session) {
  const Scene& scene = session.scene();
  std::vector<bool> led;
  for (std::size_t h = 0; h < session.hands(); ++h) led.push_back(session.can_be_led(h));
  return {scene.name,       scene.description, scene.world, scene.settings,
          session.device(), session.rate_Hz(), led};
}

std::string run_message(const ShownScene& scene, const ShownSettings& settings, const RunFacts& facts) {
  const Tool& tool = scene.settings.tool;
  OrderedJson message = {
      {"type", "run"},
      {"run", facts.run},
      {"version", fmt::format("{}.{}.{}", TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH)},
      {"scene", scene.name},
      {"description", scene.description},
      {"scenes", facts.replay ? OrderedJson::array() : scenes_json()},
      {"remarks", remarks_json(facts.remarks)},
      {"rate_Hz", scene.rate_Hz},
      {"real_time", facts.loop_in_real_time},
      {"bodies", bodies_json(scene.world)},
      {"posed", posed_bodies(scene.world)},
      {"field", field_json(scene.world)},
      {"grasped", tool.body},
      {"picks", tool.picks},
      {"other_hands", other_hands_json(scene)},
      {"X_BH", pose_json(tool.X_BH)},
      {"device", device_json(scene, facts)},
      {"stages", stages_json()},
      {"channels", channels_json()},
      {"flags", flags_json()}};
  if (facts.replay)
    message["replay"] = {
        {"file", facts.replay->file}, {"first", facts.replay->first}, {"past", facts.replay->past}};
  message.update(settings_part(scene, settings));
  return message.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

std::string settings_message(const ShownScene& scene, const ShownSettings& settings) {
  OrderedJson message = {{"type", "settings"}};
  message.update(settings_part(scene, settings));
  return message.dump();
}

std::string geometry_of(const World& world) {
  const Shapes shapes = shapes_of(world);
  std::string out;
  wire::put(out, static_cast<std::uint32_t>(shapes.parts.size()));
  for (const Part* part : shapes.parts) {
    if (part->is_surface()) {
      write_shape(*part, out);
      continue;
    }
    const Part shown = with_surface_of_pieces(*part);
    write_shape(same_triangles(part->surface, shown.surface) ? *part : shown, out);
  }
  return out;
}

void write_picture(const FramePicture& picture, std::string& out) {
  wire::put(out, static_cast<std::uint32_t>(picture.index));
  wire::put(out, static_cast<std::uint32_t>(picture.grasped_body + 1));
  wire::put(out, static_cast<std::uint32_t>(picture.X_WB.size()));
  wire::put(out, static_cast<std::uint32_t>(picture.contacts.size()));
  wire::put(out, static_cast<std::uint32_t>(picture.contacts_left_out));
  wire::put(out, static_cast<std::uint32_t>(picture.other_hands.size()));
  put(out, picture.X_WH);
  put(out, picture.X_WH_proxy);
  put(out, picture.X_WD);
  for (const HandPicture& hand : picture.other_hands) {
    wire::put(out, static_cast<std::int32_t>(hand.grasped_body));
    put(out, hand.X_WH);
    put(out, hand.X_WH_proxy);
    wire::put(out, hand.shown_W.f);
    wire::put(out, hand.shown_W.t);
  }
  for (const Pose& X_WB : picture.X_WB) put(out, X_WB);
  for (const ShownContact& contact : picture.contacts) {
    for (std::int32_t number : {contact.body_a, contact.body_b, contact.piece_a, contact.piece_b})
      wire::put(out, number);
    wire::put(out, static_cast<std::int32_t>(contact.a.kind));
    wire::put(out, static_cast<std::int32_t>(contact.a.index));
    wire::put(out, static_cast<std::int32_t>(contact.b.kind));
    wire::put(out, static_cast<std::int32_t>(contact.b.index));
    wire::put(out, contact.patch);
    wire::put(out, contact.p_W);
    wire::put(out, contact.n_W);
    for (double number : {contact.distance_m, contact.tolerance_m, contact.force_N})
      wire::put(out, static_cast<float>(number));
    wire::put(out, static_cast<std::int32_t>(contact.grip));
    wire::put(out, static_cast<float>(contact.cone_used));
    wire::put(out, static_cast<std::int32_t>(contact.rests ? 1 : 0));
  }
}

}  // namespace tactum
