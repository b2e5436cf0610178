#include "tactum/parts/slotted_plate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tactum/parts/generated_parts.h"
#include "tactum/parts/measure_checks.h"

namespace tactum::inline v0_1 {
namespace {

using Polygon = std::vector<Vec2>;

std::optional<Error> defect(const SlottedPlate& plate) {
  const auto bad = [](const char* what, double found, const char* expected) {
    return Error{fmt::format("the plate's {} cannot be", what), fmt::format("{}", found), expected, ""};
  };
  if (plate.slots < 1 || plate.slots > 32) return bad("number of slots", plate.slots, "1 to 32");
  if (plate.end_facets < 2 || plate.end_facets > 32 || plate.end_facets % 2 != 0)
    return bad("number of end facets", plate.end_facets, "an even number from 2 (square ends) to 32");
  if (!positive(plate.slot_width_m)) return bad("slot width", plate.slot_width_m, "more than 0 m");
  const double shortest = plate.end_facets > 2 ? plate.slot_width_m : 0.0;
  if (!positive(plate.slot_length_m) || plate.slot_length_m < shortest)
    return bad("slot length", plate.slot_length_m,
               "more than 0 m, and no less than the slot's width where its ends are round");
  if (!(std::isfinite(plate.pitch_m) && plate.pitch_m > plate.slot_width_m))
    return bad("pitch", plate.pitch_m, "more than the slot's width");
  if (!positive(plate.margin_m)) return bad("margin", plate.margin_m, "more than 0 m");
  if (!positive(plate.thickness_m)) return bad("thickness", plate.thickness_m, "more than 0 m");
  return std::nullopt;
}

/// The region about one end of a slot: from its straight sides' end (y = low) to the plate's edge.
struct Cell {
  double left = 0.0, right = 0.0, low = 0.0, high = 0.0;  // [m]

  /// Where the ray from `from`, on the lower side, leaves the cell.
  Vec2 exit(const Vec2& from, const Vec2& through) const {
    const Vec2 ray = through - from;
    double length = ray.y() > 0.0 ? (high - from.y()) / ray.y() : 1e300;
    if (ray.x() > 0.0) length = std::min(length, (right - from.x()) / ray.x());
    if (ray.x() < 0.0) length = std::min(length, (left - from.x()) / ray.x());
    return from + length * ray;
  }
};

/// The rounded end's corners from its right side to its left one. With two facets: a square end's.
Polygon end_corners(const SlottedPlate& plate, double middle_x) {
  const double centre_y = 0.5 * (plate.slot_length_m - plate.slot_width_m);
  const double step = kPi / plate.end_facets;
  const double radius = 0.5 * plate.slot_width_m / std::cos(0.5 * step);
  Polygon corners;
  for (int i = 0; i < plate.end_facets; ++i) {
    const double angle = (i + 0.5) * step;
    corners.emplace_back(middle_x + radius * std::cos(angle), centre_y + radius * std::sin(angle));
  }
  return corners;
}

/// One piece for each facet: the facet, and the part of the cell between the rays through its ends.
std::vector<Polygon> fan(const Polygon& end, const Cell& cell) {
  const Vec2 middle(0.5 * (end.front().x() + end.back().x()), cell.low);
  const auto turned_left = [&middle](const Vec2& a, const Vec2& b) {
    const Vec2 p = a - middle;
    const Vec2 q = b - middle;
    return p.x() * q.y() - p.y() * q.x() > 0.0;
  };
  std::vector<Polygon> pieces;
  for (std::size_t i = 0; i + 1 < end.size(); ++i) {
    // The first and the last ray run along the cell's lower side, whatever the corners' rounding.
    const Vec2 from = i == 0 ? Vec2(cell.right, cell.low) : cell.exit(middle, end[i]);
    const Vec2 to = i + 2 == end.size() ? Vec2(cell.left, cell.low) : cell.exit(middle, end[i + 1]);
    Polygon piece = {end[i], from};
    for (const Vec2& corner : {Vec2(cell.right, cell.high), Vec2(cell.left, cell.high)})
      if (turned_left(from, corner) && turned_left(corner, to)) piece.push_back(corner);
    piece.push_back(to);
    piece.push_back(end[i + 1]);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace

Result<std::vector<Polytope>> slotted_plate_pieces(const SlottedPlate& plate) {
  if (const std::optional<Error> error = defect(plate)) return *error;
  const double half_width = 0.5 * plate.slot_width_m;
  const auto middle = [&plate](int slot) { return (slot - 0.5 * (plate.slots - 1)) * plate.pitch_m; };
  const double x_end = middle(plate.slots - 1) + half_width + plate.margin_m;
  const double y_end = 0.5 * plate.slot_length_m + plate.margin_m;
  const double straight = end_corners(plate, 0.0).front().y();

  std::vector<Polygon> outlines;
  for (int bar = 0; bar <= plate.slots; ++bar) {
    const double low = bar == 0 ? -x_end : middle(bar - 1) + half_width;
    const double high = bar == plate.slots ? x_end : middle(bar) - half_width;
    outlines.push_back({{low, -straight}, {high, -straight}, {high, straight}, {low, straight}});
  }
  for (int slot = 0; slot < plate.slots; ++slot) {
    const Cell cell{slot == 0 ? -x_end : middle(slot) - 0.5 * plate.pitch_m,
                    slot + 1 == plate.slots ? x_end : middle(slot) + 0.5 * plate.pitch_m, straight, y_end};
    const std::vector<Polygon> upper = fan(end_corners(plate, middle(slot)), cell);
    outlines.insert(outlines.end(), upper.begin(), upper.end());
    for (Polygon piece : upper) {
      for (Vec2& corner : piece) corner.y() = -corner.y();
      outlines.push_back(std::move(piece));
    }
  }
  std::vector<Polytope> pieces;
  for (const Polygon& outline : outlines) {
    Result<Polytope> piece = extruded(outline, 0.0, plate.thickness_m);
    if (!piece) return piece.error();
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace tactum::inline v0_1
