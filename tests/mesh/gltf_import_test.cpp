#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "mesh/gltf_sample.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"

/// What glTF files of the field hold beside plain floats: quantized positions, sparse accessors, strips and
/// fans, names of files in percents. All of it is one tetrahedron with legs of 30, 20 and 10 units.

namespace tactum::gltf_import_test {
namespace {

using Json = nlohmann::json;

enum Component { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };

const std::vector<double> kPoints = {0, 0, 0, 30, 0, 0, 0, 20, 0, 0, 0, 10};
const std::vector<double> kCorners = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

template <class T>
void put(std::string& bytes, double value) {
  const T typed = static_cast<T>(value);
  bytes.append(reinterpret_cast<const char*>(&typed), sizeof typed);
}

void put(std::string& bytes, Component component, double value) {
  switch (component) {
    case kByte:
      return put<std::int8_t>(bytes, value);
    case kUnsignedByte:
      return put<std::uint8_t>(bytes, value);
    case kShort:
      return put<std::int16_t>(bytes, value);
    case kUnsignedShort:
      return put<std::uint16_t>(bytes, value);
    case kUnsignedInt:
      return put<std::uint32_t>(bytes, value);
    case kFloat:
      return put<float>(bytes, value);
  }
}

double largest(Component component) {
  return component == kByte            ? 127.0
         : component == kUnsignedByte  ? 255.0
         : component == kShort         ? 32767.0
         : component == kUnsignedShort ? 65535.0
                                       : 1.0;
}

/// A GLB of one primitive, put together number by number.
struct Sample {
  Json document = Json::parse(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "accessors":[],"bufferViews":[]})");
  std::string bin;

  /// The view of numbers with `stride` of them in an entry, `used` of which are given.
  int add_view(Component component, const std::vector<double>& numbers, std::size_t used = 1,
               std::size_t stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4, '\0');
    const std::size_t start = bin.size();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      put(bin, component, numbers[i]);
      for (std::size_t k = used; (i + 1) % used == 0 && k < stride; ++k) put(bin, component, 77);
    }
    Json view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bin.size() - start}};
    if (stride > 0) view["byteStride"] = (bin.size() - start) / (numbers.size() / used);
    document["bufferViews"].push_back(view);
    return static_cast<int>(document["bufferViews"].size()) - 1;
  }
  int add_accessor(Component component, std::size_t count, const char* type, const Json& more) {
    Json accessor = {{"componentType", component}, {"count", count}, {"type", type}};
    accessor.update(more);
    document["accessors"].push_back(accessor);
    return static_cast<int>(document["accessors"].size()) - 1;
  }
  int add_points(Component component, const std::vector<double>& numbers, bool normalized = false) {
    const bool is_float = component == kFloat;
    const int view = add_view(component, numbers, 3, is_float ? 0 : 4);
    return add_accessor(component, numbers.size() / 3, "VEC3",
                        {{"bufferView", view}, {"normalized", normalized}});
  }
  int add_indices(Component component, const std::vector<double>& numbers) {
    return add_accessor(component, numbers.size(), "SCALAR", {{"bufferView", add_view(component, numbers)}});
  }
  void set_primitive(int points, int indices, int mode = 4) {
    Json primitive = {{"attributes", {{"POSITION", points}}}, {"mode", mode}};
    if (indices >= 0) primitive["indices"] = indices;
    document["meshes"] = Json::array({{{"primitives", Json::array({primitive})}}});
  }
  std::string glb() const {
    Json whole = document;
    whole["buffers"] = Json::array({{{"byteLength", bin.size()}}});
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    for (const std::size_t word : {std::size_t{2}, 28 + text.size() + bin.size(), text.size()})
      put<std::uint32_t>(bytes, static_cast<double>(word));
    bytes += "JSON" + text;
    put<std::uint32_t>(bytes, static_cast<double>(bin.size()));
    return bytes + std::string("BIN\0", 4) + bin;
  }
};

