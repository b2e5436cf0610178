#pragma once
/// The clients that may talk to the viewer, and their limits. The server listens on the loopback interface
/// only; still, any program of any user of this machine and any page in the user's browser can reach a
/// loopback port. So:
///
///   a token of 128 random bits in the address       other users and programs do not know it
///   Host must name this loopback port               a foreign name that resolves to 127.0.0.1 is refused
///   Origin must be this page's own                  another page's scripts are refused, and Sec-Fetch-Site
///   a strict content policy                         the page runs nothing but its own files
///   sizes and rates are bounded                     one page cannot take the machine
///
/// Everything refused is counted by its reason, and the page shows the counts.

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactum {

/// Why something was refused.
enum class Refusal {
  kWrongToken,
  kForeignHost,
  kForeignOrigin,
  kOversized,
  kMalformed,
  kTooFast,
  kTooMany,
  kNotThere,
  kNotSteering,
};
inline constexpr int kRefusalCount = 9;
/// "wrong token": for people, and for the page's counters.
const char* refusal_name(Refusal refusal) noexcept;

using RefusalCounts = std::array<std::uint64_t, kRefusalCount>;

/// 32 hexadecimal digits from the operating system's random source.
std::string new_token();

/// Compares in a time that does not reveal how much of a guess was right.
bool same_secret(std::string_view a, std::string_view b) noexcept;

/// Whether a Host header names this server: 127.0.0.1 or localhost with its port.
bool own_host(std::string_view host, int port);
/// Whether an Origin header is that of this server's page.
bool own_origin(std::string_view origin, int port);
/// Whether a browser's statement of a request's source lets it pass: "" (no such browser), "same-origin", or
/// "none" (typed in).
bool own_fetch_site(std::string_view site);

/// Value of the Content-Security-Policy header.
std::string content_policy(int port);

/// A bucket of tokens: `rate` a second in the long run, `burst` at once.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  RateLimit(double rate_Hz, double burst) : rate_Hz_(rate_Hz), burst_(burst), left_(burst) {}
  /// Whether one more may pass now.
  bool pass(Clock::time_point now) noexcept;

 private:
  double rate_Hz_, burst_, left_;
  Clock::time_point last_ = {};
};

}  // namespace tactum
