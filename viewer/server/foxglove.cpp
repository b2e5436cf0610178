/// The Foxglove WebSocket protocol, subprotocol foxglove.websocket.v1: channels with JSON schemas, to which
/// clients subscribe.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "viewer/server/bridge_speaker.h"
#include "viewer/server/wire.h"

namespace tactum {
namespace {

using OrderedJson = nlohmann::ordered_json;
constexpr BridgeProtocol kFoxglove = BridgeProtocol::kFoxglove;
constexpr std::uint8_t kMessageData = 1;
constexpr std::size_t kMostChannels = 1000;  // that one client subscribes to

class Foxglove final : public BridgeSpeaker {
 public:
  Foxglove(const BridgeTopics& topics, BridgeLine& line) : topics_(topics), line_(line) {}

  void opened() override {
    owe({{"op", "serverInfo"},
         {"name", "tactum"},
         {"capabilities", OrderedJson::array()},
         {"supportedEncodings", OrderedJson::array({"json"})},
         {"metadata", OrderedJson::object()}});
    OrderedJson channels = OrderedJson::array();
    for (std::size_t i = 0; i < topics_.all().size(); ++i) {
      const BridgeTopic& topic = topics_.all()[i];
      channels.push_back({{"id", i + 1},
                          {"topic", topic.name},
                          {"encoding", "json"},
                          {"schemaName", topic.schema_name},
                          {"schema", topic.schema},
                          {"schemaEncoding", "jsonschema"}});
    }
    owe({{"op", "advertise"}, {"channels", channels}});
  }

  bool received(const std::string& message, bool is_text) override {
    const OrderedJson json = is_text ? OrderedJson::parse(message, nullptr, false) : OrderedJson();
    if (!json.is_object()) return refuse("expected a JSON object as a text");
    const auto op = json.find("op");
    const std::string name = op != json.end() && op->is_string() ? op->get<std::string>() : "";
    if (name == "subscribe") return subscribe(json);
    if (name == "unsubscribe") return unsubscribe(json);
    return refuse(fmt::format("found the operation \"{}\", expected subscribe or unsubscribe", name));
  }

  void show(BridgeMoment& moment) override {
    for (const Subscription& one : subscriptions_)
      if (const std::string& message = moment.message(kFoxglove, *one.topic); !message.empty())
        line_.offer(data(one.id, moment.time_ns(), message), true);
  }

  void lost(std::uint64_t messages) override {
    status(1, fmt::format("this client is slow: {} messages gave way to newer ones so far", messages));
  }

  void closed() override {}

 private:
  struct Subscription {
    std::uint32_t id = 0;
    const BridgeTopic* topic = nullptr;
  };

  void owe(const OrderedJson& json) {
    line_.owe(json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace), false);
  }
  void status(int level, const std::string& sentence) {
    owe({{"op", "status"}, {"level", level}, {"message", sentence}});
  }
  bool refuse(const std::string& sentence) {
    status(2, sentence);
    return false;
  }

  static std::string data(std::uint32_t subscription, std::uint64_t time_ns, const std::string& message) {
    std::string out;
    out.reserve(message.size() + 13);
    wire::put(out, kMessageData);
    wire::put(out, subscription);
    wire::put(out, time_ns);
    return out + message;
  }

  /// A whole number of 32 bits behind a key.
  static std::optional<std::uint32_t> id_of(const OrderedJson& json, const char* key) {
    if (!json.is_object()) return std::nullopt;
    const auto found = json.find(key);
    return found == json.end() ? std::nullopt : id_of(*found);
  }
  static std::optional<std::uint32_t> id_of(const OrderedJson& number) {
    if (!number.is_number_unsigned() || number.get<std::uint64_t>() > UINT32_MAX) return std::nullopt;
    return static_cast<std::uint32_t>(number.get<std::uint64_t>());
  }

  bool subscribe(const OrderedJson& json) {
    const auto list = json.find("subscriptions");
    if (list == json.end() || !list->is_array()) return refuse("subscribe: expected a list of subscriptions");
    for (const OrderedJson& one : *list) {
      const std::optional<std::uint32_t> id = id_of(one, "id"), channel = id_of(one, "channelId");
      if (!id || !channel) return refuse("subscribe: expected an id and a channelId, whole numbers");
      if (*channel == 0 || *channel > topics_.all().size())
        return refuse(fmt::format("subscribe: there is no channel {}", *channel));
      if (subscriptions_.size() >= kMostChannels || find(*id) != subscriptions_.end())
        return refuse(fmt::format("subscribe: {} is subscribed already, or there are too many", *id));
      const BridgeTopic& topic = topics_.all()[*channel - 1];
      subscriptions_.push_back({*id, &topic});
      // The shapes do not change: who comes late is told as well.
      if (topic.what == BridgeTopic::What::kScene) line_.owe(data(*id, 0, topics_.scene()), true);
    }
    return true;
  }

  bool unsubscribe(const OrderedJson& json) {
    const auto list = json.find("subscriptionIds");
    if (list == json.end() || !list->is_array())
      return refuse("unsubscribe: expected a list subscriptionIds");
    for (const OrderedJson& one : *list) {
      const std::optional<std::uint32_t> id = id_of(one);
      const auto found = id ? find(*id) : subscriptions_.end();
      if (found == subscriptions_.end()) return refuse("unsubscribe: there is no such subscription");
      subscriptions_.erase(found);
    }
    return true;
  }

  std::vector<Subscription>::iterator find(std::uint32_t id) {
    return std::find_if(subscriptions_.begin(), subscriptions_.end(),
                        [id](const Subscription& one) { return one.id == id; });
  }

  const BridgeTopics& topics_;
  BridgeLine& line_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace

std::unique_ptr<BridgeSpeaker> speak_foxglove(const BridgeTopics& topics, BridgeLine& line) {
  return std::make_unique<Foxglove>(topics, line);
}

}  // namespace tactum
