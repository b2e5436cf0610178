#include "tactum/loop/loop.h"

#include <chrono>
#include <cmath>
#include <string>

namespace tactum::inline v0_1 {

Result<void> check_rate(double rate_Hz) {
  constexpr double kLowest = 10.0;    // below, no hand would take it for touch
  constexpr double kHighest = 1.0e5;  // above, no timer of this machine wakes a thread
  if (rate_Hz >= kLowest && rate_Hz <= kHighest) return {};
  return Error{"bad rate of the haptic loop", std::to_string(rate_Hz) + " Hz", "10 to 100000 Hz", ""};
}

Result<VirtualRun> run_virtual(Device& device, HapticFrame& frame, double rate_Hz, std::uint64_t n_frames,
                               LoopObserver* observer) {
  if (Result<void> good = check_rate(rate_Hz); !good) return good.error();
  if (Result<void> opened = device.open(); !opened) return opened.error();
  VirtualRun run;
  FrameRecord record;
  record.tick.period_s = 1.0 / rate_Hz;
  const auto stop_frames = static_cast<std::uint64_t>(std::ceil(kMaxStop_s * rate_Hz));
  std::uint64_t end = n_frames;
  for (std::uint64_t i = 0; i < end; ++i) {
    record.tick.index = i;
    record.tick.now_s = static_cast<double>(i) / rate_Hz;
    if (!device.read(record.tick.now_s, record.sample)) ++run.failed_reads;
    if (observer) {
      const auto before = std::chrono::steady_clock::now();
      record.F_D = frame.run(record.sample, record.tick);
      const auto after = std::chrono::steady_clock::now();
      record.frame_time_s = std::chrono::duration<double>(after - before).count();
    } else {
      record.F_D = frame.run(record.sample, record.tick);
    }
    record.written = device.write(record.F_D);
    if (!record.written) ++run.failed_writes;
    ++run.frames;
    if (record.tick.stop && is_zero(record.F_D)) break;
    if (observer && !observer->after_frame(record) && !record.tick.stop) {
      record.tick.stop = run.stopped_early = true;
      end = i + 1 + stop_frames;
    }
    record.tick.refused = !record.written;
  }
  device.write({});
  device.close();
  return run;
}

}  // namespace tactum::inline v0_1
