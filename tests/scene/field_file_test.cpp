/// Field files and the fields of scene files: the values read are those written, and faults are reported.

#include "tactum/scene/field_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "app/program.h"
#include "tactum/base/random.h"
#include "tactum/scene/scene_file.h"

namespace tactum::field_file_test {
namespace {

using testing::ScratchFolder;
using testing::write;

GridShape small_shape() {
  GridShape shape;
  shape.nodes = {3, 4, 2};
  shape.spacing = {0.01, 0.02, 0.03};
  shape.origin = {-0.01, 0.5, 1.0 / 3.0};
  return shape;
}

Vec3 numbered(const Vec3& p) { return {100.0 * p.x(), 10.0 * p.y() - 3.0, p.z() * p.x() + 1.0 / 7.0}; }

const char* const kHeader = R"(schema = 1
data = "field.raw"
nodes = [3, 4, 2]
spacing_m = [0.01, 0.02, 0.03]
origin_m = [-0.01, 0.5, 0.25]
type = "float64"
byte_order = "little"
components = 3
unit_N = 1
)";
constexpr std::size_t kDataBytes = 3 * 24 * sizeof(double);

/// The header with one line changed; the data are zeros.
std::string error_of(const ScratchFolder& folder, const std::string& line, const std::string& instead,
                     std::size_t bytes = kDataBytes) {
  std::string header = kHeader;
  const std::size_t at = header.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  header.replace(at, line.size(), instead);
  write(folder / "field.toml", header);
  write(folder / "field.raw", std::string(bytes, '\0'));
  const Result<FieldGrid> grid = read_field_file(folder / "field.toml");
  return grid ? "none" : grid.error().message();
}

TEST(FieldFile, IsReadAsItWasWritten) {
  const ScratchFolder folder;
  const GridShape shape = small_shape();
  for (const bool single : {false, true}) {
    FieldGrid::Samples samples;
    if (single) {
      samples = sampled<float>(shape, numbered);
    } else {
      samples = sampled<double>(shape, numbered);
    }
    ASSERT_TRUE(write_field_file(folder / "a \"b\".toml", shape, samples));
    const Result<FieldGrid> grid = read_field_file(folder / "a \"b\".toml");
    ASSERT_TRUE(grid) << grid.error().message();
    EXPECT_EQ(grid->shape().nodes, shape.nodes);
    EXPECT_EQ(grid->shape().spacing, shape.spacing);
    EXPECT_EQ(grid->shape().origin, shape.origin);
    EXPECT_EQ(grid->samples(), samples);
  }
  EXPECT_FALSE(write_field_file(folder / "x.raw", shape, sampled<float>(shape, numbered)));
  EXPECT_FALSE(write_field_file("/no/such/folder/x.toml", shape, sampled<float>(shape, numbered)));
}

template <class Number>
std::string in_order(const std::vector<Number>& numbers, bool big) {
  std::string bytes;
  for (const Number number : numbers) {
    char one[sizeof(Number)];
    std::memcpy(one, &number, sizeof(Number));
    if (big) std::reverse(one, one + sizeof(Number));
    bytes.append(one, sizeof(Number));
  }
  return bytes;
}

TEST(FieldFile, TakesBothByteOrdersBothPrecisionsAndAUnit) {
  const ScratchFolder folder;
  GridShape shape = small_shape();
  shape.origin.z() = 0.25;
  for (const bool big : {false, true})
    for (const bool single : {false, true}) {
      std::string header = kHeader;
      if (big) header.replace(header.find("little"), 6, "big");
      if (single) header.replace(header.find("float64"), 7, "float32");
      header.replace(header.find("unit_N = 1"), 10, "unit_N = 0.25");
      write(folder / "field.toml", header);
      write(folder / "field.raw", single ? in_order(sampled<float>(shape, numbered), big)
                                         : in_order(sampled<double>(shape, numbered), big));
      const Result<FieldGrid> grid = read_field_file(folder / "field.toml");
      ASSERT_TRUE(grid) << grid.error().message();
      for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 3; ++i) {
            const Vec3 p = shape.node(i, j, k);
            EXPECT_LT((grid->at(p).force - 0.25 * numbered(p)).norm(), single ? 1e-6 : 1e-12);
          }
    }
}

