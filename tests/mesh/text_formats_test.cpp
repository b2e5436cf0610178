#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"

/// Text formats as programs spell them. All of it is one tetrahedron with legs of 30, 20 and 10: a volume of
/// 30 * 20 * 10 / 6 = 1000.

namespace tactum::text_formats_test {
namespace {

constexpr int kPoints[4][3] = {{0, 0, 0}, {30, 0, 0}, {0, 20, 0}, {0, 0, 10}};
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

const std::string kMark = "\xEF\xBB\xBF";
const std::string kObj = "v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kRows = "0 0 0\n30 0 0\n0 20 0\n0 0 10\n";
const std::string kFaceRows = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string kVertexElement = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaceElement = "element face 4\nproperty list uchar int vertex_indices\n";
const std::string kPlyHead = "ply\nformat ascii 1.0\n" + kVertexElement + kFaceElement + "end_header\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::string upper(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

std::string stl(const std::string& first = "solid part", const std::string& last = "endsolid part") {
  std::string text = first + "\n";
  for (const auto& face : kFaces) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const int corner : face) {
      text += "      vertex";
      for (const int x : kPoints[corner]) text += " " + std::to_string(x) + ".0e+00";
      text += "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + last + "\n";
}

std::string utf16(const std::string& text, bool big, bool marked) {
  std::string wide = !marked ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
  return wide;
}

void expect_tetrahedra(const std::string& bytes, const std::string& name, int count = 1) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(bytes, name);
  ASSERT_TRUE(mesh) << mesh.error().message() << "\n" << bytes.substr(0, 200);
  const MeshReport report = report_mesh(mesh->mesh);
  EXPECT_EQ(report.triangles, 4 * count) << bytes.substr(0, 200);
  EXPECT_TRUE(report.closed && report.oriented) << bytes.substr(0, 200);
  EXPECT_NEAR(report.volume, 1000.0 * count, 1e-9) << bytes.substr(0, 200);
}

/// The error, which names the file and holds these words.
void expect_refused(const std::string& bytes, const std::string& name,
                    const std::vector<std::string>& words) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(bytes, name);
  ASSERT_FALSE(mesh) << name << "\n" << bytes.substr(0, 200);
  for (const std::string& word : words)
    EXPECT_NE(mesh.error().message().find(word), std::string::npos) << word << "\n" << mesh.error().message();
  EXPECT_EQ(mesh.error().message().find("cut short"), std::string::npos) << mesh.error().message();
}

TEST(TextFormats, AByteOrderMarkIsNoPartOfTheText) {
  expect_tetrahedra(kMark + kObj, "a.obj");
  expect_tetrahedra(kMark + "# comment\n" + kObj, "a.obj");
  expect_tetrahedra(kMark + replaced(kObj, "\n", "\r\n"), "a.obj");
  expect_tetrahedra(kMark + stl(), "a.stl");
  expect_tetrahedra(kMark + "OFF\n4 4 6\n" + kRows + kFaceRows, "a.off");
  expect_tetrahedra(kMark + kPlyHead + kRows + kFaceRows, "a.ply");
  expect_tetrahedra(kMark + kPlyHead + kRows + kFaceRows, "misnamed.txt");
}

TEST(TextFormats, OtherEncodingsAreRefusedByName) {
  for (const bool big : {false, true}) {
    for (const bool marked : {false, true}) {
      expect_refused(utf16(kObj, big, marked), "a.obj", {"UTF-16", "UTF-8"});
      expect_refused(utf16(stl(), big, marked), "a.stl", {"UTF-16"});
      expect_refused(utf16(kPlyHead + kRows + kFaceRows, big, marked), "a.ply", {"UTF-16"});
      expect_refused(utf16("OFF\n4 4 6\n" + kRows + kFaceRows, big, marked), "a.off", {"UTF-16"});
      expect_refused(utf16(R"({"asset":{"version":"2.0"}})", big, marked), "a.gltf", {"UTF-16"});
    }
  }
  expect_refused(std::string("\xFF\xFE\0\0v\0\0\0", 8), "a.obj", {"UTF-32"});
}

