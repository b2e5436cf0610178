/// Distance and closest points of two convex parts: a box and an octahedron above it.

#include <tactum/tactum.h>

#include <cmath>
#include <cstdio>

int main() {
  using namespace tactum;
  const Result<Polytope> box = convex_hull(make_box({0.05, 0.05, 0.05}).vertices);
  const Result<Polytope> octahedron =
      convex_hull({{0.02, 0, 0}, {-0.02, 0, 0}, {0, 0.02, 0}, {0, -0.02, 0}, {0, 0, 0.02}, {0, 0, -0.02}});
  if (!box || !octahedron) return 1;  // points that span no solid

  PairCache cache{};  // features of the last query: along a motion the next one starts there
  for (int step = 0; step < 3; ++step) {
    Pose X_AB;  // the octahedron in the frame of the box
    X_AB.p = {0.01, 0.02, 0.10 - 0.02 * step};
    const PairDistance found = closest_features(*box, *octahedron, X_AB, cache);
    std::printf("distance %.6f m, at (%.3f %.3f %.3f) of the box\n", found.distance, found.p_a.x(),
                found.p_a.y(), found.p_a.z());
    if (std::abs(found.distance - (0.03 - 0.02 * step)) > 1e-9) return 1;  // negative: they overlap
  }
  return 0;
}
