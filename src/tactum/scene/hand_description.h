#pragma once
/// The tool of a scene's hand and its motion, as values in memory.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tactum/devices/hand_motion.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// The handle is on the hinge's axis, or at the centre of mass of a body without a hinge.
struct CentreGrasp {
  static constexpr const char* kKind = "centre";
};

/// The handle is beside the hinge's axis.
struct RimGrasp {
  static constexpr const char* kKind = "rim";
  double radius_m = 0.0;   ///< from the axis [m]
  double angle_rad = 0.0;  ///< about it, from the part's x axis [rad]
};

/// The handle is at a point of the part.
struct PointGrasp {
  static constexpr const char* kKind = "point";
  Vec3 pos_m = Vec3::Zero();  ///< in the part's frame [m]
};

/// A body is grasped from the start to the end.
struct BodyTool {
  std::string body = {};  ///< its name
  std::variant<CentreGrasp, RimGrasp, PointGrasp> grasp = {};
};

/// The hand begins empty; while the primary button is pressed it grasps the body that was nearest.
struct PickingTool {
  double pick_distance_m = Tool{}.pick_distance_m;  ///< how far from the handle [m]
  double centre_fraction = Tool{}.centre_fraction;  ///< see Tool::centre_fraction, 0 to 1 [-]
};

using ToolDescription = std::variant<BodyTool, PickingTool>;

/// The place of the device in the world. Its scale and clutch are settings.
struct WorkspaceDescription {
  std::optional<Vec3> pos_m = {};  ///< its middle; where the handle starts when absent [m]
  Mat3 R_WD = Mat3::Identity();    ///< its axes
};

/// The hand rests.
struct HoldStep {
  double hold_s = 0.0;  ///< [s]
  bool button = false;  ///< the primary button is pressed meanwhile
};

/// The handle turns with a line of the world.
struct TurnStep {
  double turn_rad = 0.0;              ///< [rad]
  double duration_s = 0.0;            ///< [s]
  std::optional<Vec3> axis = {};      ///< that of the grasped body's hinge when absent [-]
  std::optional<Vec3> anchor_m = {};  ///< a point of the line; of that hinge when absent [m]
  MotionProfile profile = MotionProfile::kMinimumJerk;
  bool button = false;  ///< the primary button is pressed meanwhile
};

/// The handle goes to a pose. A member that is absent leaves its value as it is; one of the two is given.
struct MoveStep {
  std::optional<Vec3> offset_m = {};    ///< from the handle's place at the start [m]
  std::optional<Mat3> rotation_W = {};  ///< from its orientation there, about the axes of the world
  double duration_s = 0.0;              ///< [s]
  MotionProfile profile = MotionProfile::kMinimumJerk;
  bool button = false;  ///< the primary button is pressed meanwhile
};

using HandStep = std::variant<HoldStep, TurnStep, MoveStep>;

struct TremorDescription {
  double translation_m = 0.0;  ///< at most 0.01 [m]
  double rotation_rad = 0.0;   ///< at most 20 degrees [rad]
  int seed = 1;                ///< [-]
};

/// A setting of one hand that is another than that of the whole scene. Those of `coupling`, `smoothing` and
/// `workspace` count instead of the scene's; with one of the coupling, the device chooses none for this hand.
/// Those of `safety` tighten the device's limits, and the scene's tighten them further.
struct OwnSetting {
  std::string setting = {};  ///< section and key of setting_table.h: "coupling.stiffness_N_per_m"
  double value = 0.0;        ///< in the unit of that table
};

/// The simulated hand and the device it was made for.
struct HandDescription {
  std::string device = "premium-1.5-6dof";  ///< preset of the simulated device (simulated_device.h)
  std::string grip = "medium";              ///< as in hand_model.h
  std::optional<TremorDescription> tremor = {};
  int repeat = 1;  ///< the steps are played so many times, 1 to 1000 [-]
  std::vector<HandStep> steps = {};
  /// Of coupling, smoothing, safety and workspace; of the first hand, of safety where there are several.
  std::vector<OwnSetting> own = {};
};

/// A hand beside the first: its tool, the place of its device, and its motion. All settings that it has not
/// of its own are those of the first, but for a coupling that the device chooses.
struct OtherHandDescription {
  ToolDescription tool = {};
  WorkspaceDescription workspace = {};
  HandDescription hand = {};
};

}  // namespace tactum::inline v0_1
