#pragma once
/// Surfaces with everything a cone can be: made by rule, for the tests and the benchmark of surface against
/// surface.

#include <cmath>

#include "tactum/base/random.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::testing {

/// A torus about z: `around` by `across` corners, radii of the ring and of the tube [m].
inline TriangleMesh torus(int around, int across, double ring, double tube) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < across; ++k) {
      const double u = 2.0 * kPi * i / around;
      const double v = 2.0 * kPi * k / across;
      const double r = ring + tube * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < across; ++k) {
      const int a = i * across + k;
      const int b = (i + 1) % around * across + k;
      const int c = (i + 1) % around * across + (k + 1) % across;
      const int d = i * across + (k + 1) % across;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

struct Thread {
  double radius = 0.008;  ///< mean [m]
  double depth = 0.001;   ///< from root to crest [m]
  double pitch = 0.002;   ///< [m]
  double offset = 0.0;    ///< added to the radius: play [m]
  int turns = 4;
  int segments = 48;   ///< a turn
  int steps = 8;       ///< a pitch
  bool inner = false;  ///< of a nut: outside is toward the axis
};

/// The flanks of a screw thread about z, open at both ends: flat crests and roots, slanted flanks.
inline TriangleMesh thread_mesh(const Thread& thread) {
  TriangleMesh mesh;
  const int rows = (thread.turns + 1) * thread.steps + 1;
  const auto profile = [&](int step) {  // -1 at the root, 1 at the crest
    const double x = static_cast<double>(step % thread.steps) / thread.steps;
    return std::clamp(3.0 - 8.0 * std::abs(x - 0.5), -1.0, 1.0);
  };
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < thread.segments; ++k) {
      const double turn = static_cast<double>(k) / thread.segments;
      const double r = thread.radius + thread.offset + 0.5 * thread.depth * profile(row);
      const double z = thread.pitch * (static_cast<double>(row) / thread.steps + turn);
      mesh.vertices.push_back({r * std::cos(2.0 * kPi * turn), r * std::sin(2.0 * kPi * turn), z});
    }
  }
  // A turn further on a corner is the one a pitch higher.
  const auto at = [&](int row, int k) {
    return (row + k / thread.segments * thread.steps) * thread.segments + k % thread.segments;
  };
  for (int row = 0; row + 1 < rows; ++row) {
    for (int k = 0; k < thread.segments; ++k) {
      const int wrapped = (k + 1) / thread.segments * thread.steps;
      if (row + 1 + wrapped >= rows) continue;
      const int a = at(row, k);
      const int b = at(row, k + 1);
      const int c = at(row + 1, k + 1);
      const int d = at(row + 1, k);
      if (thread.inner) {
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  }
  return mesh;
}

/// A square sheet of cells, bumpy by `height`, seen from above; open all around.
inline TriangleMesh bumpy_sheet(Random& random, int cells, double side, double height) {
  TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int k = 0; k <= cells; ++k) {
      mesh.vertices.push_back({side * (static_cast<double>(i) / cells - 0.5),
                               side * (static_cast<double>(k) / cells - 0.5),
                               random.uniform(-height, height)});
    }
  }
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      const int a = i * (cells + 1) + k;
      const int b = a + cells + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

/// Every corner moved along its direction from the origin by up to the fraction `share` of its distance.
inline TriangleMesh roughened(TriangleMesh mesh, Random& random, double share) {
  for (Vec3& v : mesh.vertices) v *= 1.0 + random.uniform(-share, share);
  return mesh;
}

/// Two meshes as one.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

}  // namespace tactum::testing