MeshReport report_of(const Sample& sample) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(sample.glb(), "a.glb");
  EXPECT_TRUE(mesh) << mesh.error().message() << "\n" << sample.document.dump();
  return mesh ? report_mesh(mesh->mesh) : MeshReport{};
}

void expect_tetrahedron(const Sample& sample, double volume = 1000.0) {
  const MeshReport report = report_of(sample);
  EXPECT_EQ(report.triangles, 4) << sample.document.dump();
  EXPECT_TRUE(report.closed && report.oriented) << sample.document.dump();
  EXPECT_NEAR(report.volume / volume, 1.0, 1e-5) << sample.document.dump();  // floats, rounded to their type
}

void expect_refused(const Sample& sample, const std::string& words) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(sample.glb(), "a.glb");
  ASSERT_FALSE(mesh) << sample.document.dump();
  EXPECT_NE(mesh.error().message().find(words), std::string::npos) << mesh.error().message();
}

std::vector<double> scaled(const std::vector<double>& numbers, double by) {
  std::vector<double> out;
  for (const double x : numbers) out.push_back(std::round(x * by));
  return out;
}

TEST(GltfImport, QuantizedPositionsAreThoseOfTheNodesTransform) {
  for (const Component component : {kByte, kUnsignedByte, kShort, kUnsignedShort}) {
    for (const bool normalized : {false, true}) {
      const double unit = std::floor(largest(component) / 30.0);  // of the type in one of ours
      const double scale = (normalized ? largest(component) : 1.0) / unit;
      Sample sample;
      sample.document["extensionsRequired"] = Json::array({"KHR_mesh_quantization"});
      const int points = sample.add_points(component, scaled(kPoints, unit), normalized);
      sample.set_primitive(points, sample.add_indices(kUnsignedByte, kCorners));
      sample.document["nodes"][0]["scale"] = {-scale, scale, 2 * scale};
      sample.document["nodes"][0]["translation"] = {5, 0, 0};
      expect_tetrahedron(sample, 2000.0);
      const MeshReport report = report_of(sample);
      EXPECT_NEAR(report.box.min.x(), -25.0, 1e-4);
      EXPECT_NEAR(report.box.max.x(), 5.0, 1e-4);
      EXPECT_NEAR(report.box.max.z(), 20.0, 1e-4);
    }
  }
}

TEST(GltfImport, NegativeQuantizedPositionsKeepTheirSign) {
  for (const Component component : {kByte, kShort}) {
    const double least = -largest(component) - 1.0;  // normalized, it is -1 like its neighbour
    Sample sample;
    const int points = sample.add_points(component, {0, 0, 0, least, 0, 0, 0, least, 0, 0, 0, least}, true);
    sample.set_primitive(points, sample.add_indices(kUnsignedShort, {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2}));
    expect_tetrahedron(sample, 1.0 / 6.0);
    EXPECT_EQ(report_of(sample).box.min, Vec3(-1, -1, -1));
  }
}

TEST(GltfImport, IndicesOfEveryTypeAndNone) {
  for (const Component component : {kUnsignedByte, kUnsignedShort, kUnsignedInt}) {
    Sample sample;
    const int points = sample.add_points(kFloat, kPoints);
    sample.set_primitive(points, sample.add_indices(component, kCorners));
    expect_tetrahedron(sample);
  }
  std::vector<double> all;
  for (const double corner : kCorners)
    for (int axis = 0; axis < 3; ++axis) all.push_back(kPoints[static_cast<std::size_t>(3 * corner) + axis]);
  Sample sample;
  sample.set_primitive(sample.add_points(kFloat, all), -1);
  expect_tetrahedron(sample);
}

