/// How long the frames took, when they came, and how old the samples were.

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "app/report/bounded_series.h"
#include "app/report/run_figures.h"
#include "tactum/telemetry/statistics.h"

namespace tactum {
namespace {

/// What a clock does not tell apart: a sum of periods deviates by as much from rounding.
constexpr double kClockStep_s = 1e-9;

constexpr std::array kStageNames = {"hand", "motion_bounds", "near_pairs", "exact_tests", "response", "show"};

std::int64_t ns_of(double time_s) { return static_cast<std::int64_t>(std::llround(time_s * 1e9)); }

std::vector<PanelBar> bars_of(const RatioBins& bins) {
  std::vector<PanelBar> bars;
  for (const auto& [bin, count] : bins.counts())
    bars.push_back({RatioBins::edge(bin) * 1e6, RatioBins::edge(bin + 1) * 1e6, static_cast<double>(count)});
  return bars;
}

class TimeFigures final : public FigureMaker {
 public:
  explicit TimeFigures(FrameColumns& columns) {
    for (std::size_t i = 0; i < kStageNames.size(); ++i)
      places_[i] = columns(std::string("stage_") + kStageNames[i] + "_s");
  }

  void frame(const FrameNumbers& frame) override {
    double sum_s = 0.0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const double time_s = frame.number(places_[i]);
      stages_[i].add(ns_of(time_s));
      sum_s += time_s;
    }
    durations_.add(ns_of(sum_s));
    means_.add(sum_s);
    duration_bins_.add(sum_s);
    over_time_.add(frame.time_s, sum_s);
    const FrameTick& tick = frame.input.tick;
    late_ += tick.late;
    if (frame.input.sample.valid) {
      age_.add(tick.now_s - frame.input.sample.time_s);
      ages_.add(frame.time_s, tick.now_s - frame.input.sample.time_s);
    }
    if (known_ && tick.index == before_.index + 1) {
      const double off_s = tick.now_s - before_.now_s - tick.period_s;
      jitter_.add(std::abs(off_s));
      squares_ += off_s * off_s;
      if (std::abs(off_s) >= kClockStep_s) jitter_bins_.add(std::abs(off_s));
    }
    known_ = true;
    before_ = tick;
  }

  void finish(RunFigures& figures) const override {
    const char* section = "Time";
    auto& numbers = figures.quantities;
    const auto micro = [&](const char* key, const char* label, double value_s) {
      numbers.push_back({section, key, label, value_s, "us", 1e6});
    };
    const Summary times = durations_.summary();
    micro("mean_frame_time_s", "frame, mean", means_.mean());
    micro("p50_frame_time_s", "frame, median", times.p50_ns / 1e9);
    micro("p99_frame_time_s", "frame, 99 % are shorter", times.p99_ns / 1e9);
    micro("p999_frame_time_s", "frame, 99.9 % are shorter", times.p999_ns / 1e9);
    micro("largest_frame_time_s", "frame, longest", means_.largest());
    micro("mean_latency_s", "latency: age of the sample at its frame, mean", age_.mean());
    micro("largest_latency_s", "latency, largest", age_.largest());
    const double count = static_cast<double>(jitter_.count());
    micro("jitter_rms_s", "jitter: root mean square of period less nominal period",
          count > 0.0 ? std::sqrt(squares_ / count) : 0.0);
    micro("largest_jitter_s", "jitter, largest", jitter_.largest());
    numbers.push_back(
        {section, "late_frames", "frames later than the loop allows", static_cast<double>(late_), ""});
    if (means_.largest() == 0.0) figures.notes.emplace_back("No times of frames were taken in this run.");
    if (jitter_.largest() < kClockStep_s * 10.0)
      figures.notes.emplace_back(
          "The clock of the loop did not deviate: the run was on the virtual clock, which has no jitter.");
    add_panels(figures, times);
    FigureTable table{"Times of the stages",
                      {"stage", "mean [us]", "median [us]", "99 % [us]", "99.9 % [us]", "longest [us]"},
                      {}};
    for (std::size_t i = 0; i < kStageNames.size(); ++i) {
      const Summary stage = stages_[i].summary();
      table.rows.push_back({kStageNames[i]});
      for (const double time_ns : {stage.mean_ns, stage.p50_ns, stage.p99_ns, stage.p999_ns, stage.max_ns})
        table.rows.back().push_back(fmt::format("{:.4g}", time_ns / 1e3));
    }
    figures.tables.push_back(std::move(table));
  }

 private:
  void add_panels(RunFigures& figures, const Summary& times) const {
    Panel histogram{"Histogram of frame times", "frame time [us]", "frames"};
    histogram.log_x = true;
    histogram.bars = bars_of(duration_bins_);
    if (means_.largest() > 0.0)
      for (const auto& [time_ns, word] :
           {std::pair{times.p50_ns, "median"}, {times.p99_ns, "99 %"}, {times.p999_ns, "99.9 %"}})
        histogram.marks.push_back({time_ns / 1e3, fmt::format("{} {:.3g} us", word, time_ns / 1e3)});
    figures.panels.push_back(std::move(histogram));
    figures.panels.push_back({"Frame times over the run", "time [s]", "frame time [us]"});
    figures.panels.back().bands = {band_of("", over_time_, 1e6)};
    figures.panels.push_back({"Latency: age of the device's sample at its frame", "time [s]", "age [us]"});
    figures.panels.back().bands = {band_of("", ages_, 1e6)};
    Panel jitter{"Jitter: deviation of the period from its nominal length", "deviation [us]", "frames"};
    jitter.log_x = true;
    jitter.bars = bars_of(jitter_bins_);
    figures.panels.push_back(std::move(jitter));
  }

  std::array<std::size_t, kStageNames.size()> places_{};
  std::array<DurationHistogram, kStageNames.size()> stages_;
  DurationHistogram durations_;
  RunningMean means_, age_, jitter_;
  RatioBins duration_bins_, jitter_bins_;
  BoundedSeries over_time_, ages_;
  double squares_ = 0.0;
  std::uint64_t late_ = 0;
  bool known_ = false;
  FrameTick before_;
};

}  // namespace

void add_time_figures(FigureMakers& makers, FrameColumns& columns) {
  makers.push_back(std::make_unique<TimeFigures>(columns));
}

}  // namespace tactum
