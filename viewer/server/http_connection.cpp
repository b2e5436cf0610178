#include "viewer/server/http_connection.h"

#include <fmt/format.h>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "viewer/server/page.h"
#include "viewer/server/page_connection.h"

namespace tactum {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;
using beast::error_code;

constexpr std::size_t kLargestHeader = 8192;
constexpr int kMostConnections = 64;

/// One HTTP connection: the page's files and the geometry, until it asks to become a WebSocket.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(ConnectionHub& hub, tcp::socket&& socket) : hub_(hub), stream_(std::move(socket)) {
    ++hub_.connections;
  }
  ~HttpConnection() { --hub_.connections; }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    parser_->body_limit(std::uint64_t{0});
    stream_.expires_after(kClientTimeout);
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
    open_page(hub_, std::move(stream_), std::move(request));
  }

  void serve(std::string_view path) {
    if (path == "geometry")
      return send(http::status::ok, "application/octet-stream", *hub_.run.geometry, false);
    for (const PageFile& file : page_files())
      if (path == file.path || (path.empty() && &file == page_files().data()))
        return send(http::status::ok, file.type, std::string(file.gzip), true);
    refuse(Refusal::kNotThere, http::status::not_found);
  }

  void refuse(Refusal reason, http::status status) {
    hub_.inbox.refuse(reason);
    keep_alive_ = false;
    const bool by_token = reason == Refusal::kWrongToken;
    send(status, "text/html; charset=utf-8",
         fmt::format(
             "<!doctype html><title>Tactum</title><h1>Refused: {}</h1>\n<p>{}</p>\n", refusal_name(reason),
             by_token ? "The address of the page ends in a long number that only the terminal shows in which "
                        "tactum was started. Open that address; each start has a new one."
                      : ""),
         false);
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
    stream_.expires_after(kClientTimeout);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error && self->keep_alive_) return self->read();
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  ConnectionHub& hub_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kLargestHeader + 1024};
  boost::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  bool keep_alive_ = false;
};

}  // namespace

void serve_http(ConnectionHub& hub, tcp::socket&& socket) {
  std::make_shared<HttpConnection>(hub, std::move(socket))->read();
}

}  // namespace tactum
