#include "viewer/server/bridge.h"

#include <fmt/format.h>
#include <pthread.h>

#include <boost/asio/post.hpp>
#include <charconv>
#include <deque>
#include <thread>

#include "viewer/server/bridge_connection.h"
#include "viewer/server/loopback.h"

namespace tactum {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr int kRosbridgePort = 9090, kFoxglovePort = 8765;  // the usual ones

const char* protocol_name(BridgeProtocol protocol) {
  return protocol == BridgeProtocol::kRosbridge ? "rosbridge" : "foxglove";
}

}  // namespace

struct ShownPicture {
  FramePicture picture;
  std::uint64_t time_ns = 0;
};

/// What send() passes on.
struct Batch {
  std::vector<BridgeFrame> frames;
  std::vector<ShownPicture> pictures;
};

Result<BridgeChoice> parse_bridge(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string name = text.substr(0, colon);
  BridgeChoice choice;
  const Error wrong{"there is no such bridge", text,
                    "rosbridge, foxglove, or one of them with :PORT, 0 to 65535", ""};
  if (name != "rosbridge" && name != "foxglove") return wrong;
  choice.protocol = name == "rosbridge" ? BridgeProtocol::kRosbridge : BridgeProtocol::kFoxglove;
  choice.port = choice.protocol == BridgeProtocol::kRosbridge ? kRosbridgePort : kFoxglovePort;
  if (colon == text.size()) return choice;
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data() + colon + 1, end, choice.port);
  if (fault != std::errc() || stop != end || choice.port < 0 || choice.port > 65535) return wrong;
  return choice;
}

struct Bridge::Impl {
  explicit Impl(BridgeTopics topics) : hub(std::move(topics)) {}
  BridgeHub hub;
  std::deque<LoopbackListener> listeners;
  std::vector<std::string> sentences;
  std::vector<int> ports;
  Batch batch;
  std::atomic<int> unseen{0};  // batches that the bridge's thread has not seen
  std::thread thread;
};

Bridge::Bridge(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Bridge>> Bridge::start(const std::vector<BridgeChoice>& choices, BridgeTopics topics,
                                              bool led) {
  auto impl = std::make_unique<Impl>(std::move(topics));
  impl->hub.led = led;
  for (const BridgeChoice& choice : choices) {
    LoopbackListener& listener = impl->listeners.emplace_back(impl->hub.io);
    const auto serve = [hub = &impl->hub, &listener, protocol = choice.protocol](tcp::socket&& socket) {
      serve_bridge(*hub, protocol, listener.port(), std::move(socket));
    };
    const char* const name = protocol_name(choice.protocol);
    if (const error_code error = listener.listen(choice.port, serve))
      return Error{fmt::format("the bridge of {} cannot listen", name), error.message(),
                   fmt::format("a port that is free, as --bridge {}:PORT", name),
                   fmt::format("127.0.0.1:{}", choice.port)};
    impl->ports.push_back(listener.port());
    impl->sentences.push_back(fmt::format("{} at ws://127.0.0.1:{}", name, listener.port()));
  }
  impl->thread = std::thread([hub = &impl->hub] {
    pthread_setname_np(pthread_self(), "tactum-bridge");
    hub->io.run();
  });
  return std::unique_ptr<Bridge>(new Bridge(std::move(impl)));
}

Bridge::~Bridge() {
  impl_->hub.io.stop();
  impl_->thread.join();
  impl_->listeners.clear();
}

const std::vector<std::string>& Bridge::sentences() const noexcept { return impl_->sentences; }
const std::vector<int>& Bridge::ports() const noexcept { return impl_->ports; }
int Bridge::clients() const noexcept { return impl_->hub.clients_now.load(std::memory_order_relaxed); }

void Bridge::show_frame(BridgeFrame frame) {
  if (clients() > 0) impl_->batch.frames.push_back(std::move(frame));
}

void Bridge::show_picture(const FramePicture& picture, std::uint64_t time_ns) {
  if (clients() > 0) impl_->batch.pictures.push_back({picture, time_ns});
}

void Bridge::send() {
  constexpr int kMostUnseen = 64;
  Batch batch = std::exchange(impl_->batch, {});
  if (batch.frames.empty() && batch.pictures.empty()) return;
  // A thread that is far behind is given no more: what it has not seen is old anyway.
  if (impl_->unseen.load() >= kMostUnseen) return;
  ++impl_->unseen;
  asio::post(impl_->hub.io, [impl = impl_.get(), batch = std::move(batch)] {
    --impl->unseen;
    for (const BridgeFrame& frame : batch.frames) {
      BridgeMoment moment(impl->hub.topics, frame);
      show_to_clients(impl->hub, moment);
    }
    for (const ShownPicture& shown : batch.pictures) {
      BridgeMoment moment(impl->hub.topics, shown.picture, shown.time_ns);
      show_to_clients(impl->hub, moment);
    }
  });
}

bool Bridge::take(Request& request) { return impl_->hub.inbox.take(request); }

}  // namespace tactum
