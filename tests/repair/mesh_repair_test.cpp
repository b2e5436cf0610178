#include "tactum/repair/mesh_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/sample_meshes.h"
#include "tactum/base/random.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/repair/hole_filling.h"
#include "tactum/repair/surface_crossings.h"

namespace tactum {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::prism;
using testing::transformed;

void add(const TriangleMesh& more, TriangleMesh& mesh) {
  const int base = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Triangle& t : more.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

TriangleMesh turned(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh moved(const TriangleMesh& mesh, const Vec3& by) {
  return transformed(mesh, Mat3::Identity(), by);
}

const RepairNote* note(const RepairedMesh& repaired, const std::string& kind) {
  const auto found = std::find_if(repaired.notes.begin(), repaired.notes.end(),
                                  [&](const RepairNote& n) { return n.kind == kind; });
  return found == repaired.notes.end() ? nullptr : &*found;
}

double volume_of(const TriangleMesh& mesh) { return report_mesh(mesh).volume; }

TEST(MeshRepair, ASoundMeshStaysAsItIsAndNothingIsTold) {
  const TriangleMesh ball = icosphere(3);
  const RepairedMesh repaired = repair_mesh(ball);
  EXPECT_TRUE(repaired.notes.empty());
  EXPECT_EQ(repaired.mesh.triangles, ball.triangles);
  EXPECT_EQ(repaired.mesh.vertices, ball.vertices);
  ASSERT_EQ(repaired.components.size(), 1u);
  EXPECT_TRUE(repaired.components[0].closed);
}

TEST(MeshRepair, SoupIsWeldedAndDoublesAndDegenerateTrianglesGo) {
  const TriangleMesh box = box_mesh({1, 2, 3});
  TriangleMesh soup;
  for (const Triangle& t : box.triangles) {
    const int base = static_cast<int>(soup.vertices.size());
    for (int corner : t) soup.vertices.push_back(box.vertices[corner]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  soup.vertices.emplace_back(100, 100, 100);  // used by none: must not stretch the box
  soup.triangles.push_back({3, 4, 5});        // stands twice
  soup.triangles.push_back({0, 1, 0});        // two equal corners
  const RepairedMesh repaired = repair_mesh(soup);
  EXPECT_EQ(repaired.mesh.vertices.size(), 8u);
  EXPECT_EQ(repaired.mesh.triangles.size(), 12u);
  ASSERT_NE(note(repaired, "duplicate_triangles"), nullptr);
  EXPECT_EQ(note(repaired, "duplicate_triangles")->triangle, 12);
  ASSERT_NE(note(repaired, "degenerate_triangles"), nullptr);
  EXPECT_EQ(note(repaired, "degenerate_triangles")->triangle, 13);
  EXPECT_EQ(note(repaired, "joined_vertices")->count, 36 - 8);
  EXPECT_TRUE(report_mesh(repaired.mesh).convex);
}

TEST(MeshRepair, EveryTriangleTurnedAtRandomComesOutOutward) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    TriangleMesh mesh = prism(9, 1.0, 0.5);
    add(moved(icosphere(2), {5, 0, 0}), mesh);
    add(moved(box_mesh({1, 1, 1}), {0, 6, 0}), mesh);
    const double volume = volume_of(mesh);
    int flipped = 0;
    for (Triangle& t : mesh.triangles) {
      if (random.unit() < 0.4) {
        std::swap(t[1], t[2]);
        ++flipped;
      }
    }
    const RepairedMesh repaired = repair_mesh(mesh);
    ASSERT_NE(note(repaired, "flipped_triangles"), nullptr);
    EXPECT_EQ(note(repaired, "flipped_triangles")->count, flipped);
    EXPECT_TRUE(report_mesh(repaired.mesh).oriented);
    EXPECT_NEAR(volume_of(repaired.mesh), volume, 1e-12);
    EXPECT_EQ(repaired.components.size(), 3u);
  }
}

TEST(MeshRepair, ACavityFacesInwardHoweverTheFileHasIt) {
  for (const bool inner_turned : {false, true}) {
    for (const bool outer_turned : {false, true}) {
      TriangleMesh mesh = outer_turned ? turned(box_mesh({2, 2, 2})) : box_mesh({2, 2, 2});
      add(inner_turned ? turned(box_mesh({1, 1, 1})) : box_mesh({1, 1, 1}), mesh);
      add(box_mesh({0.5, 0.5, 0.5}), mesh);  // a solid loose in the cavity
      const RepairedMesh repaired = repair_mesh(mesh);
      ASSERT_EQ(repaired.components.size(), 3u);
      EXPECT_EQ(repaired.components[1].depth, 1);
      EXPECT_EQ(repaired.components[2].depth, 2);
      EXPECT_NEAR(volume_of(repaired.mesh), 64 - 8 + 1, 1e-12);
      ASSERT_NE(note(repaired, "cavities"), nullptr);
      EXPECT_EQ(note(repaired, "cavities")->triangle, 12);
      EXPECT_EQ(note(repaired, "turned_components") != nullptr, outer_turned || !inner_turned);
    }
  }
}

TEST(MeshRepair, ComponentsThatCutEachOtherStayOutwardAndAreTold) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  add(moved(box_mesh({0.3, 0.4, 5}), {0.1, 0.05, 0}), mesh);
  const RepairedMesh repaired = repair_mesh(mesh);
  EXPECT_NEAR(volume_of(repaired.mesh), 8 + 4.8, 1e-12);
  EXPECT_NE(note(repaired, "cutting_components"), nullptr);
  EXPECT_EQ(note(repaired, "cavities"), nullptr);
}

TEST(MeshRepair, AnOpenSheetFacesAsMostOfItDid) {
  TriangleMesh sheet = icosphere(2);
  sheet.triangles.resize(sheet.triangles.size() / 2);
  const RepairedMesh kept = repair_mesh(sheet);
  EXPECT_EQ(note(kept, "flipped_triangles"), nullptr);
  TriangleMesh mixed = sheet;
  for (std::size_t t = 0; t < mixed.triangles.size(); t += 3)
    std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
  EXPECT_TRUE(report_mesh(repair_mesh(mixed).mesh).oriented);
  EXPECT_NEAR(volume_of(repair_mesh(mixed).mesh), volume_of(kept.mesh), 1e-12);
  EXPECT_EQ(note(kept, "holes")->count, 1);
}

TEST(MeshRepair, AMoebiusBandIsToldWithItsPlace) {
  TriangleMesh band;
  constexpr int kSteps = 24;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = 2 * kPi * i / kSteps;
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const Vec3 across = std::cos(angle / 2) * along + std::sin(angle / 2) * Vec3(0, 0, 1);
    band.vertices.push_back(along + 0.2 * across);
    band.vertices.push_back(along - 0.2 * across);
  }
  for (int i = 0; i < kSteps; ++i) {
    const int a = 2 * i, b = 2 * i + 1;
    const bool last = i + 1 == kSteps;
    const int c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.triangles.push_back({a, b, c});
    band.triangles.push_back({b, d, c});
  }
  const RepairedMesh repaired = repair_mesh(band);
  ASSERT_NE(note(repaired, "twisted_components"), nullptr);
  EXPECT_NE(note(repaired, "twisted_components")->sentence().find("triangle 0 at"), std::string::npos);
}

TEST(MeshRepair, NonManifoldEdgesAndPinchedVerticesAreToldWithTheirPlace) {
  TriangleMesh fin = box_mesh({1, 1, 1});
  fin.vertices.emplace_back(-1, -1, -3);
  fin.triangles.push_back({0, 1, 8});  // a fin at the edge from corner 0 to 1
  const RepairedMesh with_fin = repair_mesh(fin);
  ASSERT_NE(note(with_fin, "non_manifold_edges"), nullptr);
  EXPECT_EQ(note(with_fin, "non_manifold_edges")->count, 1);

  TriangleMesh touching = box_mesh({1, 1, 1});
  add(moved(box_mesh({1, 1, 1}), {2, 2, 2}), touching);  // corner on corner
  const RepairedMesh pinched = repair_mesh(touching);
  ASSERT_NE(note(pinched, "pinched_vertices"), nullptr);
  EXPECT_EQ(note(pinched, "pinched_vertices")->count, 1);
  EXPECT_EQ(note(pinched, "non_manifold_edges"), nullptr);
  EXPECT_NEAR(volume_of(pinched.mesh), 16, 1e-12);
}

TEST(MeshRepair, TwoSolidsThatShareAnEdgeAreTwoClosedComponents) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  add(turned(moved(box_mesh({1, 1, 1}), {2, 2, 0})), mesh);
  const RepairedMesh repaired = repair_mesh(mesh);
  ASSERT_EQ(repaired.components.size(), 2u);
  EXPECT_TRUE(repaired.components[0].closed && repaired.components[1].closed);
  EXPECT_NEAR(volume_of(repaired.mesh), 16, 1e-12);
  EXPECT_EQ(note(repaired, "non_manifold_edges")->count, 1);
}

