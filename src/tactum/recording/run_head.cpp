#include "tactum/recording/run_head.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactum/haptics/setting_table.h"
#include "tactum/recording/frame_slot.h"

namespace tactum::inline v0_1 {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity.
Json number_json(double number) {
  return std::isfinite(number) ? Json(number) : Json(number > 0 ? "inf" : number < 0 ? "-inf" : "nan");
}

double number_of(const Json& json) {
  if (json.is_number()) return json.get<double>();
  const auto word = json.get<std::string>();
  if (word == "inf") return std::numeric_limits<double>::infinity();
  if (word == "-inf") return -std::numeric_limits<double>::infinity();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  throw std::invalid_argument("\"" + word + "\" is no number");
}

/// Every member of a device's description but its name.
template <class Info, class Visit>
void visit_device(Info& info, const Visit& visit) {
  visit("senses_rotation", info.senses_rotation);
  visit("actuates_force", info.actuates_force);
  visit("actuates_torque", info.actuates_torque);
  visit("max_force_N", info.max_force_N);
  visit("max_torque_Nm", info.max_torque_Nm);
  visit("max_stiffness_N_per_m", info.max_stiffness_N_per_m);
  visit("max_stiffness_Nm_per_rad", info.max_stiffness_Nm_per_rad);
  visit("workspace_radius_m", info.workspace_radius_m);
  visit("max_still_s", info.max_still_s);
  visit("rate_Hz", info.rate_Hz);
  visit("handle_mass_kg", info.handle.mass_kg);
  visit("handle_inertia_kg_m2", info.handle.inertia_kg_m2);
  visit("handle_damping_Ns_per_m", info.handle.damping_Ns_per_m);
  visit("handle_damping_Nms_per_rad", info.handle.damping_Nms_per_rad);
  visit("handle_friction_N", info.handle.friction_N);
  visit("handle_friction_Nm", info.handle.friction_Nm);
  visit("handle_encoder_step_m", info.handle.encoder_step_m);
  visit("handle_encoder_step_rad", info.handle.encoder_step_rad);
  visit("handle_delay_s", info.handle.delay_s);
}

Json device_json(const DeviceInfo& info) {
  Json json{{"name", info.name}};
  visit_device(info, [&](const char* name, auto value) {
    if constexpr (std::is_same_v<decltype(value), bool>)
      json[name] = value;
    else
      json[name] = number_json(value);
  });
  return json;
}

DeviceInfo device_of(const Json& json) {
  DeviceInfo info;
  info.name = json.at("name").get<std::string>();
  visit_device(info, [&](const char* name, auto& value) {
    if constexpr (std::is_same_v<decltype(value), bool&>)
      value = json.at(name).get<bool>();
    else
      value = number_of(json.at(name));
  });
  return info;
}

std::string compiler() {
#ifdef __clang__
  std::string name = fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  std::string name = fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
#ifdef NDEBUG
  return name + ", optimised";
#else
  return name + ", with assertions";
#endif
}

void read_lists(const Json& json, RunHead& head) {
  head.bodies = json.at("bodies").get<std::vector<std::string>>();
  for (const auto& [key, value] : json.at("settings").items())
    head.settings.emplace_back(key, number_of(value));
  for (const Json& file : json.at("files"))
    head.files.push_back({file.at("attachment").get<std::string>(), file.at("name").get<std::string>(),
                          std::stoull(file.at("hash").get<std::string>(), nullptr, 16)});
  for (const Json& column : json.at("columns"))
    head.columns.push_back({column.at("name").get<std::string>(), column.at("meaning").get<std::string>()});
}

}  // namespace

std::vector<std::pair<std::string, double>> settings_in_force(const FrameSettings& settings,
                                                              const SafetySettings& safety) {
  std::vector<std::pair<std::string, double>> values;
  for (const SettingInfo& setting : setting_table())
    values.emplace_back(
        setting.section[0] == '\0' ? setting.key : fmt::format("{}.{}", setting.section, setting.key),
        setting.get(settings, safety));
  return values;
}

RunHead head_of(const Session& session, const std::string& scene_file, const RecorderOptions& options,
                const std::vector<TraceColumn>& columns) {
  const Scene& scene = session.scene();
  RunHead head;
  head.version = options.version;
  head.compiler = compiler();
  head.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  head.scene = scene.name;
  head.scene_file = scene_file;
  head.grip = options.grip.empty() ? scene.grip : options.grip;
  head.dt_s = scene.settings.dt_s;
  head.device = session.device();
  for (std::size_t h = 1; h < session.hands(); ++h) head.other_devices.push_back(session.device_of(h));
  for (const Body& body : scene.world.bodies) head.bodies.push_back(body.name);
  head.settings = options.midway ? settings_in_force(options.midway->frame, options.midway->safety)
                                 : settings_in_force(scene.settings, scene.safety);
  head.columns = columns;
  return head;
}

std::string setting_text(const std::string& key, double value) {
  const int place = setting_called(key);
  if (place < 0) return fmt::format("{}", value);
  const SettingInfo& setting = setting_table()[static_cast<std::size_t>(place)];
  const bool is_word = setting.kind == SettingKind::kChoice && value >= 0.0 &&
                       value < static_cast<double>(setting.choices.size());
  return is_word ? std::string(setting.choices[static_cast<std::size_t>(value)]) : fmt::format("{}", value);
}

std::string head_text(const RunHead& head) {
  Json json{{"format", recording::kFormat},
            {"tactum", head.version},
            {"compiler", head.compiler},
            {"date", head.date},
            {"scene", head.scene},
            {"scene_file", head.scene_file},
            {"grip", head.grip},
            {"dt_s", head.dt_s},
            {"device", device_json(head.device)},
            {"bodies", head.bodies},
            {"settings", Json::object()},
            {"files", Json::array()},
            {"columns", Json::array()}};
  for (const auto& [key, value] : head.settings) json["settings"][key] = number_json(value);
  for (const DeviceInfo& other : head.other_devices) json["other_devices"].push_back(device_json(other));
  for (const RecordedFile& file : head.files)
    json["files"].push_back(
        {{"attachment", file.attachment}, {"name", file.name}, {"hash", fmt::format("{:016x}", file.hash)}});
  for (const TraceColumn& column : head.columns)
    json["columns"].push_back({{"name", column.name}, {"meaning", column.meaning}});
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<RunHead> read_head(std::string_view text, const std::string& where) {
  const auto error = [&](const std::string& found) {
    return Error{"the message of /tactum/run is not that of a recording", found,
                 fmt::format("format {} of Tactum's recordings", recording::kFormat), where};
  };
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return error("no JSON object");
  RunHead head;
  try {
    if (const int format = json.at("format").get<int>(); format != recording::kFormat)
      return error(fmt::format("format {}", format));
    for (const auto& [key, value] :
         std::initializer_list<std::pair<const char*, std::string*>>{{"tactum", &head.version},
                                                                     {"compiler", &head.compiler},
                                                                     {"date", &head.date},
                                                                     {"scene", &head.scene},
                                                                     {"scene_file", &head.scene_file},
                                                                     {"grip", &head.grip}})
      *value = json.at(key).get<std::string>();
    head.dt_s = number_of(json.at("dt_s"));
    head.device = device_of(json.at("device"));
    if (const auto others = json.find("other_devices"); others != json.end())  // of several hands only
      for (const Json& other : *others) head.other_devices.push_back(device_of(other));
    read_lists(json, head);
  } catch (const std::exception& exception) {  // of nlohmann, or a number that is none
    return error(exception.what());
  }
  return head;
}

}  // namespace tactum::inline v0_1
