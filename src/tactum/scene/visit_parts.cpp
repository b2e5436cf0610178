#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

void visit_fit(ItemVisitor& visitor, FitDescription& fit) {
  visitor.text("fit", fit.fit);
  visitor.optional("fit_position", fit.fit_position, [&](FitPosition& position) {
    visitor.choice("fit_position", position, {"min_clearance", "mid", "max_clearance"});
  });
  if (fit.fit_position && fit.fit.empty())
    visitor.fail("fit_position", "a place within no fit in " + visitor.section(), "no fit",
                 "fit, such as \"H7/g6\"");
}

/// A clearance, or a fit in its place. Below zero the part does not fit, which a remark states.
void visit_clearance(ItemVisitor& visitor, double& clearance_m, FitDescription& fit) {
  visitor.number("clearance_m", clearance_m, kAny);
  visit_fit(visitor, fit);
  visitor.exclude("clearance_m", "fit", "two clearances");
}

void visit_screw(ItemVisitor& visitor, ScrewShape& screw) {
  visitor.text("size", screw.size);
  visitor.number("clearance_m", screw.clearance_m, kNotNegative);
  visitor.text("class", screw.tolerance_class);
  visitor.exclude("clearance_m", "class", "two clearances");
  visitor.integer("facets_per_turn", screw.facets_per_turn, 16, 256);
}

}  // namespace

void visit_items(ItemVisitor& visitor, MeshPart& part) {
  visitor.text("mesh", part.mesh, Need::kRequired);
  visitor.number("scale", part.scale, kPositive);
  visitor.vector("scale_xyz", part.scale_xyz);
  visitor.exclude("scale", "scale_xyz", "two scales");
  if (part.scale_xyz && part.scale_xyz->cwiseAbs().minCoeff() == 0.0)
    visitor.fail("scale_xyz", "a scale of zero in " + visitor.section(), "0", "any other numbers");
  visitor.optional("pieces", part.pieces, [&](PieceSource& pieces) {
    visitor.choice("pieces", pieces, {"auto", "given", "solid", "surface"});
  });
}

void visit_items(ItemVisitor& visitor, GearPart& part) {
  Gear& gear = part.gear;
  visitor.integer("teeth", gear.teeth, 1, 400);
  visitor.number("module_m", gear.module_m, kPositive);
  visitor.angle("pressure_angle_deg", gear.pressure_angle_rad, {10.0, 30.0});
  visitor.number("addendum", gear.addendum, kPositive);
  visitor.number("dedendum", gear.dedendum, kPositive);
  visitor.number("face_width_m", gear.face_width_m, kPositive);
  visitor.number("profile_shift", gear.profile_shift, {-0.5, 1.0});
  visitor.number("backlash_m", gear.backlash_m, kNotNegative);
  visitor.integer("flank_facets", gear.flank_facets, 2, 256);
  visitor.choice("as", part.as, {"pieces", "surface"});
}

void visit_items(ItemVisitor& visitor, PegPart& part) {
  visitor.integer("sides", part.peg.sides, 0, 256);
  visitor.number("width_m", part.peg.width_m, kPositive);
  visitor.number("depth_m", part.peg.depth_m, kPositive);
  visitor.number("length_m", part.peg.length_m, kPositive);
  visitor.number("chamfer_m", part.peg.chamfer_m, kNotNegative);
  visit_fit(visitor, part.fit);
}

void visit_items(ItemVisitor& visitor, HoleBlockPart& part) {
  HoleBlock& block = part.block;
  visitor.integer("sides", block.sides, 0, 256);
  visitor.number("peg_width_m", block.peg_width_m, kPositive);
  visitor.number("peg_depth_m", block.peg_depth_m, kPositive);
  visit_clearance(visitor, block.clearance_m, part.fit);
  visitor.number("wall_m", block.wall_m, kPositive);
  visitor.number("hole_depth_m", block.hole_depth_m, kPositive);
  visitor.number("floor_m", block.floor_m, kNotNegative);
}

void visit_items(ItemVisitor& visitor, BoltPart& part) {
  visit_screw(visitor, part.screw);
  visitor.number("length_m", part.screw.length_m, kPositive);
}

void visit_items(ItemVisitor& visitor, NutPart& part) { visit_screw(visitor, part.screw); }