/// A box whose one edge has corners in its middle on one side, joined by caps on the other.
TriangleMesh box_with_caps(int caps) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  // The triangle {0, 1, 5} becomes a fan from 5 over points on the edge 0 - 1, and caps close the T-joints.
  mesh.triangles.erase(mesh.triangles.begin() + 4);
  int before = 0;
  for (int i = 1; i <= caps; ++i) {
    const int point = static_cast<int>(mesh.vertices.size());
    mesh.vertices.emplace_back(-1.0 + 2.0 * i / (caps + 1), -1, -1);
    mesh.triangles.push_back({before, point, 5});
    mesh.triangles.push_back({before, 1, point});
    before = point;
  }
  mesh.triangles.push_back({before, 1, 5});
  return mesh;
}

TEST(MeshRepair, CapsAreGivenToTheirNeighbours) {
  for (const int caps : {1, 2, 7}) {
    SCOPED_TRACE(caps);
    const TriangleMesh mesh = box_with_caps(caps);
    ASSERT_TRUE(report_mesh(mesh).closed);
    ASSERT_EQ(report_mesh(mesh).zero_area.size(), static_cast<std::size_t>(caps));
    const RepairedMesh repaired = repair_mesh(mesh);
    const MeshReport report = report_mesh(repaired.mesh);
    EXPECT_TRUE(report.closed && report.oriented);
    EXPECT_TRUE(report.zero_area.empty());
    EXPECT_NEAR(report.volume, 8, 1e-12);
    EXPECT_NEAR(report.area, 24, 1e-12);
    EXPECT_EQ(note(repaired, "zero_area_mended")->count, caps);
  }
}

