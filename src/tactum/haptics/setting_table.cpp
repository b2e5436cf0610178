#include "tactum/haptics/setting_table.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

namespace tactum::inline v0_1 {
namespace {

constexpr double degrees(double radians) { return radians * (180.0 / kPi); }
constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

using Frame = FrameSettings;
using Safety = SafetySettings;
constexpr SettingKind kNumber = SettingKind::kNumber;
constexpr SettingKind kInteger = SettingKind::kInteger;
constexpr SettingKind kOnOff = SettingKind::kOnOff;
constexpr SettingKind kChoice = SettingKind::kChoice;
constexpr const char* kResponses[] = {"penalty", "constraint"};  // as in ResponseModel
constexpr const char* kDepths[] = {"shortest", "along_motion"};  // as in OverlapDepth

/// Reads and writes a member of a section of the frame's settings, and of the user's safety settings.
template <auto Section, auto Member>
double get_field(const Frame& frame, const Safety&) {
  return static_cast<double>((frame.*Section).*Member);
}
template <auto Section, auto Member>
void set_field(Frame& frame, Safety&, double value) {
  auto& member = (frame.*Section).*Member;
  using Field = std::remove_reference_t<decltype(member)>;
  if constexpr (std::is_enum_v<Field>)
    member = static_cast<Field>(static_cast<int>(value));
  else
    member = static_cast<Field>(value);
}
template <auto Member>
double get_limit(const Frame&, const Safety& safety) {
  return safety.*Member;
}
template <auto Member>
void set_limit(Frame&, Safety& safety, double value) {
  safety.*Member = value;
}

// clang-format off
constexpr SettingInfo kSettings[] = {
  {"coupling", "stiffness_N_per_m", "Stiffness", "N/m", "spring between the hand and the held part, as felt at the device", 1, 50000, kNumber, true,
   get_field<&Frame::coupling, &Coupling::stiffness_N_per_m>,
   set_field<&Frame::coupling, &Coupling::stiffness_N_per_m>},
  {"coupling", "stiffness_Nm_per_rad", "Turning stiffness", "N m/rad", "the same spring against turning", 0.0005, 100, kNumber, true,
   get_field<&Frame::coupling, &Coupling::stiffness_Nm_per_rad>,
   set_field<&Frame::coupling, &Coupling::stiffness_Nm_per_rad>},
  {"coupling", "damping_Ns_per_m", "Damping", "N s/m", "damping of that spring, so that it does not swing", 0, 20, kNumber, true,
   get_field<&Frame::coupling, &Coupling::damping_Ns_per_m>,
   set_field<&Frame::coupling, &Coupling::damping_Ns_per_m>},
  {"coupling", "damping_Nms_per_rad", "Turning damping", "N m s/rad", "damping of that spring against turning", 0, 0.05, kNumber, true,
   get_field<&Frame::coupling, &Coupling::damping_Nms_per_rad>,
   set_field<&Frame::coupling, &Coupling::damping_Nms_per_rad>},

  {"", "response", "Response", "", "how contacts push: penalty, by the published springs; constraint, without interpenetration", 0, 1, kChoice, false,
   [](const Frame& frame, const Safety&) { return static_cast<double>(frame.response); },
   [](Frame& frame, Safety&, double value) { frame.response = value != 0.0 ? ResponseModel::kConstraint : ResponseModel::kPenalty; },
   kResponses},
  {"constraint", "max_step_m", "Longest step (constraint)", "m", "how far the held part may travel in a millisecond, times the scale; a large part may travel farther", 0.05e-3, 0.005, kNumber, true,
   get_field<&Frame::constraint, &Constraint::max_step_m>,
   set_field<&Frame::constraint, &Constraint::max_step_m>},
  {"constraint", "least_step_m", "Shortest step limit", "m", "where steps are refused their limit sinks, never below this length, times the scale; it then doubles from frame to frame", 0.01e-3, 0.001, kNumber, true,
   get_field<&Frame::constraint, &Constraint::least_step_m>,
   set_field<&Frame::constraint, &Constraint::least_step_m>},
  {"constraint", "max_turn_deg", "Largest turn", "deg", "how far the held part may turn in a millisecond", 0.1, 5, kNumber, true,
   [](const Frame& frame, const Safety&) { return degrees(frame.constraint.max_turn_rad); },
   [](Frame& frame, Safety&, double value) { frame.constraint.max_turn_rad = radians(value); }},

  {"penalty", "stiffness_N_per_m", "Contact stiffness", "N/m", "force of a wall per metre of penetration, as felt at the device", 50, 20000, kNumber, true,
   get_field<&Frame::penalty, &Penalty::stiffness_N_per_m>,
   set_field<&Frame::penalty, &Penalty::stiffness_N_per_m>},
  {"penalty", "max_step_m", "Longest step (penalty)", "m", "how far the held part may travel in a millisecond, times the scale; a large part may travel farther", 0.05e-3, 0.005, kNumber, true,
   get_field<&Frame::penalty, &Penalty::max_step_m>,
   set_field<&Frame::penalty, &Penalty::max_step_m>},
  {"penalty", "min_tolerance_m", "Least tolerance", "m", "distance at which resting parts still push, times the scale", 0, 0.001, kNumber, true,
   get_field<&Frame::penalty, &Penalty::min_tolerance_m>,
   set_field<&Frame::penalty, &Penalty::min_tolerance_m>},
  {"penalty", "depth", "Depth", "", "how an overlap is measured: the shortest way out, or back along the motion", 0, 1, kChoice, true,
   get_field<&Frame::penalty, &Penalty::depth>,
   set_field<&Frame::penalty, &Penalty::depth>, kDepths},

  {"impacts", "expansion_s", "Length of an impact", "s", "an impact on the held part is felt as a pulse of this length and of the same momentum", 0, 0.1, kNumber, true,
   get_field<&Frame::impacts, &Impacts::expansion_s>,
   set_field<&Frame::impacts, &Impacts::expansion_s>},
  {"impacts", "amplification", "Strength of an impact", "", "the momentum of that pulse is multiplied by this number", 0, 10, kNumber, true,
   get_field<&Frame::impacts, &Impacts::amplification>,
   set_field<&Frame::impacts, &Impacts::amplification>},

  {"shading", "on", "Force shading", "", "facets of a curved surface feel round", 0, 1, kOnOff, false,
   get_field<&Frame::shading, &Shading::on>,
   set_field<&Frame::shading, &Shading::on>},
  {"shading", "crease_deg", "Crease", "deg", "facets that meet at a smaller angle are taken for one curved surface", 0, 90, kNumber, false,
   [](const Frame& frame, const Safety&) { return degrees(frame.shading.crease_rad); },
   [](Frame& frame, Safety&, double value) { frame.shading.crease_rad = radians(value); }},

  {"smoothing", "on", "Smoothing", "", "limits how fast the shown force and torque change, by the six numbers below", 0, 1, kOnOff, true,
   get_field<&Frame::smoothing, &SmoothingSettings::on>,
   set_field<&Frame::smoothing, &SmoothingSettings::on>},
  {"smoothing", "beyond_hand_N_per_s", "Change not made by the hand", "N/s",
   "the force may change so fast where stiffness times the motion of the hand explains less", 1, 1e6, kNumber, true,
   get_field<&Frame::smoothing, &SmoothingSettings::beyond_hand_N_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::beyond_hand_N_per_s>},
  {"smoothing", "beyond_hand_Nm_per_s", "Change of torque not made by the hand", "N m/s",
   "the torque may change so fast where stiffness times the motion of the hand explains less", 0.01, 1e4, kNumber, true,
   get_field<&Frame::smoothing, &SmoothingSettings::beyond_hand_Nm_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::beyond_hand_Nm_per_s>},
  {"smoothing", "reversal_N_per_s", "Change that turns back", "N/s", "the force may change so fast in a step that goes against the last one",
   1, 1e6, kNumber, true, get_field<&Frame::smoothing, &SmoothingSettings::reversal_N_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::reversal_N_per_s>},
  {"smoothing", "reversal_Nm_per_s", "Change of torque that turns back", "N m/s", "the torque may change so fast in a step that goes against the last one",
   0.01, 1e4, kNumber, true, get_field<&Frame::smoothing, &SmoothingSettings::reversal_Nm_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::reversal_Nm_per_s>},
  {"smoothing", "max_force_N_per_s", "Largest change of force", "N/s", "the force may change so fast in any case; published: 0.5 N in 1 ms", 10, 1e4, kNumber, true,
   get_field<&Frame::smoothing, &SmoothingSettings::max_force_N_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::max_force_N_per_s>},
  {"smoothing", "max_torque_Nm_per_s", "Largest change of torque", "N m/s", "the torque may change so fast in any case", 0.5, 500, kNumber, true,
   get_field<&Frame::smoothing, &SmoothingSettings::max_torque_Nm_per_s>,
   set_field<&Frame::smoothing, &SmoothingSettings::max_torque_Nm_per_s>},

  {"safety", "max_force_N", "Largest force", "N", "never more is sent; can only be tighter than the device's own", 0, 50, kNumber, true,
   get_limit<&Safety::max_force_N>, set_limit<&Safety::max_force_N>},
  {"safety", "max_torque_Nm", "Largest torque", "N m", "never more is sent; can only be tighter than the device's own", 0, 5, kNumber, true,
   get_limit<&Safety::max_torque_Nm>, set_limit<&Safety::max_torque_Nm>},
  {"safety", "max_force_slew_N_per_s", "Slew limit of force", "N/s", "safety stage: how fast the force that is sent may change; can only be tighter than the device's own", 1, 20000, kNumber, true,
   get_limit<&Safety::max_force_slew_N_per_s>, set_limit<&Safety::max_force_slew_N_per_s>},
  {"safety", "max_torque_slew_Nm_per_s", "Slew limit of torque", "N m/s", "safety stage: how fast the torque that is sent may change; can only be tighter than the device's own", 0.02, 1000, kNumber, true,
   get_limit<&Safety::max_torque_slew_Nm_per_s>, set_limit<&Safety::max_torque_slew_Nm_per_s>},
  {"safety", "start_ramp_s", "Start ramp", "s", "time from no force to the full force after a start", 0, 5, kNumber, true,
   get_limit<&Safety::start_ramp_s>, set_limit<&Safety::start_ramp_s>},
  {"safety", "stop_ramp_s", "Stop ramp", "s", "time from the full force to none when stopped", 0.001, 0.1, kNumber, true,
   get_limit<&Safety::stop_ramp_s>, set_limit<&Safety::stop_ramp_s>},

  {"", "dt_s", "Frame period", "s", "time from the start of a frame to the start of the next: one over the rate of the loop", 0.0001, 0.01, kNumber, false,
   [](const Frame& frame, const Safety&) { return frame.dt_s; },
   [](Frame& frame, Safety&, double value) { frame.dt_s = value; }},
  {"budget", "max_exact_tests", "Exact tests", "", "most exact tests of pairs in a frame", 1, 1000000, kInteger, true,
   get_field<&Frame::budget, &WorkBudget::max_exact_tests>,
   set_field<&Frame::budget, &WorkBudget::max_exact_tests>},
  {"budget", "max_path_tests", "Path tests", "", "most tests of tree nodes and leaves in a frame, for the proof that surfaces do not cross on their paths", 0, 100000000, kInteger, true,
   get_field<&Frame::budget, &WorkBudget::max_path_tests>,
   set_field<&Frame::budget, &WorkBudget::max_path_tests>},
  {"budget", "max_contact_points", "Contact points", "", "most contact points in a frame", 1, 100000, kInteger, false,
   get_field<&Frame::budget, &WorkBudget::max_contact_points>,
   set_field<&Frame::budget, &WorkBudget::max_contact_points>},
  {"budget", "solver_iterations", "Solver rounds", "", "most rounds of the contact solver", 1, 10000, kInteger, true,
   get_field<&Frame::budget, &WorkBudget::solver_iterations>,
   set_field<&Frame::budget, &WorkBudget::solver_iterations>},
  {"budget", "sleep", "Sleep", "", "bodies at rest are not computed, as long as that makes no difference", 0, 1, kOnOff, true,
   get_field<&Frame::budget, &WorkBudget::sleep>,
   set_field<&Frame::budget, &WorkBudget::sleep>},

  {"workspace", "scale", "Scale", "", "metres of the scene to a metre of the device; forces are the same on both sides", 0.001, 1000, kNumber, false,
   get_field<&Frame::workspace, &Workspace::scale>,
   set_field<&Frame::workspace, &Workspace::scale>},
  {"workspace", "clutch_button", "Clutch", "", "while this button is held the device moves without the scene; -1: none", -1, 31, kInteger, false,
   get_field<&Frame::workspace, &Workspace::clutch_button>,
   set_field<&Frame::workspace, &Workspace::clutch_button>},
};
// clang-format on

}  // namespace

std::span<const SettingInfo> setting_table() noexcept { return kSettings; }

int setting_called(std::string_view section_and_key) noexcept {
  const std::size_t dot = section_and_key.find('.');
  const bool top = dot == std::string_view::npos;
  const std::string_view section = top ? "" : section_and_key.substr(0, dot);
  const std::string_view key = top ? section_and_key : section_and_key.substr(dot + 1);
  int index = 0;
  for (const SettingInfo& setting : kSettings) {
    if (section == setting.section && key == setting.key) return index;
    ++index;
  }
  return -1;
}

bool may_be_unlimited(const SettingInfo& setting) { return std::isinf(setting.get({}, {})); }

bool in_range(const SettingInfo& setting, double value) noexcept {
  if (std::isinf(value)) return value > 0.0 && may_be_unlimited(setting);
  if (!(value >= setting.low && value <= setting.high)) return false;
  return setting.kind == SettingKind::kNumber || std::floor(value) == value;
}

namespace {

/// "stiffness_N_per_m = 600  # spring ... [N/m]".
std::string toml_line(const SettingInfo& setting, double value) {
  const std::string shown = setting.kind == SettingKind::kOnOff ? (value != 0.0 ? "true" : "false")
                            : setting.kind == SettingKind::kChoice
                                ? fmt::format("\"{}\"", setting.choices[static_cast<std::size_t>(value)])
                            : setting.kind == SettingKind::kInteger ? fmt::format("{:.0f}", value)
                                                                    : fmt::format("{}", value);
  const std::string unit = *setting.unit ? fmt::format(" [{}]", setting.unit) : "";
  return fmt::format("{} = {}  # {}{}\n", setting.key, shown, setting.meaning, unit);
}

}  // namespace

std::string changed_settings_toml(const UserSettings& now, const UserSettings& usual, bool whole_coupling) {
  std::string lines;
  for (const SettingInfo& setting : kSettings) {
    const double value = setting.get(now.frame, now.safety);
    const std::string_view section = setting.section;
    if (value == setting.get(usual.frame, usual.safety) && !(whole_coupling && section == "coupling"))
      continue;
    // A limit that was taken away: the end of its range lets the device's own hold.
    lines += section.empty() ? "" : std::string(section) + ".";
    lines += toml_line(setting, std::isfinite(value) ? value : setting.high);
  }
  return lines.empty() ? "" : "[settings]\n" + lines;
}

}  // namespace tactum::inline v0_1
