#include "tactum/mesh/prepare_part.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/effort.h"
#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;
using testing::box_mesh;
using testing::icosphere;
using testing::prism;
using testing::transformed;

ImportedMesh as_imported(const std::vector<TriangleMesh>& groups) {
  ImportedMesh out;
  for (const TriangleMesh& group : groups) {
    const int base = static_cast<int>(out.mesh.vertices.size());
    out.groups.push_back({"group" + std::to_string(out.groups.size()),
                          static_cast<int>(out.mesh.triangles.size()),
                          static_cast<int>(group.triangles.size())});
    out.mesh.vertices.insert(out.mesh.vertices.end(), group.vertices.begin(), group.vertices.end());
    for (const Triangle& t : group.triangles)
      out.mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return out;
}

TriangleMesh dented_ball() {
  TriangleMesh mesh = icosphere(3);
  for (Vec3& v : mesh.vertices) v *= 0.05;
  mesh.vertices[40] *= 0.8;
  return mesh;
}

TEST(PreparePart, StandsAtItsCentreOfMassAndKnowsWhereThatWas) {
  const TriangleMesh rod = transformed(prism(12, 0.01, 0.02), Mat3::Identity(), Vec3(0.1, 0.2, 0.3));
  const Result<PartFile> file = prepare_part(as_imported({rod}), {.name = "rod", .density_kg_per_m3 = 7800});
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_LT((file->origin - Vec3(0.1, 0.2, 0.3)).norm(), 1e-15);
  EXPECT_LT(file->part.mass.center.norm(), 1e-15);
  EXPECT_EQ(file->part.pieces.size(), 1u);
  const nlohmann::json report = nlohmann::json::parse(file->report);
  EXPECT_EQ(report["unit"]["name"], "metres");
  EXPECT_EQ(report["pieces"]["way"], "solid");
  EXPECT_EQ(report["pieces"]["solid"], true);
  EXPECT_LT(report["verification"]["deviation_over_size"].get<double>(), tolerances::kSurfaceDeviation);
  EXPECT_NEAR(report["verification"]["mesh_volume_m3"].get<double>(), file->part.mass.volume, 1e-18);
}

/// `side` to the third boxes beside each other, every other one turned inside out, and a cavity in some.
TriangleMesh many_boxes(int side) {
  TriangleMesh all;
  int count = 0;
  const auto add = [&](const TriangleMesh& one, bool turned) {
    const int base = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const Triangle& t : one.triangles)
      all.triangles.push_back(turned ? Triangle{base + t[0], base + t[2], base + t[1]}
                                     : Triangle{base + t[0], base + t[1], base + t[2]});
  };
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z) {
        const Vec3 place = 0.01 * Vec3(x, y, z);
        add(transformed(box_mesh({0.003, 0.003, 0.003}), Mat3::Identity(), place), ++count % 2 == 0);
        if (count % 5 == 0)
          add(transformed(box_mesh({0.001, 0.001, 0.001}), Mat3::Identity(), place), count % 3 == 0);
      }
  return all;
}

TEST(PreparePart, ThePartIsTheSameWhateverTheNumberOfThreads) {
  TriangleMesh folded =
      icosphere(testing::effort(5, 4));  // a surface of one component, with flat, sharp and reflex edges
  for (Vec3& v : folded.vertices) v = 0.05 * Vec3(v.x(), v.y(), std::round(8.0 * v.z()) / 8.0 + 0.2 * v.z());
  TriangleMesh open = folded;
  open.triangles.resize(open.triangles.size() / 50 * 49);
  for (const TriangleMesh& mesh : {many_boxes(testing::effort(13, 6)), folded, open, dented_ball()}) {
    const ImportedMesh given = as_imported({mesh});
    std::string alone;
    for (int threads : testing::sampled(std::vector<int>{1, 2, 3, 7}, 3)) {
      const Result<PartFile> file = prepare_part(given, {.unit = "m", .threads = threads});
      ASSERT_TRUE(file) << file.error().message();
      const std::string bytes = part_bytes(*file);
      if (threads == 1) alone = bytes;
      EXPECT_TRUE(bytes == alone) << threads << " threads, " << mesh.triangles.size() << " triangles";
    }
  }
}

