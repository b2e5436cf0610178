#pragma once
/// The commands of another thread to a running session. Plain data, so that it can pass through a ring; the
/// session carries them out before the next frame.

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "tactum/loop/safety.h"
#include "tactum/math/pose.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

struct SessionCommand {
  enum class Kind : std::uint8_t {
    kAim,   ///< lead the hand to a pose (pointer_device.h)
    kRest,  ///< a hand that was led stays where it is
    kSet,   ///< a setting that is live (setting_table.h)
  };
  Kind kind = Kind::kRest;
  std::uint32_t hand = 0;        ///< of kAim and kRest: which hand, counted from 0
  std::uint32_t buttons = 0;     ///< of kAim: bit 0 is the primary button
  std::array<double, 3> p_WH{};  ///< of kAim: the wanted place of the hand in the world [m]
  std::array<double, 4> quat_wxyz_WH{1.0, 0.0, 0.0, 0.0};  ///< of kAim: its orientation there
  int setting = -1;                                        ///< of kSet: index in setting_table()
  double value = 0.0;                                      ///< of kSet

  /// Of kAim: p_WH and quat_wxyz_WH as one.
  Pose aim() const {
    const auto& q = quat_wxyz_WH;
    return {Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(), {p_WH[0], p_WH[1], p_WH[2]}};
  }
};

/// Carries out a kSet: on the settings of a run, and on the user's limits, which only tighten those of the
/// device. A setting that is not live, or a value out of its range, changes nothing.
void set_live(const SessionCommand& command, const SafetyLimits& device, FrameSettings& settings,
              SafetySettings& safety) noexcept;
/// The same for every hand, whose devices have these limits: a setting is that of all hands.
void set_live(const SessionCommand& command, std::span<const SafetyLimits> devices, FrameSettings& settings,
              SafetySettings& safety) noexcept;

/// Calls `visit(hand)` for every hand, counted from 0 and the first one last, while the settings have what is
/// that hand's own in the first one's place, where the table of settings sees it.
template <class Visit>
void with_every_hand(FrameSettings& settings, const Visit& visit) {
  for (std::size_t i = 0; i < settings.other_hands.size(); ++i) {
    HandSettings& first = settings;
    std::swap(first, settings.other_hands[i]);
    visit(i + 1);
    std::swap(first, settings.other_hands[i]);
  }
  visit(std::size_t{0});
}

}  // namespace tactum::inline v0_1
