#include "tactum/haptics/picking.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

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
  grasp.body = body;
  grasp.X_BH = relative_pose(X_WB[Index(body)], X_WH);
}

}  // namespace tactum::inline v0_1
