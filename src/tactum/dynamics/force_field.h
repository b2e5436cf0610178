#pragma once
/// A force field in the world and its load on a body: force and torque on sample points fixed in the body
/// [Iwata and Noma 1993; Gregory 2000, 7].
///
///     f = s sum_i w_i F(p_i)        t = s sum_i w_i (p_i - p_B) x F(p_i)       about the centre of mass
///
/// Weights are fractions of one body, so that a small part feels F itself, however many points it has. Where
/// force or torque exceed the field's limits the whole wrench is scaled down, so its line of action stays.

#include <limits>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "tactum/dynamics/analytic_field.h"
#include "tactum/dynamics/field_grid.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

struct FieldPoint {
  Vec3 p_B = Vec3::Zero();  ///< from the centre of mass [m]
  double weight = 0.0;      ///< [-]
};

struct ForceField {
  std::variant<DipoleField, WellField, VortexField, std::shared_ptr<const FieldGrid>> shape;
  Pose X_WF{};                                                         ///< where the field is [m]
  double scale = 1.0;                                                  ///< s [-]
  double largest_force_N = std::numeric_limits<double>::infinity();    ///< on a body [N]
  double largest_torque_Nm = std::numeric_limits<double>::infinity();  ///< about its centre of mass [N m]
};

/// The field at a place of the world, without scale and limits; axes of F.
FieldValue value_at(const ForceField& field, const Vec3& p_W) noexcept;

/// A bound on the steepness of the field, with its scale [N/m].
double steepest(const ForceField& field) noexcept;

/// The load of fields on a body.
struct FieldLoad {
  Wrench at_centre;  ///< of mass, world axes [N, N m]
  // How fast it may change: with a displacement of the body, and with a turn about the handle.
  double stiffness_N_per_m = 0.0;     ///< [N/m]
  double stiffness_Nm_per_rad = 0.0;  ///< [N m/rad]
};

/// Of all fields together on the points of a body. `p_BH`: the handle, the centre of its turns.
FieldLoad field_load(std::span<const ForceField> fields, std::span<const FieldPoint> points, const Pose& X_WB,
                     const Vec3& p_BH) noexcept;

/// `count` points of equal weight, one in all, spread evenly over a surface: each represents the same area.
/// The same surface gives the same points.
std::vector<FieldPoint> spread_over(const TriangleMesh& surface, int count);

}  // namespace tactum::inline v0_1
