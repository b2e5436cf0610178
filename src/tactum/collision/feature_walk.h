#pragma once
/// The outcome of a walk to the closest features of two pieces (vclip.h, support_distance.h).

#include <cstdint>
#include <limits>

namespace tactum::inline v0_1 {

enum class FeatureWalkEnd : std::uint8_t {
  kClosest,  ///< no Voronoi plane is violated
  kOverlap,  ///< an edge goes through a face
  kBehind,   ///< a vertex is behind the face in whose column it is: overlapping, or far beyond the piece
  kCircle,   ///< came back to a state: the nearest of the cycle is returned
  kBounded,  ///< out of steps
};

struct FeatureWalk {
  /// The signed distance of the pieces is above the returned one less this [m]. Infinite when the walk proves
  /// nothing: it did not end closest, or its points coincide and have no normal.
  double error_bound = std::numeric_limits<double>::infinity();
  FeatureWalkEnd end = FeatureWalkEnd::kBounded;
  int steps = 0;
};

}  // namespace tactum::inline v0_1