TEST(FieldFile, SaysWhatIsWrong) {
  const ScratchFolder folder;
  const auto expect = [&](const char* line, const char* instead, const char* words,
                          std::size_t bytes = kDataBytes) {
    const std::string message = error_of(folder, line, instead, bytes);
    EXPECT_NE(message.find(words), std::string::npos) << instead << ": " << message;
  };
  EXPECT_EQ(error_of(folder, "unit_N", "unit_N"), "none");
  expect("schema = 1", "schema = 2", "field.toml:1:10");
  expect("schema = 1", "", "missing key \"schema\"");
  expect("data = \"field.raw\"", "data = \"other.raw\"", "other.raw: the file cannot be opened");
  expect("data = \"field.raw\"", "data = \"\"", "this is not a file");
  expect("data = \"field.raw\"", "data = 3", "field.toml:2:8: wrong type of \"data\"");
  expect("data =", "dat =", "unknown key in the file: found \"dat\", expected \"data\"");
  expect("nodes = [3, 4, 2]", "", "missing key \"nodes\"");
  expect("[3, 4, 2]", "[3, 4]", "expected 3 numbers");
  expect("[3, 4, 2]", "[3, 4.5, 2]", "expected a whole number");
  expect("[3, 4, 2]", "[3, -4, 2]", "along y: found -4, expected 2 to 4096");
  expect("[3, 4, 2]", "[3, 4, 1]", "along z: found 1");
  expect("[3, 4, 2]", "[4000000000, 4000000000, 4000000000]", "whole number");
  expect("[3, 4, 2]", "[999999999, 4, 2]", "along x: found 999999999");
  expect("[3, 4, 2]", "[1e400, 4, 2]", "field.toml:3");
  expect("[3, 4, 2]", "[4096, 4096, 4096]", "found 576 bytes, expected 1649267441664 for 4096 x 4096 x 4096");
  expect("[0.01, 0.02, 0.03]", "[0.01, 0, 0.03]", "spacing is no length");
  expect("[0.01, 0.02, 0.03]", "[0.01, nan, 0.03]", "a finite number");
  expect("[-0.01, 0.5, 0.25]", "[inf, 0.5, 0.25]", "a finite number");
  expect("\"float64\"", "\"int16\"", "\"type\" in the file is not known");
  expect("\"float64\"", "\"float32\"", "found 576 bytes, expected 288");
  expect("\"little\"", "\"middle\"", "\"byte_order\"");
  expect("components = 3", "components = 1", "\"components\" in the file is out of range");
  expect("components = 3", "", "missing key \"components\"");
  expect("unit_N = 1", "unit_N = nan", "\"unit_N\"");
  expect("unit_N = 1", "unit_N = inf", "\"unit_N\"");
  expect("unit_N = 1", "unit_N = [", "not TOML");
  expect("unit_N", "unit_N", "found 575 bytes, expected 576", kDataBytes - 1);
  expect("unit_N", "unit_N", "found 577 bytes, expected 576", kDataBytes + 1);
  expect("unit_N", "unit_N", "the file is empty", 0);
  EXPECT_FALSE(read_field_file(folder / "none.toml"));
  EXPECT_FALSE(read_field_file("/tmp"));

  std::vector<double> numbers(72, 0.5);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    numbers[3 * (2 + 3 * (1 + 4 * 1)) + 2] = bad;
    write(folder / "field.toml", kHeader);
    write(folder / "field.raw", in_order(numbers, false));
    const Result<FieldGrid> grid = read_field_file(folder / "field.toml");
    ASSERT_FALSE(grid);
    EXPECT_NE(grid.error().message().find("field.raw: node (2, 1, 1): a sample is no force"),
              std::string::npos)
        << grid.error().message();
  }
}

