#pragma once
/// A recording that is seen on a page: its frames are computed again, as fast as they were or slower, and any
/// of them can be gone to. Everything on one thread, that of its owner.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tactum/recording/replayed_run.h"
#include "viewer/server/scene_message.h"
#include "viewer/server/server.h"

namespace tactum {

class ReplayViewer {
 public:
  static constexpr double kFastest = 16.0;  ///< times the speed of the run

  /// Opens the server; `port` 0 finds a free one. The recording begins to play when a page is there.
  static Result<std::unique_ptr<ReplayViewer>> open(std::unique_ptr<ReplayedRun> run, int port);

  /// Waits for the pages' requests for at most `longest`, does what they ask, computes the frames that are
  /// due, and shows them.
  void poll(std::chrono::microseconds longest);
  const Server& server() const noexcept { return *server_; }

 private:
  using Clock = std::chrono::steady_clock;
  ReplayViewer(std::unique_ptr<ReplayedRun> run, std::unique_ptr<Server> server);

  void obey(const Request& request);
  void seek(std::uint64_t frame);
  void play(double speed);
  void advance();
  bool step();
  void show(bool with_status);
  std::string status_json() const;

  std::unique_ptr<ReplayedRun> run_;
  std::unique_ptr<Server> server_;
  FrameFeed feed_;
  std::vector<ChartSample> ready_;
  double speed_ = 1.0;       // 0: it stands still
  double due_ = 0.0;         // frames that are to be computed, and the part of one
  std::uint64_t shown_ = 0;  // the frame that is shown
  Clock::time_point last_advance_, last_shown_, last_status_;
};

}  // namespace tactum
