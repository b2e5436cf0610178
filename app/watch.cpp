#include "watch.h"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

#include "commands.h"

namespace tactum {
namespace {

// Set by the signal handler, read by the main thread; the loop then ramps the wrench to zero.
std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int) { g_interrupted.store(true); }

}  // namespace

void watch_for_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() { return g_interrupted.load(); }

void StatusLine::show(const Session& session, const SessionStatus& status) {
  if (!on_terminal_) return;
  fmt::print(stderr,
             "\r{:>8.2f} s  force {:6.2f} N  torque {:7.1f} mN m  stretch {:6.3f} mm  contacts {:3}  "
             "{:5.0f} Hz {}\033[K",
             static_cast<double>(status.frame) / session.rate_Hz(), status.force_N, status.torque_Nm * 1e3,
             status.stretch_m * 1e3, status.contact_points, rate(status.frame),
             safety_flag_names(status.safety));
  std::fflush(stderr);
  shown_ = true;
}

StatusLine::~StatusLine() {
  if (shown_) fmt::print(stderr, "\n");
}

double StatusLine::rate(std::uint64_t frame) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  const double frames = static_cast<double>(frame) - static_cast<double>(last_frame_);
  last_ = now;
  last_frame_ = frame;
  return seconds > 0.0 ? frames / seconds : 0.0;
}

void report_trouble(Viewer& viewer) {
  if (const std::string trouble = viewer.take_recording_trouble(); !trouble.empty())
    fmt::print(stderr, "{}\n", trouble);
}

void open_page(std::FILE* out, const std::string& address) {
  fmt::print(out, "see and feel it at {}\n", address);
  std::fflush(out);
  const bool screen = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
  if (!screen) return;
  // The address holds digits, letters and slashes only. Where there is no browser, it stays printed.
  const std::string command = "xdg-open '" + address + "' >/dev/null 2>&1 &";
  if (std::system(command.c_str()) != 0) fmt::print(stderr, "cannot start a browser; open the address\n");
}

Summary run_viewed(Viewer& viewer, std::uint64_t frames, double wait_s) {
  constexpr double kReload_s = 2.0;  // a page that comes back within this was only loaded anew
  if (const Result<void> started = viewer.start(); !started) fail(started.error());
  for (const std::string& sentence : viewer.session().privileges().sentences)
    fmt::print(stderr, "{}\n", sentence);
  StatusLine status;
  auto last_line = std::chrono::steady_clock::now();
  std::uint64_t earlier = 0, last = 0;                        // frames of runs that a page has ended
  std::optional<std::chrono::steady_clock::time_point> over;  // since then all frames are done
  while (!interrupted()) {
    viewer.poll(std::chrono::milliseconds(8));
    report_trouble(viewer);
    const LoopStatus loop = viewer.session().loop_status();
    if (!loop.running) break;
    if (loop.frames < last) earlier += last;
    last = loop.frames;
    if (frames > 0 && earlier + loop.frames >= frames) {
      const auto now = std::chrono::steady_clock::now();
      if (!over) over = now;
      const double since_s = std::chrono::duration<double>(now - *over).count();
      const bool page_was_here = viewer.server().status().pages_ever > 0;
      if (page_was_here ? viewer.alone_s() > kReload_s : since_s >= wait_s) break;
    }
    if (std::chrono::steady_clock::now() - last_line < std::chrono::milliseconds(100)) continue;
    last_line = std::chrono::steady_clock::now();
    status.show(viewer.session(), viewer.status());
  }
  viewer.stop();
  viewer.poll(std::chrono::microseconds(0));
  return viewer.session().frame_times().summary();
}

}  // namespace tactum
