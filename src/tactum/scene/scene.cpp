#include "tactum/scene/scene.h"

#include "tactum/haptics/coupling_gains.h"

namespace tactum::inline v0_1 {

namespace {

/// Sets what depends on the device of a hand.
void set_device(const Scene& scene, const DeviceInfo& info, HandSettings& settings) {
  settings.safety = tightened(safety_limits(info), scene.safety);
  settings.port = port_settings(info);
  if (scene.coupling_by_device) settings.coupling = coupling_gains(info, 1.0 / scene.settings.dt_s).coupling;
}

}  // namespace

FrameSettings settings_for(const Scene& scene, const DeviceInfo& info) {
  return settings_for(scene, std::span<const DeviceInfo>(&info, 1));
}

FrameSettings settings_for(const Scene& scene, std::span<const DeviceInfo> infos) {
  FrameSettings settings = scene.settings;
  set_device(scene, infos.front(), settings);
  for (std::size_t h = 1; h < infos.size() && h <= settings.other_hands.size(); ++h)
    set_device(scene, infos[h], settings.other_hands[h - 1]);
  return settings;
}

}  // namespace tactum::inline v0_1
