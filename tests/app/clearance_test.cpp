#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "app/program.h"
#include "support/effort.h"
#include "support/real_data.h"

namespace tactum::clearance_test {
namespace {

using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;

const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 1 5 8 4\n";

const char* const kHeader =
    "frame,time_s,a_px,a_py,a_pz,a_m00,a_m01,a_m02,a_m10,a_m11,a_m12,a_m20,a_m21,a_m22,"
    "b_px,b_py,b_pz,b_m00,b_m01,b_m02,b_m10,b_m11,b_m12,b_m20,b_m21,b_m22\n";

const std::string kStill = "0,0,0,1,0,0,0,1,0,0,0,1";

/// Two unit cubes: a gap of 0.5 along x, an overlap, a turned and moved A.
std::string motion() {
  return std::string(kHeader) + "7,0.0," + kStill + ",1.5,0,0,1,0,0,0,1,0,0,0,1\n" + "8,0.5," + kStill +
         ",0.5,0.5,0.5,1,0,0,0,1,0,0,0,1\n" + "9,1.0,0,0,5,0,-1,0,1,0,0,0,0,1,0,0,8.25,1,0,0,0,1,0,0,0,1\n";
}

/// The same motion as a spreadsheet writes it elsewhere.
TEST(ClearanceCommand, ReadsTablesOfOtherSeparators) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", kCube);
  testing::write(folder / "motion.csv", motion());
  const std::string meshes = "clearance " + (folder / "cube.obj") + " " + (folder / "cube.obj") + " ";
  const ProgramRun expected = run_tactum(meshes + (folder / "motion.csv"));
  ASSERT_EQ(expected.exit_code, 0) << expected.err;
  const auto replaced = [](std::string text, char from, char to) {
    std::replace(text.begin(), text.end(), from, to);
    return text;
  };
  for (const char separator : {';', '\t', ' '}) {
    for (const char decimal : {'.', ','}) {
      const std::string text = "\xEF\xBB\xBF" + replaced(replaced(motion(), ',', separator), '.', decimal);
      testing::write(folder / "other.csv", text);
      const ProgramRun run = run_tactum(meshes + (folder / "other.csv"));
      EXPECT_EQ(run.exit_code, 0) << run.err;
      EXPECT_EQ(run.out, expected.out);
    }
  }
}

/// A cube of half a unit moves from the middle of a box of 6 through its wall to the outside; the box is
/// solid, or has a cavity of 2.
TEST(ClearanceCommand, AMeshInsideASolidTouchesItAndOneInACavityDoesNot) {
  const auto box = [](double half, int first, bool inward) {
    std::string text;
    for (const double z : {-half, half})
      for (const double y : {-half, half})
        for (const double x : {-half, half}) text += fmt::format("v {} {} {}\n", x, y, z);
    for (std::array<int, 4> f :
         {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
      if (inward) std::reverse(f.begin(), f.end());
      text += fmt::format("f {} {} {} {}\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
    }
    return text;
  };
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", box(0.25, 0, false));
  testing::write(folder / "solid.obj", box(3.0, 0, false));
  testing::write(folder / "solid_turned.obj", box(3.0, 0, true));
  testing::write(folder / "hollow.obj", box(3.0, 0, false) + box(1.0, 8, false));
  std::string rows = kHeader;
  for (const double x : {0.0, 0.5, 1.0, 2.0, 3.1, 3.5})
    rows += fmt::format("0,0,{},{},0,0,1,0,0,0,1,0,0,0,1\n", kStill, x);
  testing::write(folder / "motion.csv", rows);
  const std::map<std::string, std::array<double, 6>> right = {{"solid.obj", {0, 0, 0, 0, 0, 0.25}},
                                                              {"solid_turned.obj", {0, 0, 0, 0, 0, 0.25}},
                                                              {"hollow.obj", {0.75, 0.25, 0, 0, 0, 0.25}}};
  for (const auto& [file, distances] : right) {
    SCOPED_TRACE(file);
    const ProgramRun run = run_tactum("clearance " + (folder / file) + " " + (folder / "cube.obj") + " " +
                                      (folder / "motion.csv") + " --json -");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const nlohmann::json json = nlohmann::json::parse(run.out);
    for (std::size_t i = 0; i < distances.size(); ++i)
      EXPECT_NEAR(json["rows"][i]["distance_m"].get<double>(), distances[i], 1e-12) << i;
    EXPECT_EQ(json["rows"][3]["inside"], true);
    EXPECT_EQ(json["touching_rows"], std::count(distances.begin(), distances.end(), 0.0));
  }
}

TEST(ClearanceCommand, PrintsTheTable) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", kCube);
  testing::write(folder / "motion.csv", motion());
  const std::string files =
      (folder / "cube.obj") + " " + (folder / "cube.obj") + " " + (folder / "motion.csv");
  const ProgramRun run = run_tactum("clearance " + files);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(run.out);
  std::string header, first, second, third;
  std::getline(lines, header);
  std::getline(lines, first);
  std::getline(lines, second);
  std::getline(lines, third);
  EXPECT_EQ(header, "frame,time_s,distance_m,touching_pairs");
  EXPECT_EQ(first.substr(0, first.rfind(',')), "7,0,0.5");
  EXPECT_EQ(second.substr(0, 8), "8,0.5,0,");
  EXPECT_GT(std::stoi(second.substr(8)), 0);
  EXPECT_EQ(third, "9,1,2.25,0");  // A turned about z and raised: its top at 6, B's bottom at 8.25
  EXPECT_NE(run.err.find("3 rows, 1 touching"), std::string::npos) << run.err;
}

TEST(ClearanceCommand, WritesFilesAndScales) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", kCube);
  testing::write(folder / "motion.csv", motion());
  const ProgramRun run = run_tactum("clearance " + (folder / "cube.obj") + " " + (folder / "cube.obj") + " " +
                                    (folder / "motion.csv") + " --scale 0.001 --json " +
                                    (folder / "out.json") + " --csv " + (folder / "out.csv"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(run.out.empty());
  const nlohmann::json json = nlohmann::json::parse(testing::content(folder / "out.json"));
  ASSERT_EQ(json["rows"].size(), 3u);
  EXPECT_NEAR(json["rows"][0]["distance_m"].get<double>(), 0.0005, 1e-18);
  EXPECT_EQ(json["min_distance_m"], 0.0);
  EXPECT_EQ(json["min_distance_frame"], 8);
  EXPECT_EQ(json["touching_rows"], 1);
  EXPECT_EQ(testing::content(folder / "out.csv").substr(0, 38), "frame,time_s,distance_m,touching_pairs");
}

TEST(ClearanceCommand, RefusesStretchedMatricesAndTellsMendedOnes) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", kCube);
  const std::string meshes = "clearance " + (folder / "cube.obj") + " " + (folder / "cube.obj") + " ";
  testing::write(folder / "near.csv", std::string(kHeader) + "0,0," + kStill +
                                          ",3,0,0,0.999999,0.001,0,-0.001,0.999999,0,0,0,1\n");
  const ProgramRun near = run_tactum(meshes + (folder / "near.csv"));
  EXPECT_EQ(near.exit_code, 0);
  EXPECT_NE(near.err.find("orthonormal"), std::string::npos) << near.err;
  testing::write(folder / "far.csv", std::string(kHeader) + "0,0," + kStill + ",3,0,0,1.2,0,0,0,1,0,0,0,1\n");
  const ProgramRun far = run_tactum(meshes + (folder / "far.csv"));
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_FALSE(far.err.empty());
}

/// A pair of real meshes, the unit they are prepared in, and the motion that was measured by others.
struct ReferenceMotion {
  const char* name;
  const char *a, *b;
  const char* motion;
  const char* unit;
  double scale;  ///< metres per unit of the motion
  bool slow;     ///< left to the long test
};

/// frame -> (distance, whether triangles cross), of the reference's brute column.
std::map<long, std::pair<double, bool>> brute_column(const std::string& path) {
  std::map<long, std::pair<double, bool>> rows;
  std::istringstream lines(testing::content(path));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || !std::isdigit(static_cast<unsigned char>(line[0]))) continue;
    std::istringstream cells(line);
    std::array<std::string, 4> cell;
    for (std::string& text : cell) std::getline(cells, text, ',');
    rows[std::stol(cell[0])] = {std::stod(cell[2]), std::stol(cell[3]) > 0};
  }
  return rows;
}

