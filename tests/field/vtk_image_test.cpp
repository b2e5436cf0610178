/// VTK images as fields: files that VTK itself writes, and files written by hand.

#include "vtk_image.h"

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredPointsWriter.h>
#include <vtkXMLImageDataWriter.h>

#include "app/program.h"
#include "tactum/base/random.h"
#include "tactum/scene/field_file.h"

namespace tactum {
namespace {

using testing::ScratchFolder;
using testing::write;

constexpr int kNodes[3] = {4, 3, 5};

Vec3 numbered(const Vec3& p) { return {p.x() - 2.0 * p.y(), 0.25 * p.z() + p.x() * p.y(), 1.0 - p.z()}; }

template <class Array>
vtkSmartPointer<Array> vectors(vtkImageData* image, const char* name, int components = 3) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
    double p[3];
    image->GetPoint(i, p);
    const Vec3 force = numbered({p[0], p[1], p[2]});
    for (int c = 0; c < components; ++c) array->InsertNextValue(static_cast<float>(force[c % 3]));
  }
  return array;
}

/// An image whose extent does not begin at zero.
vtkSmartPointer<vtkImageData> image() {
  auto made = vtkSmartPointer<vtkImageData>::New();
  made->SetExtent(2, 2 + kNodes[0] - 1, 0, kNodes[1] - 1, -1, kNodes[2] - 2);
  made->SetSpacing(0.5, 0.25, 2.0);
  made->SetOrigin(1.0, -0.5, 0.125);
  return made;
}

std::string error_of(const std::string& path, const VtkOptions& options = {}) {
  const Result<VtkField> field = read_vtk_image(path, options);
  return field ? "none" : field.error().message();
}

void expect_numbered(const Result<VtkField>& field, const char* array, double metres = 1.0,
                     double newtons = 1.0) {
  ASSERT_TRUE(field) << field.error().message();
  EXPECT_EQ(field->array, array);
  const GridShape& shape = field->grid.shape();
  for (int i = 0; i < 3; ++i) ASSERT_EQ(shape.nodes[std::size_t(i)], kNodes[i]);
  EXPECT_LT((shape.origin - metres * Vec3(2.0, -0.5, -1.875)).norm(), 1e-12);
  EXPECT_LT((shape.spacing - metres * Vec3(0.5, 0.25, 2.0)).norm(), 1e-12);
  for (int k = 0; k < shape.nodes[2]; ++k)
    for (int j = 0; j < shape.nodes[1]; ++j)
      for (int i = 0; i < shape.nodes[0]; ++i) {
        const Vec3 p = shape.node(i, j, k);
        const Vec3 truth = newtons * numbered(p / metres);
        EXPECT_LT((field->grid.at(p).force - truth).norm(), 1e-6 * newtons * 20.0);
      }
}

TEST(VtkImage, WhatVtkWritesIsReadInEveryEncoding) {
  const ScratchFolder folder;
  const auto made = image();
  made->GetPointData()->AddArray(vectors<vtkFloatArray>(made, "velocity"));
  made->GetPointData()->AddArray(vectors<vtkFloatArray>(made, "pressure", 1));
  const auto writer = vtkSmartPointer<vtkXMLImageDataWriter>::New();
  writer->SetInputData(made);
  writer->SetFileName((folder / "flow.vti").c_str());
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended})
    for (const int order : {vtkXMLWriter::BigEndian, vtkXMLWriter::LittleEndian})
      for (const bool encoded : {true, false})
        for (const bool packed : {true, false}) {
          SCOPED_TRACE(mode * 8 + order * 4 + encoded * 2 + packed);
          writer->SetDataMode(mode);
          writer->SetByteOrder(order);
          writer->SetEncodeAppendedData(encoded);
          if (packed) {
            writer->SetCompressorTypeToZLib();
          } else {
            writer->SetCompressorTypeToNone();
          }
          ASSERT_EQ(writer->Write(), 1);
          const Result<VtkField> field = read_vtk_image(folder / "flow.vti");
          expect_numbered(field, "velocity");
          EXPECT_TRUE(std::holds_alternative<std::vector<float>>(field->grid.samples()));
        }
  expect_numbered(read_vtk_image(folder / "flow.vti", {"velocity", 1e-3, 0.01}), "velocity", 1e-3, 0.01);
}

