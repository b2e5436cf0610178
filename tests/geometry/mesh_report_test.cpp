#include "tactum/geometry/mesh_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "mesh/gltf_sample.h"
#include "support/effort.h"
#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "tactum/base/random.h"
#include "tactum/geometry/weld.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum::mesh_report_test {
namespace {

using testing::box_mesh;
using testing::icosphere;

/// Every triangle with corners of its own, as STL stores them.
TriangleMesh exploded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    const int first = static_cast<int>(soup.vertices.size());
    for (int corner : t) soup.vertices.push_back(mesh.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

TEST(MeshReport, CountsEdgesBentOutwardAndInward) {
  const MeshReport box = report_mesh(testing::box_mesh({1, 2, 3}));
  EXPECT_EQ(box.convex_edges, 12);  // the diagonals of its sides are flat
  EXPECT_EQ(box.reflex_edges, 0);
  TriangleMesh inside_out = testing::box_mesh({1, 2, 3});
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(report_mesh(inside_out).reflex_edges, 12);
}

TEST(Weld, JoinsWhatWasExploded) {
  const TriangleMesh sphere = icosphere(3);
  const WeldedMesh welded = weld(exploded(sphere));
  EXPECT_EQ(welded.mesh.vertices.size(), sphere.vertices.size());
  EXPECT_EQ(welded.mesh.triangles.size(), sphere.triangles.size());
  EXPECT_EQ(welded.report.vertices_joined,
            static_cast<int>(3 * sphere.triangles.size() - sphere.vertices.size()));
}

TEST(Weld, JoinsWithinTheToleranceAcrossCellsAndNotBeyond) {
  const std::uint64_t seed = 31;
  Random random(seed);
  const TriangleMesh sphere = icosphere(3);
  TriangleMesh shaken = exploded(sphere);
  const double tolerance = 1e-4 * bounds(sphere.vertices).diagonal();
  for (Vec3& p : shaken.vertices) {
    const double x = random.uniform(-0.25, 0.25);
    const double y = random.uniform(-0.25, 0.25);
    p += tolerance * Vec3(x, y, 0.0);
  }
  EXPECT_EQ(weld(shaken, {.tolerance = 1e-4}).mesh.vertices.size(), sphere.vertices.size())
      << "seed " << seed;
  EXPECT_GT(weld(shaken, {.tolerance = 1e-7}).mesh.vertices.size(), 2 * sphere.vertices.size());
}

TEST(Weld, DropsAndCountsWithPlaces) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices.push_back(mesh.vertices[0]);  // a twin
  const int twin = static_cast<int>(mesh.vertices.size()) - 1;
  mesh.triangles.push_back({0, twin, 1});  // 12: corners that are one
  mesh.vertices.push_back(0.5 * (mesh.vertices[0] + mesh.vertices[1]));
  mesh.triangles.push_back({0, 1, twin + 1});  // 13: no area
  mesh.triangles.push_back({mesh.triangles[3][1], mesh.triangles[3][2], mesh.triangles[3][0]});  // 14: again
  const WeldedMesh welded = weld(mesh, {.drop_zero_area = true, .drop_duplicates = true});
  EXPECT_EQ(welded.report.index_degenerate, std::vector<int>{12});
  EXPECT_EQ(welded.report.zero_area, std::vector<int>{13});
  EXPECT_EQ(welded.report.duplicates, std::vector<int>{14});
  EXPECT_EQ(welded.mesh.triangles.size(), 12u);
}

TEST(MeshReport, BoxAndSphere) {
  const MeshReport box = report_mesh(box_mesh({1, 2, 3}));
  EXPECT_TRUE(box.closed && box.manifold() && box.oriented && box.convex);
  EXPECT_NEAR(box.volume, 48.0, 1e-12);
  EXPECT_NEAR(box.area, 88.0, 1e-12);
  EXPECT_EQ(box.euler, 2);
  EXPECT_TRUE(report_mesh(icosphere(3)).convex);
}

TEST(MeshReport, SeesHolesTurnsFinsAndDents) {
  TriangleMesh open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_EQ(report_mesh(open).boundary_edges, 3);
  EXPECT_FALSE(report_mesh(open).closed);

  TriangleMesh turned = box_mesh({1, 1, 1});
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_EQ(report_mesh(turned).misoriented_edges, 3);
  EXPECT_TRUE(report_mesh(turned).closed);

  TriangleMesh fin = box_mesh({1, 1, 1});
  fin.vertices.push_back({5, 5, 5});
  fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], 8});
  EXPECT_EQ(report_mesh(fin).non_manifold_edges, 1);
  EXPECT_EQ(report_mesh(fin).boundary_edges, 2);

  TriangleMesh dented = icosphere(2);
  dented.vertices[40] *= 0.9;
  EXPECT_FALSE(report_mesh(dented).convex);
  EXPECT_TRUE(report_mesh(dented).closed);

  TriangleMesh two = box_mesh({1, 1, 1});
  for (const Vec3& p : box_mesh({1, 1, 1}).vertices) two.vertices.push_back(p + Vec3(9, 0, 0));
  for (const Triangle& t : box_mesh({1, 1, 1}).triangles)
    two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(report_mesh(two).components, 2);
  EXPECT_FALSE(report_mesh(two).convex);
}

