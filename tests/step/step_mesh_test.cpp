/// STEP files made here, with known geometry, become meshes that are judged by that geometry.

#include "step_mesh.h"

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <cmath>

#include "app/program.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"

namespace tactum {
namespace {

using testing::ScratchFolder;

/// Writes shapes whose numbers are in `unit` ("MM", "INCH").
void write_step(const std::string& path, const std::vector<TopoDS_Shape>& shapes, const char* unit) {
  Message::DefaultMessenger()->ChangePrinters().Clear();  // it prints everything it does
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", unit);
  Interface_Static::SetCVal("write.step.unit", unit);
  STEPControl_Writer writer;
  for (const TopoDS_Shape& shape : shapes)
    ASSERT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
}

/// 40 x 30 x 10 with a hole of radius 5 through (20, 15).
TopoDS_Shape holed_plate() {
  const TopoDS_Shape hole =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(20, 15, -1), gp_Dir(0, 0, 1)), 5.0, 12.0).Shape();
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(40, 30, 10).Shape(), hole).Shape();
}

/// Of a point [m] from the surface of the holed plate with its numbers in `unit` [m].
double from_holed_plate(const Vec3& p, double unit) {
  const Vec3 x = p / unit;
  const double hole = std::abs(std::hypot(x.x() - 20, x.y() - 15) - 5);
  const double sides = std::min({std::abs(x.x()), std::abs(x.x() - 40), std::abs(x.y()), std::abs(x.y() - 30),
                                 std::abs(x.z()), std::abs(x.z() - 10)});
  return std::min(hole, sides) * unit;
}

TEST(StepMesh, APlateWithAHoleIsClosedAndOnItsSurface) {
  const ScratchFolder folder;
  for (const auto& [name, unit] : {std::pair("MM", 1e-3), std::pair("INCH", 0.0254)}) {
    SCOPED_TRACE(name);
    write_step(folder / "plate.step", {holed_plate()}, name);
    const double asked = 0.002 * unit;
    const Result<StepMesh> step = read_step(folder / "plate.step", {.deviation_m = asked, .angle_rad = 1.0});
    ASSERT_TRUE(step) << step.error().message();
    ASSERT_EQ(step->bodies.size(), 1u);
    EXPECT_TRUE(step->bodies[0].solid);
    EXPECT_EQ(step->bodies[0].faces, 7);
    for (const Vec3& p : step->mesh.vertices) EXPECT_LT(from_holed_plate(p, unit), 1e-9 * unit);
    // No welding: corners on common edges are one already.
    const MeshReport report = report_mesh(step->mesh, 0.0);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.oriented);
    EXPECT_EQ(report.components, 1);
    EXPECT_EQ(report.euler, 0) << "one hole through";
    // A polygon of n corners in the hole: its sides are off by r (1 - cos(pi / n)).
    EXPECT_LE(step->deviation_m, asked);
    EXPECT_GT(step->deviation_m, 0.1 * asked) << "finer than asked, and so larger";
    const double exact = (40 * 30 - kPi * 25) * 10 * unit * unit * unit;
    const double hole_area = 2 * kPi * 5 * 10 * unit * unit;
    EXPECT_GT(report.volume, exact);
    EXPECT_LT(report.volume, exact + step->deviation_m * hole_area);
  }
}

TEST(StepMesh, AConeClosesAtItsTip) {
  const ScratchFolder folder;
  write_step(folder / "cone.step", {BRepPrimAPI_MakeCone(8, 0, 20).Shape()}, "MM");
  const Result<StepMesh> step = read_step(folder / "cone.step", {.deviation_m = 1e-5});
  ASSERT_TRUE(step) << step.error().message();
  const MeshReport report = report_mesh(step->mesh, 0.0);
  EXPECT_TRUE(report.closed);
  EXPECT_TRUE(report.oriented);
  EXPECT_EQ(report.euler, 2);
  EXPECT_TRUE(report.index_degenerate.empty());
  EXPECT_NEAR(report.volume, kPi * 64 * 20 / 3 * 1e-9, 1e-5 * kPi * 8 * 22 * 1e-6);
}

