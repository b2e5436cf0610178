#include "viewer/server/access.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

namespace tactum {

const char* refusal_name(Refusal refusal) noexcept {
  static constexpr const char* kNames[kRefusalCount] = {"wrong token", "foreign host", "foreign origin",
                                                        "too large",   "malformed",    "too fast",
                                                        "too many",    "not there",    "not steering"};
  return kNames[static_cast<std::size_t>(refusal)];
}

std::string new_token() {
  std::random_device random;  // the kernel's generator on this system
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

bool same_secret(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

bool own_host(std::string_view host, int port) {
  return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
}

bool own_origin(std::string_view origin, int port) {
  constexpr std::string_view kScheme = "http://";
  return origin.substr(0, kScheme.size()) == kScheme && own_host(origin.substr(kScheme.size()), port);
}

bool own_fetch_site(std::string_view site) { return site.empty() || site == "same-origin" || site == "none"; }

std::string content_policy(int port) {
  // Some browsers do not take 'self' for WebSockets of the same origin: they are named.
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
      "connect-src 'self' ws://127.0.0.1:{0} ws://localhost:{0}; base-uri 'none'; form-action 'none'; "
      "frame-ancestors 'none'; require-trusted-types-for 'script'",
      port);
}

bool RateLimit::pass(Clock::time_point now) noexcept {
  if (last_ != Clock::time_point{})
    left_ = std::min(burst_, left_ + rate_Hz_ * std::chrono::duration<double>(now - last_).count());
  last_ = now;
  if (left_ < 1.0) return false;
  left_ -= 1.0;
  return true;
}

}  // namespace tactum
