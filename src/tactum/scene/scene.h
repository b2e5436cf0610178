#pragma once
/// A scene: bodies, which of them the hand holds and how, what the hand does with it, and what counts as
/// done. Made from a scene file (scene_file.h); constant while frames run.

#include <memory>
#include <string>
#include <vector>

#include "tactum/devices/hand_motion.h"
#include "tactum/dynamics/world.h"
#include "tactum/haptics/settings.h"
#include "tactum/loop/safety.h"
#include "tactum/scene/goal.h"

namespace tactum {

struct Scene {
  std::string name;         ///< "gears"
  std::string description;  ///< one line
  World world;
  std::vector<Vec3>
      p_BP;  ///< of each body: the origin of its part's own frame P (that of its file); axes of B are P's [m]
  std::vector<std::string> materials;  ///< of each body; empty when none is told
  FrameSettings settings;              ///< its safety limits are the device's, see `safety`
  bool coupling_by_device =
      false;              ///< the file tells no coupling: a session chooses it for its device and rate
  SafetySettings safety;  ///< what the scene tightens; the session applies it to the device's limits
  std::string device;     ///< preset of the simulated device the hand motion was made for
  std::string grip;       ///< hand model of the simulated hand
  std::shared_ptr<const HandMotion> hand;  ///< what the simulated hand does; it starts at the handle's pose
  std::vector<Goal> goals;
  std::vector<std::string> remarks;  ///< what was not taken as it stood, as sentences
};

/// The pose of a body's part as its file tells it: same axes as B, origin of the file.
inline Pose part_pose(const Scene& scene, std::size_t body, const Pose& X_WB) {
  return {X_WB.R, X_WB * scene.p_BP[body]};
}

/// How many frames the hand's motion lasts.
inline long frames_of_motion(const Scene& scene) {
  return static_cast<long>(scene.hand->duration_s() / scene.settings.dt_s);
}

}  // namespace tactum
