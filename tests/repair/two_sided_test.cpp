#include "tactum/repair/two_sided.h"

#include <gtest/gtest.h>

#include "support/sample_meshes.h"
#include "tactum/geometry/mesh_report.h"

namespace tactum {
namespace two_sided_test {
namespace {

TEST(TwoSided, OpenSurfacesHaveABackOfTheirOwnCorners) {
  TriangleMesh cup = testing::box_mesh({1, 1, 1});
  cup.triangles.resize(cup.triangles.size() - 2);
  const RepairedMesh repaired = repair_mesh(cup);
  const TriangleMesh both = with_backs(repaired);
  EXPECT_EQ(both.triangles.size(), 20u);
  EXPECT_EQ(both.vertices.size(), 16u);
  EXPECT_NEAR(open_area(repaired), 20.0, 1e-12);
  Vec3 area = Vec3::Zero();  // front and back cancel
  for (const Triangle& t : both.triangles) {
    const Vec3& a = both.vertices[t[0]];
    area += (both.vertices[t[1]] - a).cross(both.vertices[t[2]] - a);
  }
  EXPECT_LT(area.norm(), 1e-12);
}

TEST(TwoSided, ClosedSurfacesStayAsTheyAre) {
  const TriangleMesh ball = testing::icosphere(2);
  const RepairedMesh repaired = repair_mesh(ball);
  EXPECT_EQ(with_backs(repaired).triangles, repaired.mesh.triangles);
  EXPECT_EQ(open_area(repaired), 0.0);
}

}  // namespace
}  // namespace two_sided_test
}  // namespace tactum
