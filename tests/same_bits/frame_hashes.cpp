/// Runs frames on the virtual clock and names the hash of each run: the gears once, the first seconds of
/// thirteen moving bodies, and a heap with fewer tests a frame than pairs. tools/same_bits.py compares what
/// the builds print.

#include <fmt/format.h>

#include "bench/schedule.h"
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

}  // namespace
}  // namespace tactum

int main() {
  using namespace tactum;
  if (const int code = run_scene("gears", ResponseModel::kPenalty, 12499)) return code;
  if (const int code = run_scene("moving-objects", ResponseModel::kConstraint, 2500)) return code;
  return run_heap();
}
