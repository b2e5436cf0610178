#include "viewer/server/bridge_connection.h"

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <optional>
#include <vector>

#include "viewer/server/loopback.h"

namespace tactum {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using beast::error_code;

constexpr std::size_t kMostWaiting = std::size_t{1} << 20;      // of messages that may give way [bytes]
constexpr std::size_t kMostOwed = std::size_t{64} << 20;        // of those that may not [bytes]
constexpr std::size_t kLargestReceived = std::size_t{1} << 16;  // [bytes]
constexpr int kMostClients = 16;
constexpr int kMostNotUnderstood = 20;   // of one client, then it is cut off
constexpr double kReceived_Hz = 2000.0;  // from a client, in the long run: a hand led at 1 kHz, and more
constexpr const char* kFoxgloveSubprotocol = "foxglove.websocket.v1";

/// Whether a list of a header, divided by commas, has this word.
bool lists(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view one = list.substr(0, comma);
    while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
    while (!one.empty() && one.back() == ' ') one.remove_suffix(1);
    if (one == word) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

}  // namespace

bool bridge_origin(std::string_view origin) {
  if (origin.empty() || origin == "file://" || origin == "https://app.foxglove.dev") return true;
  for (const std::string_view here : {"http://127.0.0.1", "http://localhost", "https://localhost"})
    if (origin == here || (origin.starts_with(here) && origin[here.size()] == ':' &&
                           origin.find_first_not_of("0123456789", here.size() + 1) == std::string_view::npos))
      return true;
  return false;
}

class BridgeConnection final : public BridgeLine, public std::enable_shared_from_this<BridgeConnection> {
 public:
  BridgeConnection(BridgeHub& hub, BridgeProtocol protocol, int port, tcp::socket&& socket)
      : hub_(hub), protocol_(protocol), port_(port), socket_(std::move(socket)) {
    ++hub_.connections;
    if (protocol == BridgeProtocol::kRosbridge)
      speaker_ = speak_rosbridge(hub.topics, *this, hub.led ? &hub.inbox : nullptr);
    else
      speaker_ = speak_foxglove(hub.topics, *this);
  }
  ~BridgeConnection() override { --hub_.connections; }
  BridgeConnection(const BridgeConnection&) = delete;
  BridgeConnection& operator=(const BridgeConnection&) = delete;

  void start() {
    stream().expires_after(kClientTimeout);
    parser_.body_limit(std::uint64_t{0});
    http::async_read(stream(), incoming_, parser_,
                     [self = shared_from_this()](error_code error, std::size_t) {
                       if (!error) self->answer();
                     });
  }

  BridgeSpeaker& speaker() { return *speaker_; }

  void owe(std::string message, bool binary) override {
    owed_bytes_ += message.size();
    if (owed_bytes_ > kMostOwed) return cut_off();
    waiting_.push_back({shared_text(std::move(message)), binary, false});
    write();
  }

  void offer(std::string message, bool binary) override {
    offered_bytes_ += message.size();
    waiting_.push_back({shared_text(std::move(message)), binary, true});
    // The oldest give way, but for the one that is being written.
    for (std::size_t i = writing_ ? 1 : 0; offered_bytes_ > kMostWaiting && i + 1 < waiting_.size();) {
      if (!waiting_[i].droppable) {
        ++i;
        continue;
      }
      offered_bytes_ -= waiting_[i].text->size();
      waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
      ++lost_;
    }
    write();
  }

 private:
  struct Waiting {
    SharedText text;
    bool binary = false;
    bool droppable = false;
  };

  beast::tcp_stream& stream() { return socket_.next_layer(); }

  void answer() {
    request_ = parser_.release();
    const auto header = [this](auto field) {
      const auto value = request_[field];
      return std::string_view(value.data(), value.size());
    };
    const bool rosbridge = protocol_ == BridgeProtocol::kRosbridge;
    if (hub_.connections > kMostClients)
      return refuse(http::status::service_unavailable, "There are too many clients.\n");
    if (!own_host(header(http::field::host), port_) || !bridge_origin(header(http::field::origin)))
      return refuse(http::status::forbidden,
                    "Only programs and pages of this machine, and Foxglove, may connect to this bridge.\n");
    if (!websocket::is_upgrade(request_))
      return refuse(http::status::upgrade_required,
                    rosbridge ? "This is a WebSocket that speaks rosbridge.\n"
                              : "This is a WebSocket that speaks foxglove.websocket.v1.\n");
    if (!rosbridge && !lists(header(http::field::sec_websocket_protocol), kFoxgloveSubprotocol))
      return refuse(http::status::bad_request,
                    "This bridge speaks foxglove.websocket.v1, which the client did not offer.\n");
    accept(rosbridge);
  }

