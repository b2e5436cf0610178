#pragma once
/// Meshes the tests build for themselves.

#include <cmath>
#include <map>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::testing {

/// A box about the origin: 8 corners, 12 triangles, outward.
inline TriangleMesh box_mesh(const Vec3& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A unit sphere: an octahedron whose triangles are quartered `levels` times; 8 * 4^levels triangles.
inline TriangleMesh icosphere(int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(mesh.vertices.size()));
      if (fresh) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const int ab = middle(t[0], t[1]);
      const int bc = middle(t[1], t[2]);
      const int ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {Triangle{t[0], ab, ca}, Triangle{ab, t[1], bc}, Triangle{ca, bc, t[2]},
                                 Triangle{ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// A prism over a regular polygon of `corners` corners and radius `radius`, from z = -half to half.
inline TriangleMesh prism(int corners, double radius, double half) {
  TriangleMesh mesh;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * kPi * i / corners;
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), -half});
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), half});
  }
  for (int i = 0; i < corners; ++i) {
    const int a = 2 * i;
    const int b = 2 * ((i + 1) % corners);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    if (i < 2) continue;
    mesh.triangles.push_back({0, a, a - 2});
    mesh.triangles.push_back({1, a - 1, a + 1});
  }
  return mesh;
}

/// A flat sheet of cells x cells squares about the origin, in the plane z = 0, facing up.
inline TriangleMesh sheet(int cells, double half) {
  TriangleMesh mesh;
  for (int x = 0; x <= cells; ++x)
    for (int y = 0; y <= cells; ++y)
      mesh.vertices.emplace_back(half * (2.0 * x / cells - 1.0), half * (2.0 * y / cells - 1.0), 0.0);
  for (int x = 0; x < cells; ++x)
    for (int y = 0; y < cells; ++y) {
      const int a = x * (cells + 1) + y;
      mesh.triangles.push_back({a, a + cells + 1, a + cells + 2});
      mesh.triangles.push_back({a, a + cells + 2, a + 1});
    }
  return mesh;
}

inline TriangleMesh transformed(TriangleMesh mesh, const Mat3& R, const Vec3& p) {
  for (Vec3& v : mesh.vertices) v = R * v + p;
  return mesh;
}

}  // namespace tactum::testing
