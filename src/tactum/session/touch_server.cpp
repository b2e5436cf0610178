#include "tactum/session/touch_server.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "tactum/loop/loop.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kLate_s = 0.010;       // beyond the period, as in loop_thread.h
constexpr int kRefusalsUntilLost = 50;  // the same
constexpr double kUnreadUntilLost_s = 0.5;

}  // namespace

double SteadyTouchClock::now_s() noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void SteadyTouchClock::wait_until(double time_s) noexcept {
  const std::chrono::duration<double> rest(time_s - now_s());
  if (rest.count() > 0.0) std::this_thread::sleep_for(rest);
}

TouchServer::TouchServer(Device& device, TouchClock& clock, double rate_Hz, std::function<bool()> stopped)
    : device_(device), clock_(clock), period_s_(1.0 / rate_Hz), stopped_(std::move(stopped)) {}

bool TouchServer::send(const Wrench& F, StepResult& result) noexcept {
  const bool taken = device_.write(F);
  refused_in_a_row_ = taken ? 0 : refused_in_a_row_ + 1;
  result.largest_N = std::max(result.largest_N, F.f.norm());
  result.largest_Nm = std::max(result.largest_Nm, F.t.norm());
  return taken;
}

StepResult TouchServer::serve(const SafetyLimits& limits, double at_most_s, const TouchStep& step,
                              bool quiet) {
  if (!started_) start_s_ = clock_.now_s();
  started_ = true;
  StepResult result;
  SafetyState safety;
  Wrench wanted;
  FrameTick tick;
  tick.period_s = period_s_;
  double deadline_s = clock_.now_s();
  double last_s = deadline_s;
  const double begin_s = deadline_s;
  for (;; ++tick.index) {
    clock_.wait_until(deadline_s);
    const double now_s = clock_.now_s();
    deadline_s = std::max(deadline_s + period_s_, now_s);
    tick.now_s = now_s - start_s_;
    tick.late = now_s - last_s > period_s_ + kLate_s;
    last_s = now_s;
    if (device_.read(tick.now_s, sample_)) unread_since_s_ = tick.now_s;
    if (!tick.stop) {
      std::optional<Wrench> next;
      if (stopped_())
        result.end = StepEnd::kStopped;
      else if (now_s - begin_s > at_most_s)
        result.end = StepEnd::kTimeOver;
      else
        next = step({sample_, safety.sent, now_s, now_s - begin_s});
      tick.stop = !next;
      if (next) wanted = *next;
    }
    std::uint32_t flags = 0;
    const Wrench F = safe_wrench(limits, safety, safety_input(sample_, tick, wanted), flags);
    tick.refused = !send(F, result);
    if (refused_in_a_row_ >= kRefusalsUntilLost || tick.now_s - unread_since_s_ > kUnreadUntilLost_s) {
      device_.write({});
      result.end = StepEnd::kLost;
      return result;
    }
    if ((flags & safety_flag::kFaults) != 0 && !quiet && !tick.stop) {
      result.end = StepEnd::kFault;
      result.faults = flags & safety_flag::kFaults;
      return result;  // safety has sent zero
    }
    if (tick.stop && is_zero(F)) return result;
  }
}

}  // namespace tactum::inline v0_1
