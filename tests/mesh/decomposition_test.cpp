#include "tactum/mesh/decomposition.h"

#include <gtest/gtest.h>

#include "support/effort.h"
#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "support/sample_solids.h"
#include "tactum/base/random.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/geometry/weld.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum {
namespace {

using testing::GridSolid;

/// Solid angle of the mesh seen from p over 4 pi: 1 inside, 0 outside [Oosterom and Strackee 1983].
double winding(const TriangleMesh& mesh, const Vec3& p) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p;
    const Vec3 b = mesh.vertices[t[1]] - p;
    const Vec3 c = mesh.vertices[t[2]] - p;
    const double d =
        a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() + c.dot(a) * b.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), d);
  }
  return sum / (4.0 * kPi);
}

/// Height of p over the piece's highest face plane: negative inside.
double height(const Polytope& piece, const Vec3& p) {
  double most = -1e300;
  for (const Polytope::Face& face : piece.faces) most = std::max(most, face.normal.dot(p) - face.offset);
  return most;
}

double volume(const Polytope& piece) {
  double six = 0.0;
  for (const Polytope::Face& face : piece.faces)
    for (int i = 1; i + 1 < face.count; ++i) {
      const int* loop = piece.face_vertices.data() + face.first;
      six += (piece.vertices[loop[0]] - piece.extent.center)
                 .dot((piece.vertices[loop[i]] - piece.extent.center)
                          .cross(piece.vertices[loop[i + 1]] - piece.extent.center));
    }
  return six / 6.0;
}

/// Points of the box are in the solid exactly when they are in one piece, and in one only.
void expect_same_points(const TriangleMesh& mesh, const std::vector<Polytope>& pieces, int count,
                        std::uint64_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  const Aabb box = bounds(mesh.vertices);
  const double noise = tolerances::kCoplanarMeshOffset * box.diagonal();
  for (int n = 0; n < count; ++n) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) p[i] = random.uniform(box.min[i], box.max[i]);
    int inside = 0;
    bool near = false;
    for (const Polytope& piece : pieces) {
      const double h = height(piece, p);
      near = near || std::abs(h) < 4.0 * noise;
      inside += h < 0.0;
    }
    if (near) continue;
    ASSERT_EQ(inside, winding(mesh, p) > 0.5 ? 1 : 0) << p.transpose();
  }
}

SolidPieces expect_decomposed(const TriangleMesh& mesh, int most = 64, int points = 300) {
  Result<SolidPieces> result = solid_pieces(mesh, most);
  EXPECT_TRUE(result) << (result ? "" : result.error().message());
  if (!result) return {};
  const MeshReport report = report_mesh(mesh);
  double sum = 0.0;
  for (const Polytope& piece : result->pieces) {
    sum += volume(piece);
    EXPECT_LT(convexity_defect(piece), tolerances::kCoplanarMeshOffset * report.box.diagonal());
  }
  EXPECT_NEAR(sum, report.volume, 1e-6 * report.volume);
  expect_same_points(mesh, result->pieces, points, 11);
  return std::move(*result);
}

GridSolid flat_solid(const std::vector<std::string>& rows) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i <= rows[0].size(); ++i) x.push_back(0.013 * static_cast<double>(i));
  for (std::size_t i = 0; i <= rows.size(); ++i) y.push_back(0.017 * static_cast<double>(i));
  GridSolid solid(x, y, {-0.01, 0.021});
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t i = 0; i < rows[0].size(); ++i)
      if (rows[j][i] == '#') solid.fill(static_cast<int>(i), static_cast<int>(j), 0);
  return solid;
}

TEST(Decomposition, FlatSolidsFallIntoAsFewPiecesAsAPersonWouldCut) {
  struct Case {
    const char* name;
    std::vector<std::string> rows;
    std::size_t pieces;
  };
  const Case cases[] = {{"L", {"##.", "#..", "#.."}, 2},
                        {"U", {"#.#", "#.#", "###"}, 3},
                        {"cross", {".#.", "###", ".#."}, 3},
                        {"T", {"###", ".#.", ".#."}, 2},
                        {"plate with a square hole", {"###", "#.#", "###"}, 4},
                        {"staircase", {"#...", "##..", "###.", "####"}, 4},
                        {"comb", {"#.#.#", "#.#.#", "#####"}, 4},
                        {"ladder", {"###", "#.#", "###", "#.#", "###"}, 5},
                        {"S", {"##.", ".#.", ".##"}, 3}};
  const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const TriangleMesh mesh = flat_solid(c.rows).mesh();
    EXPECT_EQ(expect_decomposed(mesh).pieces.size(), c.pieces);
    EXPECT_EQ(expect_decomposed(testing::transformed(mesh, turned, Vec3(0.3, -0.2, 0.1))).pieces.size(),
              c.pieces);
  }
}

