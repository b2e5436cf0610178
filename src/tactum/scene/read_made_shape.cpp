#include <fmt/format.h>

#include <optional>

#include "tactum/geometry/primitives.h"
#include "tactum/mesh/make_part.h"
#include "tactum/parts/bolt_and_nut.h"
#include "tactum/parts/gear.h"
#include "tactum/parts/generated_parts.h"
#include "tactum/parts/iso_fit.h"
#include "tactum/parts/slotted_plate.h"
#include "tactum/parts/socket.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

using Made = Result<Shape>;

Made shape_of(Result<std::vector<Polytope>> pieces) {
  if (!pieces) return pieces.error();
  Shape shape;
  shape.pieces = std::move(*pieces);
  return shape;
}

Made shape_of(Result<TriangleMesh> mesh) {
  if (!mesh) return mesh.error();
  Shape shape;
  shape.mesh.mesh = std::move(*mesh);
  shape.piece_source = PieceSource::kSurface;
  return shape;
}

Vec3 positive_vector3(const TomlReader& reader, const char* key) {
  const Vec3 read = reader.vector3(key);
  if (reader.has(key) && !(read.minCoeff() > 0.0)) {
    reader.fail(key, fmt::format("\"{}\" in {} is out of range", key, reader.section()),
                fmt::format("[{}, {}, {}]", read.x(), read.y(), read.z()), "three numbers above 0");
    return Vec3::Ones();
  }
  return reader.has(key) ? read : Vec3::Ones();
}

/// `fit` and `fit_position` of a table: which of the two parts it is, and where it lies in its zone.
class FitKeys {
 public:
  FitKeys(const TomlReader& table, bool hole) : table_(table), hole_(hole) {
    const std::string position =
        table.choice("fit_position", "mid", {"min_clearance", "mid", "max_clearance"});
    if (position == "min_clearance") position_ = FitPosition::kMinClearance;
    if (position == "max_clearance") position_ = FitPosition::kMaxClearance;
    if (given()) {
      name_ = table.text("fit");
    } else if (table.has("fit_position")) {
      table.fail("fit_position", "a place within no fit in " + table.section(), position,
                 "fit, such as \"H7/g6\"");
    }
    if (given() && table.has("clearance_m"))
      table.fail("clearance_m", "two clearances in " + table.section(), "clearance_m and fit", "one of them");
  }

  bool given() const { return table_.has("fit"); }

  /// The size as made: nominal when there is no fit.
  double size(double nominal_m) const {
    if (!given() || table_.errors()) return nominal_m;
    const Result<Fit> fit = iso_fit(name_, nominal_m);
    if (!fit) {
      table_.fail("fit", fit.error().what, fit.error().found, fit.error().expected);
      return nominal_m;
    }
    return nominal_m + (hole_ ? fit->hole_m(position_) : fit->shaft_m(position_));
  }

 private:
  const TomlReader& table_;
  bool hole_;
  FitPosition position_ = FitPosition::kMid;
  std::string name_;
};

Made read_gear(const TomlReader& part) {
  const TomlReader table =
      part.table("gear", {"teeth", "module_m", "pressure_angle_deg", "addendum", "dedendum", "face_width_m",
                          "profile_shift", "backlash_m", "flank_facets", "as"});
  Gear gear;
  gear.teeth = table.integer("teeth", gear.teeth, 1, 400);
  gear.module_m = table.number("module_m", gear.module_m, kPositive);
  gear.pressure_angle_rad = radians(table.number("pressure_angle_deg", 20.0, {10.0, 30.0}));
  gear.addendum = table.number("addendum", gear.addendum, kPositive);
  gear.dedendum = table.number("dedendum", gear.dedendum, kPositive);
  gear.face_width_m = table.number("face_width_m", gear.face_width_m, kPositive);
  gear.profile_shift = table.number("profile_shift", gear.profile_shift, {-0.5, 1.0});
  gear.backlash_m = table.number("backlash_m", gear.backlash_m, kNotNegative);
  gear.flank_facets = table.integer("flank_facets", gear.flank_facets, 2, 256);
  if (table.choice("as", "pieces", {"pieces", "surface"}) == "surface") return shape_of(gear_surface(gear));
  return shape_of(gear_pieces(gear));
}