TEST(VtkImage, TheOldFormatIsReadAsTextAndBinary) {
  const ScratchFolder folder;
  const auto made = image();
  made->GetPointData()->AddArray(vectors<vtkDoubleArray>(made, "velocity"));
  const auto writer = vtkSmartPointer<vtkStructuredPointsWriter>::New();
  writer->SetInputData(made);
  writer->SetFileName((folder / "flow.vtk").c_str());
  for (const bool binary : {true, false}) {
    if (binary) {
      writer->SetFileTypeToBinary();
    } else {
      writer->SetFileTypeToASCII();
    }
    ASSERT_EQ(writer->Write(), 1);
    const Result<VtkField> field = read_vtk_image(folder / "flow.vtk");
    expect_numbered(field, "velocity");
    EXPECT_TRUE(std::holds_alternative<std::vector<double>>(field->grid.samples()));
  }
}

/// Two by two by two points in an XML image by hand.
std::string by_hand(const std::string& inside, const std::string& extent = "0 1 0 1 0 1",
                    const std::string& more = "") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<ImageData WholeExtent=\"" +
         extent + "\" Origin=\"0 0 0\" Spacing=\"1 1 1\"" + more + ">\n<Piece Extent=\"" + extent + "\">\n" +
         inside + "\n</Piece>\n</ImageData>\n</VTKFile>\n";
}

std::string ascii(const std::string& name, int components, int tuples, const std::string& number = "1.5") {
  std::string text = "<DataArray type=\"Float64\" Name=\"" + name + "\" NumberOfComponents=\"" +
                     std::to_string(components) + "\" format=\"ascii\">";
  for (int i = 0; i < components * tuples; ++i) text += number + " ";
  return text + "</DataArray>";
}

std::string points(const std::string& arrays) {
  return "<PointData>" + arrays + "</PointData><CellData></CellData>";
}

TEST(VtkImage, FilesByHandAreReadToo) {
  const ScratchFolder folder;
  write(folder / "hand.vti", by_hand(points(ascii("wind", 3, 8))));
  const Result<VtkField> field = read_vtk_image(folder / "hand.vti");
  ASSERT_TRUE(field) << field.error().message();
  EXPECT_EQ(field->grid.at({0.3, 0.6, 0.9}).force, Vec3(1.5, 1.5, 1.5));

  // Raw numbers behind the tree, with their length before them.
  std::string raw =
      by_hand(points("<DataArray type=\"Float32\" Name=\"wind\" NumberOfComponents=\"3\" "
                     "format=\"appended\" offset=\"0\"/>"));
  std::string numbers;
  for (int i = 0; i < 24; ++i) {
    const float number = static_cast<float>(i) * 0.5f;
    numbers.append(reinterpret_cast<const char*>(&number), sizeof(number));
  }
  const std::uint32_t length = 96;
  raw.insert(raw.find("</VTKFile>"), "<AppendedData encoding=\"raw\">_" +
                                         std::string(reinterpret_cast<const char*>(&length), sizeof(length)) +
                                         numbers + "</AppendedData>\n");
  write(folder / "raw.vti", raw);
  const Result<VtkField> appended = read_vtk_image(folder / "raw.vti");
  ASSERT_TRUE(appended) << appended.error().message();
  EXPECT_EQ(appended->grid.at({1, 1, 1}).force, Vec3(10.5, 11.0, 11.5));

  write(folder / "old.vtk",
        "# vtk DataFile Version 2.0\nby hand\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 "
        "0\n"
        "SPACING 1 1 1\nPOINT_DATA 8\nVECTORS wind float\n0 0 0  1 0 0  0 1 0  1 1 0  0 0 1  1 0 1  0 1 1  1 "
        "1 1\n");
  const Result<VtkField> old = read_vtk_image(folder / "old.vtk");
  ASSERT_TRUE(old) << old.error().message();
  EXPECT_LT((old->grid.at({0.25, 0.5, 0.75}).force - Vec3(0.25, 0.5, 0.75)).norm(), 1e-7);
}

