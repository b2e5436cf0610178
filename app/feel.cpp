/// tactum feel SCENE: the main job. Opens the scene and a device, runs the loop, shows the forces, prints a
/// summary.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "bridge_run.h"
#include "commands.h"
#include "feel_options.h"
#include "output.h"
#include "referee_watch.h"
#include "robot_scene.h"
#include "scene_of_meshes.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/recording/recorder.h"
#include "tactum/response/field_pull.h"
#include "tactum/response/penalty_response.h"
#include "tactum/response/workspace_scale.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/scene_remarks.h"
#include "tactum/session/device_profile.h"
#include "tactum/session/session.h"
#include "tactum/telemetry/statistics.h"
#include "tactum/version.h"
#include "trace_file.h"
#include "viewer/server/viewer.h"
#include "watch.h"

namespace tactum {
namespace {

constexpr int kGoalsNotMet = 2;  // the exit code

/// Of a run with parts that are felt by their surfaces the referee judges a frame in this time. What has come
/// through another thing, or loose from it, remains so, and is seen later; the crossing itself may be missed.
constexpr double kRefereeLooks_s = 0.05;

/// What looks at every frame of a run, where it was asked for; null where not.
struct Watchers {
  RefereeWatch* referee = nullptr;
  TraceFile* trace = nullptr;
  Recorder* recorder = nullptr;
  BridgeRun* bridge = nullptr;
};

/// Says why nothing is recorded any more: once, while the run goes on.
void report_trouble(Recorder& recorder) {
  if (const std::optional<Error> trouble = recorder.trouble())
    fmt::print(stderr, "the run goes on, and is not recorded any more: {}\n", trouble->message());
}

/// The times of a run's frames. Of a run that is repeated each frame's fastest is kept, of a single one only
/// how often each duration came: it may last for days.
class FrameTimes {
 public:
  FrameTimes(std::uint64_t frames, int runs) {
    if (runs > 1) least_.emplace(frames);
  }
  void add(std::uint64_t frame, double time_s) {
    const auto time_ns = static_cast<std::int64_t>(time_s * 1e9);
    if (least_)
      least_->add(frame, time_ns);
    else
      all_.add(time_ns);
  }
  Summary summary() const { return least_ ? least_->summary() : all_.summary(); }

 private:
  std::optional<MinimumOfReplays> least_;
  DurationHistogram all_;
};

/// Times the frames of a virtual run, passes them to those who watch, keeps the status line alive, and passes
/// Ctrl-C on.
class VirtualWatch final : public LoopObserver {
 public:
  VirtualWatch(Session& session, const Watchers& watchers, FrameTimes& times)
      : session_(session), watchers_(watchers), times_(times) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    times_.add(record.tick.index, record.frame_time_s);
    if (watchers_.referee != nullptr) watchers_.referee->look(record.tick.index);
    if (watchers_.trace != nullptr) watchers_.trace->drain();
    if (watchers_.recorder != nullptr) watchers_.recorder->wait_for_room();
    if (record.tick.index % kFramesPerLook == 0) status_.show(session_, session_.poll());
    return !interrupted();
  }

