#include "viewer/server/field_arrows.h"

namespace tactum {
namespace {

constexpr double kMargin = 0.15;  // of the box's diagonal, on every side

Aabb box_of(const World& world) {
  Aabb box;
  for (const Body& body : world.bodies)
    for (const double side : {1.0, -1.0}) box.extend(body.X_WB.p + Vec3::Constant(side * body.part->radius));
  for (const ForceField& field : world.fields) box.extend(field.X_WF.p);
  const Vec3 margin = Vec3::Constant(kMargin * box.diagonal());
  return {box.min - margin, box.max + margin};
}

}  // namespace

std::vector<FieldArrow> field_arrows(const World& world) {
  std::vector<FieldArrow> arrows;
  if (world.fields.empty()) return arrows;
  const Aabb box = box_of(world);
  const Vec3 step = (box.max - box.min) / (kArrowsASide - 1);
  for (int k = 0; k < kArrowsASide; ++k)
    for (int j = 0; j < kArrowsASide; ++j)
      for (int i = 0; i < kArrowsASide; ++i) {
        FieldArrow arrow{box.min + step.cwiseProduct(Vec3(i, j, k)), Vec3::Zero()};
        for (const ForceField& field : world.fields)
          arrow.force += field.scale * (field.X_WF.R * value_at(field, arrow.p_W).force);
        arrows.push_back(arrow);
      }
  return arrows;
}

}  // namespace tactum