TEST(MeshReport, GuessesUnits) {
  EXPECT_EQ(guess_unit({Vec3::Zero(), {0.02, 0.02, 0.04}}).name, "metres");
  EXPECT_EQ(guess_unit({Vec3::Zero(), {203, 304, 12}}).name, "millimetres");
  EXPECT_EQ(guess_unit({Vec3::Zero(), {5, 2.5, 1}}).name, "inches");
  EXPECT_FALSE(guess_unit({Vec3::Zero(), {5, 2.5, 1}}).certain);
  EXPECT_TRUE(guess_unit({Vec3::Zero(), {203, 304, 12}}).certain);
}

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) cells.push_back(cell);
  return cells;
}

Vec3 vector_of(const std::string& text) {
  std::stringstream stream(text);
  Vec3 v;
  stream >> v.x() >> v.y() >> v.z();
  return v;
}

/// Judged by the inventory of the same files that another program made.
TEST(MeshReport, RealMeshesMatchTheirInventory) {
  TACTUM_NEEDS_REAL_DATA();
  std::ifstream file(testing::real_data() / "mesh_inventory.csv");
  std::string line;
  std::getline(file, line);
  int compared = 0;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cells_of(line, '|');
    ASSERT_EQ(cells.size(), 21u);
    const bool is_long = std::stoi(cells[5]) > 30000;
    if (is_long && !testing::full_run()) continue;
    const Result<ImportedMesh> mesh = import_mesh((testing::real_data() / cells[0]).string());
    ASSERT_TRUE(mesh) << mesh.error().message();
    const MeshReport report = report_mesh(mesh->mesh, 0.0);  // the inventory joins equal coordinates only
    const std::string& name = cells[0];
    EXPECT_EQ(report.vertices, std::stoi(cells[4])) << name;
    EXPECT_EQ(report.triangles, std::stoi(cells[5])) << name;
    EXPECT_EQ(mesh->report.polygons_split, std::stoi(cells[6])) << name;
    const std::vector<std::string> degenerate = cells_of(cells[8], '+');
    EXPECT_EQ(static_cast<int>(report.index_degenerate.size()), std::stoi(degenerate[0])) << name;
    EXPECT_GE(static_cast<int>(report.zero_area.size()), std::stoi(degenerate[1]))
        << name;  // ours also counts near zero
    EXPECT_EQ(report.duplicate_triangles, std::stoi(cells[9])) << name;
    EXPECT_EQ(report.boundary_edges, std::stoi(cells[10])) << name;
    EXPECT_EQ(report.non_manifold_edges, std::stoi(cells[11])) << name;
    EXPECT_EQ(report.misoriented_edges, std::stoi(cells[12])) << name;
    EXPECT_EQ(report.components, std::stoi(cells[13])) << name;
    EXPECT_EQ(report.euler, std::stoi(cells[14])) << name;
    EXPECT_EQ(report.closed                ? "yes"
              : report.boundary_edges == 0 ? "closed-nonmanifold"
                                           : "no",
              cells[15])
        << name;
    EXPECT_EQ(report.oriented, cells[16] == "yes") << name;
    if (report.boundary_edges == 0) {
      EXPECT_NEAR(report.volume, std::stod(cells[17]), 1e-5 * std::abs(report.volume)) << name;
    }
    // Fans over concave polygons, as the inventory cuts them, cover more than the polygons.
    const double area = std::stod(cells[18]);
    EXPECT_NEAR(report.area, area, (mesh->report.concave_polygons > 0 ? 1e-4 : 1e-5) * area) << name;
    const double size = report.box.diagonal();
    EXPECT_LT((report.box.min - vector_of(cells[19])).norm(), 1e-5 * size) << name;
    EXPECT_LT((report.box.max - vector_of(cells[20])).norm(), 1e-5 * size) << name;
    ++compared;
  }
  EXPECT_GT(compared, 25);
}

TEST(MeshReport, RoundingOpensNoHoles) {
  TACTUM_NEEDS_REAL_DATA();
  const Result<ImportedMesh> mesh = import_mesh((testing::real_data() / "cad/featuretype.STL").string());
  ASSERT_TRUE(mesh);
  EXPECT_EQ(report_mesh(mesh->mesh, 0.0).boundary_edges, 576);  // zeros that are -3e-16 elsewhere
  EXPECT_TRUE(report_mesh(mesh->mesh).closed);
}

}  // namespace
}  // namespace tactum::mesh_report_test
