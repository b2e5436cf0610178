#include "viewer/server/bridge_topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tactum {
namespace {

constexpr std::uint64_t kSecond_ns = 1'000'000'000;
using TopicKind = BridgeTopic::What;

/// The names that the parts of a time have in a message.
std::string time_text(BridgeProtocol protocol, std::uint64_t ns) {
  const bool ros = protocol == BridgeProtocol::kRosbridge;
  return fmt::format(R"({{"{}":{},"{}":{}}})", ros ? "secs" : "sec", ns / kSecond_ns, ros ? "nsecs" : "nsec",
                     ns % kSecond_ns);
}

std::string header_text(BridgeProtocol protocol, std::uint64_t index, std::uint64_t ns) {
  return fmt::format(R"({{"seq":{},"stamp":{},"frame_id":"world"}})", index, time_text(protocol, ns));
}

/// A zero that is negative is a zero, as in the trace.
std::string vector_text(const double* v) {
  return fmt::format(R"({{"x":{},"y":{},"z":{}}})", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
}

/// Of a quaternion w, x, y, z.
std::string turn_text(const double* q) {
  return fmt::format(R"({{"x":{},"y":{},"z":{},"w":{}}})", q[1] + 0.0, q[2] + 0.0, q[3] + 0.0, q[0] + 0.0);
}

std::string header_schema() {
  return fmt::format(
      R"("header":{{"type":"object","properties":{{"seq":{{"type":"integer"}},"stamp":{},"frame_id":{{"type":"string"}}}}}})",
      shown_json::time_schema());
}

std::string two_vectors_schema(const char* title, const char* inner, const char* first, const char* second) {
  const std::string vector = shown_json::vector_schema();
  return shown_json::object_schema(
      title, fmt::format(R"({},"{}":{{"type":"object","properties":{{"{}":{},"{}":{}}}}})", header_schema(),
                         inner, first, vector, second, vector));
}

std::string schema_of(TopicKind what) {
  switch (what) {
    case TopicKind::kPose:
      return shown_json::object_schema(
          "geometry_msgs/PoseStamped",
          fmt::format(R"({},"pose":{{"type":"object","properties":{{"position":{},"orientation":{}}}}})",
                      header_schema(), shown_json::vector_schema(), shown_json::turn_schema()));
    case TopicKind::kTwist:
      return two_vectors_schema("geometry_msgs/TwistStamped", "twist", "linear", "angular");
    case TopicKind::kWrench:
      return two_vectors_schema("geometry_msgs/WrenchStamped", "wrench", "force", "torque");
    case TopicKind::kTransforms:
      return shown_json::object_schema(
          "foxglove.FrameTransforms",
          fmt::format(R"("transforms":{{"type":"array","items":{}}})", shown_json::transform_schema()));
    case TopicKind::kContacts: {
      const std::string number = R"({"type":"number"})", integer = R"({"type":"integer"})";
      const std::string contact = shown_json::object_schema(
          "tactum/Contact",
          fmt::format(R"("body_a":{1},"body_b":{1},"p_W_m":{2},"n_BA_W":{2},"distance_m":{0},"force_N":{0},)"
                      R"("cone_used":{0},"grip":{1})",
                      number, integer, shown_json::vector_schema()));
      return shown_json::object_schema(
          "tactum/Contacts", fmt::format(R"({},"left_out":{},"contacts":{{"type":"array","items":{}}})",
                                         header_schema(), integer, contact));
    }
    case TopicKind::kScene:
      return shown_json::scene_schema();
  }
  return "";
}

std::string type_of(TopicKind what) {
  switch (what) {
    case TopicKind::kPose:
      return "geometry_msgs/PoseStamped";
    case TopicKind::kTwist:
      return "geometry_msgs/TwistStamped";
    case TopicKind::kWrench:
      return "geometry_msgs/WrenchStamped";
    case TopicKind::kTransforms:
      return "tf2_msgs/TFMessage";
    case TopicKind::kContacts:
      return "tactum/Contacts";
    case TopicKind::kScene:
      return "";
  }
  return "";
}

std::size_t numbers_of(TopicKind what) { return what == TopicKind::kPose ? 7 : 6; }

}  // namespace

BridgeTopics::BridgeTopics(const World& world, const std::vector<TraceColumn>& columns, std::size_t hands)
    : columns_(world, columns, hands), scene_(shown_json::scene_message(world, kMostTriangles)) {
  for (const ShownHandColumns& hand : columns_.hands) {
    add_stamped(TopicKind::kPose, "/tactum/hand" + hand.number + "/pose", hand.hand);
    add_stamped(TopicKind::kTwist, "/tactum/hand" + hand.number + "/twist", hand.hand_twist);
    add_stamped(TopicKind::kPose, "/tactum/tool" + hand.number + "/pose", hand.proxy);
    add_stamped(TopicKind::kTwist, "/tactum/tool" + hand.number + "/twist", hand.proxy_twist);
    add_stamped(TopicKind::kWrench, "/wrench/sent" + hand.number, hand.sent);
    add_stamped(TopicKind::kWrench, "/wrench/computed" + hand.number, hand.computed);
  }
  add_stamped(TopicKind::kContacts, "/tactum/contacts", 0);
  topics_.push_back({TopicKind::kTransforms, "/tf", type_of(TopicKind::kTransforms),
                     "foxglove.FrameTransforms", schema_of(TopicKind::kTransforms), 0});
  topics_.push_back(
      {TopicKind::kScene, "/scene", "", "foxglove.SceneUpdate", schema_of(TopicKind::kScene), 0});
}

void BridgeTopics::add_stamped(TopicKind what, const std::string& name, std::size_t column) {
  topics_.push_back({what, name, type_of(what), type_of(what), schema_of(what), column});
}

const BridgeTopic* BridgeTopics::named(BridgeProtocol protocol, const std::string& name) const noexcept {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BridgeTopic& topic) {
    return topic.name == name && (protocol == BridgeProtocol::kFoxglove || !topic.ros_type.empty());
  });
  return found == topics_.end() ? nullptr : &*found;
}

