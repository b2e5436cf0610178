#pragma once
/// A scene as a plain value in memory: everything that a scene file can contain, with the same defaults. A
/// program fills one, or reads one from a file (scene_file.h); build_scene.h makes the scene from it.
///
///   SceneDescription scene;
///   scene.bodies.push_back({.name = "block", .part = BoxPart{{0.04, 0.03, 0.02}}});
///   scene.tool = BodyTool{.body = "block"};
///   Result<Scene> built = build_scene(scene);
///
/// Units are SI, angles radians. Errors name an item by the keys that scene files have for it, counted from
/// 0: "body[2].joint.axis"; numbers in them have the unit of that key.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactum/haptics/materials.h"
#include "tactum/response/settings.h"
#include "tactum/scene/body_description.h"
#include "tactum/scene/field_description.h"
#include "tactum/scene/goal_description.h"
#include "tactum/scene/hand_description.h"

namespace tactum::inline v0_1 {

/// The rotation by roll, pitch and yaw about fixed x, then y, then z, as in URDF [deg].
Mat3 rotation_rpy_deg(const Vec3& rpy_deg);

struct SourcePlace {
  int line = 1;
  int column = 1;
};

/// The source of a description.
struct SceneSource {
  std::string file;                           ///< as errors call it; empty: it was made in code
  std::vector<std::string> folders;           ///< in which meshes and fields are searched, in this order
  std::map<std::string, SourcePlace> places;  ///< in the file, of items by their path
  std::string text;                           ///< the file as it was read; empty: it was made in code
  std::string changes;                        ///< the file of change_settings(), as it was read

  /// "FILE:LINE:COLUMN" of an item, or of the table it would belong to; without a file the path itself.
  std::string where(const std::string& path) const;
  /// The name of a table in messages: "[body 3.joint]" of a file, else its path; "the scene" for the whole.
  std::string section(const std::string& path) const;
};

/// The settings of setting_table.h, and coefficients of pairs of materials. `frame` and `safety` count in
/// that extent only: the grasped part, the place of the device, coefficients by bodies and the device's own
/// limits are set when the scene is built and opened.
struct SettingsDescription {
  FrameSettings frame = {};
  SafetySettings safety = {};      ///< these only tighten the device's limits
  bool coupling_by_device = true;  ///< a session chooses frame.coupling for its device and rate
  std::vector<MaterialPair> friction = {};
  std::vector<MaterialPair> restitution = {};
  /// As the sections of the file have them, where a table [settings] has changed some; else null.
  std::shared_ptr<const SettingsDescription> before_changes = {};
};

struct SceneDescription {
  std::string name = {};          ///< "gears"; of a file, its stem
  std::string description = {};   ///< one line, for lists of scenes
  Vec3 gravity_W = Vec3::Zero();  ///< [m/s^2]
  std::vector<BodyDescription> bodies = {};
  std::vector<FieldDescription> fields = {};
  SettingsDescription settings = {};
  WorkspaceDescription workspace = {};
  std::optional<ToolDescription> tool = {};  ///< absent: nothing is grasped
  HandDescription hand = {};
  std::vector<OtherHandDescription> other_hands = {};  ///< of the second hand and all after it
  std::vector<GoalDescription> goals = {};
  SceneSource source = {};
};

}  // namespace tactum::inline v0_1
