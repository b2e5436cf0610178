#include "tactum/drivers/command_guard.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <system_error>

namespace tactum::inline v0_1 {
namespace {

/// How often the guard looks while the writer may be silent: a zero comes this fraction of the time late.
constexpr int kLooksPerLimit = 5;

/// What the safety stage has already limited may be longer by its rounding, and passes as it is.
void shorten(Vec3& v, double limit) noexcept {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double length = v.norm();
  if (length > limit * (1.0 + kRounding)) v *= limit / length;
}

std::int64_t steady_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

bool CommandGate::pass(const Wrench& wanted, Wrench& sent) const noexcept {
  sent = {};
  if (!wanted.finite()) return false;
  sent = wanted;
  shorten(sent.f, max_force_N_);
  shorten(sent.t, max_torque_Nm_);
  return true;
}

void StaleClock::start(double stale_after_s) noexcept {
  stale_after_ns_ = std::llround(stale_after_s * 1e9);
  written_ns_.store(steady_ns(), std::memory_order_relaxed);
  acted_.store(false, std::memory_order_relaxed);
}

bool StaleClock::on_time() noexcept {
  const std::int64_t now_ns = steady_ns();
  const std::int64_t since_ns = now_ns - written_ns_.exchange(now_ns, std::memory_order_acq_rel);
  const bool acted = acted_.exchange(false, std::memory_order_acq_rel);
  return !acted && since_ns <= stale_after_ns_;
}

bool StaleClock::stale() noexcept {
  if (steady_ns() - written_ns_.load(std::memory_order_acquire) <= stale_after_ns_) return false;
  acted_.store(true, std::memory_order_release);
  return true;
}

Result<void> StaleGuard::start(double stale_after_s, std::function<void()> send_zero) {
  stop();
  clock_.start(stale_after_s);
  send_zero_ = std::move(send_zero);
  stop_ = false;
  const std::chrono::nanoseconds look_every(std::llround(stale_after_s * 1e9) / kLooksPerLimit);
  try {
    thread_ = std::thread([this, look_every] { watch(look_every); });
  } catch (const std::system_error& error) {
    return Error{"cannot start the thread that guards the device", error.what(), "", ""};
  }
  return {};
}

void StaleGuard::stop() noexcept {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  stopped_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void StaleGuard::watch(std::chrono::nanoseconds look_every) noexcept {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopped_.wait_for(lock, look_every, [this] { return stop_; }))
    if (clock_.stale()) send_zero_();
}

}  // namespace tactum::inline v0_1
