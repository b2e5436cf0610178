/// The table of settings lies in haptics; scene files are the referee of what it writes.

#include "tactum/haptics/setting_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tactum/scene/scene_file.h"

namespace tactum {
namespace {

const char* const kBody = "schema = 1\n";
const char* const kPart = "\n[[body]]\nname = \"b\"\npart = { box = { size_m = [0.1, 0.1, 0.1] } }\n";

TEST(SettingTable, WhatItWritesReadsBackToTheSameSettings) {
  UserSettings settings;
  double share = 0.1;
  for (const SettingInfo& setting : setting_table()) {
    share = std::fmod(share + 0.37, 1.0);
    double value = setting.low + share * (setting.high - setting.low);
    if (setting.kind != SettingKind::kNumber)
      value = setting.kind == SettingKind::kOnOff ? 1.0 : std::round(value);
    EXPECT_TRUE(in_range(setting, value)) << setting.key;
    setting.set(settings.frame, settings.safety, value);
    EXPECT_NEAR(setting.get(settings.frame, settings.safety), value, 1e-12 * std::abs(value)) << setting.key;
  }
  const std::string text = kBody + settings_toml(settings.frame, settings.safety) + kPart;
  const Result<Scene> scene = parse_scene(text, "saved", "saved.toml", {});
  ASSERT_TRUE(scene) << scene.error().message() << "\n" << text;
  for (const SettingInfo& setting : setting_table()) {
    const double written = setting.get(settings.frame, settings.safety);
    EXPECT_NEAR(setting.get(scene->settings, scene->safety), written, 1e-12 * std::abs(written))
        << setting.key;
  }
}

TEST(SettingTable, TheDefaultsLieInTheirRangesAndReadBack) {
  const UserSettings settings;
  for (const SettingInfo& setting : setting_table()) {
    const double value = setting.get(settings.frame, settings.safety);
    EXPECT_TRUE(std::isinf(value) || in_range(setting, value))
        << setting.section << "." << setting.key << " " << value;
  }
  const Result<Scene> scene =
      parse_scene(kBody + settings_toml(settings.frame, settings.safety) + kPart, "saved", "saved.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(settings_toml(scene->settings, scene->safety), settings_toml(settings.frame, settings.safety));
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
}  // namespace tactum
