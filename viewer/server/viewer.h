#pragma once
/// A session that can be seen and steered from a page: runs it, shows it, and carries out the page's
/// requests.
///
///   loop thread  --- FrameFeed --->  poll() on the owner's thread  --- Server --->  pages
///                <-- commands ---                                  <-- inbox ---
///
/// Scenes, devices and settings that need it start the session anew; the big stop outlives that.

#include <deque>
#include <memory>

#include "viewer/server/run_recording.h"
#include "viewer/server/scene_message.h"
#include "viewer/server/server.h"

namespace tactum {

/// What follows the runs of a viewer beside its pages, as bridges do. It is called on the thread that polls.
class RunFollower {
 public:
  virtual ~RunFollower() = default;
  /// A session was opened. Its run has not begun.
  virtual void begin(Session& session) = 0;
  /// Its run goes on; called at every poll.
  virtual void go_on() = 0;
  /// The picture of a frame, before pages see it.
  virtual void see(const FramePicture& picture) = 0;
  /// The run is over, and the session is about to be closed.
  virtual void end() = 0;
};

class Viewer {
 public:
  /// Opens the session and the server; `port` 0 finds a free one. The scene's simulated device is led by the
  /// page unless the options name another device. The page shows the remarks on the scene. `description` is
  /// what the scene was built from: without it the run cannot be recorded.
  static Result<std::unique_ptr<Viewer>> open(Scene scene, SessionOptions options, int port,
                                              std::vector<SceneRemark> remarks = {},
                                              std::optional<SceneDescription> description = {});

  /// Records the run into this file; before it begins. A page may end that, and begin others.
  Result<void> record(const std::string& path);
  /// Ends the recording that is open, if one is; all of them.
  std::vector<RecordingFile> end_recording();
  /// Why a recording could not go on, as a sentence for the terminal, which pages were told: once, then
  /// empty.
  std::string take_recording_trouble() { return std::exchange(recording_trouble_, ""); }

  /// Begins the follower with the session that is open; before its run. Null: none any more.
  void let_follow(RunFollower* follower);

  /// The loop on its own thread.
  Result<void> start();
  void stop() noexcept { session_->stop(); }
  /// Waits for the pages' requests for at most `longest`, does what they ask, and shows them what happened
  /// since.
  void poll(std::chrono::microseconds longest);
  /// The same for a run on the virtual clock: call it after every frame.
  void after_virtual_frame(const FrameRecord& record);

  Session& session() noexcept { return *session_; }
  const StageClock& stages() const noexcept { return *stages_; }
  const Server& server() const noexcept { return *server_; }
  const SessionStatus& status() const noexcept { return newest_; }
  /// How long no page has been here [s]; zero while there is one.
  double alone_s() const noexcept;

 private:
  using Clock = std::chrono::steady_clock;
  Viewer(Scene scene, SessionOptions options, std::unique_ptr<Server> server,
         std::vector<SceneRemark> remarks, std::optional<SceneDescription> description);

  Result<void> begin_run();
  void begin_recording();
  void end_recording_by_page();
  void watch_recording();
  void restart();
  void obey(const Request& request);
  void set(const Request& request);
  void unset(const Request& request);
  void apply(const SettingInfo& setting, double value);
  void remember_usual();
  ShownSettings shown_settings() const;
  std::string message_of_run() const;
  void change_scene(const std::string& name);
  void change_device(const std::string& name, std::string SessionOptions::*choice);
  void gather();
  void show();
  void send_settings();
  std::string status_json();

  Scene scene_;                  // as it starts, with the settings as they are now
  UserSettings usual_;           // as the scene has them
  bool device_chooses_ = false;  // the scene leaves the coupling to the device
  std::vector<SceneRemark> remarks_;
  std::optional<SceneDescription> description_;
  SessionOptions options_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<FrameFeed> feed_;
  std::unique_ptr<StageClock> stages_;
  std::unique_ptr<Session> session_;
  RunRecording recording_;  // ends before its session does
  RunFollower* follower_ = nullptr;
  std::string recording_trouble_;
  std::uint32_t run_ = 0;
  bool threaded_ = false;
  bool stopped_ = false;  // the big stop
  SessionStatus newest_;
  std::deque<FrameSample> waiting_;   // for their times
  std::vector<FrameTiming> timings_;  // for their samples
  std::vector<ChartSample> ready_;
  std::uint64_t frames_ready_ = 0;  // the pages have, or are about to have, the numbers of all before it
  bool picture_waits_ = false;      // the feed's picture, for the numbers of its frame
  std::uint64_t virtual_frames_ = 0;
  Clock::time_point last_shown_, last_status_;
  Clock::time_point last_page_ = Clock::now();
};

}  // namespace tactum