TEST(MeshRepair, AMeshOfOneLineLosesItsTriangles) {
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_TRUE(repair_mesh(line).mesh.triangles.empty());
}

TEST(HoleFilling, OnlyWhenAskedAndOnlySmallOnes) {
  TriangleMesh prism12 = prism(12, 1.0, 0.5);
  // Both lids away: two holes of twelve edges.
  std::erase_if(prism12.triangles, [&](const Triangle& t) {
    const double z = prism12.vertices[t[0]].z();
    return prism12.vertices[t[1]].z() == z && prism12.vertices[t[2]].z() == z;
  });
  const double whole = volume_of(prism(12, 1.0, 0.5));
  const RepairedMesh open = repair_mesh(prism12);
  EXPECT_EQ(note(open, "holes")->count, 2);
  EXPECT_EQ(open.mesh.triangles.size(), 24u);
  EXPECT_EQ(repair_mesh(prism12, {.close_holes = 11}).mesh.triangles.size(), 24u);
  const RepairedMesh closed = repair_mesh(prism12, {.close_holes = 12});
  EXPECT_EQ(note(closed, "closed_holes")->count, 2);
  EXPECT_EQ(note(closed, "holes"), nullptr);
  EXPECT_TRUE(report_mesh(closed.mesh).convex);
  EXPECT_NEAR(volume_of(closed.mesh), whole, 1e-12);
  EXPECT_EQ(std::count(closed.source.begin(), closed.source.end(), -1), 20);
}

TEST(HoleFilling, AConcaveFlatHoleIsFilledWithoutFolds) {
  // An arrow-shaped rim in the plane z = 0 with a wall below it: the fill's area is the polygon's.
  const std::vector<Vec3> rim = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}};
  TriangleMesh wall;
  const int n = static_cast<int>(rim.size());
  for (const Vec3& p : rim) wall.vertices.push_back(p);
  for (const Vec3& p : rim) wall.vertices.emplace_back(p - Vec3(0, 0, 1));
  for (int i = 0; i < n; ++i) {
    const int k = (i + 1) % n;
    wall.triangles.push_back({i + n, k + n, k});
    wall.triangles.push_back({i + n, k, i});
  }
  const RepairedMesh closed = repair_mesh(wall, {.close_holes = 8});
  const MeshReport report = report_mesh(closed.mesh);
  EXPECT_TRUE(report.closed && report.oriented);
  EXPECT_NEAR(report.volume, 16 - 6, 1e-12);
}

TEST(HoleFilling, ACrackIsClosedWithoutMovingAnything) {
  // A corner in the middle of one edge that the neighbour does not know: a rim of three edges, no area.
  TriangleMesh mesh = box_with_caps(1);
  mesh.triangles.erase(mesh.triangles.end() - 2);
  ASSERT_EQ(report_mesh(mesh).boundary_edges, 3);
  const RepairedMesh closed = repair_mesh(mesh);
  const MeshReport report = report_mesh(closed.mesh);
  EXPECT_TRUE(report.closed && report.oriented);
  EXPECT_TRUE(report.zero_area.empty());
  EXPECT_NEAR(report.area, 24, 1e-12);
  EXPECT_EQ(note(closed, "closed_cracks")->count, 1);
}

