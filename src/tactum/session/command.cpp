#include "tactum/session/command.h"

#include "tactum/haptics/setting_table.h"

namespace tactum::inline v0_1 {

void set_live(const SessionCommand& command, const SafetyLimits& device, FrameSettings& settings,
              SafetySettings& safety) noexcept {
  const std::span<const SettingInfo> table = setting_table();
  if (command.setting < 0 || command.setting >= static_cast<int>(table.size())) return;
  const SettingInfo& setting = table[static_cast<std::size_t>(command.setting)];
  if (!setting.live || !in_range(setting, command.value)) return;
  setting.set(settings, safety, command.value);
  settings.safety = tightened(device, safety);
}

void set_live(const SessionCommand& command, std::span<const SafetyLimits> devices, FrameSettings& settings,
              SafetySettings& safety) noexcept {
  with_every_hand(settings, [&](std::size_t hand) {
    if (hand < devices.size()) set_live(command, devices[hand], settings, safety);
  });
}

}  // namespace tactum::inline v0_1
