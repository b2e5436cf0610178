#include "tactum/loop/loop_thread.h"

#include <cerrno>
#include <cmath>
#include <ctime>
#include <future>
#include <system_error>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNanoseconds + now.tv_nsec;
}

void sleep_until(std::int64_t deadline_ns) noexcept {
  timespec deadline{};
  deadline.tv_sec = deadline_ns / kNanoseconds;
  deadline.tv_nsec = deadline_ns % kNanoseconds;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

double seconds(std::int64_t ns) noexcept { return static_cast<double>(ns) / 1e9; }

/// Counters have one writer, the loop's thread, so no read-modify-write is needed.
void add(std::atomic<std::uint64_t>& counter, std::uint64_t n) noexcept {
  counter.store(counter.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
}

void write_zero(void* device) noexcept { static_cast<Device*>(device)->write({}); }

}  // namespace

struct LoopThread::Clock {
  std::int64_t period_ns;
  std::int64_t late_ns;  // a frame begun so long after the last is late
  std::int64_t start_ns;
  std::int64_t deadline_ns;  // of the next frame
  std::int64_t last_ns;      // when the last frame began
};

Result<void> LoopThread::start(Device& device, HapticFrame& frame, const LoopSettings& settings) {
  if (thread_.joinable()) return Error{"the haptic loop is already started", "", "a stop before", ""};
  if (Result<void> good = check_rate(settings.rate_Hz); !good) return good;
  if (Result<void> opened = device.open(); !opened) return opened;
  device_ = &device;
  frame_ = &frame;
  settings_ = settings;
  timings_ = std::make_unique<SpscRing<FrameTiming>>(settings.timing_room);
  refused_in_a_row_ = 0;
  stop_frames_ = 0;
  stop_requested_ = device_lost_ = false;
  for (auto* counter :
       {&frames_, &missed_deadlines_, &late_frames_, &failed_reads_, &failed_writes_, &dropped_timings_}) {
    counter->store(0);
  }
  set_zero_wrench_hook(write_zero, device_);
  running_ = true;
  std::promise<LoopPrivileges> granted;
  std::future<LoopPrivileges> privileges = granted.get_future();
  try {
    thread_ = std::thread([this, promise = std::move(granted)]() mutable {
      promise.set_value(acquire_privileges(settings_.realtime));
      run();
    });
  } catch (const std::system_error& error) {
    running_ = false;
    set_zero_wrench_hook(nullptr, nullptr);
    device.close();
    return Error{"cannot start the haptic loop's thread", error.what(), "", ""};
  }
  privileges_ = privileges.get();
  return {};
}

void LoopThread::stop() noexcept {
  request_stop();
  if (thread_.joinable()) thread_.join();
}

void LoopThread::run() noexcept {
  Clock clock{};
  clock.period_ns = std::llround(static_cast<double>(kNanoseconds) / settings_.rate_Hz);
  clock.late_ns = clock.period_ns + std::llround(settings_.late_limit_s * static_cast<double>(kNanoseconds));
  clock.start_ns = monotonic_ns();
  clock.last_ns = clock.start_ns;
  clock.deadline_ns = clock.start_ns + clock.period_ns;
  FrameTick tick;
  tick.period_s = seconds(clock.period_ns);
  DeviceSample sample;
  while (run_frame(clock, tick, sample)) ++tick.index;
  device_->write({});
  device_->close();
  set_zero_wrench_hook(nullptr, nullptr);
  running_.store(false, std::memory_order_release);
}

/// One period; false when it was the last.
bool LoopThread::run_frame(Clock& clock, FrameTick& tick, DeviceSample& sample) noexcept {
  sleep_until(clock.deadline_ns);
  const std::int64_t begin_ns = monotonic_ns();
  tick.now_s = seconds(begin_ns - clock.start_ns);
  tick.late = begin_ns - clock.last_ns > clock.late_ns;
  tick.stop = stop_requested_.load(std::memory_order_relaxed) ||
              (settings_.frames > 0 && tick.index >= settings_.frames);
  clock.last_ns = begin_ns;

  if (!device_->read(tick.now_s, sample)) add(failed_reads_, 1);
  const std::int64_t before_ns = monotonic_ns();
  const Wrench computed = frame_->run(sample, tick);
  const std::int64_t after_ns = monotonic_ns();
  // A frame that was delayed so long belongs to an old pose: zero is better. The next frame is late and ramps
  // up again.
  const Wrench F_D = after_ns - begin_ns > clock.late_ns ? Wrench{} : computed;
  const bool written = device_->write(F_D);
  const std::int64_t end_ns = monotonic_ns();

  FrameTiming timing;
  timing.index = tick.index;
  timing.now_s = tick.now_s;
  timing.wakeup_latency_s = seconds(begin_ns - clock.deadline_ns);
  timing.frame_time_s = seconds(after_ns - before_ns);
  timing.busy_time_s = seconds(end_ns - begin_ns);
  clock.deadline_ns += clock.period_ns;
  if (end_ns > clock.deadline_ns) {
    const std::int64_t missed = (end_ns - clock.deadline_ns) / clock.period_ns + 1;
    clock.deadline_ns += missed * clock.period_ns;
    timing.missed_deadlines = static_cast<std::uint64_t>(missed);
  }
  if (!written) add(failed_writes_, 1);
  tick.refused = !written;
  refused_in_a_row_ = written ? 0 : refused_in_a_row_ + 1;
  if (tick.late) add(late_frames_, 1);
  publish(timing);

  if (refused_in_a_row_ >= settings_.writes_until_lost) {
    device_lost_.store(true, std::memory_order_relaxed);
    return false;
  }
  if (!tick.stop) return true;
  ++stop_frames_;
  return !is_zero(F_D) && static_cast<double>(stop_frames_) * tick.period_s < kMaxStop_s;
}

void LoopThread::publish(const FrameTiming& timing) noexcept {
  add(frames_, 1);
  add(missed_deadlines_, timing.missed_deadlines);
  if (!timings_->push(timing)) add(dropped_timings_, 1);
}

LoopStatus LoopThread::status() const noexcept {
  LoopStatus status;
  status.running = running_.load(std::memory_order_acquire);
  status.device_lost = device_lost_.load(std::memory_order_relaxed);
  status.frames = frames_.load(std::memory_order_relaxed);
  status.missed_deadlines = missed_deadlines_.load(std::memory_order_relaxed);
  status.late_frames = late_frames_.load(std::memory_order_relaxed);
  status.failed_reads = failed_reads_.load(std::memory_order_relaxed);
  status.failed_writes = failed_writes_.load(std::memory_order_relaxed);
  status.dropped_timings = dropped_timings_.load(std::memory_order_relaxed);
  return status;
}

}  // namespace tactum::inline v0_1