 private:
  static constexpr std::uint64_t kFramesPerLook = 1000;
  Session& session_;
  Watchers watchers_;
  FrameTimes& times_;
  StatusLine status_;
};

/// Zero, for a run without end, only where a person holds a real device, and nothing else was asked for.
std::uint64_t frames_asked_for(const FeelOptions& options, const Session& session) {
  if (options.updates > 0) return options.updates;
  if (session.device().is_hardware && options.duration_s <= 0.0) return 0;
  const double duration = options.duration_s > 0.0 ? options.duration_s : session.scene().hand->duration_s();
  const auto frames = static_cast<std::uint64_t>(duration * session.rate_Hz());
  if (frames == 0)
    fail({"there is nothing to run", "a hand that does not move", "--duration, --updates or --view",
          session.scene().name});
  return frames;
}

void refuse_virtual_clock(const FeelOptions& options, const Session& session) {
  if (!options.virtual_clock || !session.device().is_hardware) return;
  fail({"a real device runs in real time: a hand has no virtual clock", session.device().name,
        "no --virtual-clock", ""});
}

SessionOptions session_options(const FeelOptions& options) {
  SessionOptions asked{.device = "", .other_devices = {}, .grip = options.hand, .rate_Hz = 0.0};
  if (options.devices.empty()) return asked;
  asked.device = options.devices.front();
  asked.other_devices.assign(options.devices.begin() + 1, options.devices.end());
  return asked;
}

std::unique_ptr<Session> open_session(const FeelOptions& options, Scene scene) {
  Result<std::unique_ptr<Session>> opened = Session::open(std::move(scene), session_options(options));
  if (!opened) fail(opened.error());
  return std::move(*opened);
}

/// The scene that is asked for by name, by file or by meshes.
SceneDescription description_of(const FeelOptions& options) {
  const bool meshes = std::all_of(options.scenes.begin(), options.scenes.end(), is_mesh_name);
  if (!meshes && options.scenes.size() > 1)
    fail({"two scenes at once", fmt::format("{}", fmt::join(options.scenes, " and ")),
          "one scene, or one or two meshes", ""});
  if (!meshes && !options.save_scene.empty())
    fail({"--save-scene is for scenes that are made of meshes", options.scenes.front(), "a mesh", ""});
  const bool robot = is_robot_name(options.scenes.front());
  if (!robot && !options.tool.empty())
    fail({"--tool is for URDF and MJCF files", options.scenes.front(), "a .urdf or .xml file", ""});
  Result<SceneDescription> description = Error{};
  if (robot) {
    std::FILE* const out = options.json == "-" ? stderr : stdout;
    description = read_robot(options.scenes.front(), {.tool = options.tool, .folder = {}}, out).description;
  } else if (meshes) {
    const bool saves = !options.save_scene.empty();
    const std::string folder =
        saves ? std::filesystem::absolute(options.save_scene).parent_path().string() : "";
    const MeshScene made = scene_of_meshes(options.scenes, folder);
    for (const std::string& sentence : made.sentences) fmt::print(stderr, "{}\n", sentence);
    if (saves) write_text(options.save_scene, made.toml);
    const std::string name = std::filesystem::path(options.scenes.back()).stem().string();
    std::vector<std::string> folders = data_folders();
    if (saves) folders.insert(folders.begin(), folder);
    description = parse_description(made.toml, name, "the scene of " + options.scenes.back(), folders);
  } else {
    description = describe_scene(options.scenes.front());
  }
  if (!description) fail(description.error());
  if (!options.settings.empty())
    if (const Result<void> changed = change_settings(options.settings, *description); !changed)
      fail(changed.error());
  return std::move(*description);
}

Scene scene_of(const FeelOptions& options, const SceneDescription& description) {
  Result<Scene> scene = build_scene(description);
  if (!scene) fail(scene.error());
  if (!options.response.empty())
    scene->settings.response =
        options.response == "penalty" ? ResponseModel::kPenalty : ResponseModel::kConstraint;
  // The remarks are about the device that is in use.
  if (!options.devices.empty())
    if (const auto device = simulated_device_preset(options.devices.front())) scene->device = device->name;
  return std::move(*scene);
}

/// Prints the remarks on the scene; with --strict the command ends when one is a warning.
std::vector<SceneRemark> remark_on(std::FILE* out, const FeelOptions& options,
                                   const SceneDescription& description, const Scene& scene) {
  std::vector<SceneRemark> remarks = remarks_on(description, scene);
  int warnings = 0;
  for (const SceneRemark& remark : remarks) {  // facts come first
    if (!remark.warning) fmt::print(out, "{}\n", remark.text);
    std::fflush(out);
    if (!remark.warning) continue;
    fmt::print(stderr, "remark: {}\n", remark.text);
    ++warnings;
  }
  if (options.strict && warnings > 0)
    fail({"with --strict the remarks on a scene are errors",
          fmt::format("{} {}", warnings, warnings == 1 ? "remark" : "remarks"), "none",
          options.scenes.back()});
  return remarks;
}

void run_virtually(Session& session, std::uint64_t frames, const Watchers& watchers, FrameTimes& times) {
  VirtualWatch watch(session, watchers, times);
  const Result<VirtualRun> run = session.run_virtual(frames, &watch);
  if (!run) fail(run.error());
}

/// Runs the session, and repeats it as many times as wanted.
Summary feel_virtually(const FeelOptions& options, const SceneDescription& description, Session& session,
                       std::uint64_t frames, const Watchers& watchers) {
  FrameTimes times(frames, options.replays);
  run_virtually(session, frames, watchers, times);
  for (int replay = 1; replay < options.replays && !interrupted(); ++replay) {
    const std::unique_ptr<Session> again = open_session(options, scene_of(options, description));
    StageClock stages;  // so that every run does the same
    again->time_stages(&stages);
    run_virtually(*again, frames, {}, times);
    if (!interrupted() && again->record().hash() != session.record().hash())
      fail({"a replay went another way", fmt::format("hash {:016x}", again->record().hash()),
            fmt::format("{:016x} as in the first run", session.record().hash()), options.scenes.back()});
  }
  return times.summary();
}

/// Runs the loop's own thread until the frames are done, the device is gone or the user stops it.
Summary feel_live(Session& session, std::uint64_t frames, const Watchers& watchers) {
  if (const Result<void> started = session.start(frames); !started) fail(started.error());
  for (const std::string& sentence : session.privileges().sentences) fmt::print(stderr, "{}\n", sentence);
  StatusLine status;
  // Clients of bridges wait for what they see, a terminal and a disk do not.
  const auto pause = std::chrono::milliseconds(watchers.bridge != nullptr ? 5 : 50);
  for (int look = 0; session.loop_status().running && !interrupted(); ++look) {
    std::this_thread::sleep_for(pause);
    const SessionStatus newest = session.poll();
    if (watchers.bridge == nullptr || look % 10 == 0) status.show(session, newest);
    if (watchers.trace != nullptr) watchers.trace->drain();
    if (watchers.bridge != nullptr) watchers.bridge->poll();
    if (watchers.recorder != nullptr) report_trouble(*watchers.recorder);
  }
  session.stop();
  session.poll();
  return session.frame_times().summary();
}

/// Passes the frames of a virtual run on to the pages.
class ViewedVirtualWatch final : public LoopObserver {
 public:
  explicit ViewedVirtualWatch(Viewer& viewer) : viewer_(viewer) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    frame_times.add(static_cast<std::int64_t>(record.frame_time_s * 1e9));
    viewer_.after_virtual_frame(record);
    return !interrupted();
  }
  DurationHistogram frame_times;

