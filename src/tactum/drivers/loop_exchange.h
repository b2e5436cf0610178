#pragma once
/// What a driver whose device is served by another thread than the loop's has between the two: the newest
/// sample goes one way, the newest command the other, and neither thread waits.
///
///   serving thread   sample(), publish() ──newest sample──>   read()    loop's thread
///                    command()           <─newest command──   write()
///
/// A command that is too old becomes zero on the serving thread; when that thread falls silent for kSilent_s,
/// the loop's reads fail. Whichever thread finds the device lost says so, and it stays lost until start().

#include <atomic>
#include <cstdint>

#include "tactum/base/newest.h"
#include "tactum/drivers/command_guard.h"

namespace tactum::inline v0_1 {

class LoopExchange {
 public:
  /// Much longer than any period, so that a busy machine is not taken for a device that is gone [s].
  static constexpr double kSilent_s = 0.5;

  LoopExchange();

  /// Before the serving thread runs: a zero command, no sample yet.
  void start(const CommandGate& gate, double stale_after_s) noexcept;
  /// Waits until the serving thread has published twice more, so that what was commanded before this call is
  /// sent; for a second at most. Whether it did.
  bool served_twice() const noexcept;
  /// From any thread: the device does not answer; reads and writes fail from now on.
  void lose() noexcept { lost_ = true; }
  bool lost() const noexcept { return lost_; }

  /// Serving thread: the sample to fill, all of it but time and validity; then publish() hands it over.
  DeviceSample& sample() noexcept { return samples_.writable(); }
  void publish() noexcept;
  /// Serving thread: what is to be sent now.
  Wrench command() noexcept;

  /// Loop's thread, as of Device. A sample keeps its time until there is a new one.
  bool read(double now_s, DeviceSample& sample) noexcept;
  bool write(const Wrench& F_D) noexcept;

 private:
  CommandGate gate_;
  StaleClock written_;  // by the loop
  StaleClock served_;   // by the serving thread
  Newest<DeviceSample> samples_;
  Newest<Wrench> commands_;
  std::atomic<std::uint64_t> published_{0};
  std::atomic<bool> lost_{false};
};

}  // namespace tactum::inline v0_1
