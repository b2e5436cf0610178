#include "viewer/server/server.h"

#include <fmt/format.h>
#include <pthread.h>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "viewer/server/page.h"
#include "viewer/server/wire.h"

namespace tactum {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using beast::error_code;
using namespace std::chrono_literals;

constexpr std::size_t kLargestHeader = 8192;
constexpr int kMostConnections = 64;
constexpr int kMostMalformed = 20;  // of one page, then it is cut off
constexpr std::uint32_t kInFlight = 2;
constexpr std::uint32_t kFramesMessage = 1;
constexpr auto kPatience = 20s;  // with a client that says or takes nothing

using Body = std::shared_ptr<const std::string>;

Body shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

class Page;

/// What all connections share. Everything but the guarded part belongs to the server's thread.
struct Hub {
  int port = 0;
  std::string token = new_token();
  int connections = 0;
  RateLimit requests{200.0, 400.0};

  std::uint32_t run = 0;
  Body run_message = shared("{}"), geometry = shared(""), picture = shared(""), settings = shared("");
  Body program_status = shared("{}"), sentence = shared("");
  std::uint64_t pictures = 0, settings_versions = 0, statuses = 0, sentences = 0;
  History history;
  std::map<std::uint64_t, Page*> pages;  // by their number, which is never used twice
  std::uint64_t next_page = 1;
  std::uint64_t steering = 0;  // that page; 0: nobody

  mutable std::mutex guard;
  std::condition_variable arrived;
  std::deque<Request> inbox;
  ServerStatus status;

  void refuse(Refusal reason) {
    const std::lock_guard lock(guard);
    ++status.refused[static_cast<std::size_t>(reason)];
  }
  void ask(const Request& request) {
    constexpr std::size_t kRoom = 4096;
    const std::lock_guard lock(guard);
    if (inbox.size() < kRoom) inbox.push_back(request);
    arrived.notify_one();
  }
  template <class Change>
  void count(Change change) {
    const std::lock_guard lock(guard);
    change(status);
  }
  void feed_pages();

