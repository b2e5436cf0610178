#include "tactum/recording/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/recorded_scene.h"
#include "tactum/recording/recording_visitor.h"

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

/// The first number, by stage and then by place, in which the rows differ; -1 when there is none.
int first_difference(const std::vector<double>& recorded, const std::vector<double>& replayed) {
  int first = -1;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (same_bits(recorded[i], replayed[i])) continue;
    const auto stage = [](std::size_t place) { return stage_of(report_numbers()[place].field->name); };
    if (first < 0 || stage(i) < stage(static_cast<std::size_t>(first))) first = static_cast<int>(i);
  }
  return first;
}

/// Places of what RunExtremes are made of.
struct ExtremePlaces {
  std::size_t force, torque, hand, proxy, grasped, pushing;
};

std::size_t place_called(const char* name) {
  const auto& all = report_numbers();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& n) { return n.name == name; });
  TACTUM_DEMAND(found != all.end());
  return static_cast<std::size_t>(found - all.begin());
}

class Replaying final : public RecordingVisitor {
 public:
  Replaying(const std::string& name, const ReplayOptions& options)
      : RecordingVisitor(name),
        options_(options),
        numbers_(report_numbers().size()),
        places_{place_called("shown_fx_N"),   place_called("shown_tx_Nm"),
                place_called("X_WH_px_m"),    place_called("X_WH_proxy_px_m"),
                place_called("grasped_body"), place_called("grasped_contact_points")} {}

  ReplayResult result;
  std::optional<Error> cannot;  // nothing can be replayed

 private:
  Result<void> begin(Files files) override {
    Result<RecordedScene> built = build_recorded(head(), files, options_, name());
    if (!built) {
      cannot = built.error();
      return built.error();
    }
    scene_ = std::move(*built);
    result.notes = scene_.notes;
    return {};
  }

  Result<void> command(const RecordedCommand& recorded) override {
    // Those that lead the hand have come in by the device's samples.
    if (recorded.command.kind == SessionCommand::Kind::kSet && !result.gap)
      set_live(recorded.command, scene_.device_limits, scene_.simulation->settings(), scene_.safety);
    return {};
  }

  Result<void> input(const RecordedInput& input) override {
    if (result.gap) return {};
    if (input.tick.index != result.frames) {
      result.gap = input.tick.index;
      return {};
    }
    scene_.simulation->run(input.sample, input.tick);
    put_report(scene_.simulation->report(), numbers_.data());
    add(numbers_, result.replayed);
    same_state_ = state_hash(scene_.simulation->report(), scene_.simulation->state()) == input.hash;
    ++result.frames;
    stepped_ = true;
    return {};
  }

  Result<void> report(const std::vector<double>& recorded) override {
    if (!stepped_) return {};
    stepped_ = false;
    add(recorded, result.recorded);
    if (result.difference) return {};
    const int place = first_difference(recorded, numbers_);
    if (place < 0 && same_state_) {
      ++result.same;
      return {};
    }
    ReplayDifference& difference = result.difference.emplace();
    difference.frame = result.frames - 1;
    if (place < 0) return {};
    const auto i = static_cast<std::size_t>(place);
    const ReportNumber& number = report_numbers()[i];
    difference.stage = stage_name(stage_of(number.field->name));
    difference.field = number.name;
    difference.meaning = number.field->meaning;
    difference.recorded = recorded[i];
    difference.replayed = numbers_[i];
    return {};
  }

  void add(const std::vector<double>& numbers, RunExtremes& extremes) const {
    const auto vector = [&](std::size_t place) {
      return Vec3(numbers[place], numbers[place + 1], numbers[place + 2]);
    };
    extremes.max_force_N = std::max(extremes.max_force_N, vector(places_.force).norm());
    extremes.max_torque_Nm = std::max(extremes.max_torque_Nm, vector(places_.torque).norm());
    if (numbers[places_.grasped] >= 0.0)
      extremes.max_stretch_m =
          std::max(extremes.max_stretch_m, (vector(places_.hand) - vector(places_.proxy)).norm());
    if (numbers[places_.pushing] > 0.0) ++extremes.contact_frames;
  }

  const ReplayOptions& options_;
  RecordedScene scene_;
  std::vector<double> numbers_;
  ExtremePlaces places_;
  bool stepped_ = false;     // a frame was stepped, and its report has not been compared
  bool same_state_ = false;  // its hash is the recorded one
};

}  // namespace

Result<ReplayResult> replay(const McapSource& source, const std::string& name, const ReplayOptions& options) {
  Replaying replaying(name, options);
  McapEnd end = read_recording(source, replaying);
  if (replaying.cannot) return *replaying.cannot;
  if (!replaying.begun() || (replaying.result.frames == 0 && end.wrong && !end.cut)) return *end.wrong;
  replaying.result.head = replaying.head();
  replaying.result.end = std::move(end);
  return std::move(replaying.result);
}

}  // namespace tactum::inline v0_1