/// A vertex that is passed over would shift every index behind it.
TEST(TextFormats, AGarbledLineOfAnObjIsNoRemark) {
  const std::string one_more = kObj + "v 9 9 9\n";
  for (const char* garbled : {"?v 0 0 0\n", "\xC3\xAF\xC2\xBB\xC2\xBFv 0 0 0\n", "V 0 0 0\n", "v0 0 0\n"})
    expect_refused(garbled + one_more.substr(8), "a.obj", {"line 1", "v, f"});
  expect_refused(replaced(kObj, "f 1 3 2", "xf 1/1 3/2 2/3"), "a.obj", {"line 5", "'xf'"});
  expect_tetrahedra("Exported by a program, version 3\n" + kObj, "a.obj");
  expect_tetrahedra("bevel on\nlod 10 20\ndeg 3 3\nvn 0 0 1\nvt 0 1\nvp 0 1\n" + kObj, "a.obj");
}

TEST(TextFormats, KeywordsOfAnStlAreSpelledAsTheyCome) {
  expect_tetrahedra(upper(stl()), "a.stl");
  expect_tetrahedra(replaced(stl(), "facet", "Facet"), "a.stl");
  expect_tetrahedra(replaced(replaced(stl(), "endsolid", "end solid"), "endloop", "end loop"), "a.stl");
  expect_tetrahedra(upper(replaced(replaced(stl(), "endfacet", "end facet"), "endloop", "end  loop")),
                    "a.stl");
  expect_tetrahedra(replaced(stl(), "outer loop", "outer \t loop"), "a.stl");
  expect_tetrahedra(replaced(stl(), "facet normal 0 0 0", "facet normal nan -1.#IND 0"), "a.stl");
  expect_tetrahedra(replaced(stl(), ".0e+00", ".0D+00"), "a.stl");
  expect_tetrahedra(replaced(stl(), "30.0e+00", "3.0d1"), "a.stl");
}

TEST(TextFormats, LinesOfAnStlEndAndBeginAsTheyCome) {
  expect_tetrahedra(replaced(stl(), "\n", "\r\n"), "a.stl");
  expect_tetrahedra(replaced(stl(), "\n", "\r"), "a.stl");
  expect_tetrahedra(std::string(200, '\n') + "   \t" + stl(), "a.stl");
  expect_tetrahedra(replaced(stl(), "\n    ", " "), "a.stl");
  expect_tetrahedra(replaced(stl("solid", "endsolid"), "\n", " "), "a.stl");  // all in one line
}

TEST(TextFormats, NamesOfAnStlAreAnyOrNone) {
  for (const char* name :
       {"", " ", " a b  c", " \xC3\xA4\xFC", " facet", " of facet and vertex", " endsolid"})
    expect_tetrahedra(stl(std::string("solid") + name, std::string("endsolid") + name), "a.stl");
  const Result<ImportedMesh> mesh = import_mesh_bytes(stl("solid a facet of b"), "a.stl");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->groups[0].name, "a facet of b");
}

TEST(TextFormats, SeveralSolidsOfAnStlAreGroups) {
  const Result<ImportedMesh> mesh =
      import_mesh_bytes(stl("SOLID one", "END SOLID one") + "\n" + stl("solid two"), "a.stl");
  ASSERT_TRUE(mesh) << mesh.error().message();
  ASSERT_EQ(mesh->groups.size(), 2u);
  EXPECT_EQ(mesh->groups[0].name, "one");
  EXPECT_EQ(mesh->groups[1].name, "two");
  EXPECT_EQ(mesh->groups[1].triangle_count, 4);
}

TEST(TextFormats, ABrokenStlIsToldWithItsKeywordAndLine) {
  expect_refused(replaced(stl(), "solid part\n  f", "slid part\n  f"), "a.stl",
                 {"'slid'", "solid", "line 1"});
  expect_refused(replaced(stl(), "outer loop", "outr loop"), "a.stl", {"line 3", "'outr'", "outer loop"});
  expect_refused(replaced(stl(), "outer loop", "outer lop"), "a.stl", {"line 3", "'lop'", "outer loop"});
  expect_refused(replaced(stl(), "endloop", "end lop"), "a.stl", {"line 7", "'lop'", "endloop"});
  expect_refused(replaced(stl(), "endfacet", "facet"), "a.stl", {"line 8", "'facet'", "endfacet"});
  expect_refused(replaced(stl(), "vertex 30", "vertx 30"), "a.stl",
                 {"line 6", "'vertx'", "vertex or endloop"});
  expect_refused(replaced(stl(), "30.0e+00", "3o"), "a.stl", {"line 6", "'3o'", "vertex X Y Z"});
  std::string zero = stl();
  zero[400] = '\0';
  expect_refused(zero, "a.stl", {"byte 400", "a zero byte"});
}

