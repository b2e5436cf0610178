#include "tactum/mesh/part_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "collision/cases.h"
#include "support/reseal.h"
#include "support/sample_meshes.h"
#include "tactum/base/random.h"
#include "tactum/geometry/hull.h"
#include "tactum/mesh/array_file.h"
#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::prism;

PartFile solid_file() {
  PartFile file;
  file.part = *part_from_mesh(prism(9, 0.01, 0.02), {.name = "rod"});
  file.origin = {1, 2, 3};
  file.report = R"({"made": "here"})";
  return file;
}

PartFile surface_file() {
  TriangleMesh dented = icosphere(2);
  dented.vertices[40] *= 0.8;
  PartFile file;
  file.part = *part_from_mesh(dented, {.name = "dented"});
  file.part.notes.remarks = {"one", "two"};
  return file;
}

PartFile pieces_file() {
  PartFile file;
  file.part =
      *part_from_clouds({box_mesh({1, 1, 1}).vertices, prism(40, 1, 2).vertices, icosphere(3).vertices});
  return file;
}

/// Bit for bit, whatever the compiler makes of equality of NaN and -0.
template <class T>
void expect_same_bits(const T& a, const T& b) {
  ASSERT_EQ(a.size(), b.size());
  if (a.empty()) return;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

void expect_same(const Polytope& a, const Polytope& b) {
  expect_same_bits(a.vertices, b.vertices);
  expect_same_bits(a.face_vertices, b.face_vertices);
  expect_same_bits(a.sides, b.sides);
  expect_same_bits(a.ray_first, b.ray_first);
  EXPECT_EQ(a.direction_table, b.direction_table);
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.extent.center, b.extent.center);
  EXPECT_EQ(a.extent.radius, b.extent.radius);
  EXPECT_EQ(a.extent.size, b.extent.size);
  EXPECT_EQ(a.extent.magnitude, b.extent.magnitude);
  EXPECT_EQ(a.flat, b.flat);
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    EXPECT_EQ(a.faces[i].normal, b.faces[i].normal);
    EXPECT_EQ(a.faces[i].offset, b.faces[i].offset);
    EXPECT_EQ(a.faces[i].first, b.faces[i].first);
    EXPECT_EQ(a.faces[i].count, b.faces[i].count);
    EXPECT_EQ(a.faces[i].rectangle, b.faces[i].rectangle);
  }
  ASSERT_EQ(a.edges.size(), b.edges.size());
  for (std::size_t i = 0; i < a.edges.size(); ++i) {
    EXPECT_EQ(a.edges[i].tail, b.edges[i].tail);
    EXPECT_EQ(a.edges[i].left_slot, b.edges[i].left_slot);
    EXPECT_EQ(a.edges[i].direction, b.edges[i].direction);
  }
}

TEST(PartFile, ComesBackBitForBit) {
  for (const PartFile& file : {solid_file(), surface_file(), pieces_file()}) {
    const std::string bytes = part_bytes(file);
    EXPECT_TRUE(looks_like_part(bytes));
    const Result<PartFile> back = read_part(bytes, "memory");
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(part_bytes(*back), bytes);  // every stored array
    EXPECT_EQ(back->report, file.report);
    EXPECT_EQ(back->origin, file.origin);
    EXPECT_EQ(back->part.notes.remarks, file.part.notes.remarks);
    ASSERT_EQ(back->part.pieces.size(), file.part.pieces.size());
    for (std::size_t i = 0; i < file.part.pieces.size(); ++i)
      expect_same(back->part.pieces[i], file.part.pieces[i]);
    expect_same_bits(back->part.hierarchy.order(), file.part.hierarchy.order());
    ASSERT_EQ(back->part.hierarchy.nodes().size(), file.part.hierarchy.nodes().size());
    for (std::size_t i = 0; i < file.part.hierarchy.nodes().size(); ++i) {
      EXPECT_EQ(back->part.hierarchy.nodes()[i].center, file.part.hierarchy.nodes()[i].center);
      EXPECT_EQ(back->part.hierarchy.nodes()[i].half, file.part.hierarchy.nodes()[i].half);
    }
  }
}

TEST(PartFile, IsWrittenWholeAndFoundAgain) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("part-file-test-" + std::to_string(::getpid()))).string();
  ASSERT_TRUE(save_part(path, solid_file()));
  EXPECT_TRUE(is_part_file(path));
  const Result<PartFile> loaded = load_part(path);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(loaded->part.name, "rod");
  EXPECT_FALSE(is_part_file(path + ".not-there"));
  std::filesystem::remove(path);
  EXPECT_FALSE(load_part(path));
  EXPECT_FALSE(load_part(std::filesystem::temp_directory_path().string()));
  EXPECT_FALSE(save_part(path + "/no/such/folder", solid_file()));
}