TEST(PreparePart, UnitsAreGuessedOrTaken) {
  TriangleMesh box = box_mesh({40, 20, 10});
  const Result<PartFile> guessed = prepare_part(as_imported({box}), {});
  ASSERT_TRUE(guessed);
  EXPECT_NEAR(guessed->part.mass.volume, 64e-6, 1e-12);  // in millimetres
  const Result<PartFile> inches = prepare_part(as_imported({box}), {.unit = "inch"});
  EXPECT_NEAR(inches->part.mass.volume, 64000 * std::pow(0.0254, 3), 1e-9);
  EXPECT_FALSE(prepare_part(as_imported({box}), {.unit = "furlong"}));
}

TEST(PreparePart, GroupsBecomePiecesWhenEachIsConvexAndNoneOverlap) {
  const auto cube_at = [](double x) {
    return transformed(box_mesh({0.1, 0.1, 0.1}), Mat3::Identity(), Vec3(x, 0, 0));
  };
  const Result<PartFile> touching = prepare_part(as_imported({cube_at(0), cube_at(0.2)}), {});
  ASSERT_TRUE(touching) << touching.error().message();
  EXPECT_EQ(touching->part.pieces.size(), 2u);
  EXPECT_LT((touching->origin - Vec3(0.1, 0, 0)).norm(), 1e-15);

  const ImportedMesh overlapping = as_imported({cube_at(0), cube_at(0.15)});
  const Result<PartFile> asked = prepare_part(overlapping, {.name = "cubes", .pieces = "given"});
  ASSERT_FALSE(asked);
  EXPECT_NE(asked.error().message().find("1 pairs of pieces that overlap, pieces 0 and 1 by 0.05 m"),
            std::string::npos)
      << asked.error().message();
  const Result<PartFile> chosen = prepare_part(overlapping, {.name = "cubes"});
  ASSERT_TRUE(chosen) << chosen.error().message();
  const nlohmann::json report = nlohmann::json::parse(chosen->report);
  EXPECT_EQ(report["pieces"]["way"], "surface");
  EXPECT_NE(report["pieces"]["reason"].get<std::string>().find("not given, since"), std::string::npos);
}

TEST(PreparePart, ClosesHolesWhenAskedAndVerifiesAgainstTheClosedMesh) {
  TriangleMesh ball = dented_ball();
  ball.triangles.pop_back();
  const Result<PartFile> open = prepare_part(as_imported({ball}), {});
  ASSERT_TRUE(open) << open.error().message();
  EXPECT_FALSE(open->part.mass.approximation.empty());
  const Result<PartFile> closed = prepare_part(as_imported({ball}), {.close_holes = 3});
  ASSERT_TRUE(closed) << closed.error().message();
  EXPECT_TRUE(closed->part.mass.approximation.empty());
  EXPECT_NEAR(closed->part.mass.volume, prepare_part(as_imported({dented_ball()}), {})->part.mass.volume,
              1e-18);
}

TEST(PreparePart, NestedSolidsAreASolidWithACavity) {
  const Result<PartFile> file = prepare_part(
      as_imported({box_mesh({0.2, 0.2, 0.2}), box_mesh({0.1, 0.1, 0.1})}), {.pieces = "surface"});
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_NEAR(file->part.mass.volume, 0.064 - 0.008, 1e-12);
  EXPECT_NE(file->report.find("taken for a cavity"), std::string::npos);
}

/// The volume and the triangles of a mesh prepared, or zero and the refusal.
struct Outcome {
  double volume = 0.0;
  std::size_t triangles = 0;
  std::string message;
};

Outcome outcome_of(const TriangleMesh& mesh) {
  const Result<PartFile> file = prepare_part(as_imported({mesh}), {.unit = "m"});
  if (!file) return {.message = file.error().message()};
  const bool exact = file->part.mass.approximation.empty();
  return {exact ? file->part.mass.volume : -1.0, file->part.surface.triangles.size(), {}};
}