 private:
  Viewer& viewer_;
};

Summary feel_viewed_virtually(Viewer& viewer, std::uint64_t frames) {
  ViewedVirtualWatch watch(viewer);
  const Result<VirtualRun> run = viewer.session().run_virtual(frames, &watch);
  if (!run) fail(run.error());
  return watch.frame_times.summary();
}

void report_what_is_felt(std::FILE* out, const Session& session, const std::string& grip) {
  const Scene& scene = session.scene();
  const bool replayed = session.device().name.starts_with("replay");  // of a hand that yields to nothing
  const bool no_grip = replayed || session.device().is_hardware;      // no simulated hand holds it
  fmt::print(out, "{}: {}\n{} at {:.0f} Hz, {}response {}\n", scene.name, scene.description,
             session.device().name, session.rate_Hz(),
             no_grip ? "" : fmt::format("hand {}, ", grip.empty() ? scene.grip : grip),
             scene.settings.response == ResponseModel::kPenalty ? "penalty" : "constraint");
  const Coupling& coupling = scene.settings.coupling;
  const double scale = scene.settings.workspace.scale;
  if (session.device().actuates_force && !replayed)
    fmt::print(out, "{}{}\n", margin_sentence(coupling, session.device(), session.rate_Hz()),
               scene.coupling_by_device ? " It was chosen for this device and rate." : "");
  if (const std::string profile = profile_sentence(session.device()); !profile.empty())
    fmt::print(out, "{}\n", profile);
  for (std::size_t h = 1; h < session.hands(); ++h)
    fmt::print(out, "hand {} on {}: {}\n", h + 1, session.device_of(h).name,
               margin_sentence(scene.settings.hand(h).coupling, session.device_of(h), session.rate_Hz()));
  for (const std::string& sentence :
       {scale_sentence(coupling, scale), field_sentence(scene.world, in_scene(coupling, scale)),
        penalty_sentence(scene.settings)})
    if (!sentence.empty()) fmt::print(out, "{}\n", sentence);
  std::fflush(out);
}

nlohmann::ordered_json remarks_json(const std::vector<SceneRemark>& remarks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const SceneRemark& remark : remarks)
    json.push_back({{"warning", remark.warning}, {"what", remark.text}});
  return json;
}

void report_recording(std::FILE* out, const std::string& path, std::uint64_t frames, std::uint64_t dropped) {
  fmt::print(out, "recording        {} frames in {}{}\n", frames, path,
             dropped == 0 ? "" : fmt::format("; {} more are lost, since the disk was too slow", dropped));
}