Made read_peg(const TomlReader& part) {
  const TomlReader table =
      part.table("peg", {"sides", "width_m", "depth_m", "length_m", "chamfer_m", "fit", "fit_position"});
  const FitKeys fit(table, false);
  Peg peg;
  peg.sides = table.integer("sides", peg.sides, 0, 256);
  peg.width_m = fit.size(table.number("width_m", peg.width_m, kPositive));
  peg.depth_m = table.number("depth_m", peg.depth_m, kPositive);
  if (peg.sides == 0) peg.depth_m = fit.size(peg.depth_m);
  peg.length_m = table.number("length_m", peg.length_m, kPositive);
  peg.chamfer_m = table.number("chamfer_m", peg.chamfer_m, kNotNegative);
  return shape_of(peg_pieces(peg));
}

Made read_hole_block(const TomlReader& part) {
  const TomlReader table =
      part.table("hole_block", {"sides", "peg_width_m", "peg_depth_m", "clearance_m", "wall_m",
                                "hole_depth_m", "floor_m", "fit", "fit_position"});
  const FitKeys fit(table, true);
  HoleBlock block;
  block.sides = table.integer("sides", block.sides, 0, 256);
  block.peg_width_m = fit.size(table.number("peg_width_m", block.peg_width_m, kPositive));
  block.peg_depth_m = table.number("peg_depth_m", block.peg_depth_m, kPositive);
  if (block.sides == 0) block.peg_depth_m = fit.size(block.peg_depth_m);
  block.clearance_m = table.number("clearance_m", fit.given() ? 0.0 : block.clearance_m, kNotNegative);
  block.wall_m = table.number("wall_m", block.wall_m, kPositive);
  block.hole_depth_m = table.number("hole_depth_m", block.hole_depth_m, kPositive);
  block.floor_m = table.number("floor_m", block.floor_m, kNotNegative);
  return shape_of(hole_block_pieces(block));
}

ScrewShape read_screw(const TomlReader& table) {
  ScrewShape screw;
  screw.size = table.text("size", screw.size);
  if (table.has("clearance_m")) screw.clearance_m = table.number("clearance_m", {}, kNotNegative);
  if (table.has("clearance_m") && table.has("class"))
    table.fail("clearance_m", "two clearances in " + table.section(), "clearance_m and class", "one of them");
  screw.tolerance_class = table.text("class", screw.tolerance_class);
  screw.facets_per_turn = table.integer("facets_per_turn", screw.facets_per_turn, 16, 256);
  return screw;
}

Made read_bolt(const TomlReader& part) {
  const TomlReader table =
      part.table("bolt", {"size", "class", "clearance_m", "length_m", "facets_per_turn"});
  ScrewShape screw = read_screw(table);
  screw.length_m = table.number("length_m", screw.length_m, kPositive);
  return shape_of(bolt_mesh(screw));
}

Made read_nut(const TomlReader& part) {
  const TomlReader table = part.table("nut", {"size", "class", "clearance_m", "facets_per_turn"});
  return shape_of(nut_mesh(read_screw(table)));
}

Made read_hex_key(const TomlReader& part) {
  const TomlReader table =
      part.table("hex_key", {"across_flats_m", "long_m", "short_m", "fit", "fit_position"});
  const FitKeys fit(table, false);
  HexKey key;
  key.across_flats_m = fit.size(table.number("across_flats_m", key.across_flats_m, kPositive));
  key.long_m = table.number("long_m", key.long_m, kPositive);
  key.short_m = table.number("short_m", key.short_m, kPositive);
  return shape_of(hex_key_pieces(key));
}

