#pragma once
/// Bodies, their joints, and their poses: World is constant while frames run, WorldState is what they change.
///
/// A body's frame B has its origin at the centre of mass and the axes of its part's file, so that a twist at
/// the origin is a twist at the centre of mass. V_WB is in world axes.

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/dynamics/force_field.h"
#include "tactum/geometry/part.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The joint between a body and the world, or another body (PairJoint).
enum class JointKind {
  kFree,    ///< none
  kFixed,   ///< the body never moves, or rides on the other one
  kHinge,   ///< turns about an axis through a point
  kSlider,  ///< slides along an axis, without turning
  kBall,    ///< turns about a point
};

/// Its position is how far the body has come from its pose at the start: the angle of a hinge, the
/// displacement of a slider; for a ball, the angle turned, about any axis. Numbers are torques for a hinge or
/// ball, forces for a slider.
struct Joint {
  JointKind kind = JointKind::kFree;
  Vec3 axis_W = Vec3::UnitZ();   ///< of a hinge or slider, unit, fixed in the world [-]
  Vec3 anchor_W = Vec3::Zero();  ///< a point of a hinge's axis; a ball's centre [m]
  double damping = 0.0;          ///< viscous, against the motion [N m s/rad or N s/m]
  double friction = 0.0;         ///< largest dry friction of a hinge or slider [N m or N]
  double stiffness = 0.0;        ///< of the spring of a hinge or slider [N m/rad or N/m]
  double rest = 0.0;             ///< the position at which its spring is at rest [rad or m]
  double lower = -std::numeric_limits<double>::infinity();  ///< least position of a hinge or slider [rad, m]
  double upper = std::numeric_limits<double>::infinity();   ///< largest position [rad or m]

  bool limited() const { return std::isfinite(lower) || std::isfinite(upper); }
};

/// A joint between two bodies that move. The body's own joint, to the world, is then none. Axis, anchor are
/// those at the start; they move with the parent. The position is how far the body has come from its pose at
/// the start as the parent sees it. Forces and torques of the joint act on both bodies, equal and opposite.
struct PairJoint {
  int body = -1;    ///< the one that is jointed; it has no other joint
  int parent = -1;  ///< ... to this one, which may be jointed itself
  Joint joint;      ///< not kFree; kFixed: the body rides on the parent
};

/// What acts on a body beside weight, contacts, its joint and the hand. All of it is stated at the centre of
/// mass; damping acts against the velocity there. A fixed body has none.
struct BodyLoad {
  Wrench constant;                   ///< force and torque that never change, axes of W [N, N m]
  double damping_Ns_per_m = 0.0;     ///< viscous, against the motion [N s/m]
  double damping_Nms_per_rad = 0.0;  ///< viscous, against the rotation about any axis [N m s/rad]

  bool damps() const { return damping_Ns_per_m > 0.0 || damping_Nms_per_rad > 0.0; }
  bool acts() const {  // one sum in place of eight comparisons: it is asked for every body in every frame
    return constant.f.cwiseAbs().sum() + constant.t.cwiseAbs().sum() + damping_Ns_per_m +
               damping_Nms_per_rad >
           0.0;
  }
};

/// A rigid body; its part's pieces are stated in B.
struct Body {
  std::string name;
  std::string material;  ///< by which pairs of bodies get friction and restitution; may be empty
  std::shared_ptr<const Part> part;
  double mass_kg = 0.0;           ///< [kg]
  Mat3 inertia_B = Mat3::Zero();  ///< about the centre of mass [kg m^2]
  Pose X_WB;                      ///< at the start [m]
  Twist V_WB;                     ///< at the start [m/s, rad/s]
  Joint joint;
  BodyLoad load;
  std::vector<FieldPoint> field_points;  ///< where force fields act while it is grasped
  int pair_joint = -1;       ///< index into World::pair_joints of the one whose body it is; -1: none
  int no_contact_with = -1;  ///< a body that it never touches, the one it is jointed to; -1: none

  bool moves() const { return joint.kind != JointKind::kFixed; }
};