  asio::io_context io{1};  // last: what it still holds when it ends refers to the rest
};

/// One WebSocket. Owes its page at most one message of each kind, the newest.
class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(Hub& hub, beast::tcp_stream&& stream) : hub_(hub), socket_(std::move(stream)) { ++hub_.connections; }
  ~Page() { --hub_.connections; }
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  void start(http::request<http::empty_body> request) {
    request_ = std::move(request);
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kPatience;
    timeout.idle_timeout = kPatience;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(Server::kLargestMessage);
    socket_.auto_fragment(false);
    socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
      if (!error) self->opened();
    });
  }

  void feed() {
    if (!open_ || writing_) return;
    if (run_ != hub_.run) {
      run_ = hub_.run;
      place_ = hub_.history.newcomers_place();
      picture_ = 0;
      settings_ = hub_.settings_versions;
      return send(hub_.run_message, false);
    }
    if (settings_ != hub_.settings_versions) {
      settings_ = hub_.settings_versions;
      return send(hub_.settings, false);
    }
    if (sentence_ != hub_.sentences) {
      sentence_ = hub_.sentences;
      return send(hub_.sentence, false);
    }
    if (sent_ - acknowledged_ >= kInFlight) return;
    if (status_ != hub_.statuses) {
      status_ = hub_.statuses;
      return send(shared(status_text()), false);
    }
    if (picture_ != hub_.pictures || place_ != hub_.history.end()) send(shared(frames()), true);
  }

 private:
  void opened() {
    number_ = hub_.next_page++;
    hub_.pages[number_] = this;
    if (hub_.steering == 0) hub_.steering = number_;
    hub_.count([](ServerStatus& status) { ++status.pages, ++status.pages_ever; });
    open_ = true;
    sentence_ = hub_.sentences;
    ++hub_.statuses;
    read();
    hub_.feed_pages();
  }

  void close() {
    if (!open_) return;
    open_ = false;
    hub_.pages.erase(number_);
    hub_.count([](ServerStatus& status) { --status.pages; });
    if (hub_.steering == number_) end_steering();
    ++hub_.statuses;
  }

  /// Nobody leads the hand now: it stays where it is.
  void end_steering() {
    hub_.steering = 0;
    Request rest;
    rest.what = Request::What::kRest;
    hub_.ask(rest);
  }

  void read() {
    socket_.async_read(incoming_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        self->hub_.refuse(Refusal::kOversized);
      if (error) return self->close();
      self->take_in();
    });
  }

  void take_in() {
    const std::string text = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    if (!rate_.pass(RateLimit::Clock::now())) {
      hub_.refuse(Refusal::kTooFast);
      return cut_off();
    }
    const Result<Request> request =
        socket_.got_text() ? parse_request(text) : Result<Request>(Error{"binary", "", "", ""});
    if (!request) {
      hub_.refuse(Refusal::kMalformed);
      if (++malformed_ > kMostMalformed) return cut_off();
    } else {
      obey(*request);
    }
    read();
  }

  void cut_off() {
    close();
    socket_.async_close(websocket::close_code::policy_error, [self = shared_from_this()](error_code) {});
  }

  void obey(const Request& request) {
    using What = Request::What;
    if (request.what == What::kAck) {
      // Only what was sent can be acknowledged, and never backwards.
      if (request.sequence - acknowledged_ <= sent_ - acknowledged_) acknowledged_ = request.sequence;
      return feed();
    }
    if (request.what == What::kSteer || request.what == What::kRelease) {
      if (request.what == What::kSteer && hub_.steering != number_) {
        if (hub_.steering != 0) end_steering();
        hub_.steering = number_;
      } else if (request.what == What::kRelease && hub_.steering == number_) {
        end_steering();
      }
      ++hub_.statuses;
      return hub_.feed_pages();
    }
    if (request.steers() && hub_.steering != number_) return hub_.refuse(Refusal::kNotSteering);
    hub_.ask(request);
  }

  std::string status_text() const {
    nlohmann::ordered_json refused;
    std::size_t pages = 0;
    {
      const std::lock_guard lock(hub_.guard);
      for (int i = 0; i < kRefusalCount; ++i)
        refused[refusal_name(static_cast<Refusal>(i))] = hub_.status.refused[static_cast<std::size_t>(i)];
      pages = hub_.pages.size();
    }
    const nlohmann::ordered_json status = {{"type", "status"},
                                           {"pages", pages},
                                           {"steering", hub_.steering == number_},
                                           {"somebody_steers", hub_.steering != 0},
                                           {"samples_lost", lost_},
                                           {"refused", refused}};
    std::string text = status.dump();
    text.pop_back();
    return text + ",\"program\":" + *hub_.program_status + "}";
  }

  /// The newest picture, unless the page has it, and every sample since the last message.
  std::string frames() {
    std::string out;
    const bool newer = picture_ != hub_.pictures;
    const std::string& picture = newer ? *hub_.picture : std::string();
    const std::uint64_t lost_before = lost_;
    const auto numbers = static_cast<std::uint32_t>(chart_sample_size());
    for (std::uint32_t word :
         {kFramesMessage, ++sent_, run_, 0u, numbers, 0u, static_cast<std::uint32_t>(picture.size()), 0u})
      wire::put(out, word);
    out += picture;
    const std::size_t rows = hub_.history.write_rows(place_, lost_, out);
    wire::put_at(out, 3 * 4, static_cast<std::uint32_t>(rows));
    wire::put_at(out, 5 * 4, static_cast<std::uint32_t>(lost_));
    picture_ = hub_.pictures;
    const std::uint64_t lost = lost_ - lost_before;
    hub_.count([lost](ServerStatus& status) { ++status.frames_sent, status.samples_lost += lost; });
    return out;
  }

  void send(const Body& message, bool binary) {
    writing_ = message;
    socket_.binary(binary);
    socket_.async_write(asio::buffer(*message), [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_.reset();
      if (error) return self->close();
      self->feed();
    });
  }

  Hub& hub_;
  websocket::stream<beast::tcp_stream> socket_;
  http::request<http::empty_body> request_;
  beast::flat_buffer incoming_;
  RateLimit rate_{Server::kMessages_Hz, 2.0 * Server::kMessages_Hz};
  Body writing_;
  bool open_ = false;
  int malformed_ = 0;
  std::uint64_t number_ = 0;
  std::uint32_t sent_ = 0, acknowledged_ = 0;
  // What the page has: of each kind, up to which it was told.
  std::uint32_t run_ = 0;
  std::uint64_t picture_ = 0, settings_ = 0, status_ = 0, sentence_ = 0, place_ = 0, lost_ = 0;
};

