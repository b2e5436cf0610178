#include "tactum/scene/scene.h"

#include "tactum/haptics/coupling_gains.h"

namespace tactum::inline v0_1 {

FrameSettings settings_for(const Scene& scene, const DeviceInfo& info) {
  const double rate_Hz = 1.0 / scene.settings.dt_s;
  FrameSettings settings = scene.settings;
  settings.safety = tightened(safety_limits(info), scene.safety);
  settings.port = port_settings(info);
  if (scene.coupling_by_device) settings.coupling = coupling_gains(info, rate_Hz).coupling;
  return settings;
}

}  // namespace tactum::inline v0_1
