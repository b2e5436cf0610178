#include "tactum/recording/shown_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactum/base/assert.h"
#include "tactum/recording/byte_io.h"

namespace tactum::inline v0_1 {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBodyNumbers = 13;  // of a body in a row: place, orientation, velocities
constexpr std::uint64_t kSecond_ns = 1'000'000'000;

constexpr const char* kVectorSchema =
    R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}})";
constexpr const char* kTurnSchema =
    R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}})";
constexpr const char* kTimeSchema =
    R"({"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})";

std::string transform_schema() {
  return fmt::format(
      R"({{"title":"foxglove.FrameTransform","type":"object","properties":{{"timestamp":{},)"
      R"("parent_frame_id":{{"type":"string"}},"child_frame_id":{{"type":"string"}},"translation":{},)"
      R"("rotation":{}}}}})",
      kTimeSchema, kVectorSchema, kTurnSchema);
}

std::string scene_schema() {
  return fmt::format(
      R"({{"title":"foxglove.SceneUpdate","type":"object","properties":{{"deletions":{{"type":"array",)"
      R"("items":{{"type":"object"}}}},"entities":{{"type":"array","items":{{"type":"object","properties":{{)"
      R"("timestamp":{},"frame_id":{{"type":"string"}},"id":{{"type":"string"}},"lifetime":{{"type":"object"}},)"
      R"("frame_locked":{{"type":"boolean"}},"metadata":{{"type":"array","items":{{"type":"object"}}}},)"
      R"("arrows":{{"type":"array","items":{{"type":"object"}}}},"cubes":{{"type":"array","items":{{"type":"object"}}}},)"
      R"("spheres":{{"type":"array","items":{{"type":"object"}}}},"cylinders":{{"type":"array","items":{{"type":"object"}}}},)"
      R"("lines":{{"type":"array","items":{{"type":"object"}}}},"triangles":{{"type":"array","items":{{"type":"object"}}}},)"
      R"("texts":{{"type":"array","items":{{"type":"object"}}}},"models":{{"type":"array","items":{{"type":"object"}}}}}}}}}}}}}})",
      kTimeSchema);
}

constexpr const char* kWrenchSchema = R"(std_msgs/Header header
geometry_msgs/Wrench wrench
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Wrench
geometry_msgs/Vector3 force
geometry_msgs/Vector3 torque
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

Json vector_json(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
Json time_json(std::uint64_t ns) { return {{"sec", ns / kSecond_ns}, {"nsec", ns % kSecond_ns}}; }
Json upright_at(const Vec3& p) {
  return {{"position", vector_json(p.x(), p.y(), p.z())},
          {"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}}}};
}

/// A grey of its own for each body.
Json colour_of(std::size_t body) {
  const double shade = 0.45 + 0.1 * static_cast<double>(body % 5);
  return {{"r", shade}, {"g", shade}, {"b", shade + 0.05}, {"a", 1.0}};
}

Json triangles_json(const TriangleMesh& mesh, std::size_t body) {
  Json points = Json::array(), indices = Json::array();
  for (const Vec3& p : mesh.vertices) points.push_back(vector_json(p.x(), p.y(), p.z()));
  for (const auto& triangle : mesh.triangles)
    for (const auto corner : triangle) indices.push_back(corner);
  return {{"pose", upright_at(Vec3::Zero())},
          {"points", points},
          {"color", colour_of(body)},
          {"colors", Json::array()},
          {"indices", indices}};
}

Json box_json(const TriangleMesh& mesh, std::size_t body) {
  Aabb box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  const Vec3 size = box.max - box.min;
  return {{"pose", upright_at(0.5 * (box.min + box.max))},
          {"size", vector_json(size.x(), size.y(), size.z())},
          {"color", colour_of(body)}};
}

std::size_t place_of(const std::vector<TraceColumn>& columns, const std::string& name) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const TraceColumn& column) { return column.name == name; });
  TACTUM_DEMAND(found != columns.end());  // every trace has it
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace

ShownRun::ShownRun(McapWriter& writer, const World& world, double dt_s,
                   const std::vector<TraceColumn>& columns, std::size_t hands)
    : writer_(writer),
      frames_a_message_(
          std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(1.0 / (dt_s * kRate_Hz))))),
      first_body_(columns.size() - kBodyNumbers * world.bodies.size()) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    bodies_.push_back(fmt::format("body {} {}", i, world.bodies[i].name));
  const std::uint16_t transform =
      writer.add_schema({"foxglove.FrameTransform", "jsonschema", transform_schema()});
  const std::uint16_t update = writer.add_schema({"foxglove.SceneUpdate", "jsonschema", scene_schema()});
  const std::uint16_t wrench = writer.add_schema({"geometry_msgs/WrenchStamped", "ros1msg", kWrenchSchema});
  transforms_ = writer.add_channel({transform, "/tf", "json", {}});
  scene_ = writer.add_channel({update, "/scene", "json", {}});
  for (std::size_t h = 0; h < hands; ++h) {
    const std::string number = h == 0 ? "" : std::to_string(h + 1);
    const std::string column = h == 0 ? "" : "h" + number + "_";
    hands_.push_back({h == 0 ? "hand" : "hand " + number, h == 0 ? "proxy" : "proxy " + number,
                      place_of(columns, column + "hand_px_m"), place_of(columns, column + "proxy_px_m"),
                      place_of(columns, column + "sent_fx_N"), place_of(columns, column + "computed_fx_N"),
                      writer.add_channel({wrench, "/wrench/sent" + number, "ros1", {}}),
                      writer.add_channel({wrench, "/wrench/computed" + number, "ros1", {}})});
  }
}