Made read_socket(const TomlReader& part) {
  const TomlReader table = part.table("socket", {"across_flats_m", "clearance_m", "diameter_m", "depth_m",
                                                 "floor_m", "facets_per_side", "fit", "fit_position"});
  const FitKeys fit(table, true);
  HexSocket socket;
  socket.across_flats_m = fit.size(table.number("across_flats_m", socket.across_flats_m, kPositive));
  socket.clearance_m = table.number("clearance_m", fit.given() ? 0.0 : socket.clearance_m, kNotNegative);
  socket.diameter_m = table.number("diameter_m", socket.diameter_m, kPositive);
  socket.depth_m = table.number("depth_m", socket.depth_m, kPositive);
  socket.floor_m = table.number("floor_m", socket.floor_m, kNotNegative);
  socket.facets_per_side = table.integer("facets_per_side", socket.facets_per_side, 1, 32);
  return shape_of(hex_socket_pieces(socket));
}

Made read_slotted_plate(const TomlReader& part) {
  const TomlReader table = part.table("slotted_plate", {"slots", "slot_width_m", "slot_length_m", "pitch_m",
                                                        "margin_m", "thickness_m", "end_facets"});
  SlottedPlate plate;
  plate.slots = table.integer("slots", plate.slots, 1, 32);
  plate.slot_width_m = table.number("slot_width_m", plate.slot_width_m, kPositive);
  plate.slot_length_m = table.number("slot_length_m", plate.slot_length_m, kPositive);
  plate.pitch_m = table.number("pitch_m", plate.pitch_m, kPositive);
  plate.margin_m = table.number("margin_m", plate.margin_m, kPositive);
  plate.thickness_m = table.number("thickness_m", plate.thickness_m, kPositive);
  plate.end_facets = table.integer("end_facets", plate.end_facets, 2, 32);
  return shape_of(slotted_plate_pieces(plate));
}

Made read_box(const TomlReader& part) {
  const TomlReader table = part.table("box", {"size_m"});
  return shape_of(std::vector<Polytope>{make_box(0.5 * positive_vector3(table, "size_m"))});
}

Made read_sphere(const TomlReader& part) {
  const TomlReader table = part.table("sphere", {"radius_m", "subdivisions"});
  const double radius = table.number("radius_m", {}, kPositive);
  const int subdivisions = table.integer("subdivisions", 2, 0, 5);
  return shape_of(std::vector<Polytope>{make_icosphere(subdivisions, radius > 0.0 ? radius : 1.0)});
}

Made read_ellipsoid(const TomlReader& part) {
  const TomlReader table = part.table("ellipsoid", {"radii_m", "subdivisions"});
  const Vec3 radii = positive_vector3(table, "radii_m");
  const int subdivisions = table.integer("subdivisions", 2, 0, 5);
  return shape_of(std::vector<Polytope>{make_ellipsoid(subdivisions, radii)});
}

Made read_prism(const TomlReader& part) {
  const TomlReader table = part.table("prism", {"sides", "radius_m", "height_m"});
  const int sides = table.integer("sides", {}, 3, 1024);
  const double radius = table.number("radius_m", {}, kPositive);
  const double height = table.number("height_m", {}, kPositive);
  if (table.errors()) return Shape{};
  return shape_of(std::vector<Polytope>{make_prism(sides, radius, height)});
}

struct MadeShape {
  const char* kind;
  Made (*read)(const TomlReader& part);
};
constexpr MadeShape kMadeShapes[] = {{"gear", read_gear},
                                     {"peg", read_peg},
                                     {"hole_block", read_hole_block},
                                     {"bolt", read_bolt},
                                     {"nut", read_nut},
                                     {"hex_key", read_hex_key},
                                     {"socket", read_socket},
                                     {"slotted_plate", read_slotted_plate},
                                     {"box", read_box},
                                     {"sphere", read_sphere},
                                     {"ellipsoid", read_ellipsoid},
                                     {"prism", read_prism}};

}  // namespace

const std::vector<std::string>& made_shapes() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names;
    for (const MadeShape& made : kMadeShapes) names.emplace_back(made.kind);
    return names;
  }();
  return kinds;
}

Shape read_made_shape(const TomlReader& part, const std::string& kind) {
  for (const MadeShape& made : kMadeShapes) {
    if (kind != made.kind) continue;
    Made shape = made.read(part);
    if (shape) return std::move(*shape);
    part.fail(made.kind, shape.error().what, shape.error().found, shape.error().expected);
  }
  return {};
}

}  // namespace tactum