TEST(GltfImport, StripsAndFansAreTriangles) {
  for (const bool stitched : {false, true}) {
    Sample strip;
    const int points = strip.add_points(kFloat, kPoints);
    const std::vector<double> corners =
        stitched ? std::vector<double>{1, 0, 2, 3, 3, 0, 0, 1, 3, 2} : std::vector<double>{1, 0, 2, 3, 1, 0};
    strip.set_primitive(points, strip.add_indices(kUnsignedByte, corners), 5);
    expect_tetrahedron(strip);
  }
  Sample fan;
  const int points = fan.add_points(kFloat, kPoints);
  const int around = fan.add_indices(kUnsignedShort, {0, 1, 3, 2, 1});
  const int last = fan.add_indices(kUnsignedShort, {1, 2, 3});
  fan.set_primitive(points, around, 6);
  Json second = fan.document["meshes"][0]["primitives"][0];
  second["indices"] = last;
  fan.document["meshes"][0]["primitives"].push_back(second);
  expect_tetrahedron(fan);
  Sample short_strip;
  const int few = short_strip.add_points(kFloat, kPoints);
  short_strip.set_primitive(few, short_strip.add_indices(kUnsignedByte, {0, 1}), 5);
  expect_refused(short_strip, "2 corners");
}

Json sparse(Sample& sample, const std::vector<double>& places, Component component,
            const std::vector<double>& values, std::size_t in_entry, Component type) {
  const int to = sample.add_view(type, places);
  const int from = sample.add_view(component, values, in_entry);
  return {{"count", places.size()},
          {"indices", {{"bufferView", to}, {"componentType", type}}},
          {"values", {{"bufferView", from}}}};
}

TEST(GltfImport, SparseAccessorsChangeWhatIsBelowOrZero) {
  for (const Component type : {kUnsignedByte, kUnsignedShort, kUnsignedInt}) {
    Sample over_zero;  // the first point is none of the changed ones
    const Json changes = sparse(over_zero, {1, 2, 3}, kFloat, {30, 0, 0, 0, 20, 0, 0, 0, 10}, 3, type);
    const int points = over_zero.add_accessor(kFloat, 4, "VEC3", {{"sparse", changes}});
    over_zero.set_primitive(points, over_zero.add_indices(kUnsignedByte, kCorners));
    expect_tetrahedron(over_zero);

    Sample over_others;
    const int base = over_others.add_view(kFloat, {0, 0, 0, 1, 1, 1, 0, 20, 0, 2, 2, 2}, 3);
    const Json two = sparse(over_others, {1, 3}, kFloat, {30, 0, 0, 0, 0, 10}, 3, type);
    const int mixed = over_others.add_accessor(kFloat, 4, "VEC3", {{"bufferView", base}, {"sparse", two}});
    const int view = over_others.add_view(kUnsignedShort, {0, 2, 1, 0, 1, 3, 0, 3, 2, 0, 0, 0});
    const Json three = sparse(over_others, {9, 10, 11}, kUnsignedShort, {1, 2, 3}, 1, type);
    const int corners =
        over_others.add_accessor(kUnsignedShort, 12, "SCALAR", {{"bufferView", view}, {"sparse", three}});
    over_others.set_primitive(mixed, corners);
    expect_tetrahedron(over_others);
  }
}