TEST(VtkImage, ErrorsSayWhatIsThereAndWhatIsMeant) {
  const ScratchFolder folder;
  const auto expect = [&](const std::string& text, const char* words, const VtkOptions& options = {},
                          const char* name = "bad.vti") {
    write(folder / name, text);
    const std::string message = error_of(folder / name, options);
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  const std::string both = points(ascii("wind", 3, 8) + ascii("rain", 3, 8));
  expect(by_hand(both), "which of the vectors is the field?: found \"wind\", \"rain\"");
  EXPECT_EQ(error_of(folder / "bad.vti", {.array = "rain"}), "none");
  expect(by_hand(both), "no such array: found \"wind\", \"rain\", expected \"snow\"", {.array = "snow"});
  expect(by_hand(points(ascii("heat", 1, 8))), "found 1 arrays, none of three components");
  expect(by_hand(points(ascii("heat", 1, 8))), "\"heat\" is no vector: found 1 components",
         {.array = "heat"});
  expect(by_hand(points("")), "found 0 arrays");
  expect(by_hand("<PointData></PointData><CellData>" + ascii("wind", 3, 1) + "</CellData>"),
         "found vectors of cells: \"wind\", expected point data");
  expect(by_hand("<PointData></PointData><CellData>" + ascii("wind", 3, 1) + "</CellData>"),
         "found it as cell data", {.array = "wind"});
  expect(by_hand(points(ascii("wind", 3, 8, "nan"))), "a sample is no force");
  expect(by_hand(points(ascii("wind", 3, 8, "1e300"))), "node (0, 0, 0): a sample is no force");
  expect(by_hand(points(ascii("wind", 3, 7))), "this is not VTK image data");
  expect(by_hand(points(ascii("wind", 3, 8)), "0 1 0 1 0 0"), "1 points along z");
  expect(by_hand(points(ascii("wind", 3, 8)), "0 99999 0 99999 0 99999"), "100000 points along x");
  expect(by_hand(points(ascii("wind", 3, 8)), "0 1 0 1 0 1", " Direction=\"0 1 0 -1 0 0 0 0 1\""),
         "the image is turned");
  expect("<VTKFile type=\"ImageData\"", "this is not VTK image data");
  expect("no XML at all", "this is not VTK image data");
  expect("", "this is not VTK image data");
  expect("# vtk DataFile Version 2.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n",
         "not VTK image data", {}, "bad.vtk");
  expect("rubbish", "not VTK image data", {}, "bad.vtk");
  expect("x", "the ending says nothing", {}, "bad.txt");
  EXPECT_NE(error_of(folder / "none.vti").find("this is not VTK image data"), std::string::npos);
}

TEST(VtkImage, DamagedFilesDoNoHarm) {
  const ScratchFolder folder;
  Random random(23);
  const std::string sound = by_hand(points(ascii("wind", 3, 8)));
  int read = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = sound;
    for (int f = 0; f < 1 + random.index(3) && !text.empty(); ++f) {
      const auto at = static_cast<std::size_t>(random.index(static_cast<int>(text.size())));
      if (random.index(2) == 0) {
        text[at] = static_cast<char>(32 + random.index(95));
      } else {
        text.erase(at, 1 + static_cast<std::size_t>(random.index(20)));
      }
    }
    write(folder / "bad.vti", text);
    read += read_vtk_image(folder / "bad.vti") ? 1 : 0;
  }
  EXPECT_GT(read, 0);
  EXPECT_LT(read, 400);
}

TEST(VtkImage, TheProgramWritesAFieldThatScenesTake) {
  const ScratchFolder folder;
  const auto made = image();
  made->GetPointData()->AddArray(vectors<vtkDoubleArray>(made, "velocity"));
  const auto writer = vtkSmartPointer<vtkXMLImageDataWriter>::New();
  writer->SetInputData(made);
  writer->SetFileName((folder / "flow.vti").c_str());
  ASSERT_EQ(writer->Write(), 1);
  const testing::ProgramRun run = testing::run_program(
      "tactum-field", folder / "flow.vti" + " -o " + (folder / "flow.toml") + " --newtons-per-unit 0.5");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\"velocity\": 4 x 3 x 5 nodes"), std::string::npos) << run.out;
  const Result<FieldGrid> grid = read_field_file(folder / "flow.toml");
  ASSERT_TRUE(grid) << grid.error().message();
  const Vec3 p = grid->shape().node(3, 2, 4);
  EXPECT_LT((grid->at(p).force - 0.5 * numbered(p)).norm(), 1e-6);
  const testing::ProgramRun bad = testing::run_program(
      "tactum-field", folder / "flow.vti" + " -o " + (folder / "x.toml") + " --array heat");
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.err.find("expected \"heat\""), std::string::npos) << bad.err;
  EXPECT_TRUE(bad.out.empty());
}

}  // namespace
}  // namespace tactum