void visit_items(ItemVisitor& visitor, HexKeyPart& part) {
  visitor.number("across_flats_m", part.key.across_flats_m, kPositive);
  visitor.number("long_m", part.key.long_m, kPositive);
  visitor.number("short_m", part.key.short_m, kPositive);
  visit_fit(visitor, part.fit);
}

void visit_items(ItemVisitor& visitor, SocketPart& part) {
  HexSocket& socket = part.socket;
  visitor.number("across_flats_m", socket.across_flats_m, kPositive);
  visit_clearance(visitor, socket.clearance_m, part.fit);
  visitor.number("diameter_m", socket.diameter_m, kPositive);
  visitor.number("depth_m", socket.depth_m, kPositive);
  visitor.number("floor_m", socket.floor_m, kNotNegative);
  visitor.integer("facets_per_side", socket.facets_per_side, 1, 32);
}

void visit_items(ItemVisitor& visitor, SlottedPlatePart& part) {
  SlottedPlate& plate = part.plate;
  visitor.integer("slots", plate.slots, 1, 32);
  visitor.number("slot_width_m", plate.slot_width_m, kPositive);
  visitor.number("slot_length_m", plate.slot_length_m, kPositive);
  visitor.number("pitch_m", plate.pitch_m, kPositive);
  visitor.number("margin_m", plate.margin_m, kPositive);
  visitor.number("thickness_m", plate.thickness_m, kPositive);
  visitor.integer("end_facets", plate.end_facets, 2, 32);
}

void visit_items(ItemVisitor& visitor, BoxPart& part) { visitor.sizes("size_m", part.size_m); }

void visit_items(ItemVisitor& visitor, SpherePart& part) {
  visitor.number("radius_m", part.radius_m, kPositive, Need::kRequired);
  visitor.integer("subdivisions", part.subdivisions, 0, 5);
}

void visit_items(ItemVisitor& visitor, BallPart& part) {
  visitor.number("radius_m", part.radius_m, kPositive, Need::kRequired);
  visitor.integer("subdivisions", part.subdivisions, 0, 5);
}

void visit_items(ItemVisitor& visitor, CylinderPart& part) {
  visitor.number("radius_m", part.radius_m, kPositive, Need::kRequired);
  visitor.number("height_m", part.height_m, kPositive, Need::kRequired);
  visitor.integer("sides", part.sides, 8, 1024);
}

void visit_items(ItemVisitor& visitor, EllipsoidPart& part) {
  visitor.sizes("radii_m", part.radii_m);
  visitor.integer("subdivisions", part.subdivisions, 0, 5);
}

void visit_items(ItemVisitor& visitor, PrismPart& part) {
  visitor.integer("sides", part.sides, 3, 1024, Need::kRequired);
  visitor.number("radius_m", part.radius_m, kPositive, Need::kRequired);
  visitor.number("height_m", part.height_m, kPositive, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, CapsulePart& part) {
  visitor.number("radius_m", part.radius_m, kPositive, Need::kRequired);
  visitor.number("height_m", part.height_m, kPositive, Need::kRequired);
  visitor.integer("sides", part.sides, 8, 256);
  if (part.sides % 4 != 0)
    visitor.fail("sides", "\"sides\" of a capsule in " + visitor.section(), fmt::format("{}", part.sides),
                 "a multiple of 4");
}

namespace {

/// The shapes in the table of a part. A mesh is given there itself, a shape made by rule in a table of its
/// own.
template <class... Kinds>
void visit_shapes(ItemVisitor& visitor, std::variant<Kinds...>& part) {
  static const WordList names{Kinds::kKind...};
  static const std::vector<KeyList> marks{{Kinds::kKind}...};
  static const Alternatives shapes = [] {
    Alternatives all{"part", names, marks};
    all.keys.front() = known_keys<MeshPart>();
    return all;
  }();
  const Error fault{visitor.section() + " must have one shape", "",
                    fmt::format("one of {}", fmt::join(names, ", ")), ""};
  const int index = visitor.marked(marks, names, static_cast<int>(part.index()), fault);
  visitor.alternative(shapes, index, part, [&visitor](auto& shape) {
    using Shape = std::remove_reference_t<decltype(shape)>;
    if constexpr (std::is_same_v<Shape, MeshPart>) {
      visit_items(visitor, shape);
    } else {
      visitor.table(Shape::kKind, shape);
    }
  });
}

}  // namespace

void visit_items(ItemVisitor& visitor, PartDescription& part) { visit_shapes(visitor, part); }

}  // namespace tactum::inline v0_1
