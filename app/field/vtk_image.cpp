#include "vtk_image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkMatrix3x3.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStructuredPoints.h>
#include <vtkStructuredPointsReader.h>
#include <vtkXMLImageDataReader.h>

#include <exception>
#include <filesystem>
#include <vector>

namespace tactum {
namespace {

/// Keeps what VTK would print.
class QuietWindow : public vtkOutputWindow {
 public:
  static QuietWindow* New();
  vtkTypeMacro(QuietWindow, vtkOutputWindow) void DisplayText(const char* text) override { text_ += text; }
  /// Its last message without the ornaments: what stands behind "): ".
  std::string reason() const {
    const std::size_t start = text_.rfind("): ");
    std::string reason = start == std::string::npos ? text_ : text_.substr(start + 3);
    for (char& c : reason) c = c == '\n' || c == '\r' ? ' ' : c;
    const std::size_t end = reason.find_last_not_of(' ');
    return end == std::string::npos ? "" : reason.substr(0, end + 1);
  }
  bool silent() const { return text_.empty(); }

 private:
  std::string text_;
};
vtkStandardNewMacro(QuietWindow)

    /// VTK says nothing on the terminal while this lives.
    struct Quiet {
  vtkSmartPointer<QuietWindow> window = vtkSmartPointer<QuietWindow>::New();
  Quiet() {
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~Quiet() { vtkOutputWindow::SetInstance(nullptr); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
};

Error no_image(const std::string& path, const Quiet& quiet) {
  return {"this is not VTK image data", quiet.window->reason(), ".vti image data, or .vtk structured points",
          path};
}

Result<GridShape> shape_of(const int (&extent)[6], const double* spacing, const double* origin, double metres,
                           const std::string& path) {
  GridShape shape;
  for (int i = 0; i < 3; ++i) {
    const long first = extent[2 * i], last = extent[2 * i + 1];
    if (last - first + 1 > 4096 || last - first + 1 < 2)
      return Error{"the image cannot be a grid",
                   fmt::format("{} points along {}", last - first + 1, "xyz"[i]), "2 to 4096", path};
    shape.nodes[std::size_t(i)] = static_cast<int>(last - first + 1);
    shape.spacing[i] = metres * spacing[i];
    shape.origin[i] = metres * (origin[i] + spacing[i] * static_cast<double>(first));
  }
  const Result<void> fine = check_shape(shape);
  if (fine) return shape;
  Error error = fine.error();
  error.where = path;
  return error;
}

/// Reads the information first, and the points only when a grid can be so large.
template <class Reader>
Result<vtkSmartPointer<vtkImageData>> image_of(const std::string& path, const Quiet& quiet) {
  const auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  vtkInformation* const information = reader->GetOutputInformation(0);
  int extent[6] = {0, -1, 0, -1, 0, -1};
  auto* const key = vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT();
  if (!quiet.window->silent() || information == nullptr || information->Has(key) == 0)
    return no_image(path, quiet);
  information->Get(key, extent);
  const double unit[3] = {1.0, 1.0, 1.0};
  const Result<GridShape> possible = shape_of(extent, unit, unit, 1.0, path);
  if (!possible) return possible.error();
  reader->Update();
  const vtkSmartPointer<vtkImageData> image = reader->GetOutput();
  if (!quiet.window->silent() || image == nullptr) return no_image(path, quiet);
  return image;
}

std::vector<std::string> vectors_in(vtkDataSetAttributes* data) {
  std::vector<std::string> names;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* const array = data->GetArray(i);  // null: texts
    if (array != nullptr && array->GetNumberOfComponents() == 3)
      names.emplace_back(array->GetName() == nullptr ? "" : array->GetName());
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("\"{}\"", fmt::join(names, "\", \""));
}

Result<vtkDataArray*> vectors_of(vtkImageData* image, const std::string& wanted, const std::string& path) {
  vtkPointData* const points = image->GetPointData();
  const std::vector<std::string> names = vectors_in(points);
  if (wanted.empty()) {
    if (names.size() == 1) {
      for (int i = 0; i < points->GetNumberOfArrays(); ++i)
        if (vtkDataArray* const array = points->GetArray(i); array && array->GetNumberOfComponents() == 3)
          return array;
    }
    if (!names.empty())
      return Error{"which of the vectors is the field?", listed(names), "one of them by --array", path};
    const std::vector<std::string> cells = vectors_in(image->GetCellData());
    return Error{"there are no vectors at the points of the image",
                 cells.empty()
                     ? fmt::format("{} arrays, none of three components", points->GetNumberOfArrays())
                     : "vectors of cells: " + listed(cells),
                 "point data of three components", path};
  }
  vtkDataArray* const array = points->GetArray(wanted.c_str());
  if (array == nullptr)
    return Error{
        "the points of the image have no such array",
        image->GetCellData()->GetArray(wanted.c_str()) != nullptr ? "it as cell data" : listed(names),
        "\"" + wanted + "\"", path};
  if (array->GetNumberOfComponents() != 3)
    return Error{"\"" + wanted + "\" is no vector",
                 fmt::format("{} components", array->GetNumberOfComponents()), "3", path};
  return array;
}

bool along_the_axes(vtkImageData* image) {
  const vtkMatrix3x3* const direction = image->GetDirectionMatrix();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (direction->GetElement(row, column) != (row == column ? 1.0 : 0.0)) return false;
  return true;
}

template <class Number>
std::vector<Number> numbers_of(vtkDataArray* array, double unit) {
  std::vector<Number> numbers;
  numbers.reserve(3 * std::size_t(array->GetNumberOfTuples()));
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
    double three[3];
    array->GetTuple(i, three);
    for (const double number : three) numbers.push_back(static_cast<Number>(unit * number));
  }
  return numbers;
}

Result<VtkField> field_of(vtkImageData* image, const VtkOptions& options, const std::string& path) {
  if (!along_the_axes(image))
    return Error{"the image is turned", "a direction matrix", "the axes' own; turn the field in its scene",
                 path};
  int extent[6];
  image->GetExtent(extent);
  const Result<GridShape> shape =
      shape_of(extent, image->GetSpacing(), image->GetOrigin(), options.metres_per_unit, path);
  if (!shape) return shape.error();
  const Result<vtkDataArray*> array = vectors_of(image, options.array, path);
  if (!array) return array.error();
  FieldGrid::Samples samples;
  if ((*array)->GetDataType() == VTK_FLOAT) {
    samples = numbers_of<float>(*array, options.newtons_per_unit);
  } else {
    samples = numbers_of<double>(*array, options.newtons_per_unit);
  }
  Result<FieldGrid> grid = FieldGrid::make(*shape, std::move(samples));
  if (!grid) {
    Error error = grid.error();
    error.where = error.where.empty() ? path : path + ": " + error.where;
    return error;
  }
  const char* const name = (*array)->GetName();
  return VtkField{name == nullptr ? "" : name, std::move(*grid)};
}

}  // namespace

Result<VtkField> read_vtk_image(const std::string& path, const VtkOptions& options) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".vti" && ending != ".vtk")
    return Error{"the ending says nothing", "\"" + ending + "\"", "\".vti\" or \".vtk\"", path};
  const Quiet quiet;
  try {
    const Result<vtkSmartPointer<vtkImageData>> image =
        ending == ".vti" ? image_of<vtkXMLImageDataReader>(path, quiet)
                         : image_of<vtkStructuredPointsReader>(path, quiet);
    if (!image) return image.error();
    return field_of(*image, options, path);
  } catch (const std::exception& thrown) {  // VTK does not, but memory may run out in it
    return Error{"the image cannot be read", thrown.what(), "", path};
  }
}

}  // namespace tactum