/// A box of sides 2, each face cut into n x n squares with an n of its own, all corners apart: along every
/// edge of the box the two faces know different corners.
TriangleMesh box_of_different_grids(Random& random) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const int n = 1 + int(random.unit() * 7);
      const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
      const int base = static_cast<int>(mesh.vertices.size());
      for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= n; ++k)
          mesh.vertices.emplace_back(side * Vec3::Unit(axis) + (2.0 * i / n - 1.0) * u +
                                     (2.0 * k / n - 1.0) * v);
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          const int a = base + i * (n + 1) + k, b = a + n + 1;
          for (Triangle t : {Triangle{a, b, b + 1}, Triangle{a, b + 1, a + 1}}) {
            if (side < 0.0) std::swap(t[1], t[2]);
            mesh.triangles.push_back(t);
          }
        }
    }
  return mesh;
}

TEST(HoleFilling, CracksBetweenFacesOfDifferentGridsAreClosed) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    TriangleMesh mesh = box_of_different_grids(random);
    const double size = std::pow(10.0, random.uniform(-4.0, 1.0));
    mesh = transformed(mesh, size * exp_rotation(Vec3(random.unit(), 2.0, random.unit())), Vec3(size, 0, 0));
    const bool stored_single = seed % 2 == 0;
    if (stored_single)
      for (Vec3& vertex : mesh.vertices) vertex = vertex.cast<float>().cast<double>();
    if (seed % 3 == 0)
      for (std::size_t t = 0; t < mesh.triangles.size(); t += 5)
        std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    const RepairedMesh closed = repair_mesh(mesh);
    const MeshReport report = report_mesh(closed.mesh);
    EXPECT_TRUE(report.balanced);
    EXPECT_EQ(note(closed, "holes"), nullptr);
    EXPECT_NEAR(report.volume / (size * size * size), 8.0, stored_single ? 1e-5 : 1e-12);
  }
}

TEST(HoleFilling, SmallSheetsAndSmallRoundHolesAreNoCracks) {
  TriangleMesh sheets;
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)})
    add(moved(testing::sheet(1, 2e-5), place), sheets);
  const RepairedMesh repaired = repair_mesh(sheets);
  EXPECT_EQ(note(repaired, "closed_cracks"), nullptr);
  EXPECT_EQ(repaired.mesh.triangles.size(), 8u);
}

TEST(HoleFilling, AHoleOfAHundredthOfTheSizeIsNoCrack) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  const Triangle lid = mesh.triangles.back();
  mesh.triangles.pop_back();
  const int point = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(0.5 * (mesh.vertices[lid[0]] + mesh.vertices[lid[1]]) +
                          0.02 * (mesh.vertices[lid[2]] - mesh.vertices[lid[0]]));
  mesh.triangles.push_back({point, lid[1], lid[2]});
  mesh.triangles.push_back({lid[0], point, lid[2]});
  ASSERT_NE(note(repair_mesh(mesh), "holes"), nullptr);
  EXPECT_EQ(note(repair_mesh(mesh), "closed_cracks"), nullptr);
  EXPECT_EQ(note(repair_mesh(mesh, {.close_holes = 3}), "closed_holes")->count, 1);
}

TEST(SurfaceCrossings, AgreeWithSolidAnglesEverywhere) {
  // The referee: the sum of the triangles' solid angles [Oosterom and Strackee 1983].
  constexpr std::uint64_t kSeed = 77;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  TriangleMesh mesh = prism(7, 1.0, 0.6);
  add(moved(turned(icosphere(2)), {0.4, 0.2, 0.1}), mesh);
  std::vector<int> surface(mesh.triangles.size(), 1);
  std::fill(surface.begin(),
            surface.begin() + static_cast<std::ptrdiff_t>(prism(7, 1.0, 0.6).triangles.size()), 0);
  const SurfaceCrossings crossings(mesh, surface);
  const auto solid_angles = [&](int which, const Vec3& p) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (surface[t] != which) continue;
      const Vec3 a = mesh.vertices[mesh.triangles[t][0]] - p;
      const Vec3 b = mesh.vertices[mesh.triangles[t][1]] - p;
      const Vec3 c = mesh.vertices[mesh.triangles[t][2]] - p;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return static_cast<int>(std::lround(sum / (4 * kPi)));
  };
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
    if (i % 4 == 0) p.z() = 0.6 - (i % 8 == 0 ? 0.05 : 0.0);  // many rays along a lid's plane
    if (i % 4 == 1)
      p.tail<2>() = mesh.vertices[14 + random.index(60)].tail<2>();  // through the ball's corners
    if (i % 4 == 0 && i % 8 != 0) continue;                          // on the lid itself
    std::vector<std::pair<int, int>> expected;
    for (int which : {0, 1})
      if (const int winding = solid_angles(which, p); winding != 0) expected.emplace_back(which, winding);
    inside += expected.empty() ? 0 : 1;
    EXPECT_EQ(crossings.windings(p), expected) << p.transpose();
  }
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace tactum
