#pragma once
/// The speed of turning, for devices that tell an orientation and no speed of it: the turn between the newest
/// orientation and one some time before, over that time. Half of that time late; noise falls with it.

#include <array>
#include <cstddef>

#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

class TurnRate {
 public:
  /// Longer than two readings of a grip that tells its orientation fifty times a second [s].
  static constexpr double kOver_s = 0.05;

  void start() noexcept { count_ = 0; }
  /// The speed after an orientation that was read at `now_s`, which rises [rad/s]; zero until there is one
  /// from before.
  Vec3 add(const Mat3& R, double now_s) noexcept;

 private:
  struct Reading {
    Mat3 R = Mat3::Identity();
    double at_s = 0.0;
  };
  static constexpr std::size_t kReadings = 64;
  std::array<Reading, kReadings> readings_;
  std::size_t count_ = 0;  // of all that were kept
};

}  // namespace tactum::inline v0_1
