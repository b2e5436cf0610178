/// tactum.Recording: what `tactum feel --record` and Session(record=...) have written.

#include <pybind11/stl.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#ifdef TACTUM_WITH_HDF5
#include "app/hdf5/export_hdf5.h"
#endif
#include "conversions.h"
#include "tactum/recording/export_csv.h"
#include "tactum/recording/recording_visitor.h"
#include "tactum/recording/replay.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

/// Keeps the head and all rows.
class TableReading final : public RecordingVisitor {
 public:
  using RecordingVisitor::RecordingVisitor;
  std::vector<double> numbers;

 private:
  Result<void> begin(Files) override { return {}; }
  Result<void> row(const std::vector<double>& row) override {
    numbers.insert(numbers.end(), row.begin(), row.end());
    return {};
  }
};

/// A recording that was read once: its head, and a row for each frame.
struct ReadRecording {
  std::string path;
  RunHead head;
  std::vector<double> numbers;
  bool complete = false;
  std::string wrong;  // why it is not
};

ReadRecording read_whole(const std::string& path) {
  const py::gil_scoped_release released;
  const McapFile file = or_raise(McapFile::open(path));
  TableReading reading(path);
  const McapEnd end = read_recording(file, reading);
  if (!reading.begun()) throw Refusal(*end.wrong);
  return {path, reading.head(), std::move(reading.numbers), end.complete,
          end.wrong ? end.wrong->message() : std::string()};
}

std::vector<std::string> column_names(const ReadRecording& recording) {
  std::vector<std::string> names;
  for (const TraceColumn& column : recording.head.columns) names.push_back(column.name);
  return names;
}

py::array table_of(const py::object& self) {
  const auto& recording = self.cast<const ReadRecording&>();
  const auto width = static_cast<py::ssize_t>(recording.head.columns.size());
  const py::ssize_t rows = width == 0 ? 0 : static_cast<py::ssize_t>(recording.numbers.size()) / width;
  py::array view(py::dtype::of<double>(), {rows, width}, {}, recording.numbers.data(), self);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::dict replay_of(const ReadRecording& recording, const std::string& response, const std::string& settings,
                   double from_s) {
  ReplayOptions options;
  options.response = response;
  options.settings = settings;
  options.from_s = from_s;
  const auto replayed = [&] {
    const py::gil_scoped_release released;
    const McapFile file = or_raise(McapFile::open(recording.path));
    return or_raise(replay(file, recording.path, options));
  }();
  return py::dict(
      "first"_a = replayed.first, "frames"_a = replayed.frames, "same"_a = replayed.same,
      "difference"_a =
          replayed.difference ? py::object(py::str(sentence_of(*replayed.difference))) : py::none(),
      "max_force_N"_a = replayed.replayed.max_force_N, "max_torque_Nm"_a = replayed.replayed.max_torque_Nm,
      "contact_frames"_a = replayed.replayed.contact_frames, "notes"_a = replayed.notes);
}

std::uint64_t write_csv(const ReadRecording& recording, const std::string& path) {
  const py::gil_scoped_release released;
  const McapFile file = or_raise(McapFile::open(recording.path));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(path.c_str(), "w"), &std::fclose);
  if (!out)
    throw Refusal({"cannot write the table", std::strerror(errno), "a file that can be written", path});
  return or_raise(export_csv(file, recording.path, out.get())).rows;
}

#ifdef TACTUM_WITH_HDF5
std::uint64_t write_hdf5(const ReadRecording& recording, const std::string& path) {
  const py::gil_scoped_release released;
  const McapFile file = or_raise(McapFile::open(recording.path));
  return or_raise(export_hdf5(file, recording.path, path)).rows;
}
#else
std::uint64_t write_hdf5(const ReadRecording&, const std::string& path) {
  throw Refusal({"this module was built without HDF5", "", "one that was built where libhdf5-dev is", path});
}
#endif

}  // namespace

void bind_recordings(py::module_& module) {
  py::class_<ReadRecording>(module, "Recording", "A recorded run.")
      .def(py::init(&read_whole), "path"_a)
      .def_readonly("path", &ReadRecording::path)
      .def_property_readonly("scene", [](const ReadRecording& r) { return r.head.scene; })
      .def_property_readonly("device", [](const ReadRecording& r) { return r.head.device.name; })
      .def_property_readonly("version", [](const ReadRecording& r) { return r.head.version; })
      .def_property_readonly("date", [](const ReadRecording& r) { return r.head.date; })
      .def_property_readonly("dt_s", [](const ReadRecording& r) { return r.head.dt_s; })
      .def_property_readonly("bodies", [](const ReadRecording& r) { return r.head.bodies; })
      .def_property_readonly("columns", &column_names)
      .def_property_readonly("table", &table_of)
      .def_readonly("complete", &ReadRecording::complete)
      .def_readonly("wrong", &ReadRecording::wrong)
      .def("replay", &replay_of, py::kw_only(), "response"_a = "", "settings_file"_a = "", "from_s"_a = 0.0)
      .def("export_csv", &write_csv, "path"_a)
      .def("export_hdf5", &write_hdf5, "path"_a);
}

}  // namespace tactum::python
