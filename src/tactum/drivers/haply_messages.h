#pragma once
/// The messages of Haply's Inverse Service, version 3, as far as they are used here: one of ours, in JSON, is
/// answered by one of the service, with the state of every device.
///
/// Axes are the service's: x right, y forward, z up, metres and newtons, where the basis is "XYZ".

#include <array>
#include <cstdint>
#include <string>

#include "tactum/base/result.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// What is set for the session before a force is sent: the origin in the middle of the workspace, and the
/// filters between a command and the motors as the maker delivers them.
inline constexpr const char* kHaplyPreset = "arm_front_centered";
inline constexpr const char* kHaplyBasis = "XYZ";
inline constexpr double kHaplyGateGain = 0.3;  ///< of the force, while the service finds that it oscillates
inline constexpr double kHaplyDamping = 0.0;   ///< the service's own [N s/m]

/// An Inverse3 or its like, as the service lists it.
struct HaplyDeviceConfig {
  std::string id{};               ///< "049D"
  std::string type{};             ///< "inverse3"
  std::string others{};           ///< ids of the further ones, for an error
  std::string grip{};             ///< id of a VerseGrip that tells its orientation; empty: there is none
  std::string preset{}, basis{};  ///< empty: the message does not tell
  double gate_gain = -1.0, damping = -1.0;  ///< negative: the message does not tell
};

/// What one answer tells of a device and its grip.
struct HaplyDeviceState {
  Vec3 position = Vec3::Zero();   ///< [m]
  Vec3 velocity = Vec3::Zero();   ///< [m/s]
  Vec3 delivered = Vec3::Zero();  ///< what the service sends to the motors [N]
  bool calibrated = false, ready = false, powered = false;
  bool has_turn = false;  ///< the grip tells its orientation
  std::array<double, 4> turn_wxyz{1, 0, 0, 0};
  std::uint32_t buttons = 0;  ///< bit 0 is `a`, or the one of a grip that has one
};

/// The device of that id, or the first when `id` is empty, of a message that tells the configuration too.
Result<HaplyDeviceConfig> haply_config(const std::string& message, const std::string& id);

/// False when the message is none, or tells nothing of the device.
bool haply_state(const std::string& message, const HaplyDeviceConfig& device, HaplyDeviceState& state);

/// The version of the answer to GET /version: "3.5.2"; empty when it tells none.
std::string haply_version(const std::string& answer);

/// Whether the service understands a force as `vector`; before 3.5 it was `values`. One of unknown version is
/// taken for a new one.
bool haply_takes_vector(const std::string& version);

/// A force for this tick.
std::string haply_force_message(const std::string& id, bool as_vector, const Vec3& F);
/// The same with what is set for the session (above), and our name for the service's own programs.
std::string haply_first_message(const std::string& id, bool as_vector);
/// Asks for the configuration, with a force of zero.
std::string haply_config_request(const std::string& id, bool as_vector);

}  // namespace tactum::inline v0_1
