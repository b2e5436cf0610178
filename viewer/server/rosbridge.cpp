/// The rosbridge protocol, version 2: JSON in texts. Of its operations those that a source of topics needs:
/// subscribe, unsubscribe, and, to lead the hand, advertise, unadvertise and publish; of services those by
/// which clients ask for topics.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "viewer/server/bridge_speaker.h"

namespace tactum {
namespace {

using OrderedJson = nlohmann::ordered_json;
constexpr std::uint64_t kMillisecond_ns = 1'000'000;
constexpr double kLargestThrottle_ms = 1e6;
constexpr std::size_t kMostSubscriptions = 1000;  // of one client
constexpr BridgeProtocol kHere = BridgeProtocol::kRosbridge;

std::string dumped(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

/// The text behind a key; empty where there is none.
std::string text_of(const OrderedJson& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Numbers behind keys; false where one is missing or not finite.
template <std::size_t N>
bool read_numbers(const OrderedJson& json, const char* object, const std::array<const char*, N>& keys,
                  std::array<double, N>& numbers) {
  const auto inner = json.find(object);
  if (inner == json.end() || !inner->is_object()) return false;
  for (std::size_t i = 0; i < N; ++i) {
    const auto found = inner->find(keys[i]);
    if (found == inner->end() || !found->is_number()) return false;
    numbers[i] = found->template get<double>();
    if (!std::isfinite(numbers[i])) return false;
  }
  return true;
}

/// The request that a geometry_msgs/PoseStamped is; nothing where it is no pose in the world.
std::optional<Request> aim_of(const OrderedJson& message) {
  if (!message.is_object()) return std::nullopt;
  if (const auto header = message.find("header"); header != message.end() && header->is_object())
    if (const std::string frame = text_of(*header, "frame_id"); !frame.empty() && frame != "world")
      return std::nullopt;
  const auto pose = message.find("pose");
  if (pose == message.end() || !pose->is_object()) return std::nullopt;
  Request aim;
  aim.what = Request::What::kAim;
  std::array<double, 3> p{};
  std::array<double, 4> q{};
  if (!read_numbers<3>(*pose, "position", {"x", "y", "z"}, p)) return std::nullopt;
  if (!read_numbers<4>(*pose, "orientation", {"w", "x", "y", "z"}, q)) return std::nullopt;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) < 0.01)) return std::nullopt;
  for (double& part : q) part /= norm;
  std::copy(p.begin(), p.end(), aim.p.begin());
  std::copy(q.begin(), q.end(), aim.q.begin());
  return aim;
}

class Rosbridge final : public BridgeSpeaker {
 public:
  Rosbridge(const BridgeTopics& topics, BridgeLine& line, RequestInbox* inbox)
      : topics_(topics), line_(line), inbox_(inbox) {}

  void opened() override {}

  bool received(const std::string& message, bool is_text) override {
    const OrderedJson json = is_text ? OrderedJson::parse(message, nullptr, false) : OrderedJson();
    if (!json.is_object()) return refuse("", "expected a JSON object as a text");
    const std::string op = text_of(json, "op"), id = text_of(json, "id");
    if (op == "subscribe") return subscribe(json, id);
    if (op == "unsubscribe") return unsubscribe(json, id);
    if (op == "call_service") return call(json, id);
    if (op == "advertise")
      return text_of(json, "topic") == kHandCommand ? may_lead(id) : refuse_topic(json, id);
    if (op == "publish") return publish(json, id);
    if (op == "unadvertise" || op == "status" || op == "set_level") return true;
    return refuse(id, fmt::format("found the operation \"{}\", expected subscribe, unsubscribe, advertise, "
                                  "unadvertise, publish, call_service, status or set_level",
                                  op));
  }

  void show(BridgeMoment& moment) override {
    const BridgeTopic* sent = nullptr;
    for (Subscription& one : subscriptions_) {
      // Subscriptions to one topic lie together, and the first that is due sends for all.
      if (one.topic == sent) continue;
      const std::uint64_t now = moment.time_ns();
      // Time goes back where a page starts the run anew.
      if (one.sent_ns && now >= *one.sent_ns && now < *one.sent_ns + one.throttle_ns) continue;
      const std::string& message = moment.message(kHere, *one.topic);
      if (message.empty()) continue;
      sent = one.topic;
      for (Subscription& other : subscriptions_)
        if (other.topic == sent) other.sent_ns = now;
      line_.offer(fmt::format(R"({{"op":"publish","topic":"{}","msg":{}}})", sent->name, message), false);
    }
  }

  void lost(std::uint64_t messages) override {
    status("", "warning",
           fmt::format("this client is slow: {} messages gave way to newer ones so far", messages));
  }

  void closed() override {
    if (!leads_ || inbox_ == nullptr) return;
    Request rest;
    rest.what = Request::What::kRest;
    inbox_->ask(rest);
  }

 private:
  struct Subscription {
    std::string id;
    const BridgeTopic* topic = nullptr;
    std::uint64_t throttle_ns = 0;
    std::optional<std::uint64_t> sent_ns;
  };

