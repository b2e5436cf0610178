#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

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
      {one_case("x", good, Json::object()).dump(),
       "case \"x\", b: a field is missing: found no \"vertices\""},
      {one_case("x", good, {{"vertices", Json::array()}}).dump(), "b.vertices: a shape has no vertices"},
      {one_case("x", 7, good).dump(), "case \"x\", a: wrong type: found number"},
      {one_case("x", good, {{"part", "none.tactum"}}).dump(), "b.part"},
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
    const std::string message = Json::parse(run.out)["results"][0]["error"];
    EXPECT_NE(message.find(expected), std::string::npos) << message;
  }
}

TEST(DistanceCommand, AFileThatIsNoListOfCasesHasNoAnswers) {
  const std::pair<std::string, const char*> bad[] = {{"{", "no JSON"},
                                                     {R"({"cases": 3})", "expected an array"},
                                                     {R"({"case": []})", "no \"cases\""},
                                                     {std::string("\xFF\xFE{\0", 4), "UTF-16"},
                                                     {std::string("{\0\"\0", 4), "UTF-16"}};
  for (const auto& [text, expected] : bad) {
    const ProgramRun run = distance(text);
    EXPECT_EQ(run.exit_code, 1) << text;
    EXPECT_NE(run.err.find(expected), std::string::npos) << run.err;
    EXPECT_TRUE(run.out.empty());
  }
}

