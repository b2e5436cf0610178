#pragma once
/// Convex bodies that fall, hit and slide by themselves, moved by another engine in small steps: a reference
/// for our own motion in tests.

#include <vector>

#include "bench/shapes.h"
#include "tactum/dynamics/world.h"

namespace tactum::bench {

struct FreeMotion {
  World world;                ///< of convex parts of one piece, free or fixed
  std::vector<Shape> shapes;  ///< of its bodies, in their order
  double friction = 0.0;      ///< between all [-]
  double restitution = 0.0;   ///< ... fraction of the speed that is left [-]
};

/// Whether the engine was there when the program was built.
bool has_ode() noexcept;

/// The poses of the world's bodies after `seconds`, in so many steps. Only where has_ode().
WorldState moved_by_ode(const FreeMotion& motion, double seconds, int steps);

}  // namespace tactum::bench
