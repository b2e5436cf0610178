#include "tactum/recording/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/haptics/frame_snapshot.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/recording/frame_numbers.h"
#include "tactum/recording/replayed_run.h"

namespace tactum::inline v0_1 {
namespace {

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

std::string section_and_key(const SettingInfo& setting) {
  return setting.section[0] == '\0' ? setting.key : fmt::format("{}.{}", setting.section, setting.key);
}

/// Compares the frames of a run that is computed again with those that were recorded.
class Comparing {
 public:
  /// `settings`: whether those of the recording are in force, and are compared.
  Comparing(const ReplayedRun& run, bool settings)
      : run_(run), settings_(settings), numbers_(report_numbers().size()) {}
  ReplayResult result;

  /// Before a frame is computed: the state that it begins with, where it was recorded.
  void begin(const TapeFrame& recorded) {
    carried_.clear();
    RecordedSnapshot snapshot;
    if (recorded.input.tick.index == result.first) return;  // it was taken over, or is that of the scene
    if (recorded.snapshot.empty() || !recording::read_snapshot_message(recorded.snapshot, snapshot)) return;
    const FrameState& state = run_.simulation().state();
    if (snapshot.layout != recording::layout_of_snapshots(state)) return;
    state_.resize(write_snapshot(state, {}));
    write_snapshot(state, state_);
    carried_ = differing_setting(snapshot.settings);
    if (!carried_.empty()) return;
    if (state_ == snapshot.state) {
      if (!result.difference) ++result.states;
      return;
    }
    const auto differs =
        std::mismatch(state_.begin(), state_.end(), snapshot.state.begin(), snapshot.state.end());
    carried_ = fmt::format("of \"{}\"",
                           snapshot_part(state, static_cast<std::size_t>(differs.first - state_.begin())));
  }

  void end(const TapeFrame& recorded) {
    const FrameReport& report = run_.simulation().report();
    put_report(report, numbers_.data());
    add(numbers_, result.replayed);
    add(recorded.report, result.recorded);
    ++result.frames;
    if (result.difference) return;
    result.difference = difference_of(recorded.input.tick.index, recorded.report, numbers_);
    for (std::size_t i = 0; i < recorded.others.size() && !result.difference; ++i) {
      other_ = recorded.others[i];
      put_hand_report(run_.simulation().state().other_reports[i], other_.report.data());
      result.difference = difference_of(recorded.others[i], other_);
    }
    if (result.difference) return;
    const bool same = state_hash(report, run_.simulation().state()) == recorded.input.hash;
    if (same && carried_.empty()) {
      ++result.same;
      return;
    }
    result.difference.emplace();
    result.difference->frame = recorded.input.tick.index;
    result.difference->carried = carried_;
  }

 private:
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

  /// The first setting that a snapshot has otherwise; empty for none.
  std::string differing_setting(const std::vector<double>& recorded) const {
    const std::span<const SettingInfo> table = setting_table();
    FrameSettings now = run_.simulation().settings();
    std::string found;
    if (!settings_ || recorded.size() != table.size() * now.hands()) return found;
    with_every_hand(now, [&](std::size_t hand) {
      for (std::size_t i = 0; i < table.size() && found.empty(); ++i) {
        SafetySettings safety = run_.scene().safety;
        const double value = table[i].get(now, safety), was = recorded[hand * table.size() + i];
        if (value == was || !in_range(table[i], was)) continue;
        table[i].set(now, safety, was);  // one in degrees may come back with another last bit
        if (table[i].get(now, safety) != value)
          found =
              fmt::format("the setting {}, which was {} and is {}", section_and_key(table[i]), was, value);
      }
    });
    return found;
  }

  const ReplayedRun& run_;
  bool settings_;
  std::vector<double> numbers_;
  ExtremePlaces places_{place_called("shown_fx_N"),   place_called("shown_tx_Nm"),
                        place_called("X_WH_px_m"),    place_called("X_WH_proxy_px_m"),
                        place_called("grasped_body"), place_called("grasped_contact_points")};
  RecordedHand other_;
  std::string state_;
  std::string carried_;  // the part of the state in which the frame began otherwise; empty: in none
};

}  // namespace

Result<ReplayResult> replay(const McapSource& source, const std::string& name, const ReplayOptions& options) {
  Result<std::unique_ptr<ReplayedRun>> opened = ReplayedRun::open(source, name, options);
  if (!opened) return opened.error();
  ReplayedRun& run = **opened;
  const RecordingTape& tape = run.tape();
  if (tape.past() == tape.first() && tape.end().wrong && !tape.end().cut) return *tape.end().wrong;
  const double dt_s = tape.head().dt_s;
  if (options.from_s > 0.0) {
    const double last = static_cast<double>(tape.past());
    const double frame = std::floor(options.from_s / dt_s + 0.5);
    if (!(frame < last))
      return Error{"the recording ends before that time", fmt::format("{:.3f} s", last * dt_s),
                   fmt::format("more than {} s", options.from_s), name};
    if (Result<void> restored = run.restore(run.snapshot_before(static_cast<std::uint64_t>(frame)));
        !restored)
      return restored.error();
  }
  Comparing comparing(run, options.settings.empty() && options.changed.empty() && options.response.empty());
  comparing.result.first = run.next_index();
  while (true) {
    const Result<const TapeFrame*> frame =
        run.step([&](const TapeFrame& recorded) { comparing.begin(recorded); });
    if (!frame) return frame.error();
    if (*frame == nullptr) break;
    comparing.end(**frame);
  }
  comparing.result.gap = tape.gap();
  comparing.result.head = tape.head();
  comparing.result.notes = run.scene().notes;
  comparing.result.end = tape.end();
  return std::move(comparing.result);
}

}  // namespace tactum::inline v0_1
