#include "viewer/server/run_recording.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <utility>

#include "tactum/version.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;

/// A file beside `path` that is not there yet: itself, or with a number behind its name.
std::string new_file(const fs::path& path) {
  fs::path free = path;
  std::error_code ignored;
  for (int number = 2; fs::exists(free, ignored); ++number)
    free =
        path.parent_path() / fmt::format("{}-{}{}", path.stem().string(), number, path.extension().string());
  return free.string();
}

std::string named_by_time(const std::string& scene) {
  const std::time_t now = std::time(nullptr);
  std::string name;
  for (const char letter : scene)  // a name from a file: no folders in it
    name += std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-' || letter == '_' ? letter
                                                                                                    : '-';
  std::error_code ignored;
  return new_file(fs::current_path(ignored) /
                  fmt::format("tactum-{}-{:%Y%m%d-%H%M%S}.mcap", name, fmt::localtime(now)));
}

}  // namespace

Result<void> RunRecording::begin(const std::string& path, const SceneDescription& scene, Session& session,
                                 const std::string& grip, const std::optional<UserSettings>& running) {
  end();
  RecorderOptions options;
  options.path = path.empty() ? named_by_time(scene.name) : path;
  options.grip = grip;
  options.version = fmt::format("{}.{}.{}", TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH);
  options.midway = running;
  auto kept = std::make_unique<SceneDescription>(scene);
  Result<std::unique_ptr<Recorder>> recorder = Recorder::open(options, *kept, session, &switch_);
  if (!recorder) return recorder.error();
  scene_ = std::move(kept);
  recorder_ = std::move(*recorder);
  asked_ = options.path;
  files_.push_back({options.path});
  return {};
}

Result<void> RunRecording::go_on(const SceneDescription& scene, Session& session, const std::string& grip) {
  return begin(new_file(asked_), scene, session, grip, std::nullopt);
}

void RunRecording::end() {
  if (!on()) return;
  recorder_->finish();
  files_.back().frames = recorder_->frames();
  files_.back().dropped = recorder_->dropped();
  if (std::optional<Error> trouble = recorder_->trouble()) trouble_ = std::move(trouble);
  recorder_.reset();
}

void RunRecording::wait_for_room() const {
  if (on()) recorder_->wait_for_room();
}

std::optional<Error> RunRecording::trouble() {
  if (on()) trouble_ = recorder_->trouble();
  if (on() && trouble_) end();
  return std::exchange(trouble_, std::nullopt);
}

std::vector<RecordingFile> RunRecording::files() const {
  std::vector<RecordingFile> files = files_;
  if (on()) {
    files.back().frames = recorder_->frames();
    files.back().dropped = recorder_->dropped();
  }
  return files;
}

}  // namespace tactum