void append(const TriangleMesh& more, TriangleMesh& mesh) {
  const int base = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Triangle& t : more.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

TEST(PreparePart, SolidsThatTouchAreTheirUnion) {
  const TriangleMesh box = box_mesh({1, 1, 1});
  struct Case {
    const char* name;
    Vec3 offset;
    std::size_t triangles;
  };
  for (const Case& c :
       {Case{"a face", {2, 0, 0}, 20}, Case{"an edge", {2, 2, 0}, 24}, Case{"a corner", {2, 2, 2}, 24}}) {
    SCOPED_TRACE(c.name);
    for (const bool turned : {false, true}) {
      TriangleMesh mesh = box;
      TriangleMesh other = transformed(box, Mat3::Identity(), c.offset);
      if (turned)
        for (Triangle& t : other.triangles) std::swap(t[0], t[1]);
      append(other, mesh);
      const Outcome outcome = outcome_of(mesh);
      EXPECT_EQ(outcome.message, "");
      EXPECT_NEAR(outcome.volume, 16.0, 1e-12);
      if (c.offset.y() > 0.0) {
        EXPECT_EQ(outcome.triangles, c.triangles);
      }
    }
  }
}

TEST(PreparePart, TrianglesThatStandTwiceAreNoReasonToRefuse) {
  TriangleMesh box = box_mesh({1, 1, 1});
  box.triangles.push_back({box.triangles[3][0], box.triangles[3][2], box.triangles[3][1]});
  EXPECT_NEAR(outcome_of(box).volume, 8.0, 1e-12) << outcome_of(box).message;

  TriangleMesh ball = dented_ball();  // wholly twice, the second time inside out
  const double volume = outcome_of(ball).volume;
  const std::size_t triangles = ball.triangles.size();
  for (std::size_t t = 0; t < triangles; ++t)
    ball.triangles.push_back({ball.triangles[t][1], ball.triangles[t][0], ball.triangles[t][2]});
  EXPECT_NEAR(outcome_of(ball).volume, volume, 1e-15) << outcome_of(ball).message;
  EXPECT_EQ(outcome_of(ball).triangles, triangles);
}

TEST(PreparePart, SheetsHaveTwoSidesWhetherTheFileHasThemOrNot) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.1, 0.1, 0.02}};
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
  EXPECT_EQ(outcome_of(sheet).message, "");
  EXPECT_EQ(outcome_of(sheet).triangles, 4u);
  for (std::size_t t = 0; t < 2; ++t)
    sheet.triangles.push_back({sheet.triangles[t][1], sheet.triangles[t][0], sheet.triangles[t][2]});
  EXPECT_EQ(outcome_of(sheet).message, "");
  EXPECT_EQ(outcome_of(sheet).triangles, 4u);
}

TEST(PreparePart, WhatIsLeftIsToldOnceWithItsPlaceInTheFile) {
  TriangleMesh cup = transformed(box_mesh({1, 1, 1}), Mat3::Identity(), Vec3(5, 0, 0));
  cup.triangles.resize(cup.triangles.size() - 2);
  const Result<PartFile> file = prepare_part(as_imported({cup}), {.unit = "m"});
  ASSERT_TRUE(file) << file.error().message();
  std::vector<std::string> holes;
  for (const std::string& remark : file->part.notes.remarks)
    if (remark.find("edges is open") != std::string::npos) holes.push_back(remark);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_NE(holes[0].find("triangle"), std::string::npos);
}

TEST(PreparePart, AHoleBesideATriangleWithoutAreaIsClosed) {
  TriangleMesh cup = box_mesh({1, 1, 1});
  cup.triangles.resize(cup.triangles.size() - 2);
  const MeshReport report = report_mesh(cup);
  ASSERT_EQ(report.boundary_edges, 4);
  // One edge of the rim is carried by a triangle whose third corner lies in its middle.
  for (const Triangle& t : cup.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      const auto has = [&](const Triangle& u) {
        for (std::size_t k = 0; k < 3; ++k)
          if (u[k] == b && u[(k + 1) % 3] == a) return true;
        return false;
      };
      if (std::any_of(cup.triangles.begin(), cup.triangles.end(), has)) continue;
      const int middle = static_cast<int>(cup.vertices.size());
      const int c = t[(i + 2) % 3];
      Triangle& whole = cup.triangles[std::size_t(&t - cup.triangles.data())];
      cup.vertices.push_back(0.5 * (cup.vertices[a] + cup.vertices[b]));
      whole = {a, middle, c};
      cup.triangles.push_back({middle, b, c});
      cup.triangles.push_back({a, b, middle});
      const Result<PartFile> file = prepare_part(as_imported({cup}), {.unit = "m", .close_holes = 8});
      ASSERT_TRUE(file) << file.error().message();
      EXPECT_NEAR(file->part.mass.volume, 8.0, 1e-12);
      return;
    }
  FAIL() << "no open edge";
}

