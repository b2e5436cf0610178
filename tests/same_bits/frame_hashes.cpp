/// frame_hashes: runs frames on the virtual clock and names the hash of each run: the gears once, the first
/// seconds of thirteen moving bodies, and a heap with fewer tests a frame than pairs. tools/same_bits.py
/// compares what the builds print.
///
/// frame_hashes record FILE: records a run, with states to begin in the middle.
/// frame_hashes verify FILE...: whether this build computes the frames that another one has recorded, from
/// the start and from the last state.

#include <fmt/format.h>

#include "bench/schedule.h"
#include "tactum/recording/recorder.h"
#include "tactum/recording/replay.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum {
namespace {

int fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.message());
  return 1;
}

int run_scene(const std::string& name, ResponseModel response, std::uint64_t frames) {
  Result<Scene> scene = open_scene(name);
  if (!scene) return fail(scene.error());
  scene->settings.response = response;
  const Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  if (!session) return fail(session.error());
  const Result<VirtualRun> run = (*session)->run_virtual(frames, nullptr);
  if (!run) return fail(run.error());
  fmt::print("{} {:016x}\n", name, (*session)->record().hash());
  return 0;
}

int run_heap() {
  bench::ScheduleOptions options;
  options.bodies = 6;
  options.seconds = 0.6;
  options.shares = {0.1};
  options.replays = 1;
  const Result<bench::ScheduleReport> report = bench_schedule(options, [](const std::string&) {});
  if (!report) return fail(report.error());
  fmt::print("heap {:016x}\n", report->rows.front().frame_hash);
  return 0;
}

int record(const std::string& path) {
  const Result<SceneDescription> scene = describe_scene("moving-objects");
  if (!scene) return fail(scene.error());
  const Result<std::unique_ptr<Session>> session = Session::open(*scene, {});
  if (!session) return fail(session.error());
  const Result<std::unique_ptr<Recorder>> recorder =
      Recorder::open({.path = path, .version = "of a test", .snapshot_every_s = 0.1}, *scene, **session);
  if (!recorder) return fail(recorder.error());
  const Result<VirtualRun> run = (*session)->run_virtual(900, nullptr);
  if (!run) return fail(run.error());
  (*recorder)->finish();
  if (const std::optional<Error> trouble = (*recorder)->trouble()) return fail(*trouble);
  return 0;
}

int verify(const std::string& path) {
  const Result<McapFile> file = McapFile::open(path);
  if (!file) return fail(file.error());
  for (const double from_s : {0.0, 0.85}) {
    const Result<ReplayResult> run = replay(*file, path, {.from_s = from_s});
    if (!run && from_s > 0.0) break;  // it is shorter
    if (!run) return fail(run.error());
    if (run->difference || run->gap || !run->end.complete)
      return fail({run->difference ? sentence_of(*run->difference) : "it is not whole", "", "", path});
    fmt::print("{} frames of {} from {} on\n", run->same, path, run->first);
  }
  return 0;
}

}  // namespace
}  // namespace tactum

int main(int count, char** words) {
  using namespace tactum;
  const std::string task = count > 1 ? words[1] : "";
  if (task == "record" && count == 3) return record(words[2]);
  if (task == "verify") {
    for (int i = 2; i < count; ++i)
      if (const int code = verify(words[i])) return code;
    return 0;
  }
  if (const int code = run_scene("gears", ResponseModel::kPenalty, 12499)) return code;
  if (const int code = run_scene("moving-objects", ResponseModel::kConstraint, 2500)) return code;
  return run_heap();
}