TEST(Decomposition, AConvexSolidIsOnePiece) {
  EXPECT_EQ(expect_decomposed(testing::box_mesh({0.1, 0.2, 0.3})).pieces.size(), 1u);
  EXPECT_EQ(expect_decomposed(testing::icosphere(2)).pieces.size(), 1u);
}

TEST(Decomposition, StarPrisms) {
  for (int points : {3, 4, 5, 8, 13}) {
    const TriangleMesh mesh = testing::extruded_mesh(testing::star(points, 0.02, 0.05), 0.0, 0.03);
    const SolidPieces result = expect_decomposed(mesh);
    EXPECT_EQ(result.reflex_edges, points);
    EXPECT_LE(result.pieces.size(), static_cast<std::size_t>(points) + 1);
  }
}

TEST(Decomposition, RandomUnionsOfBoxes) {
  int tried = 0;
  const int wanted = testing::full_run() ? 2000 : 60;
  for (std::uint64_t seed = 1; tried < wanted; ++seed) {
    Random random(seed);
    std::vector<double> at[3];
    for (auto& planes : at)
      for (double x = 0.0; planes.size() < 5; x += random.uniform(0.004, 0.02)) planes.push_back(x);
    GridSolid solid(at[0], at[1], at[2]);
    for (int box = 0; box < 3; ++box) {
      int low[3], high[3];
      for (int i = 0; i < 3; ++i) {
        low[i] = random.index(4);
        high[i] = low[i] + 1 + random.index(4 - low[i]);
      }
      for (int i = low[0]; i < high[0]; ++i)
        for (int j = low[1]; j < high[1]; ++j)
          for (int k = low[2]; k < high[2]; ++k) solid.fill(i, j, k);
    }
    if (!solid.manifold()) continue;
    ++tried;
    SCOPED_TRACE("seed " + std::to_string(seed));
    TriangleMesh mesh = solid.mesh();
    if (seed % 2 == 0)
      mesh = testing::transformed(
          mesh, Quat(random.unit(), 1, random.unit(), random.unit()).normalized().toRotationMatrix(),
          Vec3(0.1, 0.2, 0.3));
    expect_decomposed(mesh, 64, 30);
    if (HasFailure()) return;
  }
}

TEST(Decomposition, RandomGridSolidsWithTunnelsAndHollows) {
  int tried = 0;
  const int wanted = testing::full_run() ? 500 : 15;
  std::size_t most = 0;
  for (std::uint64_t seed = 1; tried < wanted; ++seed) {
    Random random(seed);
    GridSolid solid({0, 1, 2.5, 3, 4.5}, {0, 1.5, 2, 3, 4}, {0, 1, 2, 3.25, 4});
    std::fill(solid.filled.begin(), solid.filled.end(), true);
    for (int i = 0; i < 9; ++i) solid.filled[static_cast<std::size_t>(random.index(64))] = false;
    if (!solid.manifold()) continue;
    ++tried;
    SCOPED_TRACE("seed " + std::to_string(seed));
    most = std::max(most, expect_decomposed(solid.mesh(), 64, 60).pieces.size());
    if (HasFailure()) return;
  }
  EXPECT_GT(most, 5u);
}

