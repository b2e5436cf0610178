#include "tactum/scene/fit_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {
namespace {

/// A part that goes into another one, or that one, by the sizes that decide.
struct Mating {
  std::string name;      ///< of the body
  std::string size;      ///< of a thread, which must be the same
  double width_m = 0.0;  ///< of a prism's circle: about a peg, in a hole
  double depth_m = 0.0;  ///< of a rectangle; else the width
  int sides = 0;         ///< of a prism; 0: a rectangle
};

/// The two sides of one kind of mating: what goes in, and what it goes into.
struct MatingKind {
  const char *noun, *hollow;
  std::vector<Mating> inner, outer;
};

/// The size as made: with the deviation of its fit.
double as_made(const FitDescription& wanted, bool hole, double nominal_m) {
  if (wanted.fit.empty()) return nominal_m;
  const Result<Fit> fit = iso_fit(wanted.fit, nominal_m);
  if (!fit) return nominal_m;
  const FitPosition position = wanted.fit_position.value_or(FitPosition::kMid);
  return nominal_m + (hole ? fit->hole_m(position) : fit->shaft_m(position));
}

double hole_size(const FitDescription& fit, double nominal_m, double clearance_m) {
  return as_made(fit, true, nominal_m) + (fit.fit.empty() ? clearance_m : 0.0);
}

/// Collects the parts of a scene that mate.
class MatingParts {
 public:
  MatingKind pegs{"peg", "hole", {}, {}}, keys{"key", "socket", {}, {}}, threads{"bolt", "nut", {}, {}};

  void add(const std::string& name, const PartDescription& part) {
    if (const auto* peg = std::get_if<PegPart>(&part)) {
      const double width = as_made(peg->fit, false, peg->peg.width_m);
      const int sides = peg->peg.sides;
      const double depth = sides != 0 ? width : as_made(peg->fit, false, peg->peg.depth_m);
      pegs.inner.push_back({name, "", width, depth, sides});
    } else if (const auto* hole = std::get_if<HoleBlockPart>(&part)) {
      const HoleBlock& block = hole->block;
      const double width = hole_size(hole->fit, block.peg_width_m, block.clearance_m);
      const double depth =
          block.sides != 0 ? width : hole_size(hole->fit, block.peg_depth_m, block.clearance_m);
      pegs.outer.push_back({name, "", width, depth, block.sides});
    } else if (const auto* key = std::get_if<HexKeyPart>(&part)) {
      const double width = as_made(key->fit, false, key->key.across_flats_m);
      keys.inner.push_back({name, "", width, width, 0});
    } else if (const auto* socket = std::get_if<SocketPart>(&part)) {
      const double width = hole_size(socket->fit, socket->socket.across_flats_m, socket->socket.clearance_m);
      keys.outer.push_back({name, "", width, width, 0});
    } else if (const auto* bolt = std::get_if<BoltPart>(&part)) {
      threads.inner.push_back({name, bolt->screw.size, 0.0, 0.0, 0});
    } else if (const auto* nut = std::get_if<NutPart>(&part)) {
      threads.outer.push_back({name, nut->screw.size, 0.0, 0.0, 0});
    }
  }
};

/// Whether a rectangle goes into another one turned in its plane, though its long side is too long (the
/// condition of Carver, 1957).
bool fits_askew(double length, double width, double hole_length, double hole_width) {
  if (length <= hole_length || width > hole_width) return false;
  const double squares = length * length + width * width;
  const double beyond = std::sqrt(squares - hole_length * hole_length);
  const double needed =
      (2.0 * length * width * hole_length + (length * length - width * width) * beyond) / squares;
  return needed <= hole_width;
}

double excess_of_rectangles(const Mating& inner, const Mating& outer) {
  const auto [width, length] = std::minmax(inner.width_m, inner.depth_m);
  const auto [hole_width, hole_length] = std::minmax(outer.width_m, outer.depth_m);
  const double over = std::max(length - hole_length, width - hole_width);
  return over > 0.0 && fits_askew(length, width, hole_length, hole_width) ? 0.0 : over;
}

/// Prisms of so many sides stand for cylinders, and are judged by their circles.
constexpr int kRound = 16;

/// What is missing for the inner part to go into the outer one, however it is turned; at or below zero: it
/// goes in, or may. Where the shapes differ, only a lack that no turn cures counts: a wrong remark is worse
/// than none.
double excess(const Mating& inner, const Mating& outer) {
  const auto flat_over_corner = [](const Mating& prism) {
    return prism.sides == 0 ? 1.0 : std::cos(kPi / prism.sides);
  };
  const double across_flats = inner.width_m * flat_over_corner(inner);    // of a prism that goes in
  const double across_corners = outer.width_m / flat_over_corner(outer);  // of a hole
  if (inner.sides == 0 && outer.sides == 0) return excess_of_rectangles(inner, outer);
  if (inner.sides == 0) return std::hypot(inner.width_m, inner.depth_m) - across_corners;
  if (outer.sides == 0) return across_flats - std::min(outer.width_m, outer.depth_m);
  if (inner.sides >= kRound && outer.sides >= kRound) return inner.width_m - outer.width_m;
  return across_flats - (inner.sides == outer.sides ? outer.width_m : across_corners);
}

void add_remarks(const MatingKind& kind, std::vector<std::string>& remarks) {
  for (const Mating& inner : kind.inner) {
    const Mating* nearest = nullptr;
    for (const Mating& outer : kind.outer) {
      if (outer.size == inner.size && (nearest == nullptr || excess(inner, outer) < excess(inner, *nearest)))
        nearest = &outer;
    }
    if (nearest == nullptr && !kind.outer.empty()) {
      const Mating& outer = kind.outer.front();
      remarks.push_back(fmt::format("the {} \"{}\" does not fit the {} \"{}\": {} and {}", kind.noun,
                                    inner.name, kind.hollow, outer.name, inner.size, outer.size));
    } else if (nearest != nullptr && excess(inner, *nearest) > 0.0) {
      const double over = excess(inner, *nearest);
      remarks.push_back(fmt::format(
          "the {} \"{}\" does not fit the {} of \"{}\": it is {} too large, a clearance of -{}", kind.noun,
          inner.name, kind.hollow, nearest->name, length_text(over), length_text(over)));
    }
  }
}

}  // namespace

std::string length_text(double length_m) {
  const double size = std::abs(length_m);
  if (size >= 1.0) return fmt::format("{:.3g} m", length_m);
  return size >= 1e-3 || size == 0.0 ? fmt::format("{:.3g} mm", length_m * 1e3)
                                     : fmt::format("{:.3g} um", length_m * 1e6);
}

std::vector<std::string> fit_remarks(const SceneDescription& scene) {
  MatingParts parts;
  for (const BodyDescription& body : scene.bodies) {
    if (body.part) parts.add(body.name, *body.part);
    for (const ComponentDescription& component : body.components)
      if (component.part) parts.add(body.name, *component.part);
  }
  std::vector<std::string> remarks;
  for (const MatingKind* kind : {&parts.pegs, &parts.keys, &parts.threads}) add_remarks(*kind, remarks);
  return remarks;
}

}  // namespace tactum::inline v0_1
