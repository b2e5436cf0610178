#include "tactum/dynamics/force_field.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

using GridPointer = std::shared_ptr<const FieldGrid>;

FieldValue value_at(const GridPointer& grid, const Vec3& p) noexcept { return grid->at(p); }
double steepest(const GridPointer& grid) noexcept { return grid->steepest(); }

/// The load of one field, limited.
template <class Shape>
FieldLoad load_of(const Shape& shape, const ForceField& field, std::span<const FieldPoint> points,
                  const Pose& X_WB, const Vec3& p_BH) noexcept {
  const Pose X_FB = relative_pose(field.X_WF, X_WB);
  FieldLoad load;
  Wrench sum;  // axes of F
  Mat3 translation = Mat3::Zero();
  Mat3 turn = Mat3::Zero();
  for (const FieldPoint& point : points) {
    const Vec3 r_F = rotated(X_FB.R, point.p_B);
    const FieldValue value = value_at(shape, X_FB.p + r_F);
    const Vec3 force = point.weight * value.force;
    sum.f += force;
    sum.t += r_F.cross(force);
    // A turn about the handle moves the point by its lever, and the torque of its force changes by the same
    // factor.
    const Mat3 steep = std::abs(point.weight) * value.gradient.cwiseAbs();
    const double lever_sq = (point.p_B - p_BH).squaredNorm();
    translation += steep;
    turn += lever_sq * steep;
    load.stiffness_Nm_per_rad += std::sqrt(force.squaredNorm() * lever_sq);
  }
  load.stiffness_N_per_m = steepness(translation);
  load.stiffness_Nm_per_rad += steepness(turn);
  const double f = std::abs(field.scale) * sum.f.norm();
  const double t = std::abs(field.scale) * sum.t.norm();
  double share = 1.0;
  if (f > field.largest_force_N) share = field.largest_force_N / f;
  if (t * share > field.largest_torque_Nm) share = field.largest_torque_Nm / t;
  load.at_centre = rotated(field.X_WF.R, sum * (field.scale * share));
  load.stiffness_N_per_m *= std::abs(field.scale) * share;
  load.stiffness_Nm_per_rad *= std::abs(field.scale) * share;
  return load;
}

}  // namespace

FieldValue value_at(const ForceField& field, const Vec3& p_W) noexcept {
  const Vec3 p_F = rotated_back(field.X_WF.R, p_W - field.X_WF.p);
  return std::visit([&](const auto& shape) { return value_at(shape, p_F); }, field.shape);
}

double steepest(const ForceField& field) noexcept {
  return std::abs(field.scale) * std::visit([](const auto& shape) { return steepest(shape); }, field.shape);
}

FieldLoad field_load(std::span<const ForceField> fields, std::span<const FieldPoint> points, const Pose& X_WB,
                     const Vec3& p_BH) noexcept {
  FieldLoad all;
  for (const ForceField& field : fields) {
    const FieldLoad load =
        std::visit([&](const auto& shape) { return load_of(shape, field, points, X_WB, p_BH); }, field.shape);
    all.at_centre = all.at_centre + load.at_centre;
    all.stiffness_N_per_m += load.stiffness_N_per_m;
    all.stiffness_Nm_per_rad += load.stiffness_Nm_per_rad;
  }
  return all;
}

std::vector<FieldPoint> spread_over(const TriangleMesh& surface, int count) {
  const auto corner = [&](const Triangle& t, int i) -> const Vec3& {
    return surface.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])];
  };
  std::vector<double> area_up_to;
  double area = 0.0;
  for (const Triangle& t : surface.triangles) {
    area += 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    area_up_to.push_back(area);
  }
  std::vector<FieldPoint> points;
  if (!(area > 0.0)) return points;
  // Equal steps of area; within a triangle the two-dimensional golden sequence.
  constexpr double kGolden = 1.32471795724474602596;  // g^3 = g + 1
  double u = 0.5, v = 0.5;
  for (int i = 0; i < count; ++i) {
    const double place = area * (i + 0.5) / count;
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, place);
    const Triangle& t = surface.triangles[static_cast<std::size_t>(found - area_up_to.begin())];
    u = std::fmod(u + 1.0 / kGolden, 1.0);
    v = std::fmod(v + 1.0 / (kGolden * kGolden), 1.0);
    const double a = u + v > 1.0 ? 1.0 - u : u;
    const double b = u + v > 1.0 ? 1.0 - v : v;
    points.push_back(
        {corner(t, 0) + a * (corner(t, 1) - corner(t, 0)) + b * (corner(t, 2) - corner(t, 0)), 1.0 / count});
  }
  return points;
}

}  // namespace tactum::inline v0_1
