#pragma once
/// The convex pieces of the benches, all of about 0.1 m, from a box to 40 962 vertices.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactum/geometry/polytope.h"

namespace tactum::bench {

struct Shape {
  std::string name;
  Polytope polytope;
  std::optional<Vec3> box_half_m;  ///< for engines that know boxes [m]
  int vertices() const { return static_cast<int>(polytope.vertices.size()); }
};

/// Made when it is first asked for, and kept:
///   box          60 x 80 x 100 mm            prism16, prism64   regular, 80 mm across, 60 mm high
///   plate        100 x 100 x 1 mm            needle             2 x 2 x 100 mm
///   sphereN      icosphere of N vertices, 12 to 40 962          hullN   N random points of an ellipsoid
///   ellipsoidN   the icosphere, 100 x 70 x 40 mm                spindleN   ... 100 x 2 x 2 mm
const Shape& shape(const std::string& name);

/// Two shapes by name.
struct Pair {
  std::string a, b;
  std::string name() const { return a + "/" + b; }
};

/// "a/b" of each.
std::vector<std::string> names_of(std::span<const Pair> pairs);

/// Whether the name is among those wanted. An empty list means all.
bool wanted(const std::vector<std::string>& asked_for, const std::string& name);

}  // namespace tactum::bench
