/// tactum distance CASES.json: signed distance, witness points and normal of pairs of convex vertex clouds,
/// down to segments and points, or prepared parts of solid pieces.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.h"
#include "output.h"
#include "tactum/base/text_encoding.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"
#include "tactum/geometry/hull.h"
#include "tactum/math/rotation.h"
#include "tactum/mesh/part_file.h"
#include "thin_shape.h"

namespace tactum {
namespace {

using Json = nlohmann::ordered_json;

/// Edge pairs up to which overlapping clouds are searched in full; at 10 ns each, the most costs 40 s.
constexpr double kMostEdgePairs = 4e9;

/// The place in the file, for errors: "cases.json: case 3 (\"lid\"), a.pose".
struct Place {
  std::string file, item, field;
  Place at(const std::string& next) const { return {file, item, field.empty() ? next : field + "." + next}; }
  [[noreturn]] void refuse(const std::string& what, const std::string& found,
                           const std::string& expected) const {
    fail({what, found, expected,
          item.empty() ? file : file + ": " + item + (field.empty() ? "" : ", " + field)});
  }
};

const Json& member(const Json& object, const std::string& key, const Place& place) {
  if (!object.is_object()) place.refuse("wrong type", object.type_name(), "an object");
  const auto found = object.find(key);
  if (found == object.end()) place.refuse("a field is missing", "no \"" + key + "\"", "it");
  return *found;
}

double number(const Json& value, const Place& place) {
  if (!value.is_number()) place.refuse("wrong type", value.type_name(), "a number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) place.refuse("a number is out of range", value.dump(), "a finite number");
  return number;
}

void expect_array(const Json& value, std::size_t size, const Place& place) {
  if (!value.is_array()) place.refuse("wrong type", value.type_name(), "an array");
  if (value.size() != size)
    place.refuse("wrong size", fmt::format("{} entries", value.size()), fmt::format("{}", size));
}

std::vector<Vec3> read_points(const Json& value, const Place& place) {
  if (!value.is_array()) place.refuse("wrong type", value.type_name(), "an array of [x, y, z]");
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const Place here = {place.file, place.item, fmt::format("{}[{}]", place.field, i)};
    expect_array(value[i], 3, here);
    Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) point[static_cast<Eigen::Index>(k)] = number(value[i][k], here);
    points.push_back(point);
  }
  return points;
}

/// Row-major 4 x 4; absent: identity. Rounded rotations are repaired and reported.
Pose read_pose(const Json& object, const Place& place) {
  const auto found = object.find("pose");
  if (found == object.end()) return {};
  const Place here = place.at("pose");
  expect_array(*found, 16, here);
  Eigen::Matrix4d M;
  for (std::size_t i = 0; i < 16; ++i)
    M(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = number((*found)[i], here);
  if (M.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    here.refuse("the last row of the matrix is wrong",
                fmt::format("{} {} {} {}", M(3, 0), M(3, 1), M(3, 2), M(3, 3)), "0 0 0 1");
  const NearestRotation nearest = orthonormalized(M.topLeftCorner<3, 3>());
  if (!nearest.exists || nearest.deviation > tolerances::kRotationNear)
    here.refuse("the matrix is no rotation", fmt::format("|M M^T - I| up to {:.3g}", nearest.deviation),
                fmt::format("at most {:g}, and no reflection", tolerances::kRotationNear));
  if (nearest.deviation > tolerances::kRotationExact)
    fmt::print(stderr, "{}: {}, {}: made orthonormal, it was off by {:.1g}\n", here.file, here.item,
               here.field, nearest.deviation);
  return {nearest.R, M.topRightCorner<3, 1>()};
}

/// Certified and global: overlapping pairs are searched over every separating axis.
PairDistance signed_distance(const Polytope& A, const Polytope& B, const Pose& X_AB, const Place& place) {
  PairCache cache;
  const PairDistance found = closest_features(A, B, X_AB, cache);
  if (found.distance >= 0.0) return found;
  if (static_cast<double>(A.edges.size()) * static_cast<double>(B.edges.size()) > kMostEdgePairs) {
    fmt::print(stderr, "{}: {}: too many edges to search them all; the depth is a local minimum\n",
               place.file, place.item);
    return found;
  }
  PairDistance deepest = penetration_exhaustive(A, B, X_AB);
  deepest.steps += found.steps;
  return deepest;
}

Json vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Convex pieces, or a point or segment, and their pose.
struct Shape {
  std::vector<Polytope> pieces;
  std::optional<ThinShape> thin;
  Pose X_WS;
};

/// {"vertices": [...]} or {"part": "file"}, which stands beside the cases.
Shape read_shape(const Json& object, const Place& place) {
  if (!object.is_object()) place.refuse("wrong type", object.type_name(), "an object");
  Shape shape{{}, {}, read_pose(object, place)};
  if (!object.contains("part")) {
    const Place here = place.at("vertices");
    const std::vector<Vec3> points = read_points(member(object, "vertices", place), here);
    if (points.empty()) here.refuse("a shape has no vertices", "an empty array", "at least one [x, y, z]");
    shape.thin = thin_hull(points);
    if (shape.thin) return shape;
    Result<Polytope> hull = convex_hull(points);
    if (!hull) here.refuse(hull.error().what, hull.error().found, hull.error().expected);
    shape.pieces.push_back(std::move(*hull));
    return shape;
  }
  const Place here = place.at("part");
  if (!object["part"].is_string())
    here.refuse("wrong type", object["part"].type_name(), "the name of a file");
  const std::filesystem::path beside = std::filesystem::path(place.file).parent_path();
  Result<PartFile> file = load_part((beside / object["part"].get<std::string>()).string());
  if (!file) here.refuse(file.error().message(), "", "");
  if (file->part.pieces.empty() || file->part.pieces.front().flat)
    here.refuse("the part has no solid pieces", "a surface", "a part of convex solids");
  shape.pieces = std::move(file->part.pieces);
  shape.X_WS.p = shape.X_WS * file->origin;  // the pieces are relative to the centre of mass
  return shape;
}

ThinShape moved(const ThinShape& shape, const Pose& X) { return {X * shape.tail, X * shape.head}; }

/// The same answer with the bodies' names exchanged, in the frame of the one that was B.
PairDistance exchanged(PairDistance x) {
  std::swap(x.p_a, x.p_b);
  x.normal = -x.normal;
  return x;
}

/// Every piece of A against every one of B: the nearest, or deepest. In A's frame.
PairDistance shape_distance(const Shape& A, const Shape& B, const Place& place) {
  const Pose X_AB = relative_pose(A.X_WS, B.X_WS);
  if (A.thin && B.thin) return thin_distance(*A.thin, moved(*B.thin, X_AB));
  std::optional<PairDistance> found;
  const auto take = [&found](const PairDistance& one) {
    if (!found || one.distance < found->distance) found = one;
  };
  if (A.thin) {
    const ThinShape in_b = moved(*A.thin, X_AB.inverse());
    for (const Polytope& b : B.pieces) take(thin_distance(in_b, b));
    found->p_a = X_AB * found->p_a;
    found->p_b = X_AB * found->p_b;
    found->normal = X_AB.R * found->normal;
    return *found;
  }
  for (const Polytope& a : A.pieces) {
    if (B.thin) take(exchanged(thin_distance(moved(*B.thin, X_AB), a)));
    for (const Polytope& b : B.pieces) take(signed_distance(a, b, X_AB, place));
  }
  return *found;
}

Json answer(const Json& item, const Json& id, const Place& place) {
  const Shape A = read_shape(member(item, "a", place), place.at("a"));
  const Shape B = read_shape(member(item, "b", place), place.at("b"));
  const PairDistance found = shape_distance(A, B, place);
  return {{"id", id},
          {"signed_distance", found.distance},
          {"p_a", vector(A.X_WS * found.p_a)},
          {"p_b", vector(A.X_WS * found.p_b)},
          {"normal", vector(A.X_WS.R * found.normal)},
          {"certified", found.certified()},
          {"steps", found.steps}};
}

Json read_cases(const Place& place) {
  std::ifstream file(place.file, std::ios::binary);
  if (!file) place.refuse("cannot read the cases", "no readable file", "a JSON file");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const Result<std::string_view> text = utf8_text(bytes, place.file);
  if (!text) fail(text.error());
  try {
    const Json input = Json::parse(*text);
    const Json& cases = member(input, "cases", place);
    if (!cases.is_array()) place.refuse("\"cases\" has the wrong type", cases.type_name(), "an array");
    return cases;
  } catch (const Json::exception& error) {
    place.refuse("this is no JSON", error.what(), R"({"cases": [...]})");
  }
}

/// A case that is wrong has its error among the answers of the others, and the command fails in the end.
void distance(const std::string& path, const std::string& json) {
  const Json cases = read_cases({path, "", ""});
  Json results = Json::array();
  bool all_answered = true;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const bool named = cases[i].is_object() && cases[i].contains("id");
    const Json id = named ? cases[i]["id"] : Json(i);
    try {
      results.push_back(
          answer(cases[i], id, {path, fmt::format("case {}", named ? id.dump() : fmt::to_string(i)), ""}));
    } catch (const std::exception& error) {
      all_answered = false;
      fmt::print(stderr, "tactum: {}\n", error.what());
      results.push_back({{"id", id}, {"error", error.what()}});
    }
  }
  write_json(json.empty() ? "-" : json, {{"results", results}});
  if (!all_answered) throw CLI::RuntimeError(1);
}

}  // namespace

void add_distance(CLI::App& app) {
  struct Options {
    std::string cases, json;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "distance",
      "Compute the signed distance of pairs of convex vertex clouds, segments, points or solid parts");
  command
      ->add_option(
          "CASES", options->cases,
          R"({"cases":[{"id","a":{"vertices":[[x,y,z],...],"pose":[16 numbers, row-major]},"b":{...}}]}; one vertex is a point, two are a segment; instead of vertices also "part": a prepared part of solid pieces, beside CASES)")
      ->required();
  command->add_option("--json", options->json, "Write the results to this file instead of standard output");
  command->callback([options] { distance(options->cases, options->json); });
}

}  // namespace tactum
