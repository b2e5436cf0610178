#include "tactum/recording/frame_copy.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace tactum::inline v0_1 {
namespace {

/// As a call: inlined, a copy of a size that is known goes number by number, which takes twice as long.
[[gnu::noinline]] void copy_bytes(const void* from, void* to, std::size_t size) noexcept {
  std::memcpy(to, from, size);
}

/// Copies numbers as they lie in memory, many at a time: member by member it takes several times as long.
template <class T>
void copy_bits(const T& from, T& to) noexcept {
  static_assert(std::is_trivially_destructible_v<T>, "it owns nothing");
  constexpr std::size_t kWorthACall = 256;  // bytes
  if constexpr (sizeof(T) < kWorthACall)
    std::memcpy(static_cast<void*>(&to), static_cast<const void*>(&from), sizeof(T));
  else
    copy_bytes(&from, &to, sizeof(T));
}

template <class T>
void copy_bits(const std::vector<T>& from, std::vector<T>& to) noexcept {
  static_assert(std::is_trivially_destructible_v<T>, "it owns nothing");
  const std::size_t count = std::min(from.size(), to.size());
  if (count > 0) copy_bytes(from.data(), to.data(), count * sizeof(T));
}

}  // namespace

FrameCopy::FrameCopy(std::size_t bodies, std::size_t hand_count)
    : other_reports(hand_count - 1), hands(hand_count) {
  world.X_WB.resize(bodies);
  world.V_WB.resize(bodies);
}

std::size_t FrameCopy::bytes(std::size_t bodies, std::size_t hand_count) noexcept {
  return sizeof(FrameCopy) + bodies * (sizeof(Pose) + sizeof(Twist)) +
         hand_count * (sizeof(HandCopy) + sizeof(HandReport));
}

void remember_proxies(const FrameSource& frame, std::span<ProxyBefore> proxies) noexcept {
  for (std::size_t h = 0; h < proxies.size(); ++h) {
    const HandReport& report = h == 0 ? frame.report : frame.state.other_reports[h - 1];
    proxies[h] = {report.X_WH_proxy, report.grasped_body >= 0};
  }
}

void copy_frame(const FrameSource& frame, const StageClock* clock, std::span<ProxyBefore> proxies,
                FrameCopy& to) noexcept {
  const FrameState& state = frame.state;
  copy_bits(frame.report, to.report);
  copy_bits(state.other_reports, to.other_reports);
  for (std::size_t h = 0; h < to.hands.size(); ++h) {
    const HandFrameState& from = state.of_hand(h);
    HandCopy& hand = to.hands[h];
    copy_bits(static_cast<const HandTracking&>(from.hand), hand.hand);
    copy_bits(from.smoothing, hand.smoothing);
    copy_bits(from.port, hand.port);
    copy_bits(from.safety, hand.safety);
    hand.before = proxies[h];
  }
  copy_bits(state.world.X_WB, to.world.X_WB);
  copy_bits(state.world.V_WB, to.world.V_WB);
  to.grasped_body = state.hand.known ? state.hand.grasp.body : -1;
  to.load_work_J = state.load_work_J;
  to.stored_J = state.response.stored_J();
  to.workspace_scale = frame.settings.workspace.scale;
  to.dt_s = frame.settings.dt_s;
  to.stage_ns = stage_times(clock);
  remember_proxies(frame, proxies);
}

void write_row(const FrameTrace& trace, const FrameCopy& frame, std::span<double> row) {
  std::vector<TracedHand> hands;
  for (std::size_t h = 0; h < frame.hands.size(); ++h) {
    const HandCopy& hand = frame.hands[h];
    hands.push_back({h == 0 ? &frame.report : &frame.other_reports[h - 1], &hand.hand, &hand.port,
                     hand.before.grasped ? &hand.before.X_WH : nullptr});
  }
  trace.write(
      {&frame.report, hands, frame.world.X_WB, frame.world.V_WB, frame.workspace_scale, frame.stage_ns}, row);
}

}  // namespace tactum::inline v0_1