TEST(PartFile, EveryCutAndEveryChangedByteIsRefusedInOneSentence) {
  const std::string bytes = part_bytes(solid_file());
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
    const Result<PartFile> cut = read_part(bytes.substr(0, size), "cut.tactum");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().message().find("cut.tactum: "), 0u);
  }
  for (std::size_t at = 0; at < bytes.size(); at += cases::kSlowness) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    EXPECT_FALSE(read_part(changed, "changed")) << at;
  }
  EXPECT_NE(read_part("solid rod", "x").error().message().find("expected a part file"), std::string::npos);
}

TEST(PartFile, AnotherVersionAsksToPrepareAgain) {
  std::string bytes = part_bytes(solid_file());
  bytes[8] = 99;
  testing::reseal(bytes);
  const Result<PartFile> part = read_part(bytes, "old.tactum");
  ASSERT_FALSE(part);
  EXPECT_EQ(
      part.error().message(),
      "old.tactum: the part cannot be read: found version 99 of the format, expected version 4: prepare it "
      "again");
}

TEST(PartFile, AnyBytesBehindARightChecksumAreSurvived) {
  constexpr std::uint64_t kSeed = 20;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  int loaded = 0;
  for (const PartFile& file : {solid_file(), surface_file(), pieces_file()}) {
    const std::string bytes = part_bytes(file);
    std::string same = bytes;
    testing::reseal(same);
    ASSERT_EQ(same, bytes);
    for (int i = 0; i < 2000 / cases::kSlowness; ++i) {
      std::string changed = bytes;
      // Of every other file one byte only, which is often a coordinate: that loads.
      const bool one_byte = i % 2 == 0;
      for (int k = one_byte ? 1 : 1 + random.index(4); k > 0; --k) {
        const int at = 32 + random.index(static_cast<int>(changed.size()) - 32);
        switch (one_byte ? 0 : random.index(3)) {
          case 0:
            changed[at] = static_cast<char>(random.index(256));
            break;
          case 1:
            changed.erase(at, 1 + random.index(64));
            break;
          default:
            changed.insert(at, changed.substr(at / 2, random.index(64)));
            break;
        }
        if (changed.size() <= 64) break;
      }
      testing::reseal(changed);
      const Result<PartFile> part = read_part(changed, "fuzzed");
      if (!part) {
        EXPECT_FALSE(part.error().found.empty());
        continue;
      }
      ++loaded;
      for (const Polytope& piece : part->part.pieces) EXPECT_GE(support_vertex(piece, Vec3(1, 2, 3)), 0);
    }
  }
  EXPECT_GT(loaded, 0);
}

TEST(PartFile, CountsBeyondTheFileAreRefusedBeforeAnythingIsAllocated) {
  std::string bytes = part_bytes(solid_file());
  const std::size_t at = bytes.find("surface.vertices") + 32;  // the count of the record
  const std::uint64_t huge = 0x2000000000000001ull;            // times 24 wraps round to 24
  std::memcpy(bytes.data() + at, &huge, sizeof huge);
  testing::reseal(bytes);
  const Result<PartFile> part = read_part(bytes, "huge.tactum");
  ASSERT_FALSE(part);
  EXPECT_NE(part.error().message().find("more than the file holds in \"surface.vertices\""),
            std::string::npos)
      << part.error().message();
}

/// An object that keeps its arrays to itself, as the tree of a surface does.
class Arrays {
 public:
  struct Scalars {
    double size = 0.0;
  };
  Scalars& scalars() { return scalars_; }
  const Scalars& scalars() const { return scalars_; }
  template <class Visitor>
  void for_each_array(Visitor&& visitor) {
    visitor(points);
    visitor(links);
  }
  template <class Visitor>
  void for_each_array(Visitor&& visitor) const {
    visitor(points);
    visitor(links);
  }
  bool sound() const { return links.empty() || links[0] < static_cast<int>(points.size()); }

  std::vector<Vec3> points;
  std::vector<int> links;

 private:
  Scalars scalars_;
};

TEST(ArrayFile, ObjectsOfArraysAreWrittenReadAndAskedWhetherTheyAreSound) {
  Arrays out;
  out.scalars().size = 4.5;
  out.points = {{1, 2, 3}, {4, 5, 6}};
  for (const int link : {1, 2}) {
    out.links = {link};
    ArrayWriter writer;
    writer("arrays", out);
    const std::string bytes = std::move(writer).finish("ARRAYS\n\n", 3);
    Arrays back;
    ArrayReader reader(bytes, "ARRAYS\n\n", 3, "thing", "here");
    reader("arrays", back);
    EXPECT_EQ(static_cast<bool>(reader.finish()), link == 1);
    EXPECT_EQ(back.points, out.points);
    EXPECT_EQ(back.scalars().size, 4.5);
  }
}

TEST(PartFile, DensityScalesMassAndInertia) {
  PartFile file = solid_file();
  const MassProperties before = file.part.mass;
  set_density(file, 7800.0);
  EXPECT_DOUBLE_EQ(file.part.mass.mass, 7.8 * before.mass);
  EXPECT_LT((file.part.mass.inertia - 7.8 * before.inertia).norm(), 1e-15 * before.inertia.norm());
  EXPECT_EQ(file.part.mass.volume, before.volume);
}

}  // namespace
}  // namespace tactum
