#include "tactum/surface/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

#include "support/effort.h"
#include "support/real_data.h"
#include "tactum/base/random.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum {
namespace {

Vec3 random_point(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

TrianglePoints random_triangle(Random& random, double size) {
  const Vec3 a = random_point(random, size);
  const Vec3 b = random_point(random, size);
  const Vec3 c = random_point(random, size);
  return {a, b, c};
}

/// Referee: squared distance by minimising over both triangles' barycentric coordinates with alternating
/// exact projections (von Neumann), a method that shares nothing with the one under test. Slow and only
/// nearly converged: an upper bound.
double alternating_distance(const TrianglePoints& a, const TrianglePoints& b) {
  const auto project = [](const Vec3& p, const TrianglePoints& t) {
    // Least squares over a dense set of candidates: inside foot, and the feet on the three sides.
    const Vec3 u = t[1] - t[0];
    const Vec3 v = t[2] - t[0];
    Eigen::Matrix2d gram;
    gram << u.dot(u), u.dot(v), u.dot(v), v.dot(v);
    const Vec2 st = gram.fullPivLu().solve(Vec2(u.dot(p - t[0]), v.dot(p - t[0])));
    if (st.x() >= 0 && st.y() >= 0 && st.x() + st.y() <= 1) return Vec3(t[0] + st.x() * u + st.y() * v);
    Vec3 best = t[0];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 d = t[(k + 1) % 3] - t[k];
      const Vec3 foot = t[k] + std::clamp((p - t[k]).dot(d) / d.squaredNorm(), 0.0, 1.0) * d;
      if ((foot - p).norm() < (best - p).norm()) best = foot;
    }
    return best;
  };
  Vec3 q = (b[0] + b[1] + b[2]) / 3.0;
  Vec3 p = q;
  for (int i = 0; i < 3000; ++i) {
    p = project(q, a);
    q = project(p, b);
  }
  return (p - q).norm();
}

bool on_triangle(const Vec3& p, const TrianglePoints& t, double tolerance) {
  return alternating_distance({p, p + Vec3(tolerance, 0, 0) * 1e-3, p + Vec3(0, tolerance, 0) * 1e-3}, t) <
         tolerance;
}

TEST(TriangleDistance, AgreesWithAlternatingProjections) {
  const std::uint64_t seed = 11;
  Random random(seed);
  int apart = 0;
  for (int i = 0; i < testing::effort(2000, 200); ++i) {
    const TrianglePoints a = random_triangle(random, 1.0);
    TrianglePoints b = random_triangle(random, 1.0);
    const Vec3 shift = random_point(random, 2.0);
    for (Vec3& corner : b) corner += shift;
    const double referee = alternating_distance(a, b);
    if (triangles_cross(a, b)) {
      EXPECT_LT(referee, 2e-3) << "seed " << seed << " case " << i;
      continue;
    }
    ++apart;
    const PointPair answer = triangle_distance(a, b);
    const double distance = std::sqrt(answer.distance_sq);
    EXPECT_LE(distance, referee + 1e-12) << "seed " << seed << " case " << i;
    EXPECT_GE(distance, referee - 2e-3) << "seed " << seed << " case " << i;
    EXPECT_TRUE(on_triangle(answer.p_a, a, 1e-7)) << "seed " << seed << " case " << i;
    EXPECT_TRUE(on_triangle(answer.p_b, b, 1e-7)) << "seed " << seed << " case " << i;
    EXPECT_NEAR((answer.p_a - answer.p_b).norm(), distance, 1e-15);
  }
  EXPECT_GT(apart, testing::effort(1000, 100));
}

TEST(TriangleDistance, SwappingTheTrianglesSwapsThePoints) {
  Random random(12);
  for (int i = 0; i < 5000; ++i) {
    const TrianglePoints a = random_triangle(random, 1.0);
    TrianglePoints b = random_triangle(random, 1.0);
    for (Vec3& corner : b) corner.z() += 2.5;
    const PointPair ab = triangle_distance(a, b);
    const PointPair ba = triangle_distance(b, a);
    EXPECT_NEAR(std::sqrt(ab.distance_sq), std::sqrt(ba.distance_sq), 1e-14) << "seed 12 case " << i;
    EXPECT_EQ(triangles_cross(a, b), triangles_cross(b, a));
  }
}

TEST(TriangleDistance, DegenerateTriangles) {
  const TrianglePoints point = {Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1)};
  const TrianglePoints needle = {Vec3(-1, 0, 2), Vec3(1, 0, 2), Vec3(0, 0, 2)};
  const TrianglePoints floor = {Vec3(-3, -3, 0), Vec3(3, -3, 0), Vec3(0, 3, 0)};
  EXPECT_DOUBLE_EQ(triangle_distance(point, floor).distance_sq, 1.0);
  EXPECT_DOUBLE_EQ(triangle_distance(floor, needle).distance_sq, 4.0);
  EXPECT_DOUBLE_EQ(triangle_distance(point, needle).distance_sq, 1.0);
  EXPECT_FALSE(triangles_cross(point, floor));
  EXPECT_FALSE(triangles_cross(needle, floor));
}