TEST(GltfImport, PrimitivesThatShareTheirPointsCarryOnlyTheirOwn) {
  for (const bool is_sparse : {true, false}) {
    for (const std::size_t count : {4, 40, 90}) {
      for (const std::size_t pieces : {1, 4, 60}) {
        Sample sample;
        std::vector<double> coordinates = kPoints;
        coordinates.resize(3 * count);
        const int points =
            is_sparse
                ? sample.add_accessor(kFloat, count, "VEC3",
                                      {{"sparse", sparse(sample, {1, 2, 3}, kFloat,
                                                         {30, 0, 0, 0, 20, 0, 0, 0, 10}, 3, kUnsignedByte)}})
                : sample.add_points(kFloat, coordinates);
        sample.set_primitive(points, sample.add_indices(kUnsignedByte, kCorners));
        const Json first = sample.document["meshes"][0]["primitives"][0];
        for (std::size_t i = 1; i < pieces; ++i) {
          Json next = first;
          const std::vector<double> corners(kCorners.begin(), kCorners.begin() + 3);
          next["indices"] = sample.add_indices(kUnsignedByte, corners);
          sample.document["meshes"][0]["primitives"].push_back(next);
        }
        ImportOptions options;
        options.max_vertices = 200;
        const Result<ImportedMesh> mesh = import_mesh_bytes(sample.glb(), "a.glb", options);
        ASSERT_TRUE(mesh) << mesh.error().message();
        EXPECT_EQ(mesh->mesh.vertices.size(), 4 + 3 * (pieces - 1));
        EXPECT_EQ(mesh->mesh.triangles.size(), 4 + (pieces - 1));
        EXPECT_EQ(mesh->report.unused_vertices, static_cast<int>(count) - 4);
      }
    }
  }
}

TEST(GltfImport, AccessorsWithoutBytesAreBoundedTogether) {
  Sample sample;
  for (int i = 0; i < 3; ++i) {
    const Json changes = sparse(sample, {1, 2, 3}, kFloat, {30, 0, 0, 0, 20, 0, 0, 0, 10}, 3, kUnsignedByte);
    const int points = sample.add_accessor(kFloat, 90, "VEC3", {{"sparse", changes}});
    const int corners = sample.add_indices(kUnsignedByte, kCorners);
    if (i == 0) sample.set_primitive(points, corners);
    Json next = sample.document["meshes"][0]["primitives"][0];
    next["attributes"]["POSITION"] = points;
    sample.document["meshes"][0]["primitives"].push_back(next);
  }
  ImportOptions options;
  options.max_vertices = 200;
  const Result<ImportedMesh> mesh = import_mesh_bytes(sample.glb(), "a.glb", options);
  ASSERT_FALSE(mesh);
  EXPECT_NE(mesh.error().message().find("too many points in all accessors"), std::string::npos)
      << mesh.error().message();
}

TEST(GltfImport, BrokenAccessorsAreTold) {
  const auto with_sparse = [](const std::vector<double>& places, std::size_t count) {
    Sample sample;
    Json changes = sparse(sample, places, kFloat, {30, 0, 0, 0, 20, 0, 0, 0, 10}, 3, kUnsignedByte);
    changes["count"] = count;
    const int points = sample.add_accessor(kFloat, 4, "VEC3", {{"sparse", changes}});
    sample.set_primitive(points, sample.add_indices(kUnsignedByte, kCorners));
    return sample;
  };
  expect_refused(with_sparse({1, 2, 4}, 3), "entry 4, expected 0 to 3");
  expect_refused(with_sparse({1, 2, 3}, 4), "expected entries that fit");
  Sample huge = with_sparse({1, 2, 3}, 3);
  huge.document["accessors"][0]["count"] = 4'000'000'000u;
  expect_refused(huge, "4000000000 entries");
  Sample nothing = with_sparse({1, 2, 3}, 3);
  nothing.document["accessors"][0].erase("sparse");
  expect_refused(nothing, "bufferView or sparse");
  Sample words;
  words.set_primitive(words.add_points(kUnsignedInt, kPoints), -1);
  expect_refused(words, "componentType 5125");
  Sample floats;
  const int points = floats.add_points(kFloat, kPoints);
  floats.set_primitive(points, floats.add_indices(kFloat, kCorners));
  expect_refused(floats, "componentType 5126");
}

