#include <gtest/gtest.h>

#include <algorithm>

#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"

/// COLLADA as programs write it. All of it is one tetrahedron with legs of 30, 20 and 10 along the axes of
/// the file: where its corners come to lie tells unit, axes and transforms, and its volume that it is closed
/// and turned outward.

namespace tactum::collada_test {
namespace {

const std::string kTriangles =
    "<triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/><p>0 2 1 0 1 3 0 3 2 1 2 3</p>"
    "</triangles>";
const std::string kPositions = "0 0 0 30 0 0 0 20 0 0 0 10";

std::string geometry(const std::string& faces, const std::string& numbers = kPositions,
                     const std::string& accessor = "count='4' stride='3'") {
  return "<library_geometries><geometry id='g' name='tetrahedron'><mesh>\n<source id='s'><float_array id='a' "
         "count='12'>" +
         numbers + "</float_array><technique_common><accessor source='#a' " + accessor +
         "/></technique_common></source>\n<vertices id='v'><input semantic='POSITION' "
         "source='#s'/></vertices>\n" +
         faces + "</mesh></geometry></library_geometries>\n";
}

std::string asset(const std::string& up, const std::string& metres) {
  return "<asset>" + (metres.empty() ? "" : "<unit name='some' meter='" + metres + "'/>") +
         (up.empty() ? "" : "<up_axis>" + up + "</up_axis>") + "</asset>\n";
}

std::string file_of(const std::string& head, const std::string& libraries,
                    const std::string& nodes = "<node id='n'><instance_geometry url='#g'/></node>") {
  return "<?xml version='1.0'?>\n<COLLADA version='1.4.1'>\n" + head + libraries +
         "<library_visual_scenes><visual_scene id='w'>" + nodes +
         "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
         "url='#w'/></scene></COLLADA>\n";
}

const std::string kMetres = asset("Z_UP", "1");

ImportedMesh read(const std::string& text) {
  Result<ImportedMesh> mesh = import_mesh_bytes(text, "part.dae");
  EXPECT_TRUE(mesh) << mesh.error().message() << "\n" << text;
  return mesh ? std::move(*mesh) : ImportedMesh{};
}

/// Whether the mesh is closed, turned outward, and has just these corners.
void expect_tetrahedron(const ImportedMesh& mesh, const std::vector<Vec3>& corners, double volume) {
  EXPECT_TRUE(mesh.report.in_metres);
  EXPECT_EQ(mesh.report.format, "COLLADA");
  ASSERT_EQ(mesh.mesh.triangles.size(), 4u);
  for (const Vec3& corner : corners)
    EXPECT_TRUE(std::any_of(mesh.mesh.vertices.begin(), mesh.mesh.vertices.end(), [&](const Vec3& vertex) {
      return (vertex - corner).norm() < 1e-13 * (1.0 + corner.norm());
    })) << corner.transpose();
  const MeshReport report = report_mesh(mesh.mesh);
  EXPECT_NEAR(report.volume, volume, 1e-12 * volume);
}

std::string refusal(const std::string& text) {
  const Result<ImportedMesh> mesh = import_mesh_bytes(text, "part.dae");
  EXPECT_FALSE(mesh) << text;
  return mesh ? "" : mesh.error().message();
}

TEST(Collada, UnitAndUpAxisOfTheFileAreHonoured) {
  struct Case {
    const char *up, *metres;
    Vec3 x, y, z;  // of the file, in metres with z up
  };
  const Case cases[] = {{"Z_UP", "1", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {"Z_UP", "0.001", {0.001, 0, 0}, {0, 0.001, 0}, {0, 0, 0.001}},
                        {"Y_UP", "0.01", {0.01, 0, 0}, {0, 0, 0.01}, {0, -0.01, 0}},
                        {"X_UP", "0.0254", {0, 0, 0.0254}, {-0.0254, 0, 0}, {0, -0.0254, 0}},
                        {"", "", {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},  // y is up where the file does not say
                        {" Y_UP ", "1.0e-3", {1e-3, 0, 0}, {0, 0, 1e-3}, {0, -1e-3, 0}}};
  for (const Case& one : cases) {
    SCOPED_TRACE(std::string(one.up) + " " + one.metres);
    const double metres = one.x.norm();
    expect_tetrahedron(read(file_of(asset(one.up, one.metres), geometry(kTriangles))),
                       {Vec3::Zero(), 30 * one.x, 20 * one.y, 10 * one.z}, 1000.0 * metres * metres * metres);
  }
  const ImportedMesh without = read(file_of("", geometry(kTriangles)));
  expect_tetrahedron(without, {Vec3::Zero(), {30, 0, 0}, {0, 0, 20}, {0, -10, 0}}, 1000.0);
}

TEST(Collada, EveryKindOfFacesIsRead) {
  const std::string vertex = "<input semantic='VERTEX' source='#v' offset='0'/>";
  const std::string wide =
      "<input semantic='VERTEX' source='#v' offset='1'/><input semantic='NORMAL' source='#s' offset='0'/>"
      "<input semantic='TEXCOORD' source='#s' offset='2' set='0'/>";
  const std::string cases[] = {
      kTriangles,
      "<triangles count='4'>" + wide +
          "<p>9 0 7 9 2 7 9 1 7 8 0 7 8 1 7 8 3 7 7 0 7 7 3 7 7 2 7 6 1 7 6 2 7 6 3 7</p></triangles>",
      "<polylist count='4'>" + vertex + "<vcount>3 3 3 3</vcount><p>0 2 1 0 1 3 0 3 2 1 2 3</p></polylist>",
      "<polygons count='4'>" + vertex + "<p>0 2 1</p><p>0 1 3</p><p>0 3 2</p><p>1 2 3</p></polygons>",
      "<tristrips count='1'>" + vertex + "<p>0 2 1 3 0 2</p></tristrips>",
      "<trifans count='2'>" + vertex + "<p>0 2 1 3 2</p><p>1 2 3</p></trifans>",
      "<triangles count='2'>" + vertex + "<p>0 2 1 0 1 3</p></triangles>\n<lines count='1'>" + vertex +
          "<p>0 1</p></lines><triangles count='2'>" + vertex + "<p>0 3 2 1 2 3</p></triangles>"};
  for (const std::string& faces : cases) {
    SCOPED_TRACE(faces);
    expect_tetrahedron(read(file_of(kMetres, geometry(faces))),
                       {Vec3::Zero(), {30, 0, 0}, {0, 20, 0}, {0, 0, 10}}, 1000.0);
  }
  // Points among other numbers of one array.
  expect_tetrahedron(read(file_of(kMetres, geometry(kTriangles, "7 0 0 0 9 30 0 0 9 0 20 0 9 0 0 10 9",
                                                    "count='4' stride='4' offset='1'"))),
                     {Vec3::Zero(), {30, 0, 0}, {0, 20, 0}, {0, 0, 10}}, 1000.0);
}

TEST(Collada, NodesPlaceTheirMeshes) {
  const std::string at = "<instance_geometry url='#g'/></node>";
  struct Case {
    std::string nodes;
    Vec3 p, x, y, z;
    double volume;
  };
  const Case cases[] = {
      {"<node><translate>1 2 3</translate>" + at, {1, 2, 3}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1000.0},
      {"<node><rotate>0 0 2 90</rotate><translate>1 0 0</translate>" + at,  // first the last
       {0, 1, 0},
       {0, 1, 0},
       {-1, 0, 0},
       {0, 0, 1},
       1000.0},
      {"<node><scale>2 1 0.5</scale>" + at, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 0.5}, 1000.0},
      {"<node><scale>-1 1 1</scale>" + at, {0, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1000.0},
      {"<node><matrix>0 -1 0 5 1 0 0 6 0 0 2 7 0 0 0 1</matrix>" + at,
       {5, 6, 7},
       {0, 1, 0},
       {-1, 0, 0},
       {0, 0, 2},
       2000.0},
      {"<node><translate>1 0 0</translate><node><scale>3 3 3</scale>" + at + "</node>",
       {1, 0, 0},
       {3, 0, 0},
       {0, 3, 0},
       {0, 0, 3},
       27000.0}};
  for (const Case& one : cases) {
    SCOPED_TRACE(one.nodes);
    expect_tetrahedron(read(file_of(kMetres, geometry(kTriangles), one.nodes)),
                       {one.p, one.p + 30 * one.x, one.p + 20 * one.y, one.p + 10 * one.z}, one.volume);
  }
}

TEST(Collada, AMeshStandsInTheSceneAsOftenAsItIsReferredTo) {
  const std::string libraries =
      geometry(kTriangles) +
      "<library_nodes><node id='pair'><node><instance_geometry url='#g'/></node><node><translate>0 0 50"
      "</translate><instance_geometry url='#g'/></node></node></library_nodes>";
  const ImportedMesh mesh =
      read(file_of(kMetres, libraries,
                   "<node><instance_node url='#pair'/></node><node><translate>100 0 0</translate>"
                   "<instance_node url='#pair'/></node><node><instance_controller url='#skin'/></node>"));
  EXPECT_EQ(mesh.mesh.triangles.size(), 16u);
  EXPECT_EQ(mesh.groups.size(), 4u);
  EXPECT_EQ(mesh.groups.front().name, "tetrahedron");
  EXPECT_NEAR(report_mesh(mesh.mesh).volume, 4000.0, 1e-9);
  EXPECT_EQ(std::count(mesh.report.remarks.begin(), mesh.report.remarks.end(),
                       "1 mesh on a skeleton was left out."),
            1);
}

TEST(Collada, WhatIsWrongIsToldWithItsLine) {
  const auto faces = [](const std::string& p, const std::string& input = "source='#v' offset='0'") {
    return file_of(kMetres, geometry("<triangles><input semantic='VERTEX' " + input + "/>\n<p>" + p +
                                     "</p></triangles>"));
  };
  struct Case {
    std::string text, says, line;
  };
  const Case cases[] = {
      {"<COLLADA><asset></COLLADA>", "no XML", "line 1"},
      {faces("0 2 one"), "no index: found 'one'", "line 8"},
      {faces("0 2 -1"), "no index: found '-1'", "line 8"},
      {faces("0 2 4"), "a vertex that is not there: found 4", "line 8"},
      {faces("0 2 1 3"), "triangles are not whole", "line 8"},
      {faces("0 2 1", "source='#v' offset='99'"), "the attribute offset is wrong", "line 7"},
      {faces("0 2 1", "source='#s' offset='0'"), "other vertices than their mesh", "line 7"},
      {file_of(kMetres, geometry("<triangles><p>0 1 2</p></triangles>")), "faces have no vertices", "line 7"},
      {file_of(kMetres, geometry(kTriangles, "0 0 x")), "no number: found 'x'", "line 5"},
      {file_of(kMetres, geometry(kTriangles, "0 0 0 1 1 1")), "the attribute count is wrong", "line 5"},
      {file_of(kMetres, geometry("<polylist><input semantic='VERTEX' source='#v' offset='0'/>"
                                 "<vcount>3 4</vcount><p>0 2 1 0 1 3</p></polylist>")),
       "less corners than <vcount> says", "line 7"},
      {file_of(kMetres, geometry("<polygons><ph><p>0 1 2</p><h>0</h></ph></polygons>")), "holes", "line 7"},
      {file_of(asset("W_UP", "1"), geometry(kTriangles)), "up is not known: found 'W_UP'", "line 3"},
      {file_of(asset("Z_UP", "-1"), geometry(kTriangles)), "unit is no length: found '-1'", "line 3"},
      {file_of(kMetres, geometry(kTriangles), "<node><instance_geometry url='#h'/></node>"),
       "not in it: found '#h'", "line 8"},
      {file_of(kMetres, geometry(kTriangles), "<node><instance_geometry url='other.dae#g'/></node>"),
       "not in it: found 'other.dae#g'", "line 8"},
      {file_of(kMetres, geometry(kTriangles), "<node><lookat>1 0 0 0 0 0 0 0 1</lookat></node>"),
       "this transform is not read: found <lookat>", "line 8"},
      {file_of(kMetres, geometry(kTriangles), "<node><matrix>1 0 0</matrix></node>"),
       "another number of numbers: found 3, expected 16", "line 8"},
      {file_of(kMetres, geometry(kTriangles), "<node id='g'/>"), "two elements have one id", "line 8"},
      {file_of(kMetres, geometry(kTriangles), "<node id='n'><instance_node url='#n'/></node>"),
       "too many nodes", "line 8"},
      {"<COLLADA>" + kMetres + geometry(kTriangles) + "</COLLADA>", "the file shows nothing", "line 1"}};
  for (const Case& one : cases) {
    const std::string said = refusal(one.text);
    EXPECT_NE(said.find(one.says), std::string::npos) << said << "\n" << one.text;
    EXPECT_NE(said.find("part.dae, " + one.line), std::string::npos) << said << "\n" << one.text;
  }
  EXPECT_NE(refusal("<robot/>").find("this is no COLLADA: found 'robot'"), std::string::npos);
}

/// Nodes that each refer twice to the next would be 2^60 meshes.
TEST(Collada, NodesThatMultiplyAreRefused) {
  std::string nodes;
  for (int i = 0; i < 60; ++i) {
    const std::string next = "<instance_node url='#n" + std::to_string(i + 1) + "'/>";
    nodes += "<node id='n" + std::to_string(i) + "'>" + next + next + "</node>";
  }
  nodes += "<node id='n60'/>";
  EXPECT_NE(refusal(file_of(kMetres, geometry(kTriangles), nodes)).find("too many nodes"), std::string::npos);
}

TEST(Collada, ContentCountsAndTheUnitIsToldAsKnown) {
  const std::string text = file_of(asset("Z_UP", "0.01"), geometry(kTriangles));
  const Result<ImportedMesh> mesh =
      import_mesh_bytes("<!-- by a program -->\n" + text.substr(22), "part.xml");
  ASSERT_TRUE(mesh) << mesh.error().message();
  const UnitGuess unit = unit_of(mesh->report, report_mesh(mesh->mesh).box);
  EXPECT_EQ(unit.name, "metres");
  EXPECT_NE(unit.reason.find("COLLADA"), std::string::npos);
  EXPECT_NE(refusal(text + std::string(1, '\0')).find("not a text"), std::string::npos);
}

}  // namespace
}  // namespace tactum::collada_test
