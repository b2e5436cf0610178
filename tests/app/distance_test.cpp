#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/program.h"

namespace tactum::distance_test {
namespace {

using testing::ProgramRun;
using testing::run_tactum;
using testing::ScratchFolder;
using Json = nlohmann::json;

/// Corners of a box.
Json box(double x, double y, double z) {
  Json corners = Json::array();
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z});
  return corners;
}

Json pose(double x, double y, double z) { return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1}; }

Json one_case(const Json& id, const Json& a, const Json& b) {
  return {{"cases", {{{"id", id}, {"a", a}, {"b", b}}}}};
}

ProgramRun distance(const std::string& text) {
  const ScratchFolder folder;
  testing::write(folder / "cases.json", text);
  return run_tactum("distance " + (folder / "cases.json"));
}

TEST(DistanceCommand, BoxesApartAndOverlappingInTheWorldFrame) {
  // A is turned a quarter about z and moved; B stands beside it along world y.
  const Json turned = {0, -1, 0, 0.5, 1, 0, 0, 0.25, 0, 0, 1, 2.0, 0, 0, 0, 1};
  for (const double gap : {0.125, -0.0625}) {
    const Json cases =
        one_case(42, {{"vertices", box(1.0, 0.5, 0.25)}, {"pose", turned}},
                 {{"vertices", box(0.5, 0.5, 0.5)}, {"pose", pose(0.5, 0.25 + 1.5 + gap, 2.0)}});
    const ProgramRun run = distance(cases.dump());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Json result = Json::parse(run.out)["results"][0];
    EXPECT_EQ(result["id"], 42);
    EXPECT_NEAR(result["signed_distance"].get<double>(), gap, 1e-12);
    EXPECT_NEAR(result["normal"][1].get<double>(), -1.0, 1e-12);  // from B to A
    EXPECT_NEAR(result["p_a"][1].get<double>(), 1.25, 1e-12);
    EXPECT_NEAR(result["p_b"][1].get<double>(), 1.25 + gap, 1e-12);
    EXPECT_EQ(result["certified"], true);
    EXPECT_GT(result["steps"].get<int>(), 0);
  }
}

TEST(DistanceCommand, TheDepthIsTheGlobalMinimum) {
  // A long bar through the middle of a plate, nearer to leaving along the plate's thickness than along
  // itself.
  const Json cases = one_case("bar", {{"vertices", box(1.0, 1.0, 0.1)}},
                              {{"vertices", box(0.05, 0.05, 3.0)}, {"pose", pose(0.9, 0, 0)}});
  const ProgramRun run = distance(cases.dump());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(Json::parse(run.out)["results"][0]["signed_distance"].get<double>(), -0.15, 1e-12);
}

TEST(DistanceCommand, BadCasesAreNamedWithTheirField) {
  const Json good = {{"vertices", box(1, 1, 1)}};
  const struct {
    std::string text, expected;
  } bad[] = {
      {"{", "no JSON"},
      {R"({"cases": 3})", "expected an array"},
      {one_case("x", good, Json::object()).dump(),
       "case \"x\", b: a field is missing: found no \"vertices\""},
      {one_case("x", good, {{"vertices", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}}).dump(), "all on one line"},
      {one_case("x", good, {{"vertices", {{0, 0}, {1, 1, 1}, {2, 2, 2}}}}).dump(),
       "b.vertices[0]: wrong size"},
      {one_case("x", good, {{"vertices", box(1, 1, 1)}, {"pose", {1, 2}}}).dump(),
       "b.pose: wrong size: found 2 entries"},
      {one_case("x", {{"vertices", box(1, 1, 1)}, {"pose", {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}},
                good)
           .dump(),
       "a.pose: the matrix is no rotation"},
      {one_case("x", good, {{"vertices", "many"}}).dump(), "wrong type: found string"},
  };
  for (const auto& [text, expected] : bad) {
    const ProgramRun run = distance(text);
    EXPECT_EQ(run.exit_code, 1) << text;
    EXPECT_NE(run.err.find(expected), std::string::npos) << run.err;
    EXPECT_TRUE(run.out.empty());
  }
}

TEST(DistanceCommand, RoundedRotationsAreMendedAndTold) {
  Json rounded = pose(5, 0, 0);
  rounded[0] = 0.995004;
  rounded[1] = -0.099833;
  rounded[4] = 0.099833;
  rounded[5] = 0.995004;
  const ProgramRun run = distance(
      one_case("r", {{"vertices", box(1, 1, 1)}}, {{"vertices", box(1, 1, 1)}, {"pose", rounded}}).dump());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("made orthonormal"), std::string::npos);
  const double half_width = std::cos(0.1) + std::sin(0.1);
  EXPECT_NEAR(Json::parse(run.out)["results"][0]["signed_distance"].get<double>(), 4.0 - half_width, 1e-6);
}

}  // namespace
}  // namespace tactum::distance_test
