#pragma once
/// Convex bodies that fall, hit and slide by themselves, moved by another engine in small steps: what the
/// tests compare our own motion with.

#include <vector>

#include "bench/shapes.h"
#include "tactum/dynamics/world.h"

namespace tactum::bench {

struct FreeMotion {
  World world;                ///< of convex parts of one piece, free or fixed
  std::vector<Shape> shapes;  ///< of its bodies, in their order
  double friction = 0.0;      ///< between all [-]
  double restitution = 0.0;   ///< ... of the speed [-]
};

/// Whether the engine was there when the program was built.
bool has_ode() noexcept;

/// Where the world's bodies are after `seconds`, in so many steps. Only where has_ode().
WorldState moved_by_ode(const FreeMotion& motion, double seconds, int steps);

}  // namespace tactum::bench
