/// The table of settings is part of haptics; scene files are the referee of its output.

#include "tactum/haptics/setting_table.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <tuple>

#include "support/generated_page.h"
#include "tactum/scene/scene_file.h"

namespace tactum::setting_table_test {
namespace {

const char* const kBody = "schema = 1\n";
const char* const kPart = "\n[[body]]\nname = \"b\"\npart = { box = { size_m = [0.1, 0.1, 0.1] } }\n";

/// A value of the setting's range that is not the default.
double other_value(const SettingInfo& setting, double share) {
  const UserSettings defaults;
  const double usual = setting.get(defaults.frame, defaults.safety);
  if (setting.kind == SettingKind::kOnOff || setting.kind == SettingKind::kChoice) return 1.0 - usual;
  const double value = setting.low + share * (setting.high - setting.low);
  return setting.kind == SettingKind::kInteger ? std::round(value) : value;
}

TEST(SettingTable, WhatItWritesReadsBackToTheSameSettings) {
  UserSettings settings;
  const UserSettings defaults;
  double share = 0.1;
  for (const SettingInfo& setting : setting_table()) {
    share = std::fmod(share + 0.37, 1.0);
    const double value = other_value(setting, share);
    EXPECT_TRUE(in_range(setting, value)) << setting.key;
    EXPECT_NE(value, setting.get(defaults.frame, defaults.safety)) << setting.key;
    setting.set(settings.frame, settings.safety, value);
    EXPECT_NEAR(setting.get(settings.frame, settings.safety), value, 1e-12 * std::abs(value)) << setting.key;
  }
  // Behind a file whose sections say something else.
  const std::string text = std::string(kBody) + kPart +
                           "[coupling]\nstiffness_N_per_m = 99\n[safety]\nmax_force_N = 1\n" +
                           changed_settings_toml(settings, defaults, false);
  const Result<Scene> scene = parse_scene(text, "saved", "saved.toml", {});
  ASSERT_TRUE(scene) << scene.error().message() << "\n" << text;
  for (const SettingInfo& setting : setting_table()) {
    const double written = setting.get(settings.frame, settings.safety);
    EXPECT_NEAR(setting.get(scene->settings, scene->safety), written, 1e-12 * std::abs(written))
        << setting.key;
  }
}

/// A scene file with this one setting.
Result<Scene> scene_with(const SettingInfo& setting, const std::string& value) {
  const std::string line = fmt::format("{} = {}\n", setting.key, value);
  const std::string section = *setting.section ? fmt::format("[{}]\n", setting.section) : "";
  return parse_scene(kBody + section + line + kPart, "one", "one.toml", {});
}

TEST(SettingTable, WhatTheTableAcceptsAFileMaySayAndNothingElse) {
  for (const SettingInfo& setting : setting_table()) {
    SCOPED_TRACE(setting.key);
    if (setting.kind == SettingKind::kOnOff || setting.kind == SettingKind::kChoice) {
      EXPECT_FALSE(scene_with(setting, "7"));
      EXPECT_FALSE(in_range(setting, 7.0));
      continue;
    }
    const bool whole = setting.kind == SettingKind::kInteger;
    const double beyond = whole ? 1.0 : 1e-3 * (setting.high - setting.low);
    for (const double value : {setting.low, setting.high, setting.low - beyond, setting.high + beyond}) {
      const Result<Scene> scene = scene_with(setting, fmt::format("{}", value));
      EXPECT_EQ(static_cast<bool>(scene), in_range(setting, value)) << value;
      EXPECT_EQ(in_range(setting, value), value >= setting.low && value <= setting.high) << value;
      if (!scene) {
        EXPECT_NE(scene.error().message().find("one.toml:"), std::string::npos) << scene.error().message();
      }
    }
    EXPECT_FALSE(scene_with(setting, "nan"));
    EXPECT_FALSE(in_range(setting, std::nan("")));
  }
}

TEST(SettingTable, SmoothingThatIsOffKeepsItsLimits) {
  UserSettings settings;
  const auto set = [&](const char* key, double value) {
    setting_table()[static_cast<std::size_t>(setting_called(key))].set(settings.frame, settings.safety,
                                                                       value);
  };
  set("smoothing.max_force_N_per_s", 250);
  set("smoothing.on", 0.0);
  set("smoothing.on", 1.0);
  EXPECT_EQ(settings.frame.smoothing.max_force_N_per_s, 250.0);
}

/// "0.001 to 5", "true, false", "penalty, constraint".
std::string range_of(const SettingInfo& setting) {
  if (setting.kind == SettingKind::kOnOff) return "true, false";
  if (setting.kind != SettingKind::kChoice) return fmt::format("{} to {}", setting.low, setting.high);
  std::string words;
  for (const char* word : setting.choices) words += (words.empty() ? "" : ", ") + std::string(word);
  return words;
}

std::string default_of(const SettingInfo& setting) {
  const UserSettings defaults;
  const double value = setting.get(defaults.frame, defaults.safety);
  if (setting.kind == SettingKind::kOnOff) return value != 0.0 ? "true" : "false";
  if (setting.kind == SettingKind::kChoice) return setting.choices[static_cast<std::size_t>(value)];
  return std::isinf(value) ? "none" : fmt::format("{:.6g}", value);
}

TEST(SettingTable, ThePageIsMadeFromTheTable) {
  std::string page =
      "# Settings\n\n"
      "Made from `src/tactum/haptics/setting_table.cpp` by a test, not by hand. The same table reads and "
      "writes\n"
      "scene files and makes the viewer's panel. Where the last column says so a setting takes effect "
      "between two\n"
      "frames, otherwise when the scene starts again. Safety settings can only tighten the device's own "
      "limits.\n"
      "Without the section `[coupling]` the coupling is chosen for the device and its rate\n"
      "([stability](algorithms/stability.md)).\n\n"
      "| setting | unit | default | range | meaning | live |\n|---|---|---|---|---|---|\n";
  for (const SettingInfo& setting : setting_table()) {
    const std::string section = *setting.section ? fmt::format("{}.", setting.section) : "";
    page += fmt::format("| `{}{}` | {} | {} | {} | {} | {} |\n", section, setting.key, setting.unit,
                        default_of(setting), range_of(setting), setting.meaning, setting.live ? "yes" : "");
  }
  testing::expect_page("docs/settings.md", page);
}

TEST(SettingTable, TheDefaultsLieInTheirRangesAndReadBack) {
  const UserSettings settings;
  for (const SettingInfo& setting : setting_table()) {
    const double value = setting.get(settings.frame, settings.safety);
    EXPECT_TRUE(std::isinf(value) || in_range(setting, value))
        << setting.section << "." << setting.key << " " << value;
  }
  EXPECT_EQ(changed_settings_toml(settings, settings, false), "");
}

TEST(SettingTable, ALimitThatWasTakenAwayIsWrittenAsTheEndOfItsRange) {
  UserSettings usual;
  usual.safety.max_force_N = 3.0;
  const std::string text = changed_settings_toml(UserSettings(), usual, false);
  EXPECT_NE(text.find("[settings]\nsafety.max_force_N = 50 "), std::string::npos) << text;
  EXPECT_TRUE(parse_scene(std::string(kBody) + kPart + text, "a", "a.toml", {}));
}

TEST(SettingTable, OnlyLimitsMayBeInfinite) {
  int unlimited = 0;
  for (const SettingInfo& setting : setting_table()) {
    EXPECT_EQ(in_range(setting, std::numeric_limits<double>::infinity()), may_be_unlimited(setting));
    EXPECT_FALSE(in_range(setting, -std::numeric_limits<double>::infinity()));
    EXPECT_TRUE(!may_be_unlimited(setting) || std::string_view(setting.section) == "safety") << setting.key;
    unlimited += may_be_unlimited(setting) ? 1 : 0;
  }
  EXPECT_GE(unlimited, 4);
}

/// A device that chooses the coupling chooses all of it or nothing.
TEST(SettingTable, ACouplingThatTheDeviceHadChosenIsWrittenWhole) {
  UserSettings usual, now;
  usual.frame.coupling = {1234.0, 2.5, 0.3, 0.001};
  now = usual;
  now.frame.coupling.stiffness_N_per_m = 1000.0;
  const std::string text = changed_settings_toml(now, usual, true);
  const Result<Scene> scene = parse_scene(std::string(kBody) + kPart + text, "a", "a.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_FALSE(scene->coupling_by_device);
  EXPECT_EQ(scene->settings.coupling.stiffness_N_per_m, 1000.0);
  EXPECT_EQ(scene->settings.coupling.damping_Ns_per_m, 0.3);
}

TEST(SettingTable, AFileOfSettingsChangesASceneAndSaysWhatIsWrongWithIt) {
  const std::string path = ::testing::TempDir() + "/settings.toml";
  const auto change = [&](const std::string& text) -> std::string {
    std::ofstream(path) << text;
    Result<SceneDescription> scene = parse_description(std::string(kBody) + kPart, "a", "a.toml", {});
    const Result<void> changed = change_settings(path, *scene);
    if (!changed) return changed.error().message();
    return fmt::format("{} {} {}", scene->settings.frame.coupling.stiffness_N_per_m,
                       scene->settings.frame.dt_s, scene->settings.coupling_by_device);
  };
  EXPECT_EQ(change("[settings]\ncoupling.stiffness_N_per_m = 432\ndt_s = 0.002\n"), "432 0.002 false");
  EXPECT_EQ(change("[settings]\ndt_s = 0.002\n"), "600 0.002 true");
  for (const auto& [text, where, what] :
       {std::tuple("[settings]\n\ncoupling.stiffnes_N_per_m = 1\n", "settings.toml:3:", "stiffness_N_per_m"),
        std::tuple("[settings]\ncoupling.stiffness_N_per_m = 1e9\n", "settings.toml:2:", "50000"),
        std::tuple("[coupling]\nstiffness_N_per_m = 1\n", "settings.toml:1:", "settings"),
        std::tuple("", "settings.toml", "[settings]"),
        std::tuple("[settings]\nworkspace.pos_m = [0, 0, 0]\n", "settings.toml:2:", "pos_m")}) {
    const std::string said = change(text);
    EXPECT_NE(said.find(where), std::string::npos) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
  }
  Result<SceneDescription> scene = parse_description(std::string(kBody) + kPart, "a", "a.toml", {});
  EXPECT_FALSE(change_settings("/no/such/settings.toml", *scene));
}

TEST(SettingTable, IsFoundByNameAndKeepsItsRanges) {
  const int index = setting_called("coupling.stiffness_N_per_m");
  ASSERT_GE(index, 0);
  const SettingInfo& setting = setting_table()[static_cast<std::size_t>(index)];
  EXPECT_TRUE(in_range(setting, 600.0));
  EXPECT_FALSE(in_range(setting, -1.0));
  EXPECT_FALSE(in_range(setting, std::nan("")));
  EXPECT_FALSE(in_range(setting, 1e9));
  EXPECT_GE(setting_called("dt_s"), 0);
  EXPECT_EQ(setting_called("coupling"), -1);
  EXPECT_EQ(setting_called("coupling.colour"), -1);
  const SettingInfo& whole =
      setting_table()[static_cast<std::size_t>(setting_called("budget.solver_iterations"))];
  EXPECT_FALSE(in_range(whole, 2.5));
}

}  // namespace
}  // namespace tactum::setting_table_test
