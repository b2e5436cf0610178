#include "tactum/mesh/make_part.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "support/sample_solids.h"
#include "tactum/geometry/coplanar_groups.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::prism;
using testing::transformed;

/// An L of two boxes that share a wall, each a group of its own.
ImportedMesh two_boxes() {
  ImportedMesh out;
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(2, 0, 0)}) {
    const TriangleMesh box = transformed(box_mesh({1, 1, 1}), Mat3::Identity(), center);
    const int base = static_cast<int>(out.mesh.vertices.size());
    out.groups.push_back(
        {center.x() > 0 ? "right" : "left", static_cast<int>(out.mesh.triangles.size()), 12});
    out.mesh.vertices.insert(out.mesh.vertices.end(), box.vertices.begin(), box.vertices.end());
    for (const Triangle& t : box.triangles)
      out.mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return out;
}

TEST(Part, ConvexMeshIsOneSolidPiece) {
  const Result<Part> part = part_from_mesh(prism(12, 0.01, 0.02), {.name = "rod", .density_kg_per_m3 = 7800});
  ASSERT_TRUE(part);
  EXPECT_EQ(part->pieces.size(), 1u);
  EXPECT_FALSE(part->is_surface());
  EXPECT_EQ(part->pieces[0].faces.size(), 14u);
  EXPECT_NEAR(part->radius, std::hypot(0.01, 0.02), 1e-12);
  EXPECT_NEAR(part->mass.mass, 7800 * part->mass.volume, 1e-12);
  EXPECT_TRUE(part->notes.remarks.empty());
}

TEST(Part, OtherMeshesAreFeltByTheirSurface) {
  TriangleMesh dented = icosphere(2);
  dented.vertices[40] *= 0.8;
  const Result<Part> part = part_from_mesh(dented, {.pieces = PieceSource::kSurface});
  ASSERT_TRUE(part);
  EXPECT_TRUE(part->is_surface());
  EXPECT_EQ(part->tree.triangle_count(), static_cast<int>(dented.triangles.size()));
  for (std::size_t i = 0; i < part->surface.triangles.size(); ++i)
    EXPECT_GT(triangle_normal(part->surface, i).dot(part->surface.vertices[part->surface.triangles[i][0]]),
              0.0);
  // No two triangles of it are coplanar.
  EXPECT_EQ(part->groups.count, static_cast<int>(part->surface.triangles.size()));
}

TEST(Part, GivenGroupsAreVerifiedConvex) {
  const Result<Part> part = part_from_convex_groups(two_boxes(), {.scale = 0.01, .density_kg_per_m3 = 1000});
  ASSERT_TRUE(part) << part.error().message();
  EXPECT_EQ(part->pieces.size(), 2u);
  EXPECT_NEAR(part->mass.volume, 16e-6, 1e-15);
  EXPECT_LT((part->mass.center - Vec3(0.01, 0, 0)).norm(), 1e-12);
  // As one box of 4 x 2 x 2 cm.
  EXPECT_NEAR(part->mass.inertia(0, 0), part->mass.mass / 3.0 * 2e-4, 1e-12);
  EXPECT_NEAR(part->mass.inertia(1, 1), part->mass.mass / 3.0 * 5e-4, 1e-12);

  ImportedMesh whole = two_boxes();
  whole.mesh.vertices[15] = Vec3(1.5, 0.5, 0.5);  // pushed in
  const Result<Part> bent = part_from_convex_groups(whole);
  ASSERT_FALSE(bent);
  EXPECT_NE(bent.error().message().find("'right'"), std::string::npos) << bent.error().message();
  EXPECT_NE(bent.error().message().find("edge ("), std::string::npos);

  whole = two_boxes();
  whole.groups = {{"both", 0, 24}};
  const Result<Part> joined =
      part_from_convex_groups(whole);  // without the wall between them they are one box
  ASSERT_TRUE(joined) << joined.error().message();
  EXPECT_NEAR(joined->mass.volume, 16.0, 1e-12);
  for (std::size_t v = 8; v < 16; ++v) whole.mesh.vertices[v].x() += 0.5;
  EXPECT_FALSE(part_from_convex_groups(whole));
}

TEST(Part, CloudsMustSpanASolid) {
  EXPECT_TRUE(part_from_clouds({box_mesh({1, 1, 1}).vertices}));
  EXPECT_FALSE(part_from_clouds({}));
  EXPECT_FALSE(part_from_clouds({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}}));
  EXPECT_FALSE(part_from_clouds({box_mesh({1, 1, 1}).vertices}, {.scale = -1.0}));
}

TEST(Part, InwardSurfacesAreTurnedAndTold) {
  TriangleMesh inward = box_mesh({1, 1, 1});
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  const Result<Part> part = part_from_mesh(inward);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->pieces.size(), 1u);
  ASSERT_EQ(part->notes.remarks.size(), 2u);
  EXPECT_NE(part->notes.remarks[1].find("1 component faced the wrong way"), std::string::npos);
  EXPECT_NEAR(part->mass.volume, 8.0, 1e-12);
}

