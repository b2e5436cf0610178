#pragma once
/// The loop in real time: a thread that wakes at absolute deadlines on a grid of one period.
///
///   deadline k      k+1       k+2       k+3
///   |--frame--|     |---- frame too long ---|        the frame of k+1 ends after k+2: k+2 is counted as
///                             ^ missed      |--      missed and skipped, never caught up in a burst
///
/// A frame that starts later than one period plus `late_limit_s` after the last is marked (FrameTick::late),
/// and safety sends zero. Stop: the frame is asked to lead the wrench to zero (FrameTick::stop); when it is
/// zero, or after kMaxStop_s, zero is written and the device closed. A device that refuses many writes in a
/// row is given up as unplugged. While the loop runs, a failed assertion anywhere first writes a zero wrench
/// (base/assert.h); with several loops at once that hook serves the one started last.
///
/// Other threads may read status() and, one of them, pop timings(); everything else is for the owner.

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "tactum/base/spsc_ring.h"
#include "tactum/loop/loop.h"
#include "tactum/loop/realtime.h"

namespace tactum::inline v0_1 {

struct LoopSettings {
  double rate_Hz = 1000.0;          ///< [Hz]
  std::uint64_t frames = 0;         ///< asks for the stop by itself after so many; 0: never
  double late_limit_s = 0.010;      ///< beyond the period; a later frame sends zero [s]
  int writes_until_lost = 50;       ///< so many refused writes in a row: the device is unplugged
  std::size_t timing_room = 16384;  ///< frames the timing ring holds until a reader pops them
  RealtimeSettings realtime;
};

/// The times of one frame, on the monotonic clock.
struct FrameTiming {
  std::uint64_t index = 0;             ///< of the frame
  double now_s = 0.0;                  ///< when it began, since the loop's start [s]
  double wakeup_latency_s = 0.0;       ///< begun after its deadline by [s]
  double frame_time_s = 0.0;           ///< of HapticFrame::run [s]
  double busy_time_s = 0.0;            ///< of read, frame and write [s]
  std::uint64_t missed_deadlines = 0;  ///< skipped because this frame ended too late
};

struct LoopStatus {
  bool running = false;
  bool device_lost = false;  ///< refused writes; the loop has ended
  std::uint64_t frames = 0;
  std::uint64_t missed_deadlines = 0;
  std::uint64_t late_frames = 0;  ///< marked FrameTick::late
  std::uint64_t failed_reads = 0;
  std::uint64_t failed_writes = 0;
  std::uint64_t dropped_timings = 0;  ///< lost because the ring was full
};

class LoopThread {
 public:
  LoopThread() = default;
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Opens the device and starts the thread. Device and frame must outlive stop().
  Result<void> start(Device& device, HapticFrame& frame, const LoopSettings& settings);
  /// Leads the wrench to zero, closes the device, ends the thread. Safe to call at any time, twice too.
  void stop() noexcept;
  /// Asks for the stop without waiting; for signal handlers' flags and the like.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }

  LoopStatus status() const noexcept;
  /// The privileges that the operating system granted; valid after start.
  const LoopPrivileges& privileges() const noexcept { return privileges_; }
  /// One consumer. Valid after the first start, until the next start.
  SpscRing<FrameTiming>& timings() noexcept { return *timings_; }

 private:
  struct Clock;  // deadlines of one run
  void run() noexcept;
  bool run_frame(Clock& clock, FrameTick& tick, DeviceSample& sample) noexcept;
  void publish(const FrameTiming& timing) noexcept;

  Device* device_ = nullptr;
  HapticFrame* frame_ = nullptr;
  LoopSettings settings_;
  LoopPrivileges privileges_;
  std::unique_ptr<SpscRing<FrameTiming>> timings_;
  std::thread thread_;
  int refused_in_a_row_ = 0;
  std::uint64_t stop_frames_ = 0;

  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> running_{false};
  std::atomic<bool> device_lost_{false};
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<std::uint64_t> missed_deadlines_{0};
  std::atomic<std::uint64_t> late_frames_{0};
  std::atomic<std::uint64_t> failed_reads_{0};
  std::atomic<std::uint64_t> failed_writes_{0};
  std::atomic<std::uint64_t> dropped_timings_{0};
};

}  // namespace tactum::inline v0_1
