#include "tactum/drivers/haply_messages.h"

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace tactum::inline v0_1 {
namespace {

using nlohmann::json;

/// A member of an object, null where there is none: what a service sends may lack anything.
const json& member(const json& object, const char* name) {
  static const json kNone;
  if (!object.is_object()) return kNone;
  const auto found = object.find(name);
  return found == object.end() ? kNone : *found;
}

std::string text_of_json(const json& value) { return value.is_string() ? value.get<std::string>() : ""; }

double number_or(const json& value, double other) { return value.is_number() ? value.get<double>() : other; }

bool flag_or(const json& value, bool other) { return value.is_boolean() ? value.get<bool>() : other; }

/// Coordinates that are left out are zero: the service leaves out what is as at the start.
Vec3 haply_vector(const json& value) {
  return {number_or(member(value, "x"), 0.0), number_or(member(value, "y"), 0.0),
          number_or(member(value, "z"), 0.0)};
}

/// The entry of a list with that id; null when there is none. An empty id is that of the first.
const json* entry_of(const json& list, const std::string& id) {
  if (!list.is_array()) return nullptr;
  for (const json& entry : list)
    if (id.empty() || text_of_json(member(entry, "device_id")) == id) return &entry;
  return nullptr;
}

constexpr const char* kGripLists[] = {"verse_grip", "wireless_verse_grip"};

/// The documents call the buttons a, b and c; the service has been seen to call them button_0 and so on.
std::uint32_t haply_buttons(const json& state) {
  constexpr const char* kNames[][2] = {{"a", "button_0"}, {"b", "button_1"}, {"c", "button_2"}};
  std::uint32_t mask = flag_or(member(state, "button"), false) ? 1u : 0u;
  const json& buttons = member(state, "buttons");
  for (std::uint32_t i = 0; i < 3; ++i)
    for (const char* name : kNames[i])
      if (flag_or(member(buttons, name), false)) mask |= 1u << i;
  return mask;
}

/// Shortest text that reads back as the same number.
std::string number_text(double number) { return json(number).dump(); }

std::string vector_text(const Vec3& v) {
  return "{\"x\":" + number_text(v.x()) + ",\"y\":" + number_text(v.y()) + ",\"z\":" + number_text(v.z()) +
         "}";
}

/// A message about one device: what stands before its list, and what beside its command.
std::string haply_message(const std::string& session, const std::string& id, const std::string& configure,
                          bool as_vector, const Vec3& F) {
  return "{" + session + "\"inverse3\":[{\"device_id\":" + json(id).dump() + "," + configure +
         "\"commands\":{\"set_cursor_force\":{\"" + (as_vector ? "vector" : "values") +
         "\":" + vector_text(F) + "}}}]}";
}

}  // namespace

Result<HaplyDeviceConfig> haply_config(const std::string& message, const std::string& id) {
  const json all = json::parse(message, nullptr, false);
  const json& devices = member(all, "inverse3");
  if (!devices.is_array())
    return Error{"the service sends no list of devices", message.substr(0, 60),
                 "a service of version 3.1 or newer", "haply"};
  HaplyDeviceConfig device;
  for (const json& entry : devices)
    device.others += (device.others.empty() ? "" : ", ") + text_of_json(member(entry, "device_id"));
  const json* ours = entry_of(devices, id);
  if (devices.empty())
    return Error{"the service finds no device", "",
                 "one that is plugged in and switched on, as Haply Hub shows it", "haply"};
  if (ours == nullptr)
    return Error{"the service has no device of this id", id, "one of " + device.others, "haply"};
  const json& config = member(*ours, "config");
  device.id = text_of_json(member(*ours, "device_id"));
  device.type = text_of_json(member(config, "type"));
  device.preset = text_of_json(member(config, "preset"));
  device.basis = text_of_json(member(member(config, "basis"), "permutation"));
  const json& filters = member(config, "filters");
  device.gate_gain = number_or(member(member(filters, "force_gate"), "gain"), -1.0);
  device.damping = number_or(member(member(filters, "damping"), "scalar"), -1.0);
  for (const char* list : kGripLists) {
    const json* grip = entry_of(member(all, list), "");
    if (device.grip.empty() && grip != nullptr && member(member(*grip, "state"), "orientation").is_object())
      device.grip = text_of_json(member(*grip, "device_id"));
  }
  return device;
}

bool haply_state(const std::string& message, const HaplyDeviceConfig& device, HaplyDeviceState& state) {
  const json all = json::parse(message, nullptr, false);
  const json* ours = entry_of(member(all, "inverse3"), device.id);
  if (ours == nullptr) return false;
  const json& now = member(*ours, "state");
  const json& status = member(*ours, "status");
  if (!member(now, "cursor_position").is_object()) return false;
  state.position = haply_vector(member(now, "cursor_position"));
  state.velocity = haply_vector(member(now, "cursor_velocity"));
  state.delivered = haply_vector(member(now, "current_cursor_force"));
  state.calibrated = flag_or(member(status, "calibrated"), true);
  state.ready = flag_or(member(status, "ready"), true);
  state.powered = flag_or(member(status, "power_supply"), true);
  state.has_turn = false;
  state.buttons = 0;
  if (device.grip.empty()) return true;
  for (const char* list : kGripLists) {
    const json* grip = entry_of(member(all, list), device.grip);
    if (grip == nullptr) continue;
    const json& grip_state = member(*grip, "state");
    const json& turn = member(grip_state, "orientation");
    state.has_turn = turn.is_object();
    const Vec3 v = haply_vector(turn);
    state.turn_wxyz = {number_or(member(turn, "w"), 0.0), v.x(), v.y(), v.z()};
    state.buttons = haply_buttons(grip_state);
  }
  return true;
}

std::string haply_version(const std::string& answer) {
  const json said = json::parse(answer, nullptr, false);
  return text_of_json(member(said, "project_version"));
}

bool haply_takes_vector(const std::string& version) {
  char* rest = nullptr;
  const long major = std::strtol(version.c_str(), &rest, 10);
  const long minor = *rest == '.' ? std::strtol(rest + 1, nullptr, 10) : 0;
  return version.empty() || major > 3 || (major == 3 && minor >= 5);
}

std::string haply_force_message(const std::string& id, bool as_vector, const Vec3& F) {
  return haply_message("", id, "", as_vector, F);
}

std::string haply_first_message(const std::string& id, bool as_vector) {
  return haply_message("\"session\":{\"configure\":{\"profile\":{\"name\":\"tactum\"}}},", id,
                       std::string("\"configure\":{\"preset\":{\"preset\":\"") + kHaplyPreset +
                           "\"},\"basis\":{\"permutation\":\"" + kHaplyBasis +
                           "\"},\"force_gate\":{\"gain\":" + number_text(kHaplyGateGain) +
                           "},\"damping\":{\"scalar\":" + number_text(kHaplyDamping) + "}},",
                       as_vector, Vec3::Zero());
}

std::string haply_config_request(const std::string& id, bool as_vector) {
  return haply_message("\"session\":{\"force_render_full_state\":{}},", id, "", as_vector, Vec3::Zero());
}

}  // namespace tactum::inline v0_1