  void accept(bool rosbridge) {
    stream().expires_never();  // the WebSocket has its own patience
    set_limits(socket_, kLargestReceived);
    if (!rosbridge)
      socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, kFoxgloveSubprotocol);
      }));
    incoming_.consume(incoming_.size());
    socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
      if (!error) self->opened();
    });
  }

  void refuse(http::status status, const char* sentence) {
    response_ = {status, 11};
    response_.set(http::field::content_type, "text/plain; charset=utf-8");
    response_.keep_alive(false);
    response_.body() = sentence;
    response_.prepare_payload();
    stream().expires_after(kClientTimeout);
    http::async_write(stream(), response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  void opened() {
    number_ = hub_.next_client++;
    hub_.clients[number_] = this;
    hub_.clients_now.fetch_add(1, std::memory_order_relaxed);
    open_ = true;
    speaker_->opened();
    read();
  }

  void close() {
    if (!open_) return;
    open_ = false;
    hub_.clients.erase(number_);
    hub_.clients_now.fetch_sub(1, std::memory_order_relaxed);
    speaker_->closed();
  }

  void cut_off() {
    if (!open_) return;
    close();
    socket_.async_close(websocket::close_code::policy_error, [self = shared_from_this()](error_code) {});
  }

  void read() {
    socket_.async_read(incoming_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->close();
      self->take_in();
    });
  }

  void take_in() {
    const std::string message = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    if (!rate_.pass(RateLimit::Clock::now())) return cut_off();
    if (!speaker_->received(message, socket_.got_text()) && ++not_understood_ > kMostNotUnderstood)
      return cut_off();
    if (open_) read();
  }

  void write() {
    if (writing_ || !open_ || waiting_.empty()) return;
    writing_ = true;
    socket_.binary(waiting_.front().binary);
    socket_.async_write(asio::buffer(*waiting_.front().text),
                        [self = shared_from_this()](error_code error, std::size_t) { self->written(error); });
  }

  void written(error_code error) {
    writing_ = false;
    if (error) return close();
    const Waiting& done = waiting_.front();
    (done.droppable ? offered_bytes_ : owed_bytes_) -= done.text->size();
    waiting_.pop_front();
    if (waiting_.empty() && lost_ > lost_reported_) {
      lost_reported_ = lost_;
      speaker_->lost(lost_);
    }
    write();
  }

  BridgeHub& hub_;
  BridgeProtocol protocol_;
  int port_;
  websocket::stream<beast::tcp_stream> socket_;
  http::request_parser<http::empty_body> parser_;
  http::request<http::empty_body> request_;
  http::response<http::string_body> response_;
  beast::flat_buffer incoming_;
  RateLimit rate_{kReceived_Hz, 2.0 * kReceived_Hz};
  std::unique_ptr<BridgeSpeaker> speaker_;
  std::deque<Waiting> waiting_;  // the first is the one that is being written, while one is
  std::size_t offered_bytes_ = 0, owed_bytes_ = 0;
  std::uint64_t lost_ = 0, lost_reported_ = 0, number_ = 0;
  int not_understood_ = 0;
  bool open_ = false, writing_ = false;
};

void serve_bridge(BridgeHub& hub, BridgeProtocol protocol, int port, tcp::socket&& socket) {
  std::make_shared<BridgeConnection>(hub, protocol, port, std::move(socket))->start();
}

void show_to_clients(BridgeHub& hub, BridgeMoment& moment) {
  std::vector<std::shared_ptr<BridgeConnection>> now;  // a client that closes meanwhile leaves the map
  now.reserve(hub.clients.size());
  for (const auto& [number, client] : hub.clients) now.push_back(client->shared_from_this());
  for (const auto& client : now) client->speaker().show(moment);
}

}  // namespace tactum
