#include "tactum/recording/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/haptics/frame_snapshot.h"
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

/// Compares the frames of a run that is computed again with those that were recorded.
class Comparing {
 public:
  explicit Comparing(const ReplayedRun& run) : run_(run), numbers_(report_numbers().size()) {}
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
    if (state_ == snapshot.state) {
      if (!result.difference) ++result.states;
      return;
    }
    const auto differs =
        std::mismatch(state_.begin(), state_.end(), snapshot.state.begin(), snapshot.state.end());
    carried_ = snapshot_part(state, static_cast<std::size_t>(differs.first - state_.begin()));
  }

  void end(const TapeFrame& recorded) {
    const FrameReport& report = run_.simulation().report();
    put_report(report, numbers_.data());
    add(numbers_, result.replayed);
    add(recorded.report, result.recorded);
    ++result.frames;
    if (result.difference) return;
    result.difference = difference_of(recorded.input.tick.index, recorded.report, numbers_);
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

  const ReplayedRun& run_;
  std::vector<double> numbers_;
  ExtremePlaces places_{place_called("shown_fx_N"),   place_called("shown_tx_Nm"),
                        place_called("X_WH_px_m"),    place_called("X_WH_proxy_px_m"),
                        place_called("grasped_body"), place_called("grasped_contact_points")};
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
  Comparing comparing(run);
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
