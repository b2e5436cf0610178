#pragma once
/// What was measured of a device by its guided first touch (first_touch.h), in a file of its own, and its
/// use: a real device that has a profile is served with the measured damping and delay, so that the gains of
/// the coupling and the energy balance know them (coupling_gains.h).
///
///   $TACTUM_DEVICE_PROFILES, $XDG_CONFIG_HOME/tactum/devices or ~/.config/tactum/devices
///     force-dimension-sigma.7-10042.toml      name and serial of the device
///
///   device = "force-dimension sigma.7"
///   serial = "10042"
///   measured = "2026-11-28T10:00:00Z"
///   delay_s = 0.0021                  from a write to the motion that is read
///   damping_Ns_per_m = 0.45           the measured one less its error: what can be relied on
///   friction_N = 0.1                  for people; not used
///   mass_kg = 0.31
///   damping_Nms_per_rad = 0.0004      the same of turning, where the device turns its handle; absent, the
///   friction_Nm = 0.001               driver's own damping and inertia hold
///   inertia_kg_m2 = 0.00012

#include <memory>
#include <optional>
#include <string>

#include "tactum/devices/device.h"
#include "tactum/session/handle_response.h"

namespace tactum::inline v0_1 {

struct DeviceProfile {
  std::string device;                     ///< DeviceInfo::name
  std::string serial;                     ///< DeviceInfo::serial
  std::string measured;                   ///< date and time, UTC
  double delay_s = 0.0;                   ///< [s]
  double damping_Ns_per_m = 0.0;          ///< [N s/m]
  double friction_N = 0.0;                ///< [N]
  double mass_kg = 0.0;                   ///< [kg]
  std::optional<TurnResponse> turning{};  ///< its damping is the measured one less its error
};

/// Where the profile of this device is, or would be; empty when there is no home for it.
std::string profile_path(const DeviceInfo& info);

/// The profile of measured answers, with the present time.
DeviceProfile profile_of(const DeviceInfo& info, const HandleResponse& response,
                         const std::optional<TurnResponse>& turning = {});

/// Errors name the file, the key, and what was expected.
Result<DeviceProfile> read_profile(const std::string& path);
/// Makes the folder, too.
Result<void> write_profile(const std::string& path, const DeviceProfile& profile);

/// The abilities of a device with what its profile knows better: the damping, and the longer of both
/// delays, as some drivers measure theirs whenever they connect.
DeviceInfo with_profile(const DeviceInfo& info, const DeviceProfile& profile);

/// The device itself; a real one that has a profile tells the measured delay and damping from now on. A
/// profile that cannot be read, or is of another device, is an error.
Result<std::unique_ptr<Device>> profiled(std::unique_ptr<Device> device);

/// "with the delay and damping of FILE, measured 2026-..." for a device that has a profile; else empty.
std::string profile_sentence(const DeviceInfo& info);

}  // namespace tactum::inline v0_1