class ClearanceOfRealParts : public ::testing::TestWithParam<ReferenceMotion> {};

TEST_P(ClearanceOfRealParts, IsThatOfTheReference) {
  TACTUM_NEEDS_REAL_DATA();
  const ReferenceMotion& of = GetParam();
  if (of.slow && !testing::full_run()) GTEST_SKIP() << "a long test: TACTUM_FULL=1";
  const ScratchFolder folder;
  const std::string data = testing::real_data().string() + "/";
  for (const auto& [mesh, part] : {std::pair(of.a, "a.tactum"), std::pair(of.b, "b.tactum")}) {
    const ProgramRun run =
        run_tactum("prepare " + data + mesh + " -o " + (folder / part) + " --no-cache --units " + of.unit);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const ProgramRun run =
      run_tactum("clearance " + (folder / "a.tactum") + " " + (folder / "b.tactum") + " " + data + of.motion +
                 "_motion.csv --scale " + std::to_string(of.scale) + " --json -");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = nlohmann::json::parse(run.out);
  const auto reference = brute_column(data + of.motion + "_reference.csv");
  ASSERT_EQ(json["rows"].size(), reference.size());
  double worst = 0.0;
  for (const nlohmann::json& row : json["rows"]) {
    const auto& [distance, touching] = reference.at(row["frame"].get<long>());
    EXPECT_EQ(row["touching_pairs"].get<int>() > 0, touching) << row["frame"];
    worst = std::max(worst, std::abs(row["distance_m"].get<double>() - of.scale * distance));
  }
  std::printf("%s: off by at most %.3g m\n", of.motion, worst);
  EXPECT_LE(worst, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    Motions, ClearanceOfRealParts,
    ::testing::Values(
        ReferenceMotion{"Gears", "industreal/industreal_gear_medium.obj",
                        "industreal/industreal_gear_small.obj", "reference/gears_medium_small", "m", 1.0,
                        testing::kSanitized},
        ReferenceMotion{"Thread", "factory/factory_bolt_m16_loose.obj",
                        "factory/factory_nut_m16_loose_subdiv_3x.obj", "reference/m16_loose_screw", "m", 1.0,
                        true},
        ReferenceMotion{"Peg", "factory/factory_round_hole_8mm_subdiv_3x.obj",
                        "factory/factory_round_peg_8mm_loose.obj", "reference/round_peg_8mm_loose", "m", 1.0,
                        false},
        ReferenceMotion{"RecordedMotion", "fcl_contact_models/newdata__Model_1_Scenario_3_obj1.obj",
                        "fcl_contact_models/newdata__Model_1_Scenario_3_obj2.obj",
                        "fcl_contact_models/newdata__Model_1_Scenario_3", "mm", 0.001, false},
        ReferenceMotion{"RecordedGears", "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_1_obj1.obj",
                        "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_1_obj2.obj",
                        "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_1", "mm", 0.001, false},
        ReferenceMotion{"RecordedGearsLater",
                        "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_2_obj1.obj",
                        "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_2_obj2.obj",
                        "fcl_contact_models/scenario-1-2-3__Model_2_Scenario_2", "mm", 0.001, false}),
    [](const ::testing::TestParamInfo<ReferenceMotion>& run) { return std::string(run.param.name); });

TEST(Program, ExitCodesTellWhoIsAtFault) {
  const ScratchFolder folder;
  EXPECT_EQ(run_tactum("--help").exit_code, 0);
  EXPECT_EQ(run_tactum("").exit_code, 2);
  EXPECT_EQ(run_tactum("clearance only_one.obj").exit_code, 2);
  EXPECT_EQ(run_tactum("no-such-command").exit_code, 2);
  const ProgramRun missing = run_tactum("inspect " + (folder / "missing.obj"));
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("missing.obj"), std::string::npos);
}

TEST(InspectCommand, ReportsTheCube) {
  const ScratchFolder folder;
  testing::write(folder / "cube.obj", kCube);
  testing::write(folder / "bad.obj", "f 1 2 3\n");
  const ProgramRun good = run_tactum("inspect --json - " + (folder / "cube.obj"));
  ASSERT_EQ(good.exit_code, 0) << good.err;
  const nlohmann::json json = nlohmann::json::parse(good.out);
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["triangles"], 12);
  EXPECT_EQ(json[0]["convex"], true);
  EXPECT_EQ(json[0]["part"]["way"], "solid: convex as it is");
  EXPECT_LT(json[0]["part"]["deviation_over_size"].get<double>(), 1e-15);
  EXPECT_NEAR(json[0]["volume_m3"].get<double>(), 1.0, 1e-12);
  const ProgramRun text = run_tactum("inspect " + (folder / "cube.obj") + " " + (folder / "bad.obj"));
  EXPECT_EQ(text.exit_code, 1);  // one of two is bad, the other is still shown
  EXPECT_NE(text.out.find("closed yes"), std::string::npos);
  EXPECT_NE(text.err.find("bad.obj, line 1"), std::string::npos);
}

}  // namespace
}  // namespace tactum::clearance_test