  void status(const std::string& id, const char* level, const std::string& sentence) {
    OrderedJson json{{"op", "status"}, {"level", level}, {"msg", sentence}};
    if (!id.empty()) json["id"] = id;
    line_.owe(dumped(json), false);
  }
  bool refuse(const std::string& id, const std::string& sentence) {
    status(id, "error", sentence);
    return false;
  }
  bool refuse_topic(const OrderedJson& json, const std::string& id) {
    return refuse(id,
                  fmt::format("clients may publish {} only, found {}", kHandCommand, text_of(json, "topic")));
  }

  bool subscribe(const OrderedJson& json, const std::string& id) {
    const std::string name = text_of(json, "topic"), type = text_of(json, "type");
    const BridgeTopic* const topic = topics_.named(kHere, name);
    if (topic == nullptr) return refuse(id, fmt::format("there is no topic {}", name));
    // ROS 2 has msg between the package and the name.
    if (const std::size_t slash = topic->ros_type.find('/');
        !type.empty() && type != topic->ros_type &&
        type != topic->ros_type.substr(0, slash) + "/msg" + topic->ros_type.substr(slash))
      return refuse(id, fmt::format("{} has the type {}, found {}", name, topic->ros_type, type));
    const std::string compression = text_of(json, "compression");
    if (!compression.empty() && compression != "none")
      return refuse(id, fmt::format("found the compression {}, expected none", compression));
    if (subscriptions_.size() >= kMostSubscriptions) return refuse(id, "too many subscriptions");
    const auto rate = json.find("throttle_rate");
    const double throttle_ms = rate != json.end() && rate->is_number() ? rate->get<double>() : 0.0;
    if (!(throttle_ms >= 0.0 && throttle_ms <= kLargestThrottle_ms))
      return refuse(id, fmt::format("found the throttle_rate {} ms, expected 0 to {}", throttle_ms,
                                    kLargestThrottle_ms));
    const auto same = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                   [&](const Subscription& one) { return one.topic == topic; });
    subscriptions_.insert(same, {id, topic, static_cast<std::uint64_t>(throttle_ms) * kMillisecond_ns, {}});
    return true;
  }

  bool unsubscribe(const OrderedJson& json, const std::string& id) {
    const std::string name = text_of(json, "topic");
    const std::size_t before = subscriptions_.size();
    std::erase_if(subscriptions_, [&](const Subscription& one) {
      return one.topic->name == name && (id.empty() || one.id == id);
    });
    return subscriptions_.size() < before || refuse(id, fmt::format("{} was not subscribed to", name));
  }

  bool may_lead(const std::string& id) {
    return inbox_ != nullptr ||
           refuse(id, "the hand of this run is not led by clients: start it with --device pointer:NAME");
  }

  bool publish(const OrderedJson& json, const std::string& id) {
    if (text_of(json, "topic") != kHandCommand) return refuse_topic(json, id);
    if (!may_lead(id)) return false;
    const auto message = json.find("msg");
    const std::optional<Request> aim = message == json.end() ? std::nullopt : aim_of(*message);
    if (!aim)
      return refuse(id,
                    "expected a geometry_msgs/PoseStamped with finite numbers, a unit quaternion, and "
                    "frame_id world");
    leads_ = true;
    inbox_->ask(*aim);
    return true;
  }

  bool call(const OrderedJson& json, const std::string& id) {
    const std::string service = text_of(json, "service");
    OrderedJson values = OrderedJson::object();
    bool known = true;
    if (service == "/rosapi/topics") {
      values = {{"topics", OrderedJson::array()}, {"types", OrderedJson::array()}};
      for (const BridgeTopic& topic : topics_.all())
        if (!topic.ros_type.empty()) {
          values["topics"].push_back(topic.name);
          values["types"].push_back(topic.ros_type);
        }
    } else if (service == "/rosapi/topic_type") {
      const auto arguments = json.find("args");
      const bool named = arguments != json.end() && arguments->is_object();
      const BridgeTopic* const topic = named ? topics_.named(kHere, text_of(*arguments, "topic")) : nullptr;
      values = {{"type", topic == nullptr ? "" : topic->ros_type}};
    } else {
      known = false;
    }
    OrderedJson answer{{"op", "service_response"}, {"service", service}, {"result", known}};
    if (known)
      answer["values"] = values;
    else
      answer["values"] = fmt::format("there is no service {}", service);
    if (!id.empty()) answer["id"] = id;
    line_.owe(dumped(answer), false);
    return true;
  }

  const BridgeTopics& topics_;
  BridgeLine& line_;
  RequestInbox* inbox_;
  std::vector<Subscription> subscriptions_;
  bool leads_ = false;
};

}  // namespace

const std::string& BridgeMoment::message(BridgeProtocol protocol, const BridgeTopic& topic) {
  const auto [place, is_new] = messages_.try_emplace({protocol, &topic});
  if (!is_new) return place->second;
  if (picture_ != nullptr && topic.what == BridgeTopic::What::kContacts)
    place->second = BridgeTopics::contacts(protocol, *picture_, time_ns_);
  else if (frame_ != nullptr)
    place->second = topics_.message(protocol, topic, *frame_);
  return place->second;
}

std::unique_ptr<BridgeSpeaker> speak_rosbridge(const BridgeTopics& topics, BridgeLine& line,
                                               RequestInbox* inbox) {
  return std::make_unique<Rosbridge>(topics, line, inbox);
}

}  // namespace tactum
