#pragma once
/// Closed solids that are not convex, as watertight meshes.

#include <array>
#include <map>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/mesh/polygon_split.h"

namespace tactum::testing {

/// Cells of a grid with planes at the given coordinates, filled or not: cell (i, j, k) spans x[i]..x[i + 1]
/// and so on.
struct GridSolid {
  std::vector<double> x, y, z;
  std::vector<bool> filled;

  GridSolid(std::vector<double> at_x, std::vector<double> at_y, std::vector<double> at_z)
      : x(std::move(at_x)), y(std::move(at_y)), z(std::move(at_z)), filled(cells(), false) {}
  std::size_t cells() const { return (x.size() - 1) * (y.size() - 1) * (z.size() - 1); }
  std::size_t number(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * (y.size() - 1) + static_cast<std::size_t>(j)) * (x.size() - 1) +
           static_cast<std::size_t>(i);
  }
  bool at(int i, int j, int k) const {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i + 1 < static_cast<int>(x.size()) &&
                        j + 1 < static_cast<int>(y.size()) && k + 1 < static_cast<int>(z.size());
    return inside && filled[number(i, j, k)];
  }
  GridSolid& fill(int i, int j, int k) {
    filled[number(i, j, k)] = true;
    return *this;
  }
  double volume() const {
    double sum = 0.0;
    for_each([&](int i, int j, int k) { sum += (x[i + 1] - x[i]) * (y[j + 1] - y[j]) * (z[k + 1] - z[k]); });
    return sum;
  }

  /// Where two filled cells meet at an edge or corner only, the surface is no manifold.
  bool manifold() const {
    for (int i = 0; i <= static_cast<int>(x.size()) - 1; ++i)
      for (int j = 0; j <= static_cast<int>(y.size()) - 1; ++j)
        for (int k = 0; k <= static_cast<int>(z.size()) - 1; ++k)
          if (!simple_at(i, j, k)) return false;
    return true;
  }

  TriangleMesh mesh() const {
    TriangleMesh out;
    std::map<std::array<int, 3>, int> number_of;
    const auto corner = [&](std::array<int, 3> at) {
      const auto [known, fresh] = number_of.try_emplace(at, static_cast<int>(out.vertices.size()));
      if (fresh) out.vertices.emplace_back(x[at[0]], y[at[1]], z[at[2]]);
      return known->second;
    };
    for_each([&](int i, int j, int k) {
      const std::array<int, 3> cell{i, j, k};
      for (int axis = 0; axis < 3; ++axis)
        for (int up = 0; up < 2; ++up) {
          std::array<int, 3> next = cell;
          next[axis] += up ? 1 : -1;
          if (at(next[0], next[1], next[2])) continue;
          const int u = (axis + 1) % 3;
          const int v = (axis + 2) % 3;
          std::array<int, 4> quad{};
          for (int q = 0; q < 4; ++q) {
            std::array<int, 3> p = cell;
            p[axis] += up;
            p[u] += q == 1 || q == 2;
            p[v] += q >= 2;
            quad[up ? q : 3 - q] = corner(p);
          }
          out.triangles.push_back({quad[0], quad[1], quad[2]});
          out.triangles.push_back({quad[0], quad[2], quad[3]});
        }
    });
    return out;
  }

 private:
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int k = 0; k + 1 < static_cast<int>(z.size()); ++k)
      for (int j = 0; j + 1 < static_cast<int>(y.size()); ++j)
        for (int i = 0; i + 1 < static_cast<int>(x.size()); ++i)
          if (at(i, j, k)) visit(i, j, k);
  }
  /// Filled cells around a corner, and empty ones, are joined by faces.
  bool simple_at(int i, int j, int k) const {
    for (bool wanted : {true, false}) {
      std::array<bool, 8> member{};
      int first = -1;
      int count = 0;
      for (int c = 0; c < 8; ++c) {
        member[c] = at(i - (c & 1), j - (c >> 1 & 1), k - (c >> 2)) == wanted;
        if (!member[c]) continue;
        ++count;
        if (first < 0) first = c;
      }
      if (count == 0) continue;
      std::array<bool, 8> seen{};
      std::vector<int> open{first};
      seen[first] = true;
      int reached = 0;
      while (!open.empty()) {
        const int c = open.back();
        open.pop_back();
        ++reached;
        for (int bit : {1, 2, 4})
          if (const int next = c ^ bit; member[next] && !seen[next]) {
            seen[next] = true;
            open.push_back(next);
          }
      }
      if (reached != count) return false;
    }
    return true;
  }
};

/// A simple polygon, counter-clockwise, from z = low to high.
inline TriangleMesh extruded_mesh(const std::vector<Vec2>& outline, double low, double high) {
  TriangleMesh mesh;
  const int n = static_cast<int>(outline.size());
  std::vector<int> top;
  for (const double height : {low, high})
    for (const Vec2& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), height);
  for (int i = 0; i < n; ++i) top.push_back(n + i);
  detail::split_polygon(mesh.vertices, top, mesh.triangles);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = mesh.triangles[i];
    mesh.triangles.push_back({t[0] - n, t[2] - n, t[1] - n});
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  return mesh;
}

/// A star with `points` tips.
inline std::vector<Vec2> star(int points, double inner, double outer) {
  std::vector<Vec2> outline;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = kPi * i / points;
    outline.emplace_back((i % 2 ? inner : outer) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

}  // namespace tactum::testing
