/// Clearance of two triangle surfaces of any shape: two L-shaped profiles, one above the other.

#include <tactum/tactum.h>

#include <cmath>
#include <cstdio>

namespace {

/// A profile of 40 mm by 40 mm by 10 mm: two walls that meet in a corner.
tactum::TriangleMesh profile() {
  tactum::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0},    {0.04, 0, 0},    {0.04, 0.01, 0},    {0, 0.01, 0},
                   {0, 0, 0.04}, {0.04, 0, 0.04}, {0.04, 0.01, 0.04}, {0, 0.01, 0.04}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 7}, {0, 7, 4}};
  return mesh;
}

}  // namespace

int main() {
  using namespace tactum;
  const Surface a(profile()), b(profile());  // trees over the triangles: made once
  SurfacePairCache cache;                    // the nearest triangles of the last query
  for (const double gap : {0.020, 0.010, 0.005}) {
    const Pose X_AB{Mat3::Identity(), {0.005, 0.0, gap}};
    const SurfaceDistance found = surface_distance(a, b, X_AB, cache);
    std::printf("clearance %.4f m, triangles %d and %d\n", found.distance, found.triangle_a,
                found.triangle_b);
    // The walls at x = 0 of the two profiles stand 5 mm apart.
    if (std::abs(found.distance - 0.005) > 1e-12) return 1;
  }
  return 0;
}