/// A glTF and the file of its buffer, beside it or where `file` says.
struct Folder {
  std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("tactum_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() { std::filesystem::create_directories(path / "in" / "below"); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  Result<ImportedMesh> import(const std::string& uri, const std::string& file) const {
    Sample sample;
    const int points = sample.add_points(kFloat, kPoints);
    sample.set_primitive(points, sample.add_indices(kUnsignedShort, kCorners));
    sample.document["buffers"] = Json::array({{{"byteLength", sample.bin.size()}, {"uri", uri}}});
    std::ofstream(path / "in" / file, std::ios::binary) << sample.bin;
    std::ofstream(path / "in" / "a.gltf", std::ios::binary) << sample.document.dump();
    Result<ImportedMesh> mesh = import_mesh((path / "in" / "a.gltf").string());
    std::filesystem::remove(path / "in" / file);
    return mesh;
  }
};

TEST(GltfImport, NamesOfFilesAreDecoded) {
  const Folder folder;
  const std::pair<const char*, const char*> names[] = {{"my%20mesh.bin", "my mesh.bin"},
                                                       {"my mesh.bin", "my mesh.bin"},
                                                       {"gr%C3%B6%c3%9fe.bin",
                                                        "gr\xC3\xB6\xC3\x9F"
                                                        "e.bin"},
                                                       {"gr\xC3\xB6\xC3\x9F"
                                                        "e.bin",
                                                        "gr\xC3\xB6\xC3\x9F"
                                                        "e.bin"},
                                                       {"a+b.bin", "a+b.bin"},
                                                       {"a%2Bb.bin", "a+b.bin"},
                                                       {"100%.bin", "100%.bin"},
                                                       {"100%25.bin", "100%.bin"},
                                                       {"a%2520b.bin", "a%20b.bin"},
                                                       {"not%20coded.bin", "not%20coded.bin"},
                                                       {"./a.bin", "a.bin"},
                                                       {"below%2Fa%231.bin", "below/a#1.bin"}};
  for (const auto& [uri, file] : names) {
    const Result<ImportedMesh> mesh = folder.import(uri, file);
    ASSERT_TRUE(mesh) << uri << ": " << mesh.error().message();
    EXPECT_NEAR(report_mesh(mesh->mesh).volume, 1000.0, 1e-9) << uri;
  }
}

TEST(GltfImport, AByteOrderMarkIsNoPartOfTheDocument) {
  for (const char* name : {"a.gltf", "misnamed.obj"}) {
    const Result<ImportedMesh> mesh = import_mesh_bytes("\xEF\xBB\xBF" + testing::gltf_cube(), name);
    ASSERT_TRUE(mesh) << mesh.error().message();
    EXPECT_EQ(mesh->report.format, "glTF");
  }
}

TEST(GltfImport, CodesAreNoWayOutOfTheFolder) {
  const Folder folder;
  for (const char* uri : {"../out.bin", "%2e%2e/out.bin", "%2E%2E%2Fout.bin", "below/%2e%2e/%2e./out.bin",
                          "%2Fetc%2Fpasswd", "file%3A///etc/passwd", "a.bin%00"}) {
    const Result<ImportedMesh> mesh = folder.import(uri, "../out.bin");
    ASSERT_FALSE(mesh) << uri;
    EXPECT_NE(mesh.error().message().find("same folder"), std::string::npos) << mesh.error().message();
  }
  const Result<ImportedMesh> missing = folder.import("no%20such.bin", "other.bin");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message().find("no file 'no such.bin'"), std::string::npos)
      << missing.error().message();
}

TEST(GltfImport, IsInMetresByItsStandard) {
  Sample sample;
  const int points = sample.add_points(kFloat, {0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1});
  sample.set_primitive(points, sample.add_indices(kUnsignedByte, kCorners));
  const Result<ImportedMesh> mesh = import_mesh_bytes(sample.glb(), "a.glb");
  ASSERT_TRUE(mesh) << mesh.error().message();
  const UnitGuess unit = unit_of(mesh->report, report_mesh(mesh->mesh).box);
  EXPECT_EQ(unit.metres_per_unit, 1.0);
  EXPECT_TRUE(unit.certain);
  EXPECT_EQ(unit.reason, "glTF is in metres by its standard.");
}

}  // namespace
}  // namespace tactum::gltf_import_test
