#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

void visit_sampled(ItemVisitor& visitor, std::optional<SampledGrid>& sampled) {
  visitor.optional("sampled", sampled, [&](SampledGrid& grid) { visitor.table("sampled", grid); });
}

/// Whether the shape of the field is a grid.
bool has_edge(const FieldDescription& field) {
  return std::visit(
      [](const auto& shape) {
        if constexpr (requires { shape.sampled; })
          return shape.sampled.has_value();
        else
          return true;
      },
      field.shape);
}

}  // namespace

void visit_items(ItemVisitor& visitor, SampledGrid& grid) {
  visitor.integer("nodes", grid.nodes, 2, 512, Need::kRequired);
  visitor.vector("size_m", grid.size_m, Need::kRequired);
  visitor.choice("type", grid.type, {"float32", "float64"});
}

void visit_items(ItemVisitor& visitor, DipoleDescription& dipole) {
  visitor.number("moment_Nm3", dipole.formula.moment_Nm3, kAny, Need::kRequired);
  visitor.number("core_m", dipole.formula.core_m, kPositive, Need::kRequired);
  visit_sampled(visitor, dipole.sampled);
}

void visit_items(ItemVisitor& visitor, WellDescription& well) {
  visitor.number("depth_J", well.formula.depth_J, kAny, Need::kRequired);
  visitor.number("width_m", well.formula.width_m, kPositive, Need::kRequired);
  visit_sampled(visitor, well.sampled);
}

void visit_items(ItemVisitor& visitor, VortexDescription& vortex) {
  visitor.number("circulation_J", vortex.formula.circulation_J, kAny, Need::kRequired);
  visitor.number("core_m", vortex.formula.core_m, kPositive, Need::kRequired);
  visit_sampled(visitor, vortex.sampled);
}

void visit_items(ItemVisitor& visitor, GridDescription& grid) {
  visitor.text("file", grid.file, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, FieldDescription& field) {
  visitor.kinds("kind", "field", field.shape, Need::kRequired);
  visitor.pose(field.X_WF);
  visitor.number("scale", field.scale);
  visitor.number("largest_force_N", field.largest_force_N, kPositive);
  visitor.number("largest_torque_Nm", field.largest_torque_Nm, kPositive);
  visitor.number("edge_m", field.edge_m, kNotNegative);
  if (field.edge_m && !has_edge(field))
    visitor.fail("edge_m", "only a grid has an edge", "a formula", "kind = \"grid\", or sampled = {...}");
}

}  // namespace tactum::inline v0_1
