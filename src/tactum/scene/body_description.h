#pragma once
/// The bodies of a scene, as values in memory. Poses are those of the part's own frame P (that of its mesh
/// file, or as drawn in parts/generated_parts.h and its neighbours), not of the centre of mass.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tactum/dynamics/world.h"
#include "tactum/math/spatial.h"
#include "tactum/scene/part_description.h"

namespace tactum::inline v0_1 {

/// From a least to a largest value.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

struct FreeJoint {
  static constexpr const char* kKind = "free";
};

/// Of every joint but the free one: the body that it is to.
struct JointParent {
  std::string parent = {};  ///< the name of another body of the scene; empty: the world
  bool contact = false;     ///< the two may touch each other; only with a parent
};

struct FixedJoint {
  static constexpr const char* kKind = "fixed";
  JointParent to = {};
};

struct HingeJoint {
  static constexpr const char* kKind = "hinge";
  Vec3 axis = Vec3::Zero();                 ///< axes of P, of any length but zero [-]
  Vec3 anchor_m = Vec3::Zero();             ///< a point of the axis, in P [m]
  double damping_Nms = 0.0;                 ///< viscous [N m s/rad]
  double friction_Nm = 0.0;                 ///< largest dry friction [N m]
  double stiffness_Nm_per_rad = 0.0;        ///< of a spring [N m/rad]
  double rest_rad = 0.0;                    ///< the angle it pulls to [rad]
  std::optional<Interval> limits_rad = {};  ///< about the pose at the start, which lies within [rad]
  JointParent to = {};
};

struct SliderJoint {
  static constexpr const char* kKind = "slider";
  Vec3 axis = Vec3::Zero();               ///< axes of P, of any length but zero [-]
  double damping_Ns_per_m = 0.0;          ///< viscous [N s/m]
  double friction_N = 0.0;                ///< largest dry friction [N]
  double stiffness_N_per_m = 0.0;         ///< of a spring [N/m]
  double rest_m = 0.0;                    ///< the position it pulls to [m]
  std::optional<Interval> limits_m = {};  ///< about the pose at the start, which lies within [m]
  JointParent to = {};
};

struct BallJoint {
  static constexpr const char* kKind = "ball";
  Vec3 anchor_m = Vec3::Zero();          ///< its centre, in P [m]
  double damping_Nms = 0.0;              ///< viscous [N m s/rad]
  std::optional<double> swing_rad = {};  ///< the largest angle it turns by; no limit when absent [rad]
  JointParent to = {};
};

using JointDescription = std::variant<FreeJoint, FixedJoint, HingeJoint, SliderJoint, BallJoint>;

/// The body that a joint is to; of a free body none.
inline JointParent parent_of(const JointDescription& joint) {
  return std::visit(
      [](const auto& kind) {
        if constexpr (requires { kind.to; }) return kind.to;
        return JointParent{};
      },
      joint);
}

/// One of several shapes of a body.
struct ComponentDescription {
  std::string name = {};                     ///< for components placed on it; may be empty
  std::optional<PartDescription> part = {};  ///< it must come to convex pieces
  std::string on = {};                       ///< an earlier component, in whose frame the pose is; empty: P
  Pose X_OC = {};                            ///< the component's frame in that one [m]
};

/// A point at which force fields act on the body.
struct SamplePoint {
  Vec3 pos_m = Vec3::Zero();          ///< in P [m]
  std::optional<double> weight = {};  ///< 1 / the number of points when absent [-]
};

/// Where force fields act on a body; with neither, on points that the program spreads.
struct FieldPointsDescription {
  std::optional<int> count = {};         ///< either so many points, spread over the surface [-]
  std::vector<SamplePoint> listed = {};  ///< ... or these
};

/// Mass, centre of mass and inertia as they are stated, in place of those that follow from the shape: of a
/// body whose shape is a simpler one than that of the thing, or whose components overlap.
struct InertialDescription {
  double mass_kg = 0.0;                ///< above 0 [kg]
  Vec3 center_m = Vec3::Zero();        ///< of mass, in P [m]
  Vec3 inertia_kg_m2 = Vec3::Zero();   ///< xx, yy, zz about the centre of mass, axes of P [kg m^2]
  Vec3 products_kg_m2 = Vec3::Zero();  ///< the elements xy, xz, yz of the same tensor [kg m^2]
  Mat3 tensor() const {
    Mat3 tensor = inertia_kg_m2.asDiagonal();
    tensor(0, 1) = tensor(1, 0) = products_kg_m2.x();
    tensor(0, 2) = tensor(2, 0) = products_kg_m2.y();
    tensor(1, 2) = tensor(2, 1) = products_kg_m2.z();
    return tensor;
  }
};

/// The mass of a body where no density gives it; at most one of the two is there.
struct MassDescription {
  std::optional<double> mass_kg = {};                ///< distributed as the shape has it [kg]
  std::optional<InertialDescription> inertial = {};  ///< ... or stated with all that follows
};

struct BodyDescription {
  std::string name = {};                              ///< one of its own
  std::optional<PartDescription> part = {};           ///< either this
  std::vector<ComponentDescription> components = {};  ///< ... or these
  std::string on = {};        ///< an earlier body, in whose part's frame the pose is; empty: the world
  Pose X_OP = {};             ///< the part's frame in that one, at the start [m]
  Twist V_WB = {};            ///< at the start, of the centre of mass, axes of the world [m/s, rad/s]
  MassDescription mass = {};  ///< either this
  std::optional<double> density_kg_per_m3 = {};  ///< ... or this; 1000 when both are absent [kg/m^3]
  JointDescription joint = FreeJoint{};
  BodyLoad load = {};         ///< at the centre of mass; none for a fixed body
  std::string material = {};  ///< for friction and restitution; may be empty
  FieldPointsDescription field_points = {};
};

}  // namespace tactum::inline v0_1
