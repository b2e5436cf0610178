#include "tactum/geometry/primitives.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "tactum/base/assert.h"
#include "tactum/geometry/hull.h"

namespace tactum::inline v0_1 {
namespace {

Polytope hull_of(const std::vector<Vec3>& points) {
  Result<Polytope> hull = convex_hull(points);
  TACTUM_DEMAND(hull);  // the shapes below always have one
  return std::move(*hull);
}

std::vector<Vec3> icosphere_points(int subdivisions) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Vec3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& p : points) p.normalize();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [at, fresh] = middle.emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (fresh)
        points.push_back(
            (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = between(a, b);
      const int bc = between(b, c);
      const int ca = between(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  return points;
}

}  // namespace

Polytope make_box(const Vec3& half_m) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? half_m.x() : -half_m.x(), i & 2 ? half_m.y() : -half_m.y(),
                         i & 4 ? half_m.z() : -half_m.z());
  return hull_of(corners);
}

Polytope make_prism(int sides, double radius_m, double height_m) {
  std::vector<Vec3> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    for (double z : {-0.5 * height_m, 0.5 * height_m})
      corners.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), z);
  }
  return hull_of(corners);
}

Polytope make_icosphere(int subdivisions, double radius_m) {
  return make_ellipsoid(subdivisions, Vec3::Constant(radius_m));
}

Polytope make_ellipsoid(int subdivisions, const Vec3& radii_m) {
  std::vector<Vec3> points = icosphere_points(subdivisions);
  for (Vec3& p : points) p = p.cwiseProduct(radii_m);
  return hull_of(points);
}

}  // namespace tactum::inline v0_1