TEST(StepMesh, EverySolidIsABody) {
  const ScratchFolder folder;
  write_step(folder / "two.step", {BRepPrimAPI_MakeBox(1, 2, 3).Shape(), holed_plate()}, "MM");
  const Result<StepMesh> step = read_step(folder / "two.step", {});
  ASSERT_TRUE(step) << step.error().message();
  ASSERT_EQ(step->bodies.size(), 2u);
  EXPECT_EQ(step->bodies[0].triangles, 12);
  EXPECT_EQ(step->bodies[0].triangles + step->bodies[1].triangles,
            static_cast<int>(step->mesh.triangles.size()));
  EXPECT_NEAR(step->asked_deviation_m, 1e-4 * std::sqrt(40 * 40 + 30 * 30 + 10 * 10) * 1e-3, 1e-9);
}

TEST(StepMesh, WhatIsNoStepIsRefused) {
  const ScratchFolder folder;
  testing::write(folder / "empty.step", "");
  testing::write(folder / "text.step", "solid nothing\n");
  testing::write(folder / "header.step",
                 "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
                 "FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\n"
                 "DATA;\nENDSEC;\nEND-ISO-10303-21;\n");
  for (const char* name : {"empty.step", "text.step", "header.step", "absent.step"}) {
    const Result<StepMesh> step = read_step(folder / name, {});
    ASSERT_FALSE(step) << name;
    EXPECT_NE(step.error().message().find(name), std::string::npos) << step.error().message();
  }
}

TEST(StepCommand, WhatItWritesIsPreparedAsItIs) {
  const ScratchFolder folder;
  write_step(folder / "plate.step", {holed_plate()}, "MM");
  const testing::ProgramRun made = testing::run_program(
      "tactum-step", folder / "plate.step" + " -o " + (folder / "plate.obj") + " --deviation 0.005");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.out.find("body_1: a solid, 7 faces"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find("--units m"), std::string::npos) << made.out;
  const Result<StepMesh> step = read_step(folder / "plate.step", {.deviation_m = 5e-6});
  const Result<ImportedMesh> read = import_mesh(folder / "plate.obj");
  ASSERT_TRUE(step && read);
  EXPECT_EQ(read->mesh.vertices, step->mesh.vertices) << "to the last bit";
  EXPECT_EQ(read->mesh.triangles, step->mesh.triangles);
  const testing::ProgramRun prepared = testing::run_tactum(
      "prepare --no-cache --units m " + (folder / "plate.obj") + " -o " + (folder / "plate.part"));
  EXPECT_EQ(prepared.exit_code, 0) << prepared.err;
}

TEST(StepCommand, PrepareTakesStepByItself) {
  const ScratchFolder folder;
  write_step(folder / "plate.step", {holed_plate()}, "MM");
  const std::string command =
      "prepare --no-cache " + (folder / "plate.step") + " -o " + (folder / "p.tactum");
  const testing::ProgramRun coarse = testing::run_tactum(command);
  ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
  EXPECT_NE(coarse.out.find("chord error of 1e-4 of the diagonal"), std::string::npos) << coarse.out;
  const testing::ProgramRun fine = testing::run_tactum(command + " --fit 20um");
  ASSERT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_NE(fine.out.find("chord error of at most 1 um, a twentieth of the fit of 20 um"), std::string::npos)
      << fine.out;
  // The same part as by hand.
  const Result<StepMesh> step = read_step(folder / "plate.step", {.deviation_m = 1e-6});
  const Result<PartFile> part = load_part(folder / "p.tactum");
  ASSERT_TRUE(step && part);
  EXPECT_EQ(part->part.surface.triangles.size(), step->mesh.triangles.size());
  for (const Vec3& vertex : part->part.surface.vertices)
    EXPECT_LT(from_holed_plate(vertex + part->origin, 1e-3), 1e-6);
}

TEST(StepCommand, AFitIsALengthOfAStepFile) {
  const ScratchFolder folder;
  write_step(folder / "plate.step", {holed_plate()}, "MM");
  const auto error_of = [&](const std::string& arguments) {
    return testing::run_tactum("prepare --no-cache -o " + (folder / "p.tactum") + " " + arguments).err;
  };
  const std::string file = folder / "plate.step";
  EXPECT_NE(error_of(file + " --fit 20").find("expected a number above 0 with um, mm, cm or m"),
            std::string::npos);
  EXPECT_NE(error_of(file + " --fit -1um").find("no length"), std::string::npos);
  EXPECT_NE(error_of(file + " --units mm").find("a STEP file states its unit"), std::string::npos);
  EXPECT_NE(error_of("a.stl --fit 20um").find("--fit is for STEP files"), std::string::npos);
  testing::write(folder / "text.step", "solid nothing\n");
  EXPECT_NE(error_of(folder / "text.step").find("tactum-step has failed"), std::string::npos);
}

}  // namespace
}  // namespace tactum
