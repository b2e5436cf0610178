#include "tactum/drivers/loop_exchange.h"

#include <chrono>
#include <thread>

namespace tactum::inline v0_1 {

LoopExchange::LoopExchange() : samples_([](DeviceSample&) {}), commands_([](Wrench&) {}) {}

void LoopExchange::start(const CommandGate& gate, double stale_after_s) noexcept {
  gate_ = gate;
  commands_.writable() = {};
  commands_.publish();
  samples_.take();  // what an earlier run left
  written_.start(stale_after_s);
  served_.start(kSilent_s);
  published_ = 0;
  lost_ = false;
}

bool LoopExchange::served_twice() const noexcept {
  constexpr int kMost_ms = 1000;
  const std::uint64_t from = published_;
  for (int i = 0; i < kMost_ms && published_ < from + 2 && !lost_; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return published_ >= from + 2;
}

void LoopExchange::publish() noexcept {
  samples_.publish();
  served_.on_time();
  published_ = published_ + 1;
}

Wrench LoopExchange::command() noexcept {
  commands_.take();
  return written_.stale() || lost_ ? Wrench{} : commands_.readable();
}

bool LoopExchange::read(double now_s, DeviceSample& sample) noexcept {
  if (served_.stale()) lost_ = true;
  if (samples_.take()) {
    sample = samples_.readable();
    sample.time_s = now_s;
  }
  sample.valid = !lost_ && published_ > 0;
  return sample.valid;
}

bool LoopExchange::write(const Wrench& F_D) noexcept {
  Wrench sent;
  const bool finite = gate_.pass(F_D, sent);
  const bool taken = written_.on_time() && finite && !lost_;
  commands_.writable() = taken ? sent : Wrench{};
  commands_.publish();
  return taken;
}

}  // namespace tactum::inline v0_1
