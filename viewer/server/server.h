#pragma once
/// HTTP and WebSocket on the loopback interface, on one thread of its own: serves the page, shows it the
/// frames of the loop, and takes in its requests (access.h decides who may; docs/viewer.md draws the
/// messages).
///
///   owner's thread: begin_run, show, send_status ---posted--->  server's thread  <---> pages
///                   take, wait                   <---inbox----
///
/// A page acknowledges every message with frames. While two are on their way it is sent none, so that a slow
/// page gets the newest picture when it is ready, never a queue of old ones; the chart samples it missed
/// meanwhile come with it (history.h). One page steers at a time; anyone may stop.

#include <atomic>
#include <chrono>
#include <memory>
#include <span>
#include <string>

#include "tactum/base/result.h"
#include "viewer/server/access.h"
#include "viewer/server/history.h"
#include "viewer/server/request.h"

namespace tactum {

struct ServerStatus {
  int pages = 0;  ///< connected now
  std::uint64_t pages_ever = 0;
  RefusalCounts refused{};
  std::uint64_t frames_sent = 0;   ///< messages with frames, to all pages
  std::uint64_t samples_lost = 0;  ///< chart samples that were gone before a page was ready, all pages
};

class Server {
 public:
  static constexpr std::size_t kLargestMessage = 4096;  ///< from a page [bytes]
  static constexpr int kMostPages = 16;
  static constexpr double kMessages_Hz = 400.0;  ///< from a page, in the long run; faster is cut off

  /// Listens on 127.0.0.1. Port 0 takes one that is free. An error gives the reason.
  static Result<std::unique_ptr<Server>> start(int port);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const noexcept;
  const std::string& token() const noexcept;
  /// The address to open in a browser, token included.
  std::string address() const;

  /// A run begins: its message and its geometry, for pages that are here and for those to come.
  void begin_run(std::uint32_t run, std::string message, std::string geometry);
  /// The settings as they are now, as a message; and the run's message with them, for those to come.
  void send_settings(std::string message, std::string run_message);
  /// Frames that are over, and the newest picture with its frame, whose sample is among these or was shown
  /// before; an empty picture means no newer one. No page gets a picture without that sample.
  void show(std::span<const ChartSample> samples, std::string picture, std::uint64_t frame);
  /// A JSON object for every page, beside the server's own status.
  void send_status(std::string json);
  /// A sentence for all pages, such as why a scene could not be opened.
  void send_notice(const std::string& sentence);

  /// The next request of a page; false when there is none.
  bool take(Request& request);
  /// Waits for one, at most so long.
  void wait(std::chrono::microseconds longest);
  ServerStatus status() const;
  /// Whether a page has asked to stop: true from the moment its request arrives, however busy the owner is,
  /// until the owner takes a request to resume. Lives as long as the server.
  const std::atomic<bool>& stop_asked() const;

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactum
