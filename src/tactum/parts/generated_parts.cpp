#include "tactum/parts/generated_parts.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "tactum/geometry/hull.h"
#include "tactum/parts/measure_checks.h"

namespace tactum::inline v0_1 {
namespace {

using Polygon = std::vector<Vec2>;

bool allowed_sides(int sides) { return sides == 0 || (sides >= 3 && sides <= 256); }

/// A regular polygon with a side across -y; `radius` reaches its corners.
Polygon regular(int sides, double radius) {
  Polygon polygon;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * (i + 0.5) / sides - 0.5 * kPi;
    polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return polygon;
}

Polygon rectangle(double x_low, double x_high, double y_low, double y_high) {
  return {{x_low, y_low}, {x_high, y_low}, {x_high, y_high}, {x_low, y_high}};
}

Polygon centred_rectangle(double width, double depth) {
  return rectangle(-0.5 * width, 0.5 * width, -0.5 * depth, 0.5 * depth);
}

/// The walls between a hole and an outer polygon of as many corners, one per side.
std::vector<Polygon> ring(const Polygon& hole, const Polygon& outer) {
  std::vector<Polygon> walls;
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const std::size_t next = (i + 1) % hole.size();
    walls.push_back({outer[i], outer[next], hole[next], hole[i]});
  }
  return walls;
}

}  // namespace

Result<Polytope> extruded(const std::vector<Vec2>& polygon, double z_low_m, double z_high_m) {
  std::vector<Vec3> corners;
  for (const Vec2& corner : polygon)
    for (double z : {z_low_m, z_high_m}) corners.emplace_back(corner.x(), corner.y(), z);
  return convex_hull(corners);
}

Result<std::vector<Polytope>> peg_pieces(const Peg& peg) {
  if (!allowed_sides(peg.sides))
    return impossible("number of sides", peg.sides, "0 (rectangular) or 3 to 256");
  if (!positive(peg.width_m)) return impossible("width", peg.width_m, "more than 0 m");
  const bool round = peg.sides > 0;
  if (!round && !positive(peg.depth_m)) return impossible("depth", peg.depth_m, "more than 0 m");
  if (!positive(peg.length_m)) return impossible("length", peg.length_m, "more than 0 m");
  const double thinnest =
      round ? peg.width_m * std::cos(kPi / peg.sides) : std::min(peg.width_m, peg.depth_m);
  if (!not_negative(peg.chamfer_m) || 2.0 * peg.chamfer_m >= thinnest || peg.chamfer_m >= peg.length_m)
    return impossible("chamfer", peg.chamfer_m,
                      "0 m or more, and less than half the peg's thickness and its length");

  const double cut = 2.0 * peg.chamfer_m;
  const Polygon full =
      round ? regular(peg.sides, 0.5 * peg.width_m) : centred_rectangle(peg.width_m, peg.depth_m);
  const Polygon tip = round
                          ? regular(peg.sides, 0.5 * peg.width_m - peg.chamfer_m / std::cos(kPi / peg.sides))
                          : centred_rectangle(peg.width_m - cut, peg.depth_m - cut);
  std::vector<Vec3> corners;
  for (const Vec2& corner : tip) corners.emplace_back(corner.x(), corner.y(), 0.0);
  if (peg.chamfer_m > 0.0)
    for (const Vec2& corner : full) corners.emplace_back(corner.x(), corner.y(), peg.chamfer_m);
  for (const Vec2& corner : full) corners.emplace_back(corner.x(), corner.y(), peg.length_m);
  Result<Polytope> piece = convex_hull(corners);
  if (!piece) return piece.error();
  return std::vector<Polytope>{std::move(*piece)};
}

Result<std::vector<Polytope>> hole_block_pieces(const HoleBlock& block) {
  if (!allowed_sides(block.sides))
    return impossible("number of sides", block.sides, "0 (rectangular) or 3 to 256");
  if (!positive(block.peg_width_m)) return impossible("peg width", block.peg_width_m, "more than 0 m");
  const bool round = block.sides > 0;
  if (!round && !positive(block.peg_depth_m))
    return impossible("peg depth", block.peg_depth_m, "more than 0 m");
  if (!not_negative(block.clearance_m)) return impossible("clearance", block.clearance_m, "0 m or more");
  if (!positive(block.wall_m)) return impossible("wall", block.wall_m, "more than 0 m");
  if (!positive(block.hole_depth_m)) return impossible("hole depth", block.hole_depth_m, "more than 0 m");
  if (!not_negative(block.floor_m))
    return impossible("floor", block.floor_m, "0 m (a hole that goes through) or more");

  const double width = block.peg_width_m + block.clearance_m;
  const double depth = block.peg_depth_m + block.clearance_m;
  Polygon outer;
  std::vector<Polygon> walls;
  if (round) {
    const double cosine = std::cos(kPi / block.sides);
    outer = regular(block.sides, (0.5 * width + block.wall_m) / cosine);
    walls = ring(regular(block.sides, 0.5 * width / cosine), outer);
  } else {
    const double x = 0.5 * width;
    const double y = 0.5 * depth;
    const double x_out = x + block.wall_m;
    const double y_out = y + block.wall_m;
    outer = rectangle(-x_out, x_out, -y_out, y_out);
    walls = {rectangle(x, x_out, -y_out, y_out), rectangle(-x_out, -x, -y_out, y_out),
             rectangle(-x, x, y, y_out), rectangle(-x, x, -y_out, -y)};
  }
  std::vector<Polytope> pieces;
  for (const Polygon& wall : walls) {
    Result<Polytope> piece = extruded(wall, 0.0, block.hole_depth_m);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  if (block.floor_m > 0.0) {
    Result<Polytope> piece = extruded(outer, -block.floor_m, 0.0);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace tactum::inline v0_1