TEST(TextFormats, ABinaryStlMayBeginAsItLikes) {
  for (const std::string& begin : {std::string("solid facet normal outer loop vertex"), kMark + "part",
                                   std::string("\xFF\xFEv"), std::string("s\0o\0", 4), std::string()}) {
    std::string bytes = begin + std::string(80 - begin.size(), ' ');
    const auto put = [&bytes](const auto& value) {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(std::uint32_t{4});
    for (const auto& face : kFaces) {
      for (int i = 0; i < 3; ++i) put(0.0f);
      for (const int corner : face)
        for (const int x : kPoints[corner]) put(static_cast<float>(x));
      put(std::uint16_t{0});
    }
    expect_tetrahedra(bytes, "a.stl");
    if (begin.starts_with("solid")) {
      expect_tetrahedra(bytes + "more", "a.stl");
      const Result<ImportedMesh> cut = import_mesh_bytes(bytes.substr(0, 150), "a.stl");
      ASSERT_FALSE(cut);
      EXPECT_NE(cut.error().message().find("284 bytes for the 4 triangles"), std::string::npos)
          << cut.error().message();
    }
  }
}

TEST(TextFormats, HeadersOfAnOffComeInManyForms) {
  for (const char* header :
       {"OFF\n4 4 6\n", "OFF4 4 6\n", "OFF 4 4 6\n", "OFF 4 4\n", "OFF\n4 4\n", "off\n4 4 6\n", "4 4 6\n",
        "4 4\n", "# a comment\n\nOFF # another\n# a third\n4 4 6 # counts\n\n", "OFF\n4\n4\n6\n",
        "OFF\n4\n4\n", "  OFF\r\n 4 4 6\r\n", "OFF\r4 4 6\r"})
    expect_tetrahedra(header + kRows + kFaceRows, "a.off");
}

TEST(TextFormats, WhatStandsBehindTheCoordinatesOfAnOffIsPassedOver) {
  const std::string colours = replaced(kRows, "\n", " 255 128 0 255\n");
  const std::string normals = replaced(kRows, "\n", " 0 0 1\n");
  const std::string both = replaced(kRows, "\n", " 0 0 1 0.5 0.5 0.5 1\n");
  const std::string all = replaced(kRows, "\n", " 0 0 1 0.5 0.5 0.5 1 0.25 0.75  # a comment\n");
  expect_tetrahedra("COFF\n4 4 6\n" + colours + kFaceRows, "a.off");
  expect_tetrahedra("COFF4 4 6\n" + colours + kFaceRows, "a.off");
  expect_tetrahedra("NOFF 4 4 6\n" + normals + kFaceRows, "a.off");
  expect_tetrahedra("CNOFF\n4 4 6\n" + both + kFaceRows, "a.off");
  expect_tetrahedra("STOFF\n4 4 6\n" + replaced(kRows, "\n", " 0.5 1\n") + kFaceRows, "a.off");
  expect_tetrahedra("STCNOFF\n4 4 6\n" + all + kFaceRows, "a.off");
  expect_tetrahedra("OFF\n4 4 6\n" + colours + replaced(kFaceRows, "\n", " 0.9 0.1 0.1\n"), "a.off");
  expect_tetrahedra("OFF\n4 4 6\n" + kRows + replaced(kFaceRows, "\n", " 17  # red\n#\n"), "a.off");
}

TEST(TextFormats, AnOffOfAnotherDimensionIsRefusedWithItsReason) {
  for (const char* keyword : {"4OFF", "C4OFF", "nOFF", "4nOFF"})
    expect_refused(std::string(keyword) + "\n4 4 6\n" + kRows + kFaceRows, "a.off",
                   {"three dimensions", std::string("'") + keyword + "'"});
  expect_refused("OFF BINARY\n4 4 6\n", "a.off", {"a binary file", "text"});
  expect_refused("QOFF\n4 4 6\n", "a.off", {"'QOFF'", "COFF", "line 1"});
  expect_refused("4 4 6 8\n" + kRows + kFaceRows, "a.off", {"line 1", "OFF"});
}

TEST(TextFormats, RowsOfAPlyNeedNoLineEach) {
  expect_tetrahedra(kPlyHead + replaced(kRows, " ", "\n") + kFaceRows, "a.ply");
  expect_tetrahedra(kPlyHead + replaced(kRows + kFaceRows, "\n", " "), "a.ply");
  expect_tetrahedra(kPlyHead + replaced(kRows + kFaceRows, " ", "\r\n"), "a.ply");
  expect_tetrahedra(kPlyHead + "0 0 0 30 0 0\n0 20\n0 0\n0 10\n" + kFaceRows,
                    "a.ply");  // as many lines as rows
  expect_tetrahedra(kPlyHead + replaced(kRows, "\n", " 9 9\n") + kFaceRows, "a.ply");  // more than declared
  expect_refused(kPlyHead + replaced(kRows, " ", "\n") + "3 0 x 1\n", "a.ply", {"line 22", "face"});
}

TEST(TextFormats, HeadersOfAPlyEndTheirLinesAsTheyLike) {
  const std::string header =
      replaced(kPlyHead, "element v", "comment a\nobj_info b c 3\nelement v") + kRows + kFaceRows;
  for (const char* end : {"\n", "\r\n", "\r"}) expect_tetrahedra(replaced(header, "\n", end), "a.ply");
}

/// A binary row whose first byte is that of a line feed, behind a header whose lines end with CR alone.
TEST(TextFormats, ABinaryPlyBehindCarriageReturns) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string bytes = replaced(
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty uchar x\n"
        "property uchar y\nproperty uchar z\nelement tristrips 1\n"
        "property list uchar uint vertex_indices\nend_header\n",
        "\n", end);
    const char shift = '\n';
    for (const auto& point : kPoints)
      for (const int x : point) bytes += static_cast<char>(x + shift);
    bytes += '\6';
    for (const std::uint32_t corner : {1u, 0u, 2u, 3u, 1u, 0u})
      bytes.append(reinterpret_cast<const char*>(&corner), sizeof corner);
    expect_tetrahedra(bytes, "a.ply");
  }
}

