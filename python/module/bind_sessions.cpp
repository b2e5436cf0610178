/// tactum.Session: a scene on a device, in C++ from the first frame to the last.

#include <pybind11/stl.h>

#include <memory>
#include <optional>

#include "conversions.h"
#include "tactum/drivers/registry.h"
#include "tactum/recording/recorder.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/scene_remarks.h"
#include "tactum/session/session.h"
#include "tactum/version.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

/// A session and what looks at it.
class WatchedSession final : private LoopObserver {
 public:
  WatchedSession(const std::string& scene, const std::string& settings, const SessionOptions& options,
                 const std::string& record, bool traced) {
    SceneDescription description = or_raise(describe_scene(scene));
    if (!settings.empty()) or_raise(parse_changes(settings, "the settings", description));
    Scene built = or_raise(build_scene(description));
    for (const SceneRemark& remark : remarks_on(description, built)) remarks.push_back(remark.text);
    session = or_raise(Session::open(std::move(built), options));
    if (traced) {
      trace.emplace(session->scene().world, session->scene().settings.dt_s, true);
      session->trace_to(&*trace);
    }
    if (record.empty()) return;
    const std::string version = std::to_string(TACTUM_VERSION_MAJOR) + "." +
                                std::to_string(TACTUM_VERSION_MINOR) + "." +
                                std::to_string(TACTUM_VERSION_PATCH);
    recorder = or_raise(Recorder::open({record, options.grip, version}, description, *session));
  }
  ~WatchedSession() override {
    session->stop();
    session->trace_to(nullptr);
    session->report_to(nullptr);
  }
  WatchedSession(const WatchedSession&) = delete;
  WatchedSession& operator=(const WatchedSession&) = delete;

  /// Runs on the virtual clock in this thread, and ends the recording.
  std::uint64_t run(std::uint64_t frames) {
    if (session->device().is_hardware)
      throw Refusal({"a real device runs in real time: a hand has no virtual clock", session->device().name,
                     "start()", ""});
    if (frames == 0) frames = static_cast<std::uint64_t>(frames_of_motion(session->scene()));
    const py::gil_scoped_release released;
    const VirtualRun run = or_raise(session->run_virtual(frames, this));
    end_recording();
    return run.frames;
  }
  void start(std::uint64_t frames) { or_raise(session->start(frames)); }
  void stop() {
    const py::gil_scoped_release released;
    session->stop();
    session->poll();
    drain();
    end_recording();
  }
  /// Takes what a running loop has published.
  SessionStatus poll() {
    const SessionStatus status = session->poll();
    drain();
    return status;
  }

  std::vector<std::string> remarks;
  std::unique_ptr<Session> session;
  std::optional<FrameTrace> trace;
  std::vector<double> rows;
  std::unique_ptr<Recorder> recorder;

 private:
  bool after_frame(const FrameRecord&) noexcept override {
    drain();
    if (recorder) recorder->wait_for_room();
    return true;
  }
  void drain() {
    if (!trace) return;
    row_.resize(trace->width());
    while (trace->pop(row_)) rows.insert(rows.end(), row_.begin(), row_.end());
  }
  void end_recording() {
    if (!recorder) return;
    recorder->finish();
    if (const std::optional<Error> trouble = recorder->trouble()) throw Refusal(*trouble);
  }

  std::vector<double> row_;
};

py::tuple trace_of(const WatchedSession& watched) {
  if (!watched.trace)
    throw Refusal({"the session keeps no trace", "trace=False", "Session(..., trace=True)", ""});
  std::vector<std::string> names;
  for (const TraceColumn& column : watched.trace->columns()) names.push_back(column.name);
  const auto width = static_cast<py::ssize_t>(names.size());
  Array table({static_cast<py::ssize_t>(watched.rows.size()) / width, width});
  std::copy(watched.rows.begin(), watched.rows.end(), table.mutable_data());
  return py::make_tuple(names, table);
}

py::dict record_of(const WatchedSession& watched) {
  const RunRecord& record = watched.session->record();
  return py::dict("frames"_a = record.frames, "contact_frames"_a = record.grasped_contact_frames,
                  "penetrating_frames"_a = record.penetrating_frames,
                  "max_penetration_m"_a = record.max_penetration_m, "max_force_N"_a = record.max_force_N,
                  "max_torque_Nm"_a = record.max_torque_Nm, "max_force_step_N"_a = record.max_force_step_N,
                  "flags"_a = record.flags, "safety"_a = record.safety, "hash"_a = record.hash());
}

py::dict status_of(WatchedSession& watched) {
  const SessionStatus status = watched.poll();
  const LoopStatus loop = watched.session->loop_status();
  return py::dict("running"_a = loop.running, "frame"_a = status.frame, "force_N"_a = status.force_N,
                  "torque_Nm"_a = status.torque_Nm, "contact_points"_a = status.contact_points,
                  "stretch_m"_a = status.stretch_m, "safety"_a = status.safety,
                  "missed_deadlines"_a = loop.missed_deadlines, "device_lost"_a = loop.device_lost);
}

std::vector<std::pair<std::string, bool>> goals_of(const WatchedSession& watched) {
  std::vector<std::pair<std::string, bool>> goals;
  const GoalRecord& record = watched.session->goals();
  for (std::size_t goal = 0; goal < record.size(); ++goal)
    goals.emplace_back(record.describe(watched.session->scene().world, goal), record.met(goal));
  return goals;
}

}  // namespace

void bind_sessions(py::module_& module) {
  py::class_<WatchedSession>(module, "Session", "One run of a scene on a device, in C++ throughout.")
      .def_static(
          "_open",
          [](const std::string& scene, const std::string& device,
             const std::vector<std::string>& other_devices, const std::string& grip,
             const std::string& settings, double rate_Hz, const std::string& record, bool trace) {
            const py::gil_scoped_release released;
            SessionOptions options;
            options.device = device;
            options.other_devices = other_devices;
            options.grip = grip;
            options.rate_Hz = rate_Hz;
            return std::make_unique<WatchedSession>(scene, settings, options, record, trace);
          },
          "scene"_a, "device"_a, "other_devices"_a, "grip"_a, "settings"_a, "rate_Hz"_a, "record"_a,
          "trace"_a)
      .def("run", &WatchedSession::run, "frames"_a = 0)
      .def("start", &WatchedSession::start, "frames"_a = 0)
      .def("stop", &WatchedSession::stop)
      .def("status", &status_of)
      .def_readonly("remarks", &WatchedSession::remarks)
      .def_property_readonly("device",
                             [](const WatchedSession& watched) { return watched.session->device().name; })
      .def_property_readonly("rate_Hz",
                             [](const WatchedSession& watched) { return watched.session->rate_Hz(); })
      .def_property_readonly("summary", &record_of)
      .def_property_readonly("goals", &goals_of)
      .def_property_readonly("_trace", &trace_of);
  module.def("scenes", [] {
    std::vector<std::pair<std::string, std::string>> scenes;
    for (const SceneEntry& entry : list_scenes()) scenes.emplace_back(entry.name, entry.description);
    return scenes;
  });
  module.def("devices", [] {
    std::vector<std::pair<std::string, std::string>> devices;
    for (const DeviceListing& listing : list_devices())
      devices.emplace_back(listing.name, listing.description);
    return devices;
  });
}

}  // namespace tactum::python
