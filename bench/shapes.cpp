#include "bench/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tactum/base/assert.h"
#include "tactum/base/random.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"

namespace tactum::bench {
namespace {

Shape box(const std::string& name, const Vec3& half_m) { return {name, make_box(half_m), half_m}; }

/// Points spread evenly over a sphere, put on an ellipsoid: all of them corners of the hull.
Polytope random_hull(int points, const Vec3& radii_m) {
  Random random(static_cast<std::uint64_t>(points));
  std::vector<Vec3> corners;
  for (int i = 0; i < points; ++i) {
    const double z = random.uniform(-1.0, 1.0);
    const double turn = random.uniform(0.0, 2.0 * kPi);
    const double across = std::sqrt(1.0 - z * z);
    corners.push_back(Vec3(across * std::cos(turn), across * std::sin(turn), z).cwiseProduct(radii_m));
  }
  Result<Polytope> hull = convex_hull(corners);
  TACTUM_DEMAND(hull);
  return std::move(*hull);
}

/// 10 * 4^s + 2 vertices after s subdivisions.
int subdivisions(int vertices) {
  int count = 0;
  for (int corners = 12; corners < vertices; corners = 4 * corners - 6) ++count;
  return count;
}

/// "sphere642" -> 642 when the name starts with `family`, else 0.
int number_after(const std::string& name, const std::string& family) {
  if (name.rfind(family, 0) != 0) return 0;
  const std::string digits = name.substr(family.size());
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return 0;
  return std::stoi(digits);
}

Shape make(const std::string& name) {
  if (name == "box") return box(name, {0.03, 0.04, 0.05});
  if (name == "plate") return box(name, {0.05, 0.05, 0.0005});
  if (name == "needle") return box(name, {0.001, 0.001, 0.05});
  if (const int n = number_after(name, "prism")) return {name, make_prism(n, 0.04, 0.06), {}};
  if (const int n = number_after(name, "sphere")) return {name, make_icosphere(subdivisions(n), 0.05), {}};
  if (const int n = number_after(name, "ellipsoid"))
    return {name, make_ellipsoid(subdivisions(n), {0.05, 0.035, 0.02}), {}};
  if (const int n = number_after(name, "spindle"))
    return {name, make_ellipsoid(subdivisions(n), {0.05, 0.001, 0.001}), {}};
  if (const int n = number_after(name, "hull")) return {name, random_hull(n, {0.05, 0.045, 0.04}), {}};
  TACTUM_DEMAND(false);  // the benches name only shapes of this file
  return {};
}

}  // namespace

const Shape& shape(const std::string& name) {
  static std::map<std::string, Shape> made;
  auto found = made.find(name);
  if (found == made.end()) found = made.emplace(name, make(name)).first;
  return found->second;
}

std::vector<std::string> names_of(std::span<const Pair> pairs) {
  std::vector<std::string> names;
  for (const Pair& pair : pairs) names.push_back(pair.name());
  return names;
}

bool wanted(const std::vector<std::string>& asked_for, const std::string& name) {
  return asked_for.empty() || std::find(asked_for.begin(), asked_for.end(), name) != asked_for.end();
}

}  // namespace tactum::bench