TEST(TextFormats, StripsOfAPlyAreTriangles) {
  const std::string head = "ply\nformat ascii 1.0\n" + kVertexElement +
                           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + kRows;
  expect_tetrahedra(head + "6 1 0 2 3 1 0\n", "a.ply");
  expect_tetrahedra(head + "6\n1 0\n2 3 1 0\n", "a.ply");
  expect_tetrahedra(head + "10 1 0 2 3 -1 0 1 3 2 -1\n", "a.ply");             // restarted
  expect_tetrahedra(head + "15 0 2 1 -1 0 1 3 -1 0 3 2 -1 1 2 3\n", "a.ply");  // four of one triangle
  expect_tetrahedra(head + "10 1 0 2 3 3 0 0 1 3 2\n", "a.ply");               // stitched
  expect_tetrahedra(replaced(head, "vertex_indices", "vertex_index") + "6 1 0 2 3 1 0\n", "a.ply");
  expect_tetrahedra(replaced(head, "strips 1", "strips 2") + "4 1 0 2 3\n4 0 1 3 2\n", "a.ply");
  expect_refused(head + "6 1 0 2 4 1 0\n", "a.ply", {"vertex 4", "0 to 3"});
  expect_refused(head + "6 1 0 2 -2 1 0\n", "a.ply", {"vertex -2"});
}

TEST(TextFormats, ListsAndElementsOfAPlyThatAreNotNeeded) {
  const std::string vertices =
      replaced(kVertexElement, "property float y", "property list uchar float weights\nproperty float y");
  const std::string faces = replaced(kFaceElement, "property list",
                                     "property int colour\nproperty list uchar float uv\nproperty list") +
                            "property list uchar float more\n";
  const std::string cameras = "element camera 2\nproperty float f\nproperty list uchar int ids\n";
  const std::string head = "ply\nformat ascii 1.0\n" + vertices + cameras + faces + "end_header\n";
  const std::string rows =
      "0 2 5 6 0 0\n30 0 0 0\n0 1 7 20 0\n0 0 0 10\n1.5 3 1 2 3\n2.5 0\n"
      "7 2 0.1 0.2 3 0 2 1 0\n7 0 3 0 1 3 1 9\n7 0 3 0 3 2 0\n7 1 4 3 1 2 3 2 8 8\n";
  expect_tetrahedra(head + rows, "a.ply");
  expect_tetrahedra(head + replaced(rows, "\n", " "), "a.ply");
  expect_tetrahedra(replaced(head, "vertex_indices", "vertex_index") + rows, "a.ply");
}

}  // namespace
}  // namespace tactum::text_formats_test