std::string BridgeTopics::message(BridgeProtocol protocol, const BridgeTopic& topic,
                                  const BridgeFrame& frame) const {
  if (topic.what == TopicKind::kTransforms) return transforms(protocol, frame);
  if (topic.what == TopicKind::kContacts || topic.what == TopicKind::kScene) return "";
  const double* const numbers = frame.row.data() + topic.column;
  if (!std::all_of(numbers, numbers + numbers_of(topic.what), [](double n) { return std::isfinite(n); }))
    return "";
  const std::string header = header_text(protocol, frame.index, frame.time_ns);
  if (topic.what == TopicKind::kPose)
    return fmt::format(R"({{"header":{},"pose":{{"position":{},"orientation":{}}}}})", header,
                       vector_text(numbers), turn_text(numbers + 3));
  const bool twist = topic.what == TopicKind::kTwist;
  return fmt::format(R"({{"header":{},"{}":{{"{}":{},"{}":{}}}}})", header, twist ? "twist" : "wrench",
                     twist ? "linear" : "force", vector_text(numbers), twist ? "angular" : "torque",
                     vector_text(numbers + 3));
}

std::string BridgeTopics::transforms(BridgeProtocol protocol, const BridgeFrame& frame) const {
  if (protocol == BridgeProtocol::kFoxglove)
    return fmt::format(R"({{"transforms":[{}]}})",
                       fmt::join(columns_.transforms(frame.row.data(), frame.time_ns), ","));
  std::vector<std::string> all;
  const auto add = [&](const std::string& name, std::size_t at) {
    const double* const pose = frame.row.data() + at;
    if (!std::all_of(pose, pose + 7, [](double n) { return std::isfinite(n); })) return;
    all.push_back(
        fmt::format(R"({{"header":{},"child_frame_id":{},"transform":{{"translation":{},"rotation":{}}}}})",
                    header_text(protocol, frame.index, frame.time_ns),
                    nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                    vector_text(pose), turn_text(pose + 3)));
  };
  for (const ShownHandColumns& hand : columns_.hands) {
    add(hand.hand_frame, hand.hand);
    add(hand.proxy_frame, hand.proxy);
  }
  for (const ShownBodyColumns& body : columns_.bodies) add(body.frame, body.pose);
  return fmt::format(R"({{"transforms":[{}]}})", fmt::join(all, ","));
}

std::string BridgeTopics::contacts(BridgeProtocol protocol, const FramePicture& picture,
                                   std::uint64_t time_ns) {
  std::string contacts;
  for (const ShownContact& contact : picture.contacts)
    contacts += fmt::format(
        R"({}{{"body_a":{},"body_b":{},"p_W_m":{},"n_BA_W":{},"distance_m":{},"force_N":{},"cone_used":{},"grip":{}}})",
        contacts.empty() ? "" : ",", contact.body_a, contact.body_b, vector_text(contact.p_W.data()),
        vector_text(contact.n_W.data()), contact.distance_m, contact.force_N, contact.cone_used,
        static_cast<int>(contact.grip));
  return fmt::format(R"({{"header":{},"left_out":{},"contacts":[{}]}})",
                     header_text(protocol, picture.index, time_ns), picture.contacts_left_out, contacts);
}

}  // namespace tactum
