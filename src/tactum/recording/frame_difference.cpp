#include "tactum/recording/frame_difference.h"

#include <fmt/format.h>

#include <cstring>

#include "tactum/recording/frame_numbers.h"
#include "tactum/telemetry/run_record.h"

namespace tactum::inline v0_1 {
namespace {

/// The stage that decides a field of the report.
Stage stage_of(std::string_view field) {
  if (field == "index" || field == "X_WH" || field == "grasped_body" || field == "hold" || field == "field")
    return Stage::kHand;
  if (field == "work.broad_phase_runs" || field == "work.near_pairs" || field == "work.bodies")
    return Stage::kNearPairs;
  if (field.starts_with("work.") || field == "tolerance_m" || field == "min_distance_m" ||
      field == "penetrating")
    return Stage::kExactTests;
  for (const char* shown : {"coupling", "smoothed", "passive", "shown", "safety", "flags"})
    if (field == shown) return Stage::kShow;
  return field.starts_with("port.") ? Stage::kShow : Stage::kResponse;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Looks at one number after the other until two differ.
class InputComparison {
 public:
  explicit InputComparison(std::uint64_t frame) : frame_(frame) {}
  void look(const char* field, const char* meaning, double before, double after) {
    if (!found && !same_bits(before, after))
      found = FrameDifference{frame_, "input", field, meaning, before, after, ""};
  }
  void look(const char* field, const char* meaning, const Vec3& before, const Vec3& after) {
    for (int i = 0; i < 3; ++i) look(field, meaning, before[i], after[i]);
  }
  std::optional<FrameDifference> found;

 private:
  std::uint64_t frame_;
};

/// Of numbers with these names.
std::optional<FrameDifference> difference_in(std::uint64_t frame, const std::vector<ReportNumber>& numbers,
                                             const std::vector<double>& before,
                                             const std::vector<double>& after) {
  const auto stage = [&](std::size_t place) { return stage_of(numbers[place].field->name); };
  std::optional<std::size_t> first;  // by stage, and then by place
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!same_bits(before[i], after[i]) && (!first || stage(i) < stage(*first))) first = i;
  if (!first) return {};
  const ReportNumber& number = numbers[*first];
  return FrameDifference{
      frame, stage_name(stage(*first)), number.name, number.field->meaning, before[*first], after[*first],
      ""};
}

void look_at(InputComparison& compare, const DeviceSample& a, const DeviceSample& b) {
  compare.look("valid", "the read succeeded", a.valid, b.valid);
  compare.look("has_velocity", "the device measures its velocity", a.has_velocity, b.has_velocity);
  compare.look("motors_on", "the device says that it pushes", a.motors_on, b.motors_on);
  compare.look("buttons", "of the device", a.buttons, b.buttons);
  compare.look("time_s", "when the sample was measured", a.time_s, b.time_s);
  compare.look("p_DH_m", "the handle in the frame of the device", a.X_DH.p, b.X_DH.p);
  for (int i = 0; i < 3; ++i)
    compare.look("R_DH", "its axes", Vec3(a.X_DH.R.row(i).transpose()), Vec3(b.X_DH.R.row(i).transpose()));
  compare.look("v_DH_m_per_s", "velocity of the handle", a.V_DH.v, b.V_DH.v);
  compare.look("w_DH_rad_per_s", "angular velocity of the handle", a.V_DH.w, b.V_DH.w);
}

}  // namespace

std::optional<FrameDifference> difference_of(std::uint64_t frame, const std::vector<double>& before,
                                             const std::vector<double>& after) {
  return difference_in(frame, report_numbers(), before, after);
}

std::optional<FrameDifference> difference_of(const RecordedHand& before, const RecordedHand& after) {
  InputComparison compare(after.index);
  compare.look("refused", "the device did not take the last wrench", before.sample.refused,
               after.sample.refused);
  look_at(compare, before.sample, after.sample);
  if (!compare.found) compare.found = difference_in(after.index, hand_numbers(), before.report, after.report);
  if (compare.found) compare.found->field.insert(0, fmt::format("h{}_", after.hand + 1));
  return compare.found;
}

std::optional<FrameDifference> difference_of(const RecordedInput& before, const RecordedInput& after) {
  InputComparison compare(after.tick.index);
  const FrameTick &s = before.tick, &t = after.tick;
  compare.look("now_s", "the loop's clock", s.now_s, t.now_s);
  compare.look("period_s", "nominal time between frames", s.period_s, t.period_s);
  compare.look("late", "the frame came too late", s.late, t.late);
  compare.look("refused", "the device did not take the last wrench", s.refused, t.refused);
  compare.look("stop", "the wrench is led to zero", s.stop, t.stop);
  look_at(compare, before.sample, after.sample);
  return compare.found;
}

std::string sentence_of(const FrameDifference& difference) {
  if (difference.field.empty())
    return fmt::format(
        "frame {} is the first that differs: in what is carried from frame to frame{}, while every field of "
        "its report is the same",
        difference.frame, difference.carried.empty() ? "" : fmt::format(" ({})", difference.carried));
  return fmt::format("frame {} is the first that differs: stage \"{}\", field {} ({}) was {} and is {}",
                     difference.frame, difference.stage, difference.field, difference.meaning,
                     difference.before, difference.after);
}

}  // namespace tactum::inline v0_1
