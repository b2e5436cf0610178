#include "standins/standin_haply.h"

#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tactum::standin {
namespace {

using boost::asio::ip::tcp;
using nlohmann::json;
namespace beast = boost::beast;

constexpr const char* kId = "049D";
constexpr const char* kGrip = "61";
constexpr std::size_t kLately = 40;  // commands that the damper looks back
constexpr int kOftenReversed = 10;   // of these
constexpr double kDamperLeaves = 0.5;

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

json object_of(const Triple& v) { return {{"x", v[0]}, {"y", v[1]}, {"z", v[2]}}; }

double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

struct HaplyService::Server {
  boost::asio::io_context context;
  tcp::acceptor acceptor{context, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
  std::atomic<int> client{-1};
};

HaplyService::HaplyService() : server_(std::make_unique<Server>()) {
  port_ = server_->acceptor.local_endpoint().port();
  thread_ = std::thread([this] { serve(); });
}

HaplyService::~HaplyService() {
  ends_ = true;
  answer_all();
  ::shutdown(server_->acceptor.native_handle(), SHUT_RDWR);
  ::shutdown(server_->client, SHUT_RDWR);
  thread_.join();
}

void HaplyService::serve() {
  while (!ends_) {
    beast::error_code error;
    tcp::socket socket(server_->context);
    server_->acceptor.accept(socket, error);
    if (error) continue;
    socket.set_option(tcp::no_delay(true), error);
    server_->client = socket.native_handle();
    if (ends_) break;
    beast::flat_buffer buffer;
    beast::http::request<beast::http::string_body> request;
    beast::http::read(socket, buffer, request, error);
    if (error) continue;
    if (!beast::websocket::is_upgrade(request)) {
      beast::http::response<beast::http::string_body> response{beast::http::status::not_found,
                                                               request.version()};
      if (const Locked now = locked(); request.target() == "/version" && !now.world.version.empty()) {
        response.result(beast::http::status::ok);
        response.body() = json{{"project_version", now.world.version}}.dump();
      }
      response.keep_alive(false);
      response.prepare_payload();
      beast::http::write(socket, response, error);
      socket.shutdown(tcp::socket::shutdown_both, error);
      continue;
    }
    beast::websocket::stream<tcp::socket> stream(std::move(socket));
    stream.accept(request, error);
    std::string text;
    {
      const Locked now = locked();
      now.world.messages = 0;
      text = now.world.begins ? state_text(true) : "";
    }
    session_ = true;
    if (!text.empty()) stream.write(boost::asio::buffer(text), error);
    for (;;) {
      beast::flat_buffer message;
      stream.read(message, error);
      if (error || !wait_to_answer()) break;
      text = answer_to(beast::buffers_to_string(message.data()));
      if (!text.empty()) stream.write(boost::asio::buffer(text), error);
    }
    const Locked now = locked();
    session_ = waits_ = false;
    now.world.preset = "defaults", now.world.basis = "YXZ";
    changed_.notify_all();
  }
}

/// False when the service ends.
bool HaplyService::wait_to_answer() {
  Locked now = locked();
  waits_ = by_hand_;
  changed_.notify_all();
  changed_.wait(now.lock, [this] { return !by_hand_ || may_answer_; });
  waits_ = may_answer_ = false;
  return !ends_;
}

void HaplyService::answer_by_hand() {
  Locked now = locked();
  by_hand_ = true;
  changed_.wait(now.lock, [this] { return waits_ || !session_; });
}

void HaplyService::answer_one() {
  Locked now = locked();
  may_answer_ = true;
  changed_.notify_all();
  changed_.wait(now.lock, [this] { return (waits_ && !may_answer_) || !session_; });
}

void HaplyService::answer_all() {
  const Locked now = locked();
  by_hand_ = false;
  changed_.notify_all();
}

std::string HaplyService::answer_to(const std::string& message) {
  const Locked now = locked();
  World& world = now.world;
  ++world.messages;
  const json said = json::parse(message, nullptr, false);
  if (said.is_discarded()) world.broken_rules.push_back("no JSON: " + message);
  const json session = said.value("session", json::object());
  if (session.contains("configure") && session["configure"].contains("profile")) {
    world.profile = session["configure"]["profile"].value("name", "");
    if (world.messages != 1) world.broken_rules.push_back("a profile after the first message");
  }
  for (const json& device : said.value("inverse3", json::array())) {
    if (device.value("device_id", "") != kId) {
      world.broken_rules.push_back("a command for another device");
      continue;
    }
    const json configure = device.value("configure", json::object());
    if (world.takes_settings) {
      if (configure.contains("preset")) world.preset = configure["preset"].value("preset", "");
      if (configure.contains("basis")) world.basis = configure["basis"].value("permutation", "");
      // As the service does, in single precision.
      if (configure.contains("force_gate"))
        world.gate_gain = static_cast<float>(configure["force_gate"].value("gain", 0.0));
      if (configure.contains("damping"))
        world.damping = static_cast<float>(configure["damping"].value("scalar", 0.0));
    }
    const json commands = device.value("commands", json::object());
    if (!commands.contains("set_cursor_force")) continue;
    const json& force = commands["set_cursor_force"];
    for (const char* spelling : {"vector", "values"}) {
      const bool understood = std::string(spelling) == "vector" ? world.takes_vector : world.takes_values;
      if (understood && force.contains(spelling))
        take_force({force[spelling].value("x", 0.0), force[spelling].value("y", 0.0),
                    force[spelling].value("z", 0.0)});
    }
  }
  read_grip();
  if (world.silent) return "";
  if (!world.nonsense.empty()) return world.nonsense;
  return state_text(session.contains("force_render_full_state"));
}

void HaplyService::read_grip() {
  const double now_s = steady_s();
  if (now_s - read_s_ < world_.grip_every_s) return;
  read_s_ = now_s;
  const double angle = world_.turning_rad_per_s * now_s;
  read_turn_ = world_.turning_rad_per_s == 0.0
                   ? world_.turn_wxyz
                   : std::array<double, 4>{std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle)};
  ++world_.grip_readings;
}

/// The filters, in their order.
void HaplyService::take_force(const Triple& F) {
  world_.commands.push_back(F);
  lately_.push_back(F);
  if (lately_.size() > kLately) lately_.erase(lately_.begin());
  int reversed = 0;
  for (std::size_t i = 1; i < lately_.size(); ++i)
    if (dot(lately_[i - 1], lately_[i]) < 0.0) ++reversed;
  const bool oscillates = reversed >= kOftenReversed;
  if (oscillates) ++world_.of_damper;
  const double gain = oscillates ? kDamperLeaves * world_.gate_gain : 1.0;
  const bool pushes = world_.calibrated && world_.ready && world_.powered && world_.connected;
  for (std::size_t i = 0; i < 3; ++i)
    motors_[i] = pushes ? world_.scale * (gain * F[i] - world_.damping * world_.velocity[i]) : 0.0;
  commanded_s_ = steady_s();
}

Triple HaplyService::motors() {
  const Locked now = locked();
  const bool fresh = session_ && steady_s() - commanded_s_ <= kHolds_s;
  return fresh && now.world.connected ? motors_ : Triple{};
}

std::string HaplyService::state_text(bool with_config) const {
  json all{{"session_id", 7}, {"inverse3", json::array()}, {"wireless_verse_grip", json::array()}};
  if (world_.connected) {
    json device{{"device_id", kId},
                {"state",
                 {{"cursor_position", object_of(world_.position)},
                  {"cursor_velocity", object_of(world_.velocity)},
                  {"current_cursor_force", object_of(motors_)},
                  {"control_domain", "cartesian"}}},
                {"status",
                 {{"calibrated", world_.calibrated},
                  {"in_use", true},
                  {"power_supply", world_.powered},
                  {"ready", world_.ready},
                  {"started", true}}}};
    if (with_config)
      device["config"] = {
          {"type", "inverse3"},
          {"preset", world_.preset},
          {"basis", {{"permutation", world_.basis}}},
          {"filters",
           {{"force_gate", {{"gain", world_.gate_gain}}}, {"damping", {{"scalar", world_.damping}}}}}};
    all["inverse3"].push_back(device);
  }
  if (world_.has_grip) {
    constexpr const char* kNames[2][3] = {{"a", "b", "c"}, {"button_0", "button_1", "button_2"}};
    json buttons;
    for (std::size_t i = 0; i < 3; ++i) buttons[kNames[world_.counts_buttons ? 1 : 0][i]] = world_.buttons[i];
    const auto& [w, x, y, z] = read_turn_;
    all["wireless_verse_grip"].push_back(
        {{"device_id", kGrip},
         {"state",
          {{"orientation", {{"w", w}, {"x", x}, {"y", y}, {"z", z}}}, {"buttons", buttons}, {"hall", 0}}}});
  }
  return all.dump();
}

}  // namespace tactum::standin
