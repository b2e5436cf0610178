#pragma once
/// The table of settings: section and key as in scene files, unit, range, meaning. Scene files are read and
/// written, ranges are checked, and the viewer's panel and docs/settings.md are made from it; a setting that
/// gets a line here appears everywhere. Settings that are no single number, such as the pose of the
/// workspace, the grasped part, and coefficients of pairs of materials, belong to the scene.

#include <span>
#include <string>
#include <string_view>

#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// Everything that can be set: the frame's settings, and the user's limits of safety (which only tighten the
/// device's).
struct UserSettings {
  FrameSettings frame;
  SafetySettings safety;
};

enum class SettingKind {
  kNumber,
  kInteger,
  kOnOff,
  kChoice  ///< a word; its value is its place in SettingInfo::choices
};

struct SettingInfo {
  const char* section;  ///< of the scene file; "" for the file's top
  const char* key;      ///< in it; its unit stands in the name
  const char* name;     ///< for people: "Stiffness"
  const char* unit;     ///< of the values in this table: "N/m"; "" for none
  const char* meaning;  ///< one line
  double low, high;     ///< the range, of files as of panels; the ends belong to it
  SettingKind kind;
  bool live;  ///< takes effect between two frames; else when the scene starts again
  double (*get)(const FrameSettings&, const SafetySettings&);  ///< infinite where there is no limit
  void (*set)(FrameSettings&, SafetySettings&, double);
  std::span<const char* const> choices = {};  ///< the words of a kChoice
};

/// In the order in which people should meet them.
std::span<const SettingInfo> setting_table() noexcept;

/// Index of "coupling.stiffness_N_per_m" (or "dt_s"); -1 when there is none.
int setting_called(std::string_view section_and_key) noexcept;

/// Whether a limit may be infinite: then the device's own holds.
bool may_be_unlimited(const SettingInfo& setting);

/// Whether the value lies in the setting's range (and is whole, or 0 or 1, where it must be), or is infinite
/// where it may be.
bool in_range(const SettingInfo& setting, double value) noexcept;

/// Those that differ from `usual`, as the table [settings] with units and meanings as comments. Such a table
/// counts more than the sections of a scene file, so it can be put behind them; reading it gives the same
/// settings. Empty when none differs. With `whole_coupling` all of the coupling is there, as it must be for a
/// scene that leaves it to the device.
std::string changed_settings_toml(const UserSettings& now, const UserSettings& usual, bool whole_coupling);

}  // namespace tactum::inline v0_1