TEST(DistanceCommand, AByteOrderMarkIsNoPartOfTheCases) {
  const Json cube = {{"vertices", box(1, 1, 1)}};
  const ProgramRun run = distance("\xEF\xBB\xBF" + one_case(1, cube, cube).dump());
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST(DistanceCommand, TheOthersAreAnsweredBesideABadCase) {
  const Json cube = {{"vertices", box(1, 1, 1)}};
  const Json moved = {{"vertices", box(1, 1, 1)}, {"pose", pose(2.5, 0, 0)}};
  const Json cases = {{"cases",
                       {{{"id", "first"}, {"a", cube}, {"b", moved}},
                        {{"id", "second"}, {"a", cube}},
                        {{"a", cube}, {"b", {{"vertices", {{1, 2}}}}}},
                        {{"id", "last"}, {"a", cube}, {"b", moved}}}}};
  const ProgramRun run = distance(cases.dump());
  EXPECT_EQ(run.exit_code, 1);
  const Json results = Json::parse(run.out)["results"];
  ASSERT_EQ(results.size(), 4u);
  for (const int i : {0, 3}) EXPECT_NEAR(results[i]["signed_distance"].get<double>(), 0.5, 1e-12);
  EXPECT_EQ(results[1]["id"], "second");
  EXPECT_NE(results[1]["error"].get<std::string>().find("no \"b\""), std::string::npos) << results[1];
  EXPECT_EQ(results[2]["id"], 2);
  EXPECT_NE(results[2]["error"].get<std::string>().find("case 2, b.vertices[0]"), std::string::npos)
      << results[2];
}

struct ThinCase {
  const char* what;
  Json a, b;  ///< vertices
  double distance;
};

/// Distances in closed form; the box reaches from -1 to 1, -2 to 2 and -3 to 3, the square lies in z = 0.
std::vector<ThinCase> thin_cases() {
  const Json solid = box(1, 2, 3);
  const Json square = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const auto point = [](double x, double y, double z) { return Json::array({{x, y, z}}); };
  return {{"point and point", point(1, 2, 3), point(4, 6, 3), 5.0},
          {"equal points", point(1, 2, 3), point(1, 2, 3), 0.0},
          {"point beside a segment", point(0, 3, 4), {{-1, 0, 0}, {1, 0, 0}}, 5.0},
          {"point beyond a segment", point(4, 0, 4), {{-1, 0, 0}, {1, 0, 0}}, 5.0},
          {"crossing segments", {{-1, 0, 0}, {1, 0, 0}}, {{0, -1, 0}, {0, 1, 0}}, 0.0},
          {"skew segments", {{-1, 0, 0}, {1, 0, 0}}, {{0, -1, 0.5}, {0, 1, 0.5}}, 0.5},
          {"parallel segments", {{-1, 0, 0}, {1, 0, 0}}, {{0, 3, 4}, {9, 3, 4}}, 5.0},
          {"points of one line", {{-1, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}, {{4, 0, 4}, {4, 0, 4}}, 5.0},
          {"point over a face", solid, point(0.5, 0.5, 3.25), 0.25},
          {"point beside an edge", solid, point(4, 6, 0), 5.0},
          {"point beside a corner", solid, point(2, 4, 5), 3.0},
          {"point inside", solid, point(0.25, 0, 0), -0.75},
          {"point on a face", solid, point(1, 0.5, 0.5), 0.0},
          {"segment over a face", solid, {{1.5, -1, 0}, {2, 1, 0}}, 0.5},
          {"segment past an edge", solid, {{2, 3, -9}, {2, 3, 9}}, std::sqrt(2.0)},
          {"segment askew to an edge", solid, {{2, 3, 0}, {3, 2, 0}}, std::sqrt(2.0)},
          {"segment right through", solid, {{0, 0, -9}, {0, 0, 9}}, -1.0},
          {"segment through an edge", solid, {{1.5, 0.5, 0}, {-0.5, 2.5, 0}}, -0.5 * std::sqrt(2.0)},
          {"segment with an end inside", solid, {{0, 0, 2.75}, {0, 0, 9}}, -0.25},
          {"point over a square", square, point(0.5, 0, -0.25), 0.25},
          {"point on a square", square, point(0.5, 0, 0), 0.0},
          {"point in a square's plane", square, point(4, 5, 0), 5.0},
          {"segment through a square", square, {{0, 0, -0.25}, {0, 0, 0.5}}, -0.25},
          {"segment in a square's plane", square, {{4, 5, 0}, {9, 5, 0}}, 5.0},
          {"segment across the plane, far away", square, {{4, 5, -1}, {4, 5, 1}}, 5.0}};
}

TEST(DistanceCommand, PointsAndSegmentsAreShapes) {
  // Turned about an axis of no symmetry and moved; either body may be the thin one.
  const Json turned = {0.36, 0.48, -0.8, 5, -0.8, 0.6, 0, 6, 0.48, 0.64, 0.6, 7, 0, 0, 0, 1};
  Json cases = Json::array();
  const std::vector<ThinCase> thin = thin_cases();
  for (const ThinCase& one : thin) {
    const Json a = {{"vertices", one.a}, {"pose", turned}};
    const Json b = {{"vertices", one.b}, {"pose", turned}};
    cases.push_back({{"a", a}, {"b", b}});
    cases.push_back({{"a", b}, {"b", a}});
  }
  const ProgramRun run = distance(Json({{"cases", cases}}).dump());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json results = Json::parse(run.out)["results"];
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Json& result = results[i];
    const double d = result["signed_distance"];
    EXPECT_NEAR(d, thin[i / 2].distance, 1e-12) << thin[i / 2].what << result;
    EXPECT_EQ(result["certified"], true);
    double length = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double n = result["normal"][k];
      length += n * n;
      EXPECT_NEAR(result["p_a"][k].get<double>() - result["p_b"][k].get<double>(), d * n, 1e-12)
          << thin[i / 2].what;
    }
    EXPECT_NEAR(length, 1.0, 1e-12) << thin[i / 2].what;
  }
}

/// A needle stands for its segment: the core's own answer for a very thin box is off by no more than its
/// width.
TEST(DistanceCommand, ASegmentIsTheLimitOfThinBoxes) {
  const Json solid = box(1, 2, 3);
  const Json turned = {0.36, 0.48, -0.8, 1.5, -0.8, 0.6, 0, 0.25, 0.48, 0.64, 0.6, 1, 0, 0, 0, 1};
  Json cases = Json::array();
  for (const double shift : {0.0, 0.5, 1.0, 2.0, 4.0}) {
    Json at = turned;
    at[3] = 1.5 + shift;
    cases.push_back(
        {{"a", {{"vertices", solid}}}, {"b", {{"vertices", {{-2, 0, 0}, {2, 0, 0}}}, {"pose", at}}}});
    cases.push_back({{"a", {{"vertices", solid}}}, {"b", {{"vertices", box(2, 1e-6, 1e-6)}, {"pose", at}}}});
  }
  const ProgramRun run = distance(Json({{"cases", cases}}).dump());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json results = Json::parse(run.out)["results"];
  for (std::size_t i = 0; i < results.size(); i += 2)
    EXPECT_NEAR(results[i]["signed_distance"].get<double>(), results[i + 1]["signed_distance"].get<double>(),
                2e-6);
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
