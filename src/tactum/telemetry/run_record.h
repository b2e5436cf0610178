#pragma once
/// The sums of a whole run, added up frame by frame: forces, penetration, counted work, and a hash of the
/// run. It is cheap to add to from the loop: no allocation, a few dozen additions.

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "tactum/base/hash.h"
#include "tactum/haptics/frame_state.h"
#include "tactum/haptics/report_fields.h"
#include "tactum/response/frame_report.h"
#include "tactum/telemetry/statistics.h"

namespace tactum::inline v0_1 {

/// What is summed up of each hand after the first.
struct HandRun {
  std::uint64_t grasped_contact_frames = 0;  ///< frames in which something pushed its part
  double max_force_N = 0.0;                  ///< largest shown force [N]
  double max_torque_Nm = 0.0;                ///< largest shown torque [N m]
  double max_force_step_N = 0.0;             ///< largest change of the shown force from frame to frame [N]
  std::uint32_t safety = 0;                  ///< union of all frames' safety_flag
  Wrench last_shown;                         ///< of the last frame [N, N m]
};

class RunRecord {
 public:
  /// Of a run with so many hands.
  explicit RunRecord(std::size_t hands = 1) : other_hands(hands - 1) {}

  /// `others` are the reports of the second hand and all after it.
  void add(const FrameReport& report, const WorldState& world,
           std::span<const HandReport> others = {}) noexcept;

  std::uint64_t frames = 0;
  std::uint64_t colliding_frames = 0;        ///< frames with any patch
  std::uint64_t grasped_contact_frames = 0;  ///< frames in which something pushed the grasped part
  std::uint64_t penetrating_frames = 0;      ///< frames in which pieces overlapped
  double max_penetration_m = 0.0;            ///< deepest overlap [m]
  double max_force_N = 0.0;                  ///< largest shown force [N]
  double max_torque_Nm = 0.0;                ///< largest shown torque [N m]
  double max_force_step_N = 0.0;             ///< largest change of the shown force from frame to frame [N]
  double max_torque_step_Nm = 0.0;           ///< the same for torque [N m]
  double sum_force_N = 0.0;                  ///< of |shown force|, for the mean [N]
  double sum_torque_Nm = 0.0;                ///< of |shown torque|, for the mean [N m]
  double max_momentum_off_Ns = 0.0;          ///< of frames whose steps were all taken whole [N s]
  std::uint64_t forced_short_frames = 0;     ///< the others
  std::uint64_t lagging_frames = 0;          ///< frames with one of frame_flag::kLags
  std::uint64_t non_finite_frames = 0;       ///< frames whose computed wrench was not finite (zero was sent)
  std::uint32_t flags = 0;                   ///< union of all frames' frame_flag
  std::uint32_t safety = 0;                  ///< union of all frames' safety_flag
  std::vector<HandRun> other_hands;          ///< of the second hand and all after it
  int max_tests = 0;  ///< exact tests in one frame with those of trial poses, which the budget bounds

  /// Of a field that runs sum up (haptics/report_fields.h), by name: sum("work.exact_tests").
  std::uint64_t sum(ReportFieldName field) const noexcept { return sum_[field.place]; }
  /// The largest value of a frame, of a field that runs sum up or keep the largest of.
  double largest(ReportFieldName field) const noexcept { return largest_[field.place]; }
  /// The same by the field's place in the list.
  std::uint64_t sum_at(std::size_t place) const noexcept { return sum_[place]; }
  double largest_at(std::size_t place) const noexcept { return largest_[place]; }
  std::uint64_t hash() const noexcept { return hash_.value(); }

 private:
  std::array<std::uint64_t, kReportFields> sum_{};
  std::array<double, kReportFields> largest_{};
  Wrench last_shown_;
  FrameHash hash_;
};

/// Takes the times of the stages of frames. It reads the clock between stages, so that the frame need not.
class StageClock final : public StageObserver {
 public:
  /// Call just before the frame.
  void frame_begins() noexcept {
    frame_ns_ = {};
    last_ = Clock::now();
  }
  void stage_ended(Stage stage) noexcept override;
  /// Of the last frame; zero for a stage it did not have [ns].
  std::int64_t stage_ns(Stage stage) const noexcept { return frame_ns_[static_cast<std::size_t>(stage)]; }
  /// Of all frames so far; a stage counts where it took place.
  std::vector<StageSummary> summaries() const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_;
  std::array<std::int64_t, kStageCount> frame_ns_{};
  std::array<DurationHistogram, kStageCount> histograms_;
};

/// "hand", "velocities", ...
const char* stage_name(Stage stage) noexcept;

}  // namespace tactum::inline v0_1
