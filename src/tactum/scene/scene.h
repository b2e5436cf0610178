#pragma once
/// A scene: bodies, the grasped part and its grasp, the motion of the hand, and its goals. Made from a
/// description (build_scene.h) or a scene file (scene_file.h); constant while frames run.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tactum/devices/device.h"
#include "tactum/devices/hand_motion.h"
#include "tactum/dynamics/world.h"
#include "tactum/loop/safety.h"
#include "tactum/response/settings.h"
#include "tactum/scene/goal.h"

namespace tactum::inline v0_1 {

struct SettingsDescription;

/// The simulated device and the motion of a hand.
struct SceneHand {
  std::string device;                      ///< preset of the simulated device the motion was made for
  std::string grip;                        ///< hand model of the simulated hand
  std::shared_ptr<const HandMotion> hand;  ///< from the handle's pose on; may be null
  SafetySettings own_safety;      ///< of this hand alone, beside those of the scene; they tighten as well
  bool has_own_coupling = false;  ///< the scene states the coupling of this hand; no device chooses it
};

/// The inherited members are those of the first hand.
struct Scene : SceneHand {
  std::string name;         ///< "gears"
  std::string description;  ///< one line
  World world;
  FrameSettings settings;           ///< its safety limits are the device's, see `safety`
  bool coupling_by_device = false;  ///< a session chooses the coupling for its device and rate
  SafetySettings safety;  ///< limits that the scene tightens; the session applies them to the device's limits
  std::vector<SceneHand> other_hands;  ///< as in FrameSettings::other_hands
  std::vector<Goal> goals;
  /// The settings without those that a table [settings] of its file has changed; null where there is none.
  std::shared_ptr<const SettingsDescription> before_changes;
  std::vector<std::string> remarks;  ///< deviations from the description, as sentences
};

/// The origin of the frame P of the body's part, that of its file; the axes of B are P's [m].
inline Vec3 p_BP_of(const Body& body) { return -body.part->origin; }

/// The pose of a body's part as in its file: same axes as B, origin of the file.
inline Pose part_pose(const Body& body, const Pose& X_WB) { return {X_WB.R, X_WB * p_BP_of(body)}; }

/// How many frames the hand's motion lasts; 0 without one.
inline long frames_of_motion(const Scene& scene) {
  if (!scene.hand) return 0;
  return static_cast<long>(scene.hand->duration_s() / scene.settings.dt_s);
}

/// The limits of a hand's device, tightened by those that the scene gives this hand alone.
SafetyLimits device_limits(const Scene& scene, std::size_t hand, const DeviceInfo& info);

/// The scene's settings with those that depend on the device: the limits of safety, tightened by the scene's,
/// the device's properties for the passivity stage, and the coupling where the scene leaves that to the
/// device. A session does this by itself; a Simulation of the scene's world takes these.
FrameSettings settings_for(const Scene& scene, const DeviceInfo& info);
/// The same of a scene with several hands: the device of each.
FrameSettings settings_for(const Scene& scene, std::span<const DeviceInfo> infos);

}  // namespace tactum::inline v0_1
