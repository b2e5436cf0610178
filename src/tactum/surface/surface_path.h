#pragma once
/// Whether two triangle surfaces stay apart all along a motion, turns included, not only at its ends. The
/// test takes triangles as they are, from either side: cones, orientation and closedness play no part, so it
/// holds for rims, thin walls and faces that are wound the wrong way, where minima of the distance
/// (surface_minima.h) may be missing.
///
///   boxes of faces    apart along an axis of either, over the whole motion          most end here
///   two triangles     apart along the normal of either, at the start and at the end
///                     else along the line of their nearest points, the motion halved where needed
///                     (path_search.h)
///
/// Triangles that touch or cross at the start already are no crossing of this motion, unless they touch and
/// come nearer. Noexcept, no allocation, the same bits for the same input. Cost: that of the pairs of
/// triangles that could touch in the motion, 0.1 us each as a rule.

#include <span>

#include "tactum/geometry/surface_tree.h"
#include "tactum/math/relative_motion.h"

namespace tactum::inline v0_1 {

/// How far a motion of two surfaces is free, and what ends it.
struct SurfacePath {
  double free = 1.0;                     ///< the fraction of the motion up to which nothing touches [-]
  int triangle_a = -1, triangle_b = -1;  ///< those which may touch first; -1: none do
  int tests = 0;                         ///< nodes and pairs of leaves looked at
  bool complete = true;                  ///< false: the tests ran out, and `free` proves nothing
  bool crossed = false;                  ///< triangles that were looked at cross at the start
};

/// Steps between surfaces that lie along one plane, as boards of a floor do, over which one of the two rides:
/// triangles that the plane keeps apart at the start, but for the height of the step, do not end a path.
struct RiddenSteps {
  std::span<const Vec3> normals;  ///< of the planes, unit, from B toward A, in A's frame
  double height_m = 0.0;          ///< of the highest step [m]
};

/// How far two surfaces stay apart, in at most `most` tests of nodes and pairs of leaves.
SurfacePath surface_path(const SurfaceTree& a, const SurfaceTree& b, const RelativeMotion& motion, int most,
                         const RiddenSteps& ridden = {}) noexcept;

}  // namespace tactum::inline v0_1
