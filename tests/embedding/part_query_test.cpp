/// Distance and clearance of whole parts: against closed forms, and with what is refused.
#include <gtest/gtest.h>

#include "support/sample_meshes.h"
#include "tactum/embedding/part_query.h"
#include "tactum/embedding/tactum_c.h"
#include "tactum/math/screw.h"

namespace tactum::part_query_test {

using tactum::testing::box_mesh;

namespace {

std::shared_ptr<const QueriedPart> box(const Vec3& half, const Vec3& at = Vec3::Zero()) {
  TriangleMesh mesh = box_mesh(half);
  for (Vec3& vertex : mesh.vertices) vertex += at;
  auto made = QueriedPart::from_mesh(std::move(mesh), {.name = "box"});
  EXPECT_TRUE(made) << made.error().message();
  return std::move(*made);
}

TEST(PartQuery, DistanceAndClearanceOfBoxesAreThoseOfTheirFaces) {
  // The frame of the mesh is far from the centre of mass: poses are of the mesh.
  const auto a = box({0.01, 0.02, 0.03}, {0.1, 0.0, 0.0});
  const auto b = box({0.02, 0.02, 0.01}, {0.0, -0.2, 0.0});
  const Pose X_WA{exp_rotation({0.3, -0.2, 0.9}), {1.0, 2.0, 3.0}};
  for (const double gap : {0.007, 0.0005, -0.002}) {
    const Pose X_WB = X_WA * Pose{Mat3::Identity(), {0.1, 0.2, 0.04 + gap}};
    const auto found = signed_distance(*a, X_WA, *b, X_WB);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, gap, 1e-12);
    EXPECT_LT((found->n_BA_W - X_WA.R * Vec3(0, 0, -1)).norm(), 1e-9);
    EXPECT_TRUE(found->certified);
    SurfacePairCache cache;
    const PartDistance clear = clearance(*a, X_WA, *b, X_WB, cache);
    EXPECT_NEAR(clear.distance, std::max(0.0, gap), 1e-12);
    EXPECT_EQ(clear.touching_pairs > 0, gap < 0.0);
    if (gap > 0.0) {
      EXPECT_NEAR((clear.p_a_W - clear.p_b_W).norm(), gap, 1e-12);
      EXPECT_LT((clear.n_BA_W - X_WA.R * Vec3(0, 0, -1)).norm(), 1e-9);
    }
  }
}

TEST(PartQuery, APartInsideAnotherHasNoClearance) {
  const auto large = box({0.1, 0.1, 0.1});
  const auto small = box({0.01, 0.01, 0.01});
  SurfacePairCache cache;
  const PartDistance found = clearance(*large, {}, *small, {}, cache);
  EXPECT_TRUE(found.inside);
  EXPECT_EQ(found.distance, 0.0);
  EXPECT_EQ(found.touching_pairs, 0);
}

TEST(PartQuery, RefusesWhatHasNoAnswer) {
  const auto solid = box({0.01, 0.01, 0.01});
  TriangleMesh open = box_mesh({0.01, 0.01, 0.01});
  open.triangles.pop_back();
  const auto surface = QueriedPart::from_mesh(open, {.name = "lid", .pieces = "surface"});
  ASSERT_TRUE(surface) << surface.error().message();
  const auto refused = signed_distance(*solid, {}, **surface, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("lid: a signed distance is one of solid pieces"),
            std::string::npos)
      << refused.error().message();
  EXPECT_FALSE(check_pose({2.0 * Mat3::Identity(), Vec3::Zero()}, "X_WA"));
  EXPECT_FALSE(check_pose({-Mat3::Identity(), Vec3::Zero()}, "X_WA"));
  EXPECT_TRUE(check_pose({}, "X_WA"));
  TriangleMesh wrong = box_mesh({0.01, 0.01, 0.01});
  wrong.triangles[3][1] = 8;
  const auto named = QueriedPart::from_mesh(wrong);
  ASSERT_FALSE(named);
  EXPECT_EQ(named.error().message(),
            "mesh: triangle 3 names a vertex that is not there: found 8, expected 0 to 7");
}

TEST(PartQuery, APartIsSavedAndLoadedThroughTheCInterface) {
  const std::string path = ::testing::TempDir() + "tactum_embedding_cube.part";
  const TriangleMesh mesh = box_mesh({0.01, 0.02, 0.03});
  tactum_part_options options{};
  options.struct_size = sizeof options;
  options.name = "cube";
  options.density_kg_per_m3 = 2000.0;
  tactum_part* made = nullptr;
  ASSERT_EQ(tactum_make_part(mesh.vertices.front().data(), mesh.vertices.size(),
                             mesh.triangles.front().data(), mesh.triangles.size(), &options, &made),
            TACTUM_OK)
      << tactum_last_error();
  ASSERT_EQ(tactum_save_part(made, path.c_str()), TACTUM_OK) << tactum_last_error();
  tactum_part* loaded = nullptr;
  ASSERT_EQ(tactum_load_part(path.c_str(), nullptr, &loaded), TACTUM_OK) << tactum_last_error();
  EXPECT_STREQ(tactum_part_name(loaded), "cube");
  EXPECT_EQ(std::string(tactum_part_report(loaded)), tactum_part_report(made));
  tactum_part_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(tactum_inspect_part(loaded, &info), TACTUM_OK);
  EXPECT_EQ(info.pieces, 1);
  EXPECT_NEAR(info.mass_kg, 2000.0 * 8 * 0.01 * 0.02 * 0.03, 1e-12);
  EXPECT_NEAR(info.inertia_B[0], info.mass_kg / 3.0 * (0.02 * 0.02 + 0.03 * 0.03), 1e-12);
  EXPECT_NEAR(info.box_max_P[2], 0.03, 1e-15);
  tactum_mesh_view view{};
  view.struct_size = sizeof view;
  ASSERT_EQ(tactum_part_mesh(loaded, &view), TACTUM_OK);
  EXPECT_EQ(view.vertex_count, 8u);
  EXPECT_EQ(view.triangle_count, 12u);
  tactum_release_part(made);
  tactum_release_part(loaded);
}

}  // namespace
}  // namespace tactum::part_query_test
