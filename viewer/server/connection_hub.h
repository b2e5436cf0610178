#pragma once
/// The state common to all connections of the viewer's server: the messages for every page, the open pages,
/// the page that steers, and the requests of pages.

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "viewer/server/access.h"
#include "viewer/server/history.h"
#include "viewer/server/request.h"
#include "viewer/server/server.h"

namespace tactum {

class PageConnection;

/// A text that several connections may be writing at once.
using SharedText = std::shared_ptr<const std::string>;

inline SharedText shared_text(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

/// The longest time that a client may neither send nor take anything.
inline constexpr std::chrono::seconds kClientTimeout{20};

/// A message of which a page needs only the newest.
struct LatestMessage {
  SharedText text = shared_text("");
  std::uint64_t version = 0;  ///< counted up with every change

  void replace(SharedText newer) {
    text = std::move(newer);
    ++version;
  }
};

/// The run that is shown.
struct PageRun {
  std::uint32_t number = 0;
  SharedText message = shared_text("{}");
  SharedText geometry = shared_text("");
};

/// The requests of pages that the owner has not yet taken, and counts of events. The server's thread and its
/// owner's thread both use it, under one lock.
class RequestInbox {
 public:
  void refuse(Refusal reason) {
    count([reason](ServerStatus& status) { ++status.refused[static_cast<std::size_t>(reason)]; });
  }
  /// Adds a request, unless too many wait already.
  void ask(const Request& request) {
    constexpr std::size_t kCapacity = 4096;
    const std::lock_guard lock(guard_);
    if (request.what == Request::What::kStop) stop_asked_.store(true, std::memory_order_relaxed);
    if (waiting_.size() < kCapacity) waiting_.push_back(request);
    arrived_.notify_one();
  }
  template <class Change>
  void count(Change change) {
    const std::lock_guard lock(guard_);
    change(status_);
  }
  /// The oldest request; false when there is none.
  bool take(Request& request) {
    const std::lock_guard lock(guard_);
    if (waiting_.empty()) return false;
    request = std::move(waiting_.front());
    waiting_.pop_front();
    const auto stops = [](const Request& one) { return one.what == Request::What::kStop; };
    if (request.what == Request::What::kResume && std::none_of(waiting_.begin(), waiting_.end(), stops))
      stop_asked_.store(false, std::memory_order_relaxed);
    return true;
  }
  /// Whether a page has asked to stop, from that moment on until its owner takes a request to resume.
  const std::atomic<bool>& stop_asked() const { return stop_asked_; }
  /// Waits for a request, at most so long.
  void wait(std::chrono::microseconds longest) {
    std::unique_lock lock(guard_);
    arrived_.wait_for(lock, longest, [this] { return !waiting_.empty(); });
  }
  ServerStatus status() const {
    const std::lock_guard lock(guard_);
    return status_;
  }

 private:
  mutable std::mutex guard_;
  std::condition_variable arrived_;
  std::deque<Request> waiting_;
  std::atomic<bool> stop_asked_{false};
  ServerStatus status_;
};

/// Everything but the inbox belongs to the server's thread.
struct ConnectionHub {
  int port = 0;
  std::string token = new_token();
  int connections = 0;
  RateLimit requests{200.0, 400.0};

  PageRun run;
  LatestMessage picture, settings, sentence;
  std::uint64_t picture_place = 0;                     // in the history, of the sample of the picture's frame
  LatestMessage program_status{shared_text("{}"), 0};  // a new version also when another page steers
  History history;
  std::map<std::uint64_t, PageConnection*> pages;  // by their number, which is never used twice
  std::uint64_t next_page = 1;
  std::uint64_t steering = 0;                      // that page; 0: nobody
  std::map<std::uint32_t, std::uint64_t> leading;  // by hand after the first: the page that leads it

  RequestInbox inbox;

  /// Sends every page what it does not have yet.
  void feed_pages();

  boost::asio::io_context io{1};  // last: what it still holds when it ends refers to the rest
};

}  // namespace tactum
