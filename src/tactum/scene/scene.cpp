#include "tactum/scene/scene.h"

#include "tactum/haptics/coupling_gains.h"

namespace tactum::inline v0_1 {

namespace {

const SceneHand& hand_of(const Scene& scene, std::size_t hand) {
  return hand == 0 || hand > scene.other_hands.size() ? scene : scene.other_hands[hand - 1];
}

/// Sets what depends on the device of a hand.
void set_device(const Scene& scene, std::size_t hand, const DeviceInfo& info, HandSettings& settings) {
  settings.safety = tightened(device_limits(scene, hand, info), scene.safety);
  settings.port = port_settings(info);
  if (scene.coupling_by_device && !hand_of(scene, hand).has_own_coupling)
    settings.coupling = coupling_gains(info, 1.0 / scene.settings.dt_s).coupling;
}

}  // namespace

SafetyLimits device_limits(const Scene& scene, std::size_t hand, const DeviceInfo& info) {
  return tightened(safety_limits(info), hand_of(scene, hand).own_safety);
}

FrameSettings settings_for(const Scene& scene, const DeviceInfo& info) {
  return settings_for(scene, std::span<const DeviceInfo>(&info, 1));
}

FrameSettings settings_for(const Scene& scene, std::span<const DeviceInfo> infos) {
  FrameSettings settings = scene.settings;
  set_device(scene, 0, infos.front(), settings);
  for (std::size_t h = 1; h < infos.size() && h <= settings.other_hands.size(); ++h)
    set_device(scene, h, infos[h], settings.other_hands[h - 1]);
  return settings;
}

}  // namespace tactum::inline v0_1
