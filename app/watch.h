#pragma once
/// Functions common to the commands that run until they are interrupted: interrupts, the status line, the
/// page.

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>

#include "viewer/server/viewer.h"

namespace tactum {

/// From here on Ctrl-C only asks to stop, so that the wrench can be led to zero first.
void watch_for_interrupts();
bool interrupted();

/// One line about the forces, overwritten in place, only on a terminal.
class StatusLine {
 public:
  void show(const Session& session, const SessionStatus& status);
  ~StatusLine();

 private:
  /// Frames a second since the last call.
  double rate(std::uint64_t frame);
  bool on_terminal_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::uint64_t last_frame_ = 0;
};

/// Says once why a viewed run is not recorded any more, while it goes on.
void report_trouble(Viewer& viewer);

/// Prints the page's address, and opens it where there is a screen.
void open_page(std::FILE* out, const std::string& address);

/// Runs the loop on its own thread until it is interrupted; or, where an end was asked for, until that many
/// frames are over and no page is open any more, nor has been waited for so long. The times of the frames.
Summary run_viewed(Viewer& viewer, std::uint64_t frames, double wait_s = 0.0);

}  // namespace tactum