TEST(TriangleCross, TouchingCounts) {
  const TrianglePoints floor = {Vec3(-3, -3, 0), Vec3(3, -3, 0), Vec3(0, 3, 0)};
  const TrianglePoints on_tip = {Vec3(0, 0, 0), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  const TrianglePoints through = {Vec3(0, 0, -1), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  const TrianglePoints above = {Vec3(0, 0, 1e-9), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  EXPECT_TRUE(triangles_cross(floor, on_tip));
  EXPECT_TRUE(triangles_cross(floor, through));
  EXPECT_FALSE(triangles_cross(floor, above));
}

/// A closed box of 12 triangles per side pattern, cut finely.
TriangleMesh cut_box(const Vec3& half, int cuts) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (double sign : {-1.0, 1.0}) {
      const int base = static_cast<int>(mesh.vertices.size());
      for (int i = 0; i <= cuts; ++i) {
        for (int k = 0; k <= cuts; ++k) {
          Vec3 p;
          p[axis] = sign * half[axis];
          p[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * i / cuts - 1.0);
          p[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * k / cuts - 1.0);
          mesh.vertices.push_back(p);
        }
      }
      for (int i = 0; i < cuts; ++i) {
        for (int k = 0; k < cuts; ++k) {
          const int v = base + i * (cuts + 1) + k;
          const int w = v + cuts + 1;
          if (sign > 0) {
            mesh.triangles.push_back({v, w, w + 1});
            mesh.triangles.push_back({v, w + 1, v + 1});
          } else {
            mesh.triangles.push_back({v, w + 1, w});
            mesh.triangles.push_back({v, v + 1, w + 1});
          }
        }
      }
    }
  }
  return mesh;
}

TEST(SurfaceDistance, AgreesWithAllPairs) {
  const std::uint64_t seed = 13;
  Random random(seed);
  const TriangleMesh mesh_a = cut_box({1.0, 0.6, 0.4}, 4);
  const TriangleMesh mesh_b = cut_box({0.5, 0.5, 0.9}, 3);
  const Surface a(mesh_a);
  const Surface b(mesh_b);
  SurfacePairCache cache;
  for (int i = 0; i < testing::effort(150, 30); ++i) {
    const Vec3 turn = random_point(random, 2.0);
    const Pose X{exp_rotation(turn), random_point(random, 1.6)};
    double least = 1e300;
    int touching = 0;
    for (int k = 0; k < a.count(); ++k) {
      for (int m = 0; m < b.count(); ++m) {
        const TrianglePoints& t = b.triangle(m);
        const TrianglePoints moved = {X * t[0], X * t[1], X * t[2]};
        const bool cross = triangles_cross(a.triangle(k), moved);
        touching += cross ? 1 : 0;
        least = std::min(least, cross ? 0.0 : std::sqrt(triangle_distance(a.triangle(k), moved).distance_sq));
      }
    }
    const SurfaceDistance answer = surface_distance(a, b, X, cache);
    EXPECT_EQ(answer.distance, least) << "seed " << seed << " case " << i;
    EXPECT_EQ(answer.touching_pairs, touching) << "seed " << seed << " case " << i;
    EXPECT_EQ(answer.distance == 0.0, answer.touching_pairs > 0);
  }
}

TEST(SurfaceDistance, FlushFacesTouch) {
  const Surface a(cut_box({1, 1, 1}, 3));
  const Surface b(cut_box({0.5, 0.5, 0.5}, 2));
  SurfacePairCache cache;
  EXPECT_EQ(surface_distance(a, b, {Mat3::Identity(), {0, 0, 1.5}}, cache).distance, 0.0);
  EXPECT_GT(surface_distance(a, b, {Mat3::Identity(), {0, 0, 1.5}}, cache).touching_pairs, 0);
  EXPECT_NEAR(surface_distance(a, b, {Mat3::Identity(), {0, 0, 1.75}}, cache).distance, 0.25, 1e-15);
  // Wholly inside: the surfaces do not meet.
  EXPECT_NEAR(surface_distance(a, b, Pose{}, cache).distance, 0.5, 1e-15);
}

// --- recorded motions of real parts, judged by another program's exhaustive triangle tree
// -------------------------

std::vector<std::vector<double>> numbers_of(const std::filesystem::path& path,
                                            std::string* comment = nullptr) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  std::string line;
  while (std::getline(file, line)) {
    if (!line.empty() && line[0] == '#' && comment != nullptr) *comment = line;
    if (line.empty() || (std::isdigit(line[0]) == 0)) continue;
    std::vector<double> row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

Pose pose_at(const std::vector<double>& row, std::size_t first) {
  Pose X;
  X.p = {row[first], row[first + 1], row[first + 2]};
  for (int i = 0; i < 9; ++i) X.R(i / 3, i % 3) = row[first + 3 + static_cast<std::size_t>(i)];
  return renormalized(X);
}

struct Worst {
  double deviation = 0.0;
  int state_differs = 0;
  int rows = 0;
};

Worst compare(const std::string& a_file, const std::string& b_file, const std::filesystem::path& stem,
              int every, double margin) {
  const Result<ImportedMesh> mesh_a = import_mesh(a_file);
  const Result<ImportedMesh> mesh_b = import_mesh(b_file);
  EXPECT_TRUE(mesh_a && mesh_b);
  const Surface a(mesh_a->mesh);
  const Surface b(mesh_b->mesh);
  const auto motion = numbers_of(stem.string() + "_motion.csv");
  const auto reference = numbers_of(stem.string() + "_reference.csv");
  EXPECT_EQ(motion.size(), reference.size());
  SurfacePairCache cache;
  Worst worst;
  long boxes = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < motion.size(); i += static_cast<std::size_t>(every)) {
    const Pose X_AB = relative_pose(pose_at(motion[i], 2), pose_at(motion[i], 14));
    const SurfaceDistance answer = surface_distance(a, b, X_AB, cache);
    ++worst.rows;
    boxes += answer.boxes_tested;
    const double expected = reference[i][2];
    worst.deviation = std::max(worst.deviation, std::abs(answer.distance - expected));
    const bool has_margin = expected == 0.0 || expected > margin;
    if (has_margin && (answer.touching_pairs > 0) != (reference[i][3] > 0)) ++worst.state_differs;
  }
  const double ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  std::printf("%s: %d rows, worst deviation %.3g, %.3f ms and %ld boxes a row\n", stem.filename().c_str(),
              worst.rows, worst.deviation, ms / worst.rows, boxes / worst.rows);
  return worst;
}

TEST(SurfaceDistance, RecordedMotionsOfRealParts) {
  TACTUM_NEEDS_REAL_DATA();
  for (const char* name : {"gears_medium_small", "m16_loose_screw", "round_peg_8mm_loose"}) {
    const std::filesystem::path stem = testing::real_data() / "reference" / name;
    std::string comment;
    numbers_of(stem.string() + "_reference.csv", &comment);
    const std::size_t a = comment.find("A=");
    const std::size_t b = comment.find("B=");
    ASSERT_NE(a, std::string::npos);
    ASSERT_NE(b, std::string::npos);
    const std::string a_file = comment.substr(a + 2, comment.find(' ', a) - a - 2);
    const std::string b_file = comment.substr(b + 2, comment.find(' ', b) - b - 2);
    const Worst worst = compare(testing::find_real(a_file), testing::find_real(b_file), stem,
                                testing::full_run() ? 1 : testing::effort(10, 50), 1e-8);
    EXPECT_LT(worst.deviation, 1e-7) << name;
    EXPECT_EQ(worst.state_differs, 0) << name;
  }
}

TEST(SurfaceDistance, RecordedTwoBodyMotionsOfContactModels) {
  TACTUM_NEEDS_REAL_DATA();
  for (const char* name : {"newdata__Model_1_Scenario_3", "scenario-1-2-3__Model_2_Scenario_1",
                           "scenario-1-2-3__Model_2_Scenario_2"}) {
    const std::filesystem::path stem = testing::real_data() / "fcl_contact_models" / name;
    const Worst worst = compare(stem.string() + "_obj1.obj", stem.string() + "_obj2.obj", stem, 1, 1e-3);
    EXPECT_LT(worst.deviation, 1e-4) << name;
    EXPECT_EQ(worst.state_differs, 0) << name;
  }
}

}  // namespace
}  // namespace tactum
