#include "tactum/recording/shown_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBodyNumbers = 13;  // of a body in a row: place, orientation, velocities
constexpr std::uint64_t kNanoseconds = 1'000'000'000;

constexpr const char* kVectorSchema =
    R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}})";
constexpr const char* kTurnSchema =
    R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}})";
constexpr const char* kTimeSchema =
    R"({"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})";

Json vector_json(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
Json time_json(std::uint64_t ns) { return {{"sec", ns / kNanoseconds}, {"nsec", ns % kNanoseconds}}; }
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

namespace shown_json {

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

std::string object_schema(const std::string& title, const std::string& properties) {
  return fmt::format(R"({{"title":"{}","type":"object","properties":{{{}}}}})", title, properties);
}
std::string vector_schema() { return kVectorSchema; }
std::string turn_schema() { return kTurnSchema; }
std::string time_schema() { return kTimeSchema; }

std::string transform_message(const std::string& name, const double* pose, std::uint64_t time_ns) {
  // NaN is not JSON: what has no pose is not drawn.
  if (!std::all_of(pose, pose + 7, [](double number) { return std::isfinite(number); })) return "";
  const Json transform{{"timestamp", time_json(time_ns)},
                       {"parent_frame_id", "world"},
                       {"child_frame_id", name},
                       {"translation", vector_json(pose[0], pose[1], pose[2])},
                       {"rotation", {{"x", pose[4]}, {"y", pose[5]}, {"z", pose[6]}, {"w", pose[3]}}}};
  return transform.dump();
}

std::string scene_message(const World& world, std::size_t most_triangles) {
  std::size_t triangles = 0;
  for (const Body& body : world.bodies) triangles += body.part->surface.triangles.size();
  Json entities = Json::array();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const TriangleMesh& mesh = world.bodies[i].part->surface;
    Json entity{{"timestamp", time_json(0)},
                {"frame_id", frame_of_body(world, i)},
                {"id", frame_of_body(world, i)},
                {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                {"frame_locked", true}};
    for (const char* list :
         {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
      entity[list] = Json::array();
    if (triangles <= most_triangles)
      entity["triangles"].push_back(triangles_json(mesh, i));
    else
      entity["cubes"].push_back(box_json(mesh, i));
    entities.push_back(std::move(entity));
  }
  return Json{{"deletions", Json::array()}, {"entities", entities}}.dump();
}

std::string frame_of_body(const World& world, std::size_t body) {
  return fmt::format("body {} {}", body, world.bodies[body].name);
}

}  // namespace shown_json

ShownColumns::ShownColumns(const World& world, const std::vector<TraceColumn>& columns,
                           std::size_t hand_count) {
  for (std::size_t h = 0; h < hand_count; ++h) {
    const std::string number = h == 0 ? "" : std::to_string(h + 1);
    const std::string before = h == 0 ? "" : "h" + number + "_";
    hands.push_back({.number = number,
                     .hand_frame = h == 0 ? "hand" : "hand " + number,
                     .proxy_frame = h == 0 ? "proxy" : "proxy " + number,
                     .hand = place_of(columns, before + "hand_px_m"),
                     .hand_twist = place_of(columns, before + "hand_vx_m_per_s"),
                     .proxy = place_of(columns, before + "proxy_px_m"),
                     .proxy_twist = place_of(columns, before + "proxy_vx_m_per_s"),
                     .sent = place_of(columns, before + "sent_fx_N"),
                     .computed = place_of(columns, before + "computed_fx_N")});
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    bodies.push_back(
        {shown_json::frame_of_body(world, i), columns.size() - kBodyNumbers * (world.bodies.size() - i)});
}

std::vector<std::string> ShownColumns::transforms(const double* row, std::uint64_t time_ns) const {
  std::vector<std::string> messages;
  const auto add = [&](const std::string& name, std::size_t at) {
    std::string message = shown_json::transform_message(name, row + at, time_ns);
    if (!message.empty()) messages.push_back(std::move(message));
  };
  for (const ShownHandColumns& hand : hands) {
    add(hand.hand_frame, hand.hand);
    add(hand.proxy_frame, hand.proxy);
  }
  for (const ShownBodyColumns& body : bodies) add(body.frame, body.pose);
  return messages;
}

}  // namespace tactum::inline v0_1
