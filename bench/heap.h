#pragma once
/// A heap: jacks of twenty convex pieces each that fall into a bin, and a jack in the hand that is led down
/// among them, drawn through them and out again. Made in code: the world of the scheduling tests and of
/// `tactum-bench schedule`, far more near pairs than a frame may check.
///
///        []            a core of two half cubes, six arms of three pieces,
///     [][][][]         the last of each tapered
///        []

#include <cstdint>

#include "tactum/base/result.h"
#include "tactum/scene/scene.h"

namespace tactum::bench {

struct HeapOptions {
  int bodies = 200;        ///< that fall [-]
  std::uint64_t seed = 1;  ///< of how they are turned before they fall
  double width_m = 0.20;   ///< of the bin, inside, both ways [m]
  double calm_s = 1.0;     ///< how long the hand rests before it goes down, and after it has come back [s]
};

/// The jack, about its centre of mass.
Result<Part> make_jack(double width_m, double arm_m);

/// Body 0 is grasped; then come the bin's floor and four walls, then the jacks.
Result<Scene> heap_scene(const HeapOptions& options = {});

/// How many of a heap's bodies come before its jacks.
inline constexpr int kHeapFixtures = 6;

}  // namespace tactum::bench
