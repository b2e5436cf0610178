#pragma once
/// How far from each other the bodies of a world start, and how deep inside each other: exact distances and
/// depths, taken once when a scene is loaded. For src/tactum/scene/*.cpp only.

#include <limits>
#include <vector>

#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

/// Two bodies that are inside each other.
struct BodyOverlap {
  int a = -1, b = -1;    ///< a < b
  double depth_m = 0.0;  ///< that they must move apart by, at least [m]
};

/// The pairs of bodies that could touch and overlap by more than `margin_m` where they start, the deepest
/// first. Left out are pairs that never touch: of bodies that do not move, and those of a joint. Bodies of
/// convex pieces are measured exactly; surfaces at a few thousand points of theirs, where they are closed.
/// Cost: a broad phase, and microseconds for each pair of near pieces; some 20 ms for two near surfaces.
std::vector<BodyOverlap> overlaps_at_start(const World& world, double margin_m);

/// The body that is nearest to another one.
struct NearestBody {
  int body = -1;                                                ///< -1: there is none
  double distance_m = std::numeric_limits<double>::infinity();  ///< of the surfaces, 0 where they cross [m]
};

/// The nearest of the bodies that `body` could touch. Branch and bound over boxes, then triangles.
NearestBody nearest_at_start(const World& world, int body);

/// The moving body whose box is nearest to a point.
NearestBody nearest_to(const World& world, const Vec3& p_W);

/// The box around a body where it starts [m].
Aabb box_at_start(const Body& body);

}  // namespace tactum::inline v0_1
