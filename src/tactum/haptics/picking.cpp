#include "tactum/haptics/picking.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/dynamics/joint.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// How far a point of the body's frame is outside the piece: 0 inside.
double outside(const Polytope& piece, const Vec3& p) {
  double farthest = 0.0;
  for (const Polytope::Face& face : piece.faces)
    farthest = std::max(farthest, face.normal.dot(p) - face.offset);
  return farthest;
}

double outside(const Part& part, const Vec3& p) {
  if (part.is_surface()) {
    double least_sq = std::numeric_limits<double>::infinity();
    for (const Vec3& vertex : part.surface.vertices)
      least_sq = std::min(least_sq, (p - vertex).squaredNorm());
    return std::sqrt(least_sq);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Polytope& piece : part.pieces) least = std::min(least, outside(piece, p));
  return least;
}

/// The farthest that the part reaches from the axis of its hinge.
double radius_about_axis(const Body& body) {
  const Vec3 axis_B = rotated_back(body.X_WB.R, body.joint.axis_W);
  const Vec3 anchor_B = rotated_back(body.X_WB.R, body.joint.anchor_W - body.X_WB.p);
  double most_sq = 0.0;
  for (const Vec3& vertex : body.part->surface.vertices)
    most_sq = std::max(most_sq, (vertex - anchor_B).cross(axis_B).squaredNorm());
  return std::sqrt(most_sq);
}

}  // namespace

void take(const Body& body, const Pose& X_WB, double centre_fraction, const Pose& X_WH,
          Grasp& grasp) noexcept {
  grasp.X_BH = relative_pose(X_WB, X_WH);
  grasp.hold = Hold::kFirm;
  grasp.beside_W.setZero();
  grasp.left = 1.0;
  if (body.joint.kind != JointKind::kHinge) return;
  const Vec3 beside = beside_axis(body.joint, X_WH.p);
  const bool near_axis = beside.norm() <= centre_fraction * radius_about_axis(body);
  grasp.hold = near_axis ? Hold::kCentre : Hold::kRod;
  if (!near_axis) return;
  grasp.beside_W = beside;
  grasp.X_BH.p = rotated_back(X_WB.R, X_WH.p - beside - X_WB.p);
}

int nearest_body(const World& world, std::span<const Pose> X_WB, const Vec3& p_W,
                 double pick_distance_m) noexcept {
  int nearest = -1;
  double least = pick_distance_m;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves() || (p_W - X_WB[i].p).norm() > body.part->radius + least) continue;
    const double distance = outside(*body.part, rotated_back(X_WB[i].R, p_W - X_WB[i].p));
    if (distance > least || (distance == least && nearest >= 0)) continue;
    nearest = static_cast<int>(i);
    least = distance;
  }
  return nearest;
}

void pick_or_release(const World& world, std::span<const Pose> X_WB, const Tool& tool, const Pose& X_WH,
                     std::uint32_t buttons, Grasp& grasp) noexcept {
  const bool pressed = (buttons & 1u) != 0;
  const bool was_pressed = grasp.pressed;
  grasp.pressed = pressed;
  if (!tool.picks || pressed == was_pressed) return;
  if (!pressed) {
    grasp.body = -1;
    return;
  }
  const int body = nearest_body(world, X_WB, X_WH.p, tool.pick_distance_m);
  if (body < 0) return;
  take(world.bodies[Index(body)], X_WB[Index(body)], tool.centre_fraction, X_WH, grasp);
  grasp.body = body;
}

}  // namespace tactum::inline v0_1