void Hub::feed_pages() {
  std::vector<std::shared_ptr<Page>> now;  // a page that closes meanwhile leaves the map
  now.reserve(pages.size());
  for (const auto& [number, page] : pages) now.push_back(page->shared_from_this());
  for (const auto& page : now) page->feed();
}

/// One HTTP connection: the page's files and the geometry, until it asks to become a WebSocket.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Hub& hub, tcp::socket&& socket) : hub_(hub), stream_(std::move(socket)) { ++hub_.connections; }
  ~Visitor() { --hub_.connections; }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    parser_->body_limit(std::uint64_t{0});
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](error_code error, std::size_t) { self->have_read(error); });
  }

 private:
  void have_read(error_code error) {
    if (error == http::error::header_limit || error == http::error::body_limit ||
        error == http::error::buffer_overflow)
      return refuse(Refusal::kOversized, http::status::payload_too_large);
    if (error == http::error::end_of_stream || error == beast::error::timeout) return;
    if (error && error.category() == http::make_error_code(http::error::bad_method).category())
      return refuse(Refusal::kMalformed, http::status::bad_request);
    if (!error) answer(parser_->release());
  }

  void answer(http::request<http::empty_body>&& request) {
    const auto header = [&request](auto field) {
      const auto value = request[field];
      return std::string_view(value.data(), value.size());
    };
    if (!hub_.requests.pass(RateLimit::Clock::now()))
      return refuse(Refusal::kTooFast, http::status::too_many_requests);
    if (hub_.connections > kMostConnections)
      return refuse(Refusal::kTooMany, http::status::service_unavailable);
    if (!own_host(header(http::field::host), hub_.port))
      return refuse(Refusal::kForeignHost, http::status::forbidden);
    const std::string_view origin = header(http::field::origin);
    const bool upgrade = websocket::is_upgrade(request);
    if ((upgrade || !origin.empty()) && !own_origin(origin, hub_.port))
      return refuse(Refusal::kForeignOrigin, http::status::forbidden);
    if (!own_fetch_site(header("Sec-Fetch-Site")))
      return refuse(Refusal::kForeignOrigin, http::status::forbidden);
    std::string_view target(request.target().data(), request.target().size());
    const std::size_t slash = target.find('/', 1);
    if (target.empty() || slash == std::string_view::npos ||
        !same_secret(target.substr(1, slash - 1), hub_.token))
      return refuse(Refusal::kWrongToken, http::status::forbidden);
    target.remove_prefix(slash + 1);
    if (request.method() != http::verb::get)
      return refuse(Refusal::kMalformed, http::status::method_not_allowed);
    keep_alive_ = request.keep_alive();
    if (upgrade && target == "ws") return become_page(std::move(request));
    serve(target);
  }

  void become_page(http::request<http::empty_body>&& request) {
    if (static_cast<int>(hub_.pages.size()) >= Server::kMostPages)
      return refuse(Refusal::kTooMany, http::status::service_unavailable);
    stream_.expires_never();  // the WebSocket has its own patience
    std::make_shared<Page>(hub_, std::move(stream_))->start(std::move(request));
  }

  void serve(std::string_view path) {
    if (path == "geometry") return send(http::status::ok, "application/octet-stream", *hub_.geometry, false);
    for (const PageFile& file : page_files())
      if (path == file.path || (path.empty() && &file == page_files().data()))
        return send(http::status::ok, file.type, std::string(file.gzip), true);
    refuse(Refusal::kNotThere, http::status::not_found);
  }

  void refuse(Refusal reason, http::status status) {
    hub_.refuse(reason);
    keep_alive_ = false;
    send(status, "text/plain; charset=utf-8", fmt::format("refused: {}\n", refusal_name(reason)), false);
  }

  void send(http::status status, std::string_view type, std::string body, bool gzip) {
    const auto view = [](std::string_view text) { return beast::string_view(text.data(), text.size()); };
    response_ = {status, 11};
    response_.set(http::field::content_type, view(type));
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", content_policy(hub_.port));
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    if (gzip) response_.set(http::field::content_encoding, "gzip");
    response_.keep_alive(keep_alive_);
    response_.body() = std::move(body);
    response_.prepare_payload();
    stream_.expires_after(kPatience);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error && self->keep_alive_) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Hub& hub_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kLargestHeader + 1024};
  boost::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  bool keep_alive_ = false;
};

}  // namespace

