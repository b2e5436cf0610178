#include "trace_file.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <iterator>

#include "commands.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/version.h"

namespace tactum {
namespace {

/// The settings of the run, as a scene file would say them; one comment line each.
std::string settings_as_comments(const Scene& scene) {
  std::string text;
  for (const SettingInfo& setting : setting_table()) {
    const double value = setting.get(scene.settings, scene.safety);
    text += fmt::format(
        "# setting {}{}{} = {}\n", setting.section, setting.section[0] == '\0' ? "" : ".", setting.key,
        setting.kind == SettingKind::kChoice ? std::string(setting.choices[static_cast<std::size_t>(value)])
                                             : fmt::format("{}", value));
  }
  return text;
}

std::string head_of(const Session& session, std::uint64_t frames, const FrameTrace& trace,
                    std::size_t columns) {
  const Scene& scene = session.scene();
  const std::time_t now = std::time(nullptr);
  std::string text = fmt::format(
      "# trace of tactum {}.{}.{}\n# scene: {}\n# device: {}\n# rate_Hz: {}\n# frames: {}\n# date: "
      "{:%Y-%m-%dT%H:%M:%SZ}\n"
      "# axes: of the world; wrenches act on the hand, at the handle; device_* is in the frame of the "
      "device\n",
      TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH, scene.name, session.device().name,
      session.rate_Hz(), frames, fmt::gmtime(now));
  text += settings_as_comments(scene);
  for (std::size_t i = 0; i < columns; ++i) text += (i == 0 ? "" : ",") + trace.columns()[i].name;
  return text + "\n";
}

}  // namespace

TraceFile::TraceFile(const std::string& path, Session& session, std::uint64_t frames, bool bodies,
                     bool passes_on)
    : path_(path),
      session_(session),
      trace_(session.scene().world, session.scene().settings.dt_s, bodies || passes_on, FrameTrace::kFrames,
             session.hands()),
      columns_(FrameTrace(session.scene().world, session.scene().settings.dt_s, bodies, 0, session.hands())
                   .width()),
      row_(trace_.width()),
      file_(std::fopen(path.c_str(), "w")) {
  if (!file_) fail({"cannot write the trace", std::strerror(errno), "a file that can be written", path});
  const std::string head = head_of(session, frames, trace_, columns_);
  std::fwrite(head.data(), 1, head.size(), file_.get());
  session_.trace_to(&trace_);
}

TraceFile::~TraceFile() { session_.trace_to(nullptr); }

void TraceFile::drain() {
  fmt::memory_buffer text;
  while (trace_.pop(row_)) {
    for (std::size_t i = 0; i < columns_; ++i)
      fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "" : ",", row_[i] + 0.0);
    text.push_back('\n');
    if (other_) other_(row_);
    ++rows_;
  }
  std::fwrite(text.data(), 1, text.size(), file_.get());
}

void TraceFile::finish() {
  drain();
  if (std::fflush(file_.get()) != 0 || std::ferror(file_.get()) != 0)
    fail({"cannot write the whole trace", std::strerror(errno), "room on the disk", path_});
}

}  // namespace tactum
