#include "tactum/telemetry/run_record.h"
#include "tactum/haptics/frame_hash.h"

#include <algorithm>

namespace tactum::inline v0_1 {

void RunRecord::add(const FrameReport& report, const WorldState& world,
                    std::span<const HandReport> others) noexcept {
  ++frames;
  if (report.in_contact()) ++colliding_frames;
  if (report.grasped_contact_points > 0) ++grasped_contact_frames;
  if (report.penetrating) ++penetrating_frames;
  max_penetration_m = std::max(max_penetration_m, -report.min_distance_m);
  if (!report.coupling.finite() || !report.smoothed.finite()) ++non_finite_frames;

  if (report.forced_short) {
    ++forced_short_frames;
  } else {
    max_momentum_off_Ns = std::max(max_momentum_off_Ns, report.momentum_off_Ns);
  }

  const double force = report.shown.f.norm();
  const double torque = report.shown.t.norm();
  max_force_N = std::max(max_force_N, force);
  max_torque_Nm = std::max(max_torque_Nm, torque);
  sum_force_N += force;
  sum_torque_Nm += torque;
  max_force_step_N = std::max(max_force_step_N, (report.shown.f - last_shown_.f).norm());
  max_torque_step_Nm = std::max(max_torque_step_Nm, (report.shown.t - last_shown_.t).norm());
  last_shown_ = report.shown;

  for (std::size_t h = 0; h < std::min(others.size(), other_hands.size()); ++h) {
    HandRun& hand = other_hands[h];
    const Wrench& shown = others[h].shown;
    if (others[h].grasped_contact_points > 0) ++hand.grasped_contact_frames;
    if (!others[h].coupling.finite() || !others[h].smoothed.finite()) ++non_finite_frames;
    hand.max_force_N = std::max(hand.max_force_N, shown.f.norm());
    hand.max_torque_Nm = std::max(hand.max_torque_Nm, shown.t.norm());
    hand.max_force_step_N = std::max(hand.max_force_step_N, (shown.f - hand.last_shown.f).norm());
    hand.safety |= others[h].safety;
    hand.last_shown = shown;
  }

  flags |= report.flags;
  if (report.flags & frame_flag::kLags) ++lagging_frames;
  safety |= report.safety;
  max_tests = std::max(max_tests, report.tests());
  for_each_report_field([&](auto field) {
    using Field = decltype(field);
    if constexpr (Field::kInfo.in_run != InRun::kNothing) {
      double& largest = largest_[Field::kPlace];
      largest = std::max(largest, static_cast<double>(Field::of(report)));
      if constexpr (Field::kInfo.in_run == InRun::kSum)
        sum_[Field::kPlace] += static_cast<std::uint64_t>(Field::of(report));
    }
  });
  add_to(hash_, report);
  add_to(hash_, others);
  add_to(hash_, world);
}

void StageClock::stage_ended(Stage stage) noexcept {
  const Clock::time_point now = Clock::now();
  const std::int64_t duration_ns = std::chrono::nanoseconds(now - last_).count();
  frame_ns_[static_cast<std::size_t>(stage)] = duration_ns;
  histograms_[static_cast<std::size_t>(stage)].add(duration_ns);
  last_ = now;
}

std::vector<StageSummary> StageClock::summaries() const {
  std::vector<StageSummary> stages;
  for (int i = 0; i < kStageCount; ++i)
    stages.push_back({stage_name(static_cast<Stage>(i)), histograms_[static_cast<std::size_t>(i)].summary()});
  return stages;
}

const char* stage_name(Stage stage) noexcept {
  switch (stage) {
    case Stage::kHand:
      return "hand";
    case Stage::kVelocities:
      return "velocities";
    case Stage::kNearPairs:
      return "near pairs";
    case Stage::kExactTests:
      return "exact tests";
    case Stage::kResponse:
      return "response";
    case Stage::kShow:
      return "show";
  }
  return "";
}

}  // namespace tactum::inline v0_1
