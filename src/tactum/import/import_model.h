#pragma once
/// What URDF and MJCF have in common: links in a tree, each with a joint to the one it hangs on, shapes and
/// an inertia. SI units, radians; nothing is merged yet.

#include <optional>
#include <string>
#include <vector>

#include "tactum/import/xml_tree.h"
#include "tactum/math/pose.h"
#include "tactum/scene/body_description.h"

namespace tactum::inline v0_1 {

enum class ModelShapeKind { kBox, kBall, kCylinder, kCapsule, kEllipsoid, kMesh, kPlane };

struct ModelShape {
  ModelShapeKind kind = ModelShapeKind::kBall;
  /// Sides of a box or of a plane's rectangle, radii of an ellipsoid, radius and height of the others, the
  /// scale of a mesh [m]
  Vec3 size = Vec3::Ones();
  std::string mesh = {};  ///< the path of its file
  std::string name = {};  ///< may be empty
  Pose X_LS = {};         ///< its frame in the link's; that of the file's numbers for a mesh [m]
  bool felt = true;       ///< it can touch; else it only weighs
  bool weighs = true;     ///< it counts where inertia follows from shapes
  std::optional<double> friction = {};  ///< sliding [-]
  std::optional<double> mass_kg = {};   ///< instead of its density [kg]
  double density_kg_per_m3 = 1000.0;    ///< [kg/m^3]
  const XmlElement* at = nullptr;
};

/// Mass, and inertia about the centre of mass, in the link's frame.
struct ModelInertial {
  double mass_kg = 0.0;         ///< [kg]
  Vec3 center = Vec3::Zero();   ///< [m]
  Mat3 inertia = Mat3::Zero();  ///< [kg m^2]
};

struct ModelJoint {
  JointKind kind = JointKind::kFixed;
  Vec3 axis = Vec3::UnitX();            ///< of the link [-]
  Vec3 anchor = Vec3::Zero();           ///< in the link [m]
  double damping = 0.0;                 ///< [N m s/rad or N s/m]
  double friction = 0.0;                ///< [N m or N]
  double stiffness = 0.0;               ///< [N m/rad or N/m]
  double rest = 0.0;                    ///< from the pose of the file [rad or m]
  std::optional<Interval> limits = {};  ///< from the pose of the file [rad or m]
  const XmlElement* at = nullptr;       ///< null where the file has none
};

struct ModelLink {
  std::string name = {};
  int parent = -1;  ///< an earlier link; -1: the world
  Pose X_PL = {};   ///< in the parent's frame, as the file has it [m]
  ModelJoint joint = {};
  std::optional<ModelInertial> inertial = {};
  std::vector<ModelShape> shapes = {};
  const XmlElement* at = nullptr;
};

/// The compiler settings of MJCF that change masses.
struct MassRules {
  enum class FromShapes { kNever, kAlways, kWhereNoneIsStated };
  FromShapes from_shapes = FromShapes::kWhereNoneIsStated;
  double least_mass_kg = 0.0;                ///< of a body that moves [kg]
  double least_inertia_kg_m2 = 0.0;          ///< [kg m^2]
  bool balance = false;                      ///< moments that no body can have become their mean
  std::optional<double> total_mass_kg = {};  ///< all are scaled to it [kg]
};

struct ImportModel {
  std::string name = {};
  Vec3 gravity_W = Vec3::Zero();  ///< [m/s^2]
  std::vector<ModelLink> links = {};
  MassRules masses = {};
};

}  // namespace tactum::inline v0_1