struct Server::Impl {
  Hub hub;
  tcp::acceptor acceptor{hub.io};
  std::thread thread;

  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        std::make_shared<Visitor>(hub, std::move(socket))->read();
      }
      accept();
    });
  }
  template <class Work>
  void post(Work work) {
    asio::post(hub.io, std::move(work));
  }
};

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Server>> Server::start(int port) {
  auto impl = std::make_unique<Impl>();
  const tcp::endpoint here(asio::ip::address_v4::loopback(), static_cast<unsigned short>(port));
  error_code error;
  impl->acceptor.open(here.protocol(), error);
  if (!error) impl->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) impl->acceptor.bind(here, error);
  if (!error) impl->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    return Error{"the viewer cannot listen", error.message(),
                 "a port that is free; without --port one is found", fmt::format("127.0.0.1:{}", port)};
  impl->hub.port = impl->acceptor.local_endpoint().port();
  impl->accept();
  impl->thread = std::thread([hub = &impl->hub] {
    pthread_setname_np(pthread_self(), "tactum-viewer");
    hub->io.run();
  });
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

Server::~Server() {
  impl_->hub.io.stop();
  impl_->thread.join();
}

int Server::port() const noexcept { return impl_->hub.port; }
const std::string& Server::token() const noexcept { return impl_->hub.token; }
std::string Server::address() const { return fmt::format("http://127.0.0.1:{}/{}/", port(), token()); }

void Server::begin_run(std::uint32_t run, std::string message, std::string geometry) {
  impl_->post(
      [hub = &impl_->hub, run, message = shared(std::move(message)), geometry = shared(std::move(geometry))] {
        hub->run = run;
        hub->run_message = message;
        hub->geometry = geometry;
        hub->history.cut();
        hub->feed_pages();
      });
}

void Server::send_settings(std::string message, std::string run_message) {
  impl_->post([hub = &impl_->hub, message = shared(std::move(message)),
               run_message = shared(std::move(run_message))] {
    hub->settings = message;
    hub->run_message = run_message;
    ++hub->settings_versions;
    hub->feed_pages();
  });
}

void Server::show(std::span<const ChartSample> samples, std::string picture) {
  impl_->post([hub = &impl_->hub, samples = std::vector<ChartSample>(samples.begin(), samples.end()),
               picture = shared(std::move(picture))] {
    for (const ChartSample& sample : samples) hub->history.add(sample);
    if (!picture->empty()) {
      hub->picture = picture;
      ++hub->pictures;
    }
    hub->feed_pages();
  });
}

void Server::send_status(std::string json) {
  impl_->post([hub = &impl_->hub, json = shared(std::move(json))] {
    hub->program_status = json;
    ++hub->statuses;
    hub->feed_pages();
  });
}

void Server::send_notice(const std::string& sentence) {
  const nlohmann::json message = {{"type", "notice"}, {"sentence", sentence}};
  impl_->post([hub = &impl_->hub,
               text = shared(message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))] {
    hub->sentence = text;
    ++hub->sentences;
    hub->feed_pages();
  });
}

bool Server::take(Request& request) {
  const std::lock_guard lock(impl_->hub.guard);
  if (impl_->hub.inbox.empty()) return false;
  request = std::move(impl_->hub.inbox.front());
  impl_->hub.inbox.pop_front();
  return true;
}

void Server::wait(std::chrono::microseconds longest) {
  std::unique_lock lock(impl_->hub.guard);
  impl_->hub.arrived.wait_for(lock, longest, [this] { return !impl_->hub.inbox.empty(); });
}

ServerStatus Server::status() const {
  const std::lock_guard lock(impl_->hub.guard);
  return impl_->hub.status;
}

}  // namespace tactum
