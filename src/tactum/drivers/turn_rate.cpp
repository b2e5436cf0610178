#include "tactum/drivers/turn_rate.h"

#include <algorithm>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {

Vec3 TurnRate::add(const Mat3& R, double now_s) noexcept {
  // Kept a little apart, so that those that are kept cover the time whatever the rate.
  constexpr double kApart_s = 1.25 * kOver_s / static_cast<double>(kReadings);
  if (count_ == 0 || now_s - readings_[(count_ - 1) % kReadings].at_s >= kApart_s)
    readings_[count_++ % kReadings] = {R, now_s};
  const Reading* from = nullptr;
  for (std::size_t back = 1; back <= count_ && back <= kReadings; ++back) {
    from = &readings_[(count_ - back) % kReadings];
    if (now_s - from->at_s >= kOver_s) break;
  }
  const double since_s = now_s - from->at_s;
  return since_s > 0.0 ? Vec3(log_rotation(R * from->R.transpose()) / since_s) : Vec3(Vec3::Zero());
}

Mat3 TurnFill::shown() const noexcept {
  if (samples_ >= over_) return reading_;
  return exp_rotation(static_cast<double>(samples_) / over_ * turn_) * from_;
}

Mat3 TurnFill::show(const Mat3& reading) noexcept {
  if (!has_reading_ || reading != reading_) {
    from_ = has_reading_ ? shown() : reading;
    turn_ = log_rotation(reading * from_.transpose());
    // The shorter of the last two: a handle that rested is not a sensor that is slow.
    over_ = has_reading_ ? std::min({gap_, samples_, kMostSamples}) : 1;
    if (has_reading_) gap_ = samples_;
    reading_ = reading;
    samples_ = 0;
    has_reading_ = true;
  }
  if (samples_ <= kMostSamples) ++samples_;
  return shown();
}

}  // namespace tactum::inline v0_1