/// The input of World::add. Mass and inertia follow from the part.
struct BodySpec {
  std::string name = {};                  ///< empty, or one that no other body of the world has
  std::shared_ptr<const Part> part = {};  ///< about its centre of mass: PartOptions::about_center_of_mass
  std::optional<double> density_kg_per_m3 = {};  ///< when absent, the density the part was made with [kg/m^3]
  std::optional<double> mass_kg = {};            ///< instead of a density [kg]
  Pose X_WP = {};             ///< at the start: the frame P of the part's input (its file, its points) [m]
  Twist V_WB = {};            ///< at the start, of the centre of mass, world axes [m/s, rad/s]
  Joint joint = {};           ///< its axis may have any length but zero
  BodyLoad load = {};         ///< finite, damping at least 0; none for a fixed body
  std::string material = {};  ///< see Body::material
  std::vector<FieldPoint> field_points = {};  ///< see Body::field_points
};

/// Constant while frames run.
struct World {
  /// Adds a body and returns its index. An error states why there can be no such body: no part, a part that
  /// is not about its centre of mass, a mass or density that is not positive (or both), a pose or velocity
  /// that is not finite, an axis of length zero, limits that leave out the pose at the start, a bad load, a
  /// name that is taken. The world is then unchanged. Cost: linear in the number of bodies.
  Result<int> add(const BodySpec& spec);

  /// Joins a free body to another one by `joint`, whose axis and anchor are given in the world as the bodies
  /// stand at the start. With a fixed parent it becomes the body's joint to the world. Without `contact` the
  /// two never touch each other. An error states why there can be no such joint: no such bodies, a body
  /// joined to itself or to one that hangs on it, a body that has a joint, a joint that is none, or one that
  /// add() would refuse. The world is then unchanged. Cost: linear in the number of bodies.
  Result<void> join(int body, int parent, const Joint& joint, bool contact = false);

  /// The joint of a body, to the world or to another body.
  const Joint& joint_of(int body) const {
    const Body& what = bodies[static_cast<std::size_t>(body)];
    return what.pair_joint < 0 ? what.joint : pair_joints[static_cast<std::size_t>(what.pair_joint)].joint;
  }

  std::vector<Body> bodies;
  std::vector<PairJoint> pair_joints;  ///< joints between bodies, that of a parent before those on it
  Vec3 gravity_W = Vec3::Zero();       ///< [m/s^2]
  std::vector<ForceField> fields;      ///< felt by the grasped part
};

/// The position of a body's joint (see Joint), now and one step before. A hinge is followed over full turns,
/// which its pose alone does not tell.
struct JointPosition {
  double now = 0.0, before = 0.0;  ///< [rad or m]
};

/// The state that frames change. One entry per body of the World.
struct WorldState {
  std::vector<Pose> X_WB;
  std::vector<Twist> V_WB;
  std::vector<JointPosition> joints;
};

/// Poses and velocities as the world starts.
WorldState initial_state(const World& world);

/// Angle about the hinge's axis of a turn from one orientation to another, in (-pi, pi] [rad].
double hinge_angle(const Joint& hinge, const Mat3& R_start, const Mat3& R) noexcept;

/// The position of a joint to the world with the body at X_WB, from X_start; a hinge's in (-pi, pi]
/// [rad or m].
double joint_position(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept;

/// Angle by which a hinged body has turned from its pose at the start, in (-pi, pi] [rad].
double hinge_angle(const Body& body, const Pose& X_WB);

/// The position of the body's joint (see Joint), a hinge's in (-pi, pi]; 0 for a free or fixed body
/// [rad or m].
double joint_position(const Body& body, const Pose& X_WB);

/// The pose of a pair joint's body as its parent sees it, with the parent taken back to where it was at the
/// start: there the joint is one to the world.
Pose pose_by_parent(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// The position of a pair joint, a hinge's in (-pi, pi]; 0 where the body rides [rad or m].
double pair_position(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// Moves the positions of all joints on to the present poses. Between two calls a hinge may turn by less than
/// half a turn. Cost: an arc tangent for each hinge.
void follow_joints(const World& world, WorldState& state) noexcept;

}  // namespace tactum::inline v0_1