TEST(FieldFile, NoHarmComesFromDamagedHeaders) {
  // Bytes changed, taken out and put in, thousands of times: an error or a grid, never anything else.
  const ScratchFolder folder;
  write(folder / "field.raw", std::string(kDataBytes, '\0'));
  Random random(21);
  int read = 0;
  const std::string sound = kHeader;
  for (int i = 0; i < 3000; ++i) {
    std::string header = sound;
    const int faults = 1 + random.index(3);
    for (int f = 0; f < faults && !header.empty(); ++f) {
      const std::size_t at = static_cast<std::size_t>(random.index(static_cast<int>(header.size())));
      const char byte = random.index(2) == 0
                            ? static_cast<char>(random.index(256))
                            : sound[static_cast<std::size_t>(random.index(int(sound.size())))];
      switch (random.index(4)) {
        case 0:
          header[at] = byte;
          break;
        case 1:
          header.erase(at, 1 + static_cast<std::size_t>(random.index(12)));
          break;
        case 2:
          header.insert(at, std::string(1 + static_cast<std::size_t>(random.index(9)), byte));
          break;
        default:
          header.resize(at + 1);
      }
    }
    write(folder / "field.toml", header);
    const Result<FieldGrid> grid = read_field_file(folder / "field.toml");
    if (!grid) continue;
    ++read;
    EXPECT_EQ(grid->shape().count(), 24u);
  }
  EXPECT_GT(read, 10);
  EXPECT_LT(read, 2000);
}

// A box over a plate with a field; every line is used below.
const char* const kScene = R"(schema = 1
[[body]]
name = "plate"
part = { box = { size_m = [0.2, 0.2, 0.01] } }
joint = { kind = "fixed" }
[[body]]
name = "box"
part = { box = { size_m = [0.02, 0.04, 0.06] } }
pos_m = [0, 0, 0.1]
[tool]
body = "box"
[[field]]
kind = "dipole"
moment_Nm3 = 2e-6
core_m = 0.01
pos_m = [0, 0.01, 0.1]
rpy_deg = [90, 0, 0]
scale = 1.5
largest_force_N = 2
largest_torque_Nm = 0.02
[hand]
grip = "firm"
[[hand.step]]
hold_s = 1
)";

Result<Scene> scene_with(const std::string& line, const std::string& instead,
                         const std::vector<std::string>& folders = {}) {
  std::string text = kScene;
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  text.replace(at, line.size(), instead);
  return parse_scene(text, "test", "test.toml", folders);
}

TEST(SceneFields, AreReadWithTheirPlaceScaleAndLimits) {
  const Result<Scene> scene = scene_with("schema", "schema");
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ(scene->world.fields.size(), 1u);
  const ForceField& field = scene->world.fields[0];
  EXPECT_EQ(std::get<DipoleField>(field.shape).moment_Nm3, 2e-6);
  EXPECT_EQ(std::get<DipoleField>(field.shape).core_m, 0.01);
  EXPECT_EQ(field.scale, 1.5);
  EXPECT_EQ(field.largest_force_N, 2.0);
  EXPECT_EQ(field.largest_torque_Nm, 0.02);
  EXPECT_LT((field.X_WF * Vec3(0, 0, 1) - Vec3(0, -1 + 0.01, 0.1)).norm(), 1e-12);
  EXPECT_TRUE(scene->world.bodies[0].field_points.empty()) << "a fixed body";
  EXPECT_EQ(scene->world.bodies[1].field_points.size(), 100u);
}

TEST(SceneFields, SamplePointsAreCountedOrTold) {
  const Result<Scene> counted = scene_with("pos_m = [0, 0, 0.1]", "pos_m = [0, 0, 0.1]\nfield_points = 7");
  ASSERT_TRUE(counted) << counted.error().message();
  EXPECT_EQ(counted->world.bodies[1].field_points.size(), 7u);
  const Result<Scene> listed = scene_with("pos_m = [0, 0, 0.1]",
                                          "pos_m = [0, 0, 0.1]\nfield_point = [{ pos_m = [0, 0, 0.03] }, { "
                                          "pos_m = [0, 0, -0.03], weight = -0.25 }]");
  ASSERT_TRUE(listed) << listed.error().message();
  const std::vector<FieldPoint>& points = listed->world.bodies[1].field_points;
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LT((points[0].p_B - Vec3(0, 0, 0.03)).norm(), 1e-12);
  EXPECT_EQ(points[0].weight, 0.5);
  EXPECT_EQ(points[1].weight, -0.25);
}