/// Who judges the run: the referee, where it is asked for, and where gaps do not tell; else nothing.
std::optional<RefereeWatch> referee_of(const FeelOptions& options, const Session& session) {
  if (!options.referee && !some_surface(session.scene())) return {};
  const double frames = options.referee ? 1.0 : session.rate_Hz() * kRefereeLooks_s;
  return std::optional<RefereeWatch>(std::in_place, session,
                                     std::max<std::uint64_t>(1, static_cast<std::uint64_t>(frames)));
}

void sum_up(std::FILE* out, const FeelOptions& options, const std::vector<SceneRemark>& remarks,
            const Session& session, const Summary& times, const StageClock& stages,
            const Watchers& watchers) {
  const RefereeWatch* referee = watchers.referee;
  const OverlapVerdict overlaps =
      referee != nullptr ? OverlapVerdict{referee->crossing_frames(), referee->judged_frames(), true}
                         : overlaps_by_gaps(session);
  print_summary(out, session, overlaps, times, stages);
  if (referee != nullptr) fmt::print(out, "referee          {}\n", referee->sentence());
  if (watchers.trace != nullptr)
    fmt::print(out, "trace            {} frames in {}{}\n", watchers.trace->rows(), options.trace,
               watchers.trace->lost() == 0
                   ? ""
                   : fmt::format("; {} more are lost, since the disk was too slow", watchers.trace->lost()));
  if (const Recorder* recorder = watchers.recorder) {
    report_recording(out, options.record, recorder->frames(), recorder->dropped());
    if (recorder->without_snapshots())
      fmt::print(out,
                 "                 its state is too large to be recorded on the way: a replay begins at the "
                 "start\n");
  }
  if (options.replays > 1 && !interrupted())
    fmt::print(out, "replays          {} runs, the same to the bit; each frame counts with its fastest\n",
               options.replays);
  if (!options.json.empty()) {
    nlohmann::ordered_json summary = summary_json(session, overlaps, times, stages);
    summary["replays"] = options.replays;
    summary["remarks"] = remarks_json(remarks);
    if (referee != nullptr)
      summary["referee"] = {{"judged_frames", referee->judged_frames()}, {"verdict", referee->sentence()}};
    write_json(options.json, summary);
  }
  if (session.loop_status().device_lost)
    fail({"the device refused every wrench for a while, so the loop has ended", session.device_trouble(),
          "a device that is plugged in and powered", session.device().name});
  if (!session.goals().all_met()) end_with(kGoalsNotMet);
}

/// Ends what a page or the command line has begun to record.
void end_recording(std::FILE* out, Viewer& viewer) {
  const std::vector<RecordingFile> files = viewer.end_recording();
  report_trouble(viewer);
  for (const RecordingFile& file : files) report_recording(out, file.path, file.frames, file.dropped);
}

void print_bridges(std::FILE* out, const BridgeRun& run) {
  for (const std::string& sentence : run.bridge().sentences()) fmt::print(out, "{}\n", sentence);
  std::fflush(out);
}

void feel_with_pages(const FeelOptions& options, const SceneDescription& description,
                     const std::vector<SceneRemark>& remarks, Scene scene, std::FILE* out) {
  Result<std::unique_ptr<Viewer>> opened =
      Viewer::open(std::move(scene), session_options(options), options.port, remarks, description);
  if (!opened) fail(opened.error());
  Viewer& viewer = **opened;
  refuse_virtual_clock(options, viewer.session());
  if (!options.record.empty())
    if (const Result<void> begun = viewer.record(options.record); !begun) fail(begun.error());
  report_what_is_felt(out, viewer.session(), options.hand);
  std::optional<BridgeRun> bridge;
  if (!options.bridge.bridges.empty()) {
    viewer.let_follow(&bridge.emplace(options.bridge));
    print_bridges(out, *bridge);
  }
  open_page(out, viewer.server().address());
  const std::uint64_t asked =
      options.updates > 0 ? options.updates
                          : static_cast<std::uint64_t>(options.duration_s * viewer.session().rate_Hz());
  if (options.wait_s > 0.0 && asked == 0)
    fail({"--wait is for a run with an end", "no end", "--duration or --updates", ""});
  if (options.wait_s > 0.0)
    fmt::print(
        out,
        "when its frames are over it waits {:.0f} s for the page to be opened, and stays as long as one "
        "is open; Ctrl-C ends it\n",
        options.wait_s);
  std::fflush(out);
  const Summary times = options.virtual_clock
                            ? feel_viewed_virtually(viewer, frames_asked_for(options, viewer.session()))
                            : run_viewed(viewer, asked, options.wait_s);
  end_recording(out, viewer);
  viewer.let_follow(nullptr);
  sum_up(out, options, remarks, viewer.session(), times, viewer.stages(), {});
}