TEST(Part, AVertexThatNoTriangleUsesIsNoCornerOfTheSolid) {
  for (const Vec3& far : {Vec3(10, 0, 0), Vec3(1e9, 0, 0)}) {
    TriangleMesh box = box_mesh({1, 1, 1});
    box.vertices.insert(box.vertices.begin(), far);
    for (Triangle& t : box.triangles)
      for (int& corner : t) ++corner;
    TriangleMesh turned = box;
    for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
    for (const TriangleMesh& mesh : {box, turned}) {
      const Result<Part> part = part_from_mesh(mesh);
      ASSERT_TRUE(part) << part.error().message();
      ASSERT_EQ(part->pieces.size(), 1u);
      EXPECT_EQ(part->pieces[0].vertices.size(), 8u);
      EXPECT_NEAR(part->size, 2.0 * std::sqrt(3.0), 1e-12);
    }
  }
}

TEST(Part, SaysWhichWayItWentAndWhy) {
  const TriangleMesh star = testing::extruded_mesh(testing::star(5, 0.02, 0.05), 0.0, 0.03);
  const Result<Part> solid = part_from_mesh(star);
  ASSERT_TRUE(solid);
  EXPECT_FALSE(solid->is_surface());
  EXPECT_EQ(solid->notes.pieces,
            fmt::format("solid: {} convex pieces from 5 reflex edges", solid->pieces.size()));
  EXPECT_NEAR(solid->mass.volume, report_mesh(star).volume, 1e-12);
  EXPECT_EQ(part_from_mesh(star, {.pieces = PieceSource::kSurface})->notes.pieces, "surface: asked for");
  EXPECT_EQ(part_from_mesh(box_mesh({1, 1, 1}))->notes.pieces, "solid: convex as it is");
  const TriangleMesh gear = testing::extruded_mesh(testing::star(60, 0.04, 0.05), 0.0, 0.03);
  const Result<Part> many = part_from_mesh(gear);
  ASSERT_TRUE(many);
  EXPECT_TRUE(many->is_surface());
  EXPECT_EQ(many->notes.pieces, "surface: the solid does not fall into few convex pieces (60 reflex edges)");
  EXPECT_FALSE(part_from_mesh(gear, {.pieces = PieceSource::kSolid})->is_surface());
  TriangleMesh open = star;
  open.triangles.pop_back();
  EXPECT_TRUE(part_from_mesh(open)->is_surface());
  const Result<Part> refused = part_from_mesh(open, {.name = "star", .pieces = PieceSource::kSolid});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("star: the part cannot be built: found 3 open edges at ("),
            std::string::npos)
      << refused.error().message();
  EXPECT_FALSE(part_from_mesh(star, {.pieces = PieceSource::kGiven}));
}

TEST(CoplanarGroups, ASubdividedBoxHasSixHoweverTurnedAndRounded) {
  TriangleMesh fine = box_mesh({0.02, 0.03, 0.05});
  for (int level = 0; level < 3; ++level) {
    TriangleMesh finer;
    for (const Triangle& t : fine.triangles) {
      const int base = static_cast<int>(finer.vertices.size());
      const Vec3 &a = fine.vertices[t[0]], &b = fine.vertices[t[1]], &c = fine.vertices[t[2]];
      for (const Vec3& p : {a, b, c, Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))})
        finer.vertices.push_back(p);
      for (const Triangle& u : {Triangle{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
        finer.triangles.push_back({base + u[0], base + u[1], base + u[2]});
      }
    }
    fine = finer;
  }
  fine = transformed(fine, exp_rotation(Vec3(0.4, 0.5, -0.9)), Vec3(0.1, 0.2, 0.05));
  for (Vec3& p : fine.vertices) p = p.cast<float>().cast<double>();  // as STL and most programs store it
  // Opened, so that it is taken as a surface, felt from both sides.
  fine.triangles.pop_back();
  const Result<Part> part = part_from_mesh(fine);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->surface.triangles.size(), 2u * 767u);
  EXPECT_EQ(part->groups.count, 2 * 6);
}

TEST(CoplanarGroups, FacetsOfARoundPegStayApart) {
  TriangleMesh peg = prism(1000, 0.004, 0.025);
  const std::vector<int> groups = coplanar_groups(peg);
  EXPECT_EQ(std::set<int>(groups.begin(), groups.end()).size(), 1002u);
}

TEST(Part, RealMeshesBecomeParts) {
  TACTUM_NEEDS_REAL_DATA();
  for (const char* name :
       {"factory_rectangular_hole_8mm_subdiv_3x.obj", "factory_rectangular_peg_8mm_loose_subdiv_3x.obj",
        "factory_nut_m8_loose_subdiv_3x.obj", "pump_base.stl", "cup.obj"}) {
    const Result<ImportedMesh> mesh = import_mesh(testing::find_real(name).string());
    ASSERT_TRUE(mesh) << mesh.error().message();
    const Result<Part> part = part_from_mesh(mesh->mesh, {.name = name});
    ASSERT_TRUE(part) << part.error().message();
    std::printf("%s: %zu triangles, %d facets, mass %.4g kg\n", name, part->surface.triangles.size(),
                part->groups.count, part->mass.mass);
    for (const std::string& remark : part->notes.remarks) std::printf("  %s\n", remark.c_str());
    EXPECT_LE(part->groups.count, static_cast<int>(part->surface.triangles.size()));
    EXPECT_GT(part->mass.mass, 0.0);
  }
}

}  // namespace
}  // namespace tactum