void ShownRun::show_scene(const World& world) {
  std::size_t triangles = 0;
  for (const Body& body : world.bodies) triangles += body.part->surface.triangles.size();
  Json entities = Json::array();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const TriangleMesh& mesh = world.bodies[i].part->surface;
    Json entity{{"timestamp", time_json(0)},
                {"frame_id", bodies_[i]},
                {"id", bodies_[i]},
                {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                {"frame_locked", true}};
    for (const char* list :
         {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
      entity[list] = Json::array();
    if (triangles <= kMostTriangles)
      entity["triangles"].push_back(triangles_json(mesh, i));
    else
      entity["cubes"].push_back(box_json(mesh, i));
    entities.push_back(std::move(entity));
  }
  writer_.add_message(scene_, 0, Json{{"deletions", Json::array()}, {"entities", entities}}.dump());
}

void ShownRun::show_transform(const char* name, const double* pose, std::uint64_t time_ns) {
  // NaN is not JSON: what has no pose is not drawn.
  if (!std::all_of(pose, pose + 7, [](double number) { return std::isfinite(number); })) return;
  const Json transform{{"timestamp", time_json(time_ns)},
                       {"parent_frame_id", "world"},
                       {"child_frame_id", name},
                       {"translation", vector_json(pose[0], pose[1], pose[2])},
                       {"rotation", {{"x", pose[4]}, {"y", pose[5]}, {"z", pose[6]}, {"w", pose[3]}}}};
  writer_.add_message(transforms_, time_ns, transform.dump());
}

void ShownRun::show_wrench(std::uint16_t channel, const double* wrench, std::uint64_t time_ns) {
  std::string message;
  ByteWriter out(message);
  out.number(sequence_);
  out.number(static_cast<std::uint32_t>(time_ns / kSecond_ns));
  out.number(static_cast<std::uint32_t>(time_ns % kSecond_ns));
  out.text("world");
  for (int i = 0; i < 6; ++i) out.number(wrench[i]);
  writer_.add_message(channel, time_ns, message);
}

void ShownRun::show(std::uint64_t index, const std::vector<double>& numbers, std::uint64_t time_ns) {
  if (index % frames_a_message_ != 0) return;
  const double* row = numbers.data();
  for (const ShownHand& hand : hands_) {
    show_transform(hand.hand.c_str(), row + hand.hand_at, time_ns);
    show_transform(hand.proxy.c_str(), row + hand.proxy_at, time_ns);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    show_transform(bodies_[i].c_str(), row + first_body_ + kBodyNumbers * i, time_ns);
  for (const ShownHand& hand : hands_) {
    show_wrench(hand.sent_channel, row + hand.sent, time_ns);
    show_wrench(hand.computed_channel, row + hand.computed, time_ns);
  }
  ++sequence_;
}

}  // namespace tactum::inline v0_1