std::string version_text() {
  return fmt::format("{}.{}.{}", TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH);
}

/// Null where no recording was asked for.
std::unique_ptr<Recorder> begin_recording(const FeelOptions& options, const SceneDescription& description,
                                          Session& session) {
  if (options.record.empty()) return nullptr;
  Result<std::unique_ptr<Recorder>> recorder =
      Recorder::open({options.record, options.hand, version_text()}, description, session);
  if (!recorder) fail(recorder.error());
  return std::move(*recorder);
}

/// Null where none was asked for.
std::unique_ptr<BridgeRun> begin_bridge(std::FILE* out, const FeelOptions& options, Session& session,
                                        TraceFile* trace) {
  if (options.bridge.bridges.empty()) return nullptr;
  auto bridge = std::make_unique<BridgeRun>(options.bridge, session, trace);
  print_bridges(out, *bridge);
  return bridge;
}

void feel(const FeelOptions& options) {
  check_writable(options.json);
  // With --json - the standard output is for machines alone.
  std::FILE* out = options.json == "-" ? stderr : stdout;
  const SceneDescription description = description_of(options);
  Scene scene = scene_of(options, description);
  const std::vector<SceneRemark> remarks = remark_on(out, options, description, scene);
  watch_for_interrupts();
  if (options.view) return feel_with_pages(options, description, remarks, std::move(scene), out);
  const std::unique_ptr<Session> opened = open_session(options, std::move(scene));
  Session& session = *opened;

  refuse_virtual_clock(options, session);
  StageClock stages;
  session.time_stages(&stages);
  report_what_is_felt(out, session, options.hand);
  const std::uint64_t frames = frames_asked_for(options, session);
  std::optional<RefereeWatch> judges = referee_of(options, session);
  std::optional<TraceFile> trace;
  const bool bridges = !options.bridge.bridges.empty();
  if (!options.trace.empty()) trace.emplace(options.trace, session, frames, options.trace_bodies, bridges);
  const std::unique_ptr<BridgeRun> bridge = begin_bridge(out, options, session, trace ? &*trace : nullptr);
  const std::unique_ptr<Recorder> recorder = begin_recording(options, description, session);
  const Watchers watchers{judges ? &*judges : nullptr, trace ? &*trace : nullptr, recorder.get(),
                          bridge.get()};
  const Summary times = options.virtual_clock
                            ? feel_virtually(options, description, session, frames, watchers)
                            : feel_live(session, frames, watchers);
  if (judges) judges->look_at_end();
  if (trace) trace->finish();
  if (recorder) {
    recorder->finish();
    report_trouble(*recorder);
  }
  sum_up(out, options, remarks, session, times, stages, watchers);
}

}  // namespace

void add_feel(CLI::App& app) {
  auto options = std::make_shared<FeelOptions>();
  CLI::App* command = app.add_subcommand("feel", "Feel a scene: run the haptic loop on a device");
  add_what_is_felt(command, options.get());
  CLI::Option* virtual_clock =
      command->add_flag("--virtual-clock", options->virtual_clock,
                        "Run as fast as the machine can, with the same result on every machine");
  CLI::Option* replays = command
                             ->add_option("--replays", options->replays,
                                          "Repeat the run so many times and report the fastest time of each "
                                          "frame, which leaves out the machine's "
                                          "other work")
                             ->check(whole_number_between(1, 1000, "a number of runs"))
                             ->needs(virtual_clock)
                             ->capture_default_str();
  CLI::Option* referee = command
                             ->add_flag("--referee", options->referee,
                                        "Judge every frame by exact signs and topology: does any surface "
                                        "cross another, has anything got inside, or out of what it hangs in? "
                                        "Without it, one frame in 0.05 s where a part is felt by its surface")
                             ->needs(virtual_clock);
  add_record(command, options.get());
  CLI::Option* trace = add_trace(command, options.get());
  add_bridge(command, options.get())->excludes(virtual_clock);
  CLI::Option* view = command->add_flag(
      "--view", options->view,
      "Serve a page that shows the scene, and on which the mouse is the hand: until interrupted, or, where a "
      "duration is given, until it is over and no page is open");
  replays->excludes(view);
  referee->excludes(view);
  trace->excludes(view);
  add_page(command, options.get(), view)->excludes(virtual_clock);
  command->callback([options] { feel(*options); });
}

}  // namespace tactum
