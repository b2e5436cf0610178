#include "tactum/parts/socket.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tactum/geometry/hull.h"
#include "tactum/parts/generated_parts.h"
#include "tactum/parts/measure_checks.h"

namespace tactum::inline v0_1 {
namespace {

/// From the axis to a corner of a hexagon.
double corner_radius(double across_flats) { return across_flats / std::sqrt(3.0); }

/// Corners of a regular polygon with one at -60 degrees: a hexagon then has its flats across y.
std::vector<Vec2> corners_from_minus_60(int count, double radius) {
  std::vector<Vec2> corners;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count - kPi / 3.0;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return corners;
}

}  // namespace

Result<std::vector<Polytope>> hex_key_pieces(const HexKey& key) {
  if (!positive(key.across_flats_m))
    return impossible("width across flats", key.across_flats_m, "more than 0 m");
  const double radius = corner_radius(key.across_flats_m);
  const std::string longer = fmt::format("more than the key's {:.3g} m across corners", 2.0 * radius);
  if (!(std::isfinite(key.short_m) && key.short_m > 2.0 * radius))
    return impossible("short arm", key.short_m, longer);
  if (!(std::isfinite(key.long_m) && key.long_m > 2.0 * radius))
    return impossible("long arm", key.long_m, longer);

  std::vector<Vec3> short_arm;
  std::vector<Vec3> long_arm;
  for (const Vec2& corner : corners_from_minus_60(6, radius)) {
    const Vec3 bend(corner.x(), corner.y(), key.short_m - radius - corner.x());
    short_arm.emplace_back(corner.x(), corner.y(), 0.0);
    short_arm.push_back(bend);
    long_arm.push_back(bend);
    long_arm.emplace_back(key.long_m - radius, bend.y(), bend.z());
  }
  std::vector<Polytope> pieces;
  for (const auto& arm : {short_arm, long_arm}) {
    Result<Polytope> piece = convex_hull(arm);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

Result<std::vector<Polytope>> hex_socket_pieces(const HexSocket& socket) {
  if (!positive(socket.across_flats_m))
    return impossible("width across flats", socket.across_flats_m, "more than 0 m");
  if (!not_negative(socket.clearance_m)) return impossible("clearance", socket.clearance_m, "0 m or more");
  if (!positive(socket.depth_m)) return impossible("depth", socket.depth_m, "more than 0 m");
  if (!not_negative(socket.floor_m))
    return impossible("floor", socket.floor_m, "0 m (a hole that goes through) or more");
  if (socket.facets_per_side < 1 || socket.facets_per_side > 32)
    return impossible("number of facets per side", socket.facets_per_side, "1 to 32");
  const double radius = corner_radius(socket.across_flats_m + socket.clearance_m);
  if (!(std::isfinite(socket.diameter_m) && socket.diameter_m > 2.0 * radius))
    return impossible("diameter", socket.diameter_m,
                      fmt::format("more than the hole's {:.3g} m across corners", 2.0 * radius));

  const std::vector<Vec2> hole = corners_from_minus_60(6, radius);
  const std::vector<Vec2> head = corners_from_minus_60(6 * socket.facets_per_side, 0.5 * socket.diameter_m);
  std::vector<Polytope> pieces;
  for (std::size_t side = 0; side < 6; ++side) {
    std::vector<Vec2> wall = {hole[(side + 1) % 6], hole[side]};
    const std::size_t facets = static_cast<std::size_t>(socket.facets_per_side);
    for (std::size_t i = 0; i <= facets; ++i) wall.push_back(head[(side * facets + i) % head.size()]);
    Result<Polytope> piece = extruded(wall, 0.0, socket.depth_m);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  if (socket.floor_m > 0.0) {
    Result<Polytope> piece = extruded(head, -socket.floor_m, 0.0);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace tactum::inline v0_1
