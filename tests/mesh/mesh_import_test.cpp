#include "tactum/mesh/mesh_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "mesh/gltf_sample.h"
#include "support/effort.h"
#include "support/real_data.h"
#include "tactum/base/random.h"
#include "tactum/geometry/mesh_report.h"

namespace tactum {
namespace {

const std::string kCubeObj =
    "o cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\ng last\nf -8 -4 -1 -5\n";

const std::string kCubeOff =
    "OFF # a cube\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 0 4 7 3\n";

const std::string kCubePlyHeader =
    " 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";

TriangleMesh cube() { return import_mesh_bytes(kCubeObj, "cube.obj")->mesh; }

template <class T>
void append(std::string& bytes, T value, bool swapped = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (swapped) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (int corner : t) {
      for (double x : mesh.vertices[corner]) append(bytes, static_cast<float>(x));
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string text_stl(const TriangleMesh& mesh) {
  std::string text = "solid cube of facets\n";
  for (const Triangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (int corner : t) {
      const Vec3& p = mesh.vertices[corner];
      text += "  vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " +
              std::to_string(p.z()) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid cube\n";
}

std::string binary_ply(bool big) {
  std::string bytes =
      std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") + kCubePlyHeader;
  for (int i = 0; i < 8; ++i) {
    const int bits = i ^ (i >> 1 & 1);  // corners in the order of the cube above
    append(bytes, static_cast<float>(bits & 1), big);
    append(bytes, static_cast<float>(bits >> 1 & 1), big);
    append(bytes, static_cast<float>(bits >> 2), big);
    bytes += '\7';
  }
  for (const auto& face :
       {std::array{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 4, 7, 3}}) {
    bytes += '\4';
    for (int corner : face) append(bytes, corner, big);
  }
  return bytes;
}

std::string text_ply() {
  return "ply\nformat ascii" + kCubePlyHeader +
         "0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n0 0 1 7\n1 0 1 7\n1 1 1 7\n0 1 1 7\n"
         "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 0 4 7 3\n";
}

struct Sample {
  const char* name;
  std::string bytes;
};
std::vector<Sample> samples() {
  return {{"cube.obj", kCubeObj},           {"cube.off", kCubeOff},
          {"text.stl", text_stl(cube())},   {"binary.stl", binary_stl(cube())},
          {"text.ply", text_ply()},         {"little.ply", binary_ply(false)},
          {"big.ply", binary_ply(true)},    {"cube.gltf", testing::gltf_cube()},
          {"cube.glb", testing::glb_cube()}};
}

TEST(MeshImport, EveryFormatGivesTheSameCube) {
  for (const Sample& sample : samples()) {
    const Result<ImportedMesh> mesh = import_mesh_bytes(sample.bytes, sample.name);
    ASSERT_TRUE(mesh) << sample.name << ": " << mesh.error().message();
    const MeshReport report = report_mesh(mesh->mesh);
    EXPECT_EQ(report.triangles, 12) << sample.name;
    EXPECT_EQ(report.vertices, 8) << sample.name;
    EXPECT_TRUE(report.convex) << sample.name;
    EXPECT_NEAR(report.volume, 1.0, 1e-12) << sample.name;
    EXPECT_EQ(report.box.min, Vec3(0, 0, 0)) << sample.name;
    EXPECT_EQ(report.box.max, Vec3(1, 1, 1)) << sample.name;
  }
}

TEST(MeshImport, ContentWinsOverTheEnding) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(text_ply(), "misnamed.stl");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->report.format, "PLY (text)");
  EXPECT_FALSE(mesh->report.remarks.empty());
  EXPECT_FALSE(import_mesh_bytes(kCubeObj, "cube.docx"));
}

TEST(MeshImport, GroupsCoverAllTriangles) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(kCubeObj, "cube.obj");
  ASSERT_EQ(mesh->groups.size(), 2u);
  EXPECT_EQ(mesh->groups[0].name, "cube");
  EXPECT_EQ(mesh->groups[0].triangle_count, 10);
  EXPECT_EQ(mesh->groups[1].name, "last");
  EXPECT_EQ(mesh->groups[1].first_triangle, 10);
  EXPECT_EQ(mesh->groups[1].triangle_count, 2);
}

TEST(MeshImport, TextKeepsDoubles) {
  const Result<ImportedMesh> mesh =
      import_mesh_bytes("v 0.1234567890123456 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "a.obj");
  EXPECT_EQ(mesh->mesh.vertices[0].x(), 0.1234567890123456);
}

TEST(MeshImport, ScaleIsApplied) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(kCubeObj, "cube.obj", {.scale = 0.001});
  EXPECT_NEAR(report_mesh(mesh->mesh).volume, 1e-9, 1e-20);
}

/// An L, a comb and a spiral: a fan would cover more than the polygon. Area by triangles against the shoelace
/// formula.
TEST(MeshImport, ConcavePolygonsAreCutRightly) {
  const std::vector<std::vector<Vec2>> polygons = {
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
      {{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}},
      {{0, 0},
       {9, 0},
       {9, 5},
       {8, 5},
       {8, 1},
       {6, 1},
       {6, 5},
       {5, 5},
       {5, 1},
       {3, 1},
       {3, 5},
       {2, 5},
       {2, 1},
       {0, 1}},
      {{0, 0}, {5, 0}, {5, 5}, {1, 5}, {1, 2}, {3, 2}, {3, 3}, {2, 3}, {2, 4}, {4, 4}, {4, 1}, {0, 1}}};
  for (const auto& polygon : polygons) {
    std::string text;
    std::string face = "f";
    double shoelace = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2& p = polygon[i];
      const Vec2& q = polygon[(i + 1) % polygon.size()];
      shoelace += 0.5 * (p.x() * q.y() - q.x() * p.y());
      text += "v " + std::to_string(p.x()) + " 0.5 " + std::to_string(-p.y()) + "\n";
      face += " " + std::to_string(i + 1);
    }
    const Result<ImportedMesh> mesh = import_mesh_bytes(text + face, "concave.obj");
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->mesh.triangles.size(), polygon.size() - 2);
    EXPECT_EQ(mesh->report.concave_polygons, 1);
    EXPECT_NEAR(report_mesh(mesh->mesh).area, std::abs(shoelace), 1e-12);
  }
}

TEST(MeshImport, GltfTransformsAreAppliedAndMirroringKeepsOutsideOut) {
  const Result<ImportedMesh> mesh =
      import_mesh_bytes(testing::glb_cube(R"("scale":[-2,1,1],"translation":[10,0,0])"), "m.glb");
  ASSERT_TRUE(mesh) << mesh.error().message();
  const MeshReport report = report_mesh(mesh->mesh);
  EXPECT_NEAR(report.volume, 2.0, 1e-12);
  EXPECT_EQ(report.box.min, Vec3(8, 0, 0));
  EXPECT_EQ(report.box.max, Vec3(10, 1, 1));
}

struct Broken {
  const char* name;
  std::string bytes;
  const char* expected;  ///< part of the message
};

TEST(MeshImport, BrokenFilesAreToldClearly) {
  std::string huge_stl = binary_stl(cube());
  std::memset(huge_stl.data() + 80, 0xFF, 4);
  std::string nan_stl = binary_stl(cube());
  std::memset(nan_stl.data() + 84 + 12, 0xFF, 4);
  const std::string counts =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n0123456789ab";
  const std::vector<Broken> cases = {
      {"empty.obj", "", "empty"},
      {"no_face.obj", "v 0 0 0\nv 1 0 0\nl 1 2\np 1\n", "no surface"},
      {"nan.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1"},
      {"inf.obj", "v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1"},
      {"range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "vertex 4"},
      {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "vertex 0"},
      {"back.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", "vertex -4"},
      {"word.obj", "v 0 zero 0\n", "'zero'"},
      {"far.obj", "v 0 1e30 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "far away"},
      {"overflow.obj", "v 0 1e999 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "'1e999'"},
      {"binary.obj", std::string("v 0 0 0\0\0\0", 10), "zero byte"},
      {"huge.stl", huge_stl, "4294967295"},
      {"nan.stl", nan_stl, "not finite"},
      {"short.stl", "not an stl", "no STL"},
      {"cut.stl", "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n", "end of the file"},
      {"counts.ply", counts, "4000000000"},
      {"no_xyz.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
       "property y"},
      {"rows.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "end_header\n1 2 x9\n",
       "line 8"},
      {"counts.off", "OFF\n4000000000 3 0\n", "4000000000"},
      {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "vertex 3"},
      {"old.gltf", R"({"asset":{"version":"1.0"}})", "version 2"},
      {"draco.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]})",
       "draco"},
      {"text.gltf", "{\"asset\":", "JSON"},
      {"climb.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"../../secret"}]})",
       "same folder"},
  };
  for (const Broken& broken : cases) {
    const Result<ImportedMesh> mesh = import_mesh_bytes(broken.bytes, broken.name);
    ASSERT_FALSE(mesh) << broken.name;
    EXPECT_NE(mesh.error().message().find(broken.expected), std::string::npos) << mesh.error().message();
    EXPECT_NE(mesh.error().message().find(broken.name), std::string::npos) << mesh.error().message();
  }
  EXPECT_FALSE(import_mesh("/nowhere/at/all.obj"));
  EXPECT_FALSE(import_mesh(TACTUM_SOURCE_DIR));
}

TEST(MeshImport, CapsHold) {
  EXPECT_FALSE(import_mesh_bytes(kCubeObj, "cube.obj", {.max_bytes = 10}));
  EXPECT_FALSE(import_mesh_bytes(kCubeObj, "cube.obj", {.max_vertices = 7}));
  EXPECT_FALSE(import_mesh_bytes(kCubeObj, "cube.obj", {.max_triangles = 11}));
  EXPECT_FALSE(import_mesh_bytes(kCubeObj, "cube.obj", {.scale = 0.0}));
}

/// A mesh that was let in must be sound, whatever the file was.
void expect_sound(const Result<ImportedMesh>& mesh, const std::string& from) {
  if (!mesh) {
    EXPECT_FALSE(mesh.error().what.empty()) << from;
    return;
  }
  ASSERT_FALSE(mesh->mesh.triangles.empty()) << from;
  for (const Vec3& vertex : mesh->mesh.vertices) ASSERT_TRUE(vertex.allFinite()) << from;
  for (const Triangle& t : mesh->mesh.triangles) {
    for (int corner : t)
      ASSERT_TRUE(corner >= 0 && corner < static_cast<int>(mesh->mesh.vertices.size())) << from;
  }
}

TEST(MeshImport, TruncatedFilesNeverCrash) {
  for (const Sample& sample : samples()) {
    for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
      const std::string cut = sample.bytes.substr(0, length);
      const Result<ImportedMesh> mesh = import_mesh_bytes(cut, sample.name);
      expect_sound(mesh, std::string(sample.name) + " cut at " + std::to_string(length));
    }
  }
}

/// Bytes changed, doubled, dropped, digits blown up: an error or a sound mesh.
TEST(MeshImport, MutatedFilesNeverCrash) {
  const std::uint64_t seed = 21;
  const int rounds = testing::full_run() ? 100000 : 3000;
  Random random(seed);
  for (const Sample& sample : samples()) {
    for (int round = 0; round < rounds; ++round) {
      std::string bytes = sample.bytes;
      const int changes = 1 + random.index(4);
      for (int i = 0; i < changes; ++i) {
        const std::size_t at = static_cast<std::size_t>(random.index(static_cast<int>(bytes.size())));
        switch (random.index(5)) {
          case 0:
            bytes[at] = static_cast<char>(random.index(256));
            break;
          case 1:
            bytes[at] = "0123456789-+.eE \n"[random.index(17)];
            break;
          case 2:
            bytes.erase(at, static_cast<std::size_t>(1 + random.index(8)));
            break;
          case 3:
            bytes.insert(at, bytes.substr(at, 16));
            break;
          default:
            bytes.insert(at, "99999999");
            break;
        }
        if (bytes.empty()) bytes = "x";
      }
      expect_sound(
          import_mesh_bytes(bytes, sample.name),
          std::string(sample.name) + " seed " + std::to_string(seed) + " round " + std::to_string(round));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(MeshImport, MalformedRealFiles) {
  TACTUM_NEEDS_REAL_DATA();
  int read = 0;
  int refused = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(testing::real_data() / "malformed")) {
    if (!entry.is_regular_file()) continue;
    const Result<ImportedMesh> mesh = import_mesh(entry.path().string());
    expect_sound(mesh, entry.path().string());
    ++(mesh ? read : refused);
    if (!mesh) std::printf("refused %s\n", mesh.error().message().c_str());
  }
  EXPECT_GT(read, 15);
  EXPECT_GT(refused, 5);
  // Legal though odd: indices that count back.
  EXPECT_TRUE(import_mesh((testing::real_data() / "malformed/trimesh/negative_indices.obj").string()));
}

}  // namespace
}  // namespace tactum