TEST(Decomposition, BodiesApartAndHollowBodies) {
  GridSolid hollow({0, 1, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3});
  std::fill(hollow.filled.begin(), hollow.filled.end(), true);
  hollow.filled[hollow.number(1, 1, 1)] = false;
  EXPECT_EQ(expect_decomposed(hollow.mesh()).pieces.size(), 6u);
  TriangleMesh two = testing::box_mesh({1, 1, 1});
  const TriangleMesh other = testing::transformed(two, Mat3::Identity(), {5, 0, 0});
  for (const Triangle& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  EXPECT_EQ(expect_decomposed(two).pieces.size(), 2u);
}

TEST(Decomposition, WhatIsNoSolidIsRefusedWithItsPlace) {
  const auto refusal = [](const TriangleMesh& mesh, int most = 64) {
    const Result<SolidPieces> result = solid_pieces(mesh, most);
    EXPECT_FALSE(result);
    return result ? std::string() : result.error().message();
  };
  TriangleMesh open = testing::box_mesh({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_NE(refusal(open).find("open edges at ("), std::string::npos) << refusal(open);
  TriangleMesh flipped = testing::box_mesh({1, 1, 1});
  std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
  EXPECT_NE(refusal(flipped).find("opposite ways"), std::string::npos);
  // Two boxes that share an edge.
  GridSolid touching({0, 1, 2}, {0, 1, 2}, {0, 1});
  touching.fill(0, 0, 0).fill(1, 1, 0);
  EXPECT_NE(refusal(touching.mesh()).find("more than two triangles at ("), std::string::npos);
  // Two boxes that cross without a common edge.
  TriangleMesh crossing = testing::box_mesh({1, 1, 1});
  const TriangleMesh other = testing::transformed(crossing, Mat3::Identity(), {0.5, 0.25, 0.125});
  for (const Triangle& t : other.triangles) crossing.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  crossing.vertices.insert(crossing.vertices.end(), other.vertices.begin(), other.vertices.end());
  EXPECT_NE(refusal(crossing).find("crosses itself near ("), std::string::npos) << refusal(crossing);
  const TriangleMesh comb = flat_solid({"#.#.#.#.#", "#########"}).mesh();
  EXPECT_NE(refusal(comb, 3).find("8 reflex edges"), std::string::npos) << refusal(comb, 3);
}

TEST(Decomposition, RealParts) {
  TACTUM_NEEDS_REAL_DATA();
  const std::vector<const char*> parts = {"cube-notch.obj",
                                          "cup.obj",
                                          "regulator_base.stl",
                                          "regulator_collision.stl",
                                          "regulator_long_peg.stl",
                                          "sensor_base.stl",
                                          "sensor_peg.stl",
                                          "pump_base.stl",
                                          "insert_base.stl",
                                          "pipe_1.stl",
                                          "factory_round_hole_8mm_subdiv_3x.obj",
                                          "factory_rectangular_peg_8mm_loose_subdiv_3x.obj",
                                          "industreal_gear_base.obj",
                                          "plate_holes.STL",
                                          "torus1.obj",
                                          "industreal_tray_insert_round_peg_8mm.obj"};
  for (const char* name : testing::sampled(parts, 3)) {
    SCOPED_TRACE(name);
    const Result<ImportedMesh> imported = import_mesh(testing::find_real(name).string());
    ASSERT_TRUE(imported) << imported.error().message();
    const TriangleMesh mesh = weld(imported->mesh).mesh;
    const Result<SolidPieces> result = solid_pieces(mesh, 256);
    if (!result) {
      std::printf("%s: %s\n", name, result.error().message().c_str());
      continue;
    }
    std::printf("%s: %zu pieces from %d reflex edges by %d cuts, %d joined again\n", name,
                result->pieces.size(), result->reflex_edges, result->cuts, result->joined);
    expect_same_points(mesh, result->pieces, 50, 5);
  }
}

TEST(Decomposition, ThousandsOfSeparateBodiesAreRefusedAtOnce) {
  // Joining pieces takes the square of their number; 30 000 boxes took minutes before the refusal.
  const TriangleMesh box = testing::box_mesh({0.3, 0.3, 0.3});
  TriangleMesh many;
  for (int i = 0; i < 20000; ++i) {
    const int base = static_cast<int>(many.vertices.size());
    for (const Vec3& v : box.vertices) many.vertices.emplace_back(v + Vec3(i % 150, i / 150, 0));
    for (const Triangle& t : box.triangles) many.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  const Result<SolidPieces> result = solid_pieces(many, kFewSolidPieces);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message().find("20000 components"), std::string::npos) << result.error().message();
}

}  // namespace
}  // namespace tactum