TEST(SceneFields, GridsComeFromFilesAndFormulas) {
  const ScratchFolder folder;
  const GridShape shape = small_shape();
  ASSERT_TRUE(write_field_file(folder / "flow.toml", shape, sampled<double>(shape, numbered)));
  const std::string dipole = "kind = \"dipole\"\nmoment_Nm3 = 2e-6\ncore_m = 0.01\n";
  const Result<Scene> read =
      scene_with(dipole, "kind = \"grid\"\nfile = \"flow.toml\"\nedge_m = 0.05\n", {folder / ""});
  ASSERT_TRUE(read) << read.error().message();
  const auto& grid = std::get<std::shared_ptr<const FieldGrid>>(read->world.fields[0].shape);
  EXPECT_LT((grid->at(shape.node(1, 2, 1)).force - numbered(shape.node(1, 2, 1))).norm(), 1e-12);

  const Result<Scene> made =
      scene_with("core_m = 0.01\n",
                 "core_m = 0.01\nsampled = { nodes = 17, size_m = [0.1, 0.08, 0.06], type = \"float64\" }\n");
  ASSERT_TRUE(made) << made.error().message();
  const auto& own = std::get<std::shared_ptr<const FieldGrid>>(made->world.fields[0].shape);
  EXPECT_EQ(own->shape().nodes, (std::array{17, 17, 17}));
  const Vec3 node = own->shape().node(16, 0, 8);
  EXPECT_LT((node - Vec3(0.05, -0.04, 0.0)).norm(), 1e-12);
  EXPECT_LT((own->at(node).force - value_at(DipoleField{2e-6, 0.01}, node).force).norm(), 1e-12);
}

TEST(SceneFields, ErrorsTellThePlaceAndWhatIsMeant) {
  const auto expect = [&](const std::string& line, const std::string& instead, const char* words) {
    const Result<Scene> scene = scene_with(line, instead);
    const std::string message = scene ? "none" : scene.error().message();
    EXPECT_NE(message.find(words), std::string::npos) << instead << ": " << message;
  };
  expect("kind = \"dipole\"", "", "missing key \"kind\" in [field 1]");
  expect("\"dipole\"", "\"monopole\"", "test.toml:13:8");
  expect("core_m = 0.01", "core_m = 0", "\"core_m\" in [field 1] is out of range");
  expect("core_m = 0.01", "", "missing key \"core_m\"");
  expect("moment_Nm3", "moment", "unknown key in [field 1]: found \"moment\", expected \"moment_Nm3\"");
  expect("core_m = 0.01", "core_m = 0.01\nwidth_m = 1",
         "\"width_m\" in [field 1] is not for this kind of field: found dipole, expected well");
  expect("core_m = 0.01", "core_m = 0.01\nedge_m = 1", "only a grid has an edge");
  expect("largest_force_N = 2", "largest_force_N = 0", "out of range");
  expect("\"dipole\"", "\"grid\"", "\"moment_Nm3\" in [field 1] is not for this kind of field: found grid");
  expect("kind = \"dipole\"\nmoment_Nm3 = 2e-6\ncore_m = 0.01\n", "kind = \"grid\"\nfile = \"none.toml\"\n",
         "test.toml:14:8: cannot find the field \"none.toml\"");
  expect("core_m = 0.01", "core_m = 0.01\nsampled = { nodes = 513, size_m = [1, 1, 1] }", "2 to 512");
  expect("core_m = 0.01", "core_m = 0.01\nsampled = { nodes = 400, size_m = [1, 1, 1] }", "too much memory");
  expect("core_m = 0.01", "core_m = 0.01\nsampled = { nodes = 4, size_m = [1, 0, 1] }",
         "spacing is no length");
  expect("core_m = 0.01", "core_m = 0.01\nsampled = { nodes = 4 }", "missing key \"size_m\"");
  expect("pos_m = [0, 0, 0.1]", "field_points = 0", "out of range");
  expect("pos_m = [0, 0, 0.1]", "field_points = 3\nfield_point = [{ pos_m = [0, 0, 0] }]",
         "two sets of sample points");
}

}  // namespace
}  // namespace tactum::field_file_test
