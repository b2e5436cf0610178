#include "viewer/server/server.h"

#include <fmt/format.h>
#include <pthread.h>

#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "viewer/server/connection_hub.h"
#include "viewer/server/http_connection.h"
#include "viewer/server/loopback.h"

namespace tactum {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;

}  // namespace

struct Server::Impl {
  ConnectionHub hub;
  LoopbackListener listener{hub.io};
  std::thread thread;

  template <class Work>
  void post(Work work) {
    asio::post(hub.io, std::move(work));
  }
};

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Server>> Server::start(int port) {
  auto impl = std::make_unique<Impl>();
  const auto serve = [hub = &impl->hub](tcp::socket&& socket) { serve_http(*hub, std::move(socket)); };
  if (const error_code error = impl->listener.listen(port, serve))
    return Error{"the viewer cannot listen", error.message(),
                 "a port that is free; without --port one is found", fmt::format("127.0.0.1:{}", port)};
  impl->hub.port = impl->listener.port();
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
  impl_->post([hub = &impl_->hub, run, message = shared_text(std::move(message)),
               geometry = shared_text(std::move(geometry))] {
    hub->run = {run, message, geometry};
    hub->history.cut();
    hub->picture.replace(shared_text(""));  // that of the run before
    hub->feed_pages();
  });
}

void Server::send_settings(std::string message, std::string run_message) {
  impl_->post([hub = &impl_->hub, message = shared_text(std::move(message)),
               run_message = shared_text(std::move(run_message))] {
    hub->settings.replace(message);
    hub->run.message = run_message;
    hub->feed_pages();
  });
}

void Server::show(std::span<const ChartSample> samples, std::string picture, std::uint64_t frame) {
  impl_->post([hub = &impl_->hub, samples = std::vector<ChartSample>(samples.begin(), samples.end()),
               picture = shared_text(std::move(picture)), frame] {
    for (const ChartSample& sample : samples) hub->history.add(sample);
    const std::optional<std::uint64_t> place = picture->empty() ? std::nullopt : hub->history.place_of(frame);
    if (place) {  // the newer samples of a long pause may have taken its room
      hub->picture.replace(picture);
      hub->picture_place = *place;
    }
    hub->feed_pages();
  });
}

void Server::send_status(std::string json) {
  impl_->post([hub = &impl_->hub, json = shared_text(std::move(json))] {
    hub->program_status.replace(json);
    hub->feed_pages();
  });
}

void Server::send_notice(const std::string& sentence) {
  const nlohmann::json message = {{"type", "notice"}, {"sentence", sentence}};
  impl_->post([hub = &impl_->hub,
               text = shared_text(message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))] {
    hub->sentence.replace(text);
    hub->feed_pages();
  });
}

bool Server::take(Request& request) { return impl_->hub.inbox.take(request); }

void Server::wait(std::chrono::microseconds longest) { impl_->hub.inbox.wait(longest); }

const std::atomic<bool>& Server::stop_asked() const { return impl_->hub.inbox.stop_asked(); }

ServerStatus Server::status() const { return impl_->hub.inbox.status(); }

}  // namespace tactum
