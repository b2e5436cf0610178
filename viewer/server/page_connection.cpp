#include "viewer/server/page_connection.h"

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "viewer/server/loopback.h"
#include "viewer/server/wire.h"

namespace tactum {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using beast::error_code;

constexpr int kMostMalformed = 20;  // of one page, then it is cut off
constexpr std::uint32_t kMostUnacknowledged = 2;
constexpr std::uint32_t kFramesMessage = 1;

}  // namespace

/// One WebSocket. Owes its page at most one message of each kind, the newest.
class PageConnection : public std::enable_shared_from_this<PageConnection> {
 public:
  PageConnection(ConnectionHub& hub, beast::tcp_stream&& stream) : hub_(hub), socket_(std::move(stream)) {
    ++hub_.connections;
  }
  ~PageConnection() { --hub_.connections; }
  PageConnection(const PageConnection&) = delete;
  PageConnection& operator=(const PageConnection&) = delete;

  void start(http::request<http::empty_body> request) {
    request_ = std::move(request);
    set_limits(socket_, Server::kLargestMessage);
    socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
      if (!error) self->opened();
    });
  }

  void feed() {
    if (!open_ || writing_) return;
    if (run_ != hub_.run.number) {
      run_ = hub_.run.number;
      place_ = unbroken_since_ = hub_.history.newcomers_place();
      picture_ = 0;
      settings_ = hub_.settings.version;
      return send(hub_.run.message, false);
    }
    if (settings_ != hub_.settings.version) {
      settings_ = hub_.settings.version;
      return send(hub_.settings.text, false);
    }
    if (sentence_ != hub_.sentence.version) {
      sentence_ = hub_.sentence.version;
      return send(hub_.sentence.text, false);
    }
    if (sent_ - acknowledged_ >= kMostUnacknowledged) return;
    if (status_ != hub_.program_status.version) {
      status_ = hub_.program_status.version;
      return send(shared_text(status_text()), false);
    }
    if (picture_ != hub_.picture.version || place_ != hub_.history.end()) send(shared_text(frames()), true);
  }

 private:
  void opened() {
    number_ = hub_.next_page++;
    hub_.pages[number_] = this;
    if (hub_.steering == 0) hub_.steering = number_;
    hub_.inbox.count([](ServerStatus& status) { ++status.pages, ++status.pages_ever; });
    open_ = true;
    sentence_ = hub_.sentence.version;
    ++hub_.program_status.version;
    read();
    hub_.feed_pages();
  }

  void close() {
    if (!open_) return;
    open_ = false;
    hub_.pages.erase(number_);
    hub_.inbox.count([](ServerStatus& status) { --status.pages; });
    give_up();
    ++hub_.program_status.version;
  }

  /// No page leads the first hand now: it stays where it is.
  void stop_steering() {
    hub_.steering = 0;
    rest(0);
  }
  void rest(std::uint32_t hand) {
    Request rest;
    rest.what = Request::What::kRest;
    rest.hand = hand;
    hub_.inbox.ask(rest);
  }
  /// This page steers and leads no more.
  void give_up() {
    if (hub_.steering == number_) stop_steering();
    for (const auto& [hand, page] : hub_.leading)
      if (page == number_) rest(hand);
    std::erase_if(hub_.leading, [this](const auto& led) { return led.second == number_; });
  }
  /// A hand after the first is led by one page at a time: whichever takes it, until that leaves it.
  void lead(const Request& request) {
    const auto led = hub_.leading.find(request.hand);
    const bool free = led == hub_.leading.end();
    if (!free && led->second != number_) return hub_.inbox.refuse(Refusal::kNotSteering);
    const bool takes = request.what == Request::What::kAim;
    if (takes) hub_.leading[request.hand] = number_;
    if (!takes && !free) hub_.leading.erase(led);
    if (request.what != Request::What::kLeave) hub_.inbox.ask(request);
    if (takes != free) return;  // the pages know
    ++hub_.program_status.version;
    hub_.feed_pages();
  }

  void read() {
    socket_.async_read(incoming_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        self->hub_.inbox.refuse(Refusal::kOversized);
      if (error) return self->close();
      self->take_in();
    });
  }

  void take_in() {
    const std::string text = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    if (!rate_.pass(RateLimit::Clock::now())) {
      hub_.inbox.refuse(Refusal::kTooFast);
      return cut_off();
    }
    const Result<Request> request =
        socket_.got_text() ? parse_request(text) : Result<Request>(Error{"binary", "", "", ""});
    if (!request) {
      hub_.inbox.refuse(Refusal::kMalformed);
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
        if (hub_.steering != 0) stop_steering();
        hub_.steering = number_;
      } else if (request.what == What::kRelease) {
        give_up();
      }
      ++hub_.program_status.version;
      return hub_.feed_pages();
    }
    if (request.leads_another()) return lead(request);
    if (request.steers() && hub_.steering != number_) return hub_.inbox.refuse(Refusal::kNotSteering);
    hub_.inbox.ask(request);
    if (request.what != Request::What::kStop) return;
    ++hub_.program_status.version;  // tells every page that the stop has arrived
    hub_.feed_pages();
  }

  /// The hands after the first that other pages lead.
  std::vector<std::uint32_t> led_elsewhere() const {
    std::vector<std::uint32_t> hands;
    for (const auto& [hand, page] : hub_.leading)
      if (page != number_) hands.push_back(hand);
    return hands;
  }

  std::string status_text() const {
    const RefusalCounts counts = hub_.inbox.status().refused;
    nlohmann::ordered_json refused;
    for (int i = 0; i < kRefusalCount; ++i)
      refused[refusal_name(static_cast<Refusal>(i))] = counts[static_cast<std::size_t>(i)];
    const nlohmann::ordered_json status = {{"type", "status"},
                                           {"pages", hub_.pages.size()},
                                           {"steering", hub_.steering == number_},
                                           {"somebody_steers", hub_.steering != 0},
                                           {"led_elsewhere", led_elsewhere()},
                                           {"stop_asked", hub_.inbox.stop_asked().load()},
                                           {"samples_lost", lost_},
                                           {"refused", refused}};
    std::string text = status.dump();
    text.pop_back();
    return text + ",\"program\":" + *hub_.program_status.text + "}";
  }

  /// The newest picture, unless the page has it or is too late for the sample of its frame, and every sample
  /// since the last message.
  std::string frames() {
    std::string out;
    if (place_ < hub_.history.oldest()) unbroken_since_ = hub_.history.oldest();
    const bool newer = picture_ != hub_.picture.version && hub_.picture_place >= unbroken_since_;
    const std::string& picture = newer ? *hub_.picture.text : std::string();
    const std::uint64_t lost_before = lost_;
    for (std::uint32_t word :
         {kFramesMessage, ++sent_, run_, 0u, 0u, 0u, static_cast<std::uint32_t>(picture.size()), 0u})
      wire::put(out, word);
    out += picture;
    const History::Rows rows = hub_.history.write_rows(place_, lost_, out);
    wire::put_at(out, 3 * 4, rows.count);
    wire::put_at(out, 4 * 4, rows.numbers);
    wire::put_at(out, 5 * 4, static_cast<std::uint32_t>(lost_));
    picture_ = hub_.picture.version;
    const std::uint64_t lost = lost_ - lost_before;
    hub_.inbox.count([lost](ServerStatus& status) { ++status.frames_sent, status.samples_lost += lost; });
    return out;
  }

  void send(const SharedText& message, bool binary) {
    writing_ = message;
    socket_.binary(binary);
    socket_.async_write(asio::buffer(*message), [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_.reset();
      if (error) return self->close();
      self->feed();
    });
  }

  ConnectionHub& hub_;
  websocket::stream<beast::tcp_stream> socket_;
  http::request<http::empty_body> request_;
  beast::flat_buffer incoming_;
  RateLimit rate_{Server::kMessages_Hz, 2.0 * Server::kMessages_Hz};
  SharedText writing_;
  bool open_ = false;
  int malformed_ = 0;
  std::uint64_t number_ = 0;
  std::uint32_t sent_ = 0, acknowledged_ = 0;
  // What the page has: of each kind, up to which it was told.
  std::uint32_t run_ = 0;
  std::uint64_t picture_ = 0, settings_ = 0, status_ = 0, sentence_ = 0, place_ = 0, lost_ = 0;
  std::uint64_t unbroken_since_ = 0;  // the place since which the page has got every sample
};

void ConnectionHub::feed_pages() {
  std::vector<std::shared_ptr<PageConnection>> now;  // a page that closes meanwhile leaves the map
  now.reserve(pages.size());
  for (const auto& [number, page] : pages) now.push_back(page->shared_from_this());
  for (const auto& page : now) page->feed();
}

void open_page(ConnectionHub& hub, beast::tcp_stream&& stream, http::request<http::empty_body>&& request) {
  std::make_shared<PageConnection>(hub, std::move(stream))->start(std::move(request));
}

}  // namespace tactum
