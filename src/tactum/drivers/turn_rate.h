#pragma once
/// Turns of devices that tell less of them than the loop wants. TurnRate: the speed of turning where only an
/// orientation is told: the turn between the newest orientation and one some time before, over that time.
/// Half of that time late; noise falls with it. TurnFill: orientations between the readings of a slow sensor.

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

/// Goes from what was shown to each new reading, by one rotation at even speed, in as many samples as lay
/// between the last readings. So a steady turn that is read in every n-th sample is shown as it was, n - 1
/// samples late; no reading is a step, and nothing is shown beyond the readings, as it would be if they were
/// carried on. Counted in samples and not on a clock, as a reading in each sample is then shown as it is.
class TurnFill {
 public:
  /// A reading after a longer pause is shown after so many samples.
  static constexpr int kMostSamples = 50;

  void start() noexcept { *this = {}; }
  /// What to show in the next sample, when the sensor tells `reading`; the same to the bit: no new one.
  Mat3 show(const Mat3& reading) noexcept;

 private:
  Mat3 shown() const noexcept;

  bool has_reading_ = false;
  Mat3 reading_ = Mat3::Identity(), from_ = Mat3::Identity();
  Vec3 turn_ = Vec3::Zero();  // from there to the reading
  int samples_ = 0;           // since the reading came, itself included
  int gap_ = 1;               // samples from the reading before to this one
  int over_ = 1;              // the turn is spread over so many
};

}  // namespace tactum::inline v0_1