TEST(PreparePart, RefusesInOneSentenceWhatIsNoPart) {
  const auto refusal = [](const TriangleMesh& mesh, const PrepareOptions& options) {
    const Result<PartFile> file = prepare_part(as_imported({mesh}), options);
    return file ? "prepared" : file.error().message();
  };
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_EQ(
      refusal(line, {.name = "line"}),
      "line: the mesh cannot be prepared: found no triangle with an area, expected a surface or a solid");
  TriangleMesh flat;  // two sides of a square, cut along different diagonals
  flat.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}};
  EXPECT_NE(refusal(flat, {}).find("a closed surface that encloses no volume, about 0 0 "), std::string::npos)
      << refusal(flat, {});
  for (const double scale : {1e-9, 1e9}) {
    TriangleMesh ball = icosphere(1);
    for (Vec3& v : ball.vertices) v *= scale;
    EXPECT_NE(refusal(ball, {.unit = "m"}).find("give the unit"), std::string::npos);
  }
}

TEST(PreparePart, ScaleDoesNotMatterWithinTheRangeOfParts) {
  for (const double scale : {1e-5, 1e-3, 1.0, 1e3, 1e5}) {
    SCOPED_TRACE(scale);
    TriangleMesh ball = dented_ball();
    for (Vec3& v : ball.vertices) v *= scale;
    const Result<PartFile> file = prepare_part(as_imported({ball}), {.unit = "m"});
    ASSERT_TRUE(file) << file.error().message();
    EXPECT_TRUE(file->part.mass.approximation.empty());
  }
}

TEST(PreparePart, TheSamePartComesOutEveryTime) {
  const ImportedMesh mesh =
      as_imported({dented_ball(), transformed(prism(7, 0.01, 0.1), Mat3::Identity(), Vec3(1, 0, 0))});
  EXPECT_EQ(part_bytes(*prepare_part(mesh, {})), part_bytes(*prepare_part(mesh, {})));
}

TEST(PreparePart, TellsItsStagesInOrder) {
  std::vector<double> shares;
  ASSERT_TRUE(prepare_part(as_imported({dented_ball()}), {},
                           [&](const char*, double share) { shares.push_back(share); }));
  EXPECT_GE(shares.size(), 4u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_LE(shares.back(), 1.0);
}

/// Every mesh of the folder, the broken ones too: prepared and verified, or refused in a sentence with a
/// place. The long run prints a table; the short one takes files up to a size.
TEST(PreparePart, EveryRealMeshIsPreparedOrRefusedWithItsReason) {
  TACTUM_NEEDS_REAL_DATA();
  const std::uintmax_t most_bytes = testing::full_run() ? 1u << 30 : 60'000;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(testing::real_data())) {
    std::string ending = entry.path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (ending != ".obj" && ending != ".stl" && ending != ".ply" && ending != ".off") continue;
    if (entry.file_size() <= most_bytes) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  int prepared = 0;
  for (const fs::path& path : files) {
    SCOPED_TRACE(path.string());
    const auto start = std::chrono::steady_clock::now();
    const std::string name = path.filename().string();
    const Result<ImportedMesh> mesh = import_mesh(path.string());
    const Result<PartFile> file = mesh ? prepare_part(*mesh, {.name = name}) : Result<PartFile>(mesh.error());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!file) {
      EXPECT_FALSE(file.error().where.empty());
      if (testing::full_run())
        std::printf("| %s | refused: %s |\n", name.c_str(), file.error().message().c_str());
      continue;
    }
    ++prepared;
    const nlohmann::json report = nlohmann::json::parse(file->report);
    const double deviation = report["verification"]["deviation_over_size"].get<double>();
    EXPECT_LE(deviation, tolerances::kSurfaceDeviation);
    EXPECT_TRUE(read_part(part_bytes(*file), name));
    if (testing::full_run())
      std::printf("| %s | %d | %s | %.1g | %.2f |\n", name.c_str(), report["mesh"]["triangles"].get<int>(),
                  report["pieces"]["way"].get<std::string>().c_str(), deviation, seconds);
  }
  EXPECT_GT(prepared, 20);
}

}  // namespace
}  // namespace tactum
