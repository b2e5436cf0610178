#include "viewer/server/field_arrows.h"

#include <gtest/gtest.h>

#include "tactum/scene/builtin_scenes.h"

namespace tactum {
namespace {

TEST(FieldArrows, TellWhatAPointFeelsAtEveryNode) {
  const Result<Scene> scene = open_scene("vortex-field");
  ASSERT_TRUE(scene) << scene.error().message();
  const std::vector<FieldArrow> arrows = field_arrows(scene->world);
  ASSERT_EQ(arrows.size(), static_cast<std::size_t>(kArrowsASide * kArrowsASide * kArrowsASide));
  const ForceField& vortex = scene->world.fields[0];
  Aabb box;
  double strongest = 0.0;
  for (const FieldArrow& arrow : arrows) {
    box.extend(arrow.p_W);
    strongest = std::max(strongest, arrow.force.norm());
    EXPECT_LT((arrow.force - value_at(vortex, arrow.p_W).force).norm(), 1e-12);  // not turned, scale 1
    EXPECT_NEAR(arrow.force.dot(Vec3(arrow.p_W.x(), arrow.p_W.y(), 0.0)), 0.0, 1e-3) << "not round the axis";
  }
  EXPECT_GT(strongest, 1.0);
  for (const Body& body : scene->world.bodies)
    EXPECT_TRUE(box.overlaps({body.X_WB.p, body.X_WB.p})) << body.name;
}

TEST(FieldArrows, OfSeveralFieldsAddUpWithTheirScalesAndAxes) {
  Result<Scene> scene = open_scene("dipole-field");
  ASSERT_TRUE(scene);
  ForceField turned = scene->world.fields[0];
  turned.scale = -2.0;
  turned.X_WF.R = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX()).toRotationMatrix();
  scene->world.fields.push_back(turned);
  const auto& dipole = std::get<DipoleField>(turned.shape);
  for (const FieldArrow& arrow : field_arrows(scene->world)) {
    const Vec3 p_F(arrow.p_W.x(), arrow.p_W.z(), -arrow.p_W.y());  // F's y is the world's z
    const Vec3 there = value_at(dipole, p_F).force;
    const Vec3 truth = value_at(dipole, arrow.p_W).force - 2.0 * Vec3(there.x(), -there.z(), there.y());
    EXPECT_LT((arrow.force - truth).norm(), 1e-9);
  }
}

TEST(FieldArrows, AreNoneWithoutFields) {
  const Result<Scene> scene = open_scene("block-on-plate");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(field_arrows(scene->world).empty());
}

}  // namespace
}  // namespace tactum
