/// What the last stage before the device did to the wrench.

#include <fmt/format.h>

#include <map>

#include "app/report/bounded_series.h"
#include "app/report/run_figures.h"
#include "tactum/loop/safety.h"

namespace tactum {
namespace {

struct SafetyFlagUse {
  std::uint64_t frames = 0;
  double first_s = 0.0, last_s = 0.0;
};

class SafetyFigures final : public FigureMaker {
 public:
  explicit SafetyFigures(FrameColumns& columns)
      : safety_(columns("safety")),
        passive_f_(columns("passive_fx_N")),
        sent_f_(columns("sent_fx_N")),
        passive_t_(columns("passive_tx_Nm")),
        sent_t_(columns("sent_tx_Nm")) {}

  void frame(const FrameNumbers& frame) override {
    const auto flags = static_cast<std::uint32_t>(frame.number(safety_));
    ++frames_;
    acted_ += flags != 0;
    faults_ += (flags & safety_flag::kFaults) != 0;
    invalid_ += !frame.input.sample.valid;
    refused_ += frame.input.tick.refused;
    for (int bit = 0; bit < 32; ++bit) {
      const std::uint32_t flag = std::uint32_t{1} << bit;
      if ((flags & flag) == 0) continue;
      SafetyFlagUse& use = uses_[flag];
      if (use.frames++ == 0) use.first_s = frame.time_s;
      use.last_s = frame.time_s;
    }
    const double force_N = (frame.vector(passive_f_) - frame.vector(sent_f_)).norm();
    withheld_N_.add(force_N);
    withheld_Nm_.add((frame.vector(passive_t_) - frame.vector(sent_t_)).norm());
    over_time_.add(frame.time_s, force_N);
  }

  void finish(RunFigures& figures) const override {
    const char* section = "Safety";
    auto& numbers = figures.quantities;
    const auto count = [&](const char* key, const char* label, std::uint64_t value) {
      numbers.push_back({section, key, label, static_cast<double>(value), ""});
    };
    count("safety_frames", "frames in which the safety stage acted", acted_);
    count("fault_frames", "of them, with a fault: no wrench was sent", faults_);
    count("invalid_samples", "reads of the device that failed", invalid_);
    count("refused_wrenches", "wrenches that the device did not take", refused_);
    numbers.push_back(
        {section, "largest_withheld_force_N", "largest force held back", withheld_N_.largest(), "N"});
    numbers.push_back({section, "largest_withheld_torque_Nm", "largest torque held back",
                       withheld_Nm_.largest(), "mN m", 1e3});
    figures.panels.push_back(
        {"Force that the safety stage held back: wanted less sent", "time [s]", "force [N]"});
    figures.panels.back().bands = {band_of("", over_time_)};
    FigureTable table{
        "What the safety stage did", {"action", "frames", "share", "first [s]", "last [s]"}, {}};
    for (const auto& [flag, use] : uses_) {
      const std::string name = safety_flag_names(flag);
      table.rows.push_back(
          {name.empty() ? fmt::format("flag {:#x}", flag) : name, fmt::format("{}", use.frames),
           fmt::format("{:.3g} %", 100.0 * static_cast<double>(use.frames) / static_cast<double>(frames_)),
           fmt::format("{:.3f}", use.first_s), fmt::format("{:.3f}", use.last_s)});
    }
    figures.tables.push_back(std::move(table));
  }

 private:
  std::size_t safety_, passive_f_, sent_f_, passive_t_, sent_t_;
  std::uint64_t frames_ = 0, acted_ = 0, faults_ = 0, invalid_ = 0, refused_ = 0;
  std::map<std::uint32_t, SafetyFlagUse> uses_;
  RunningMean withheld_N_, withheld_Nm_;
  BoundedSeries over_time_;
};

}  // namespace

void add_safety_figures(FigureMakers& makers, FrameColumns& columns) {
  makers.push_back(std::make_unique<SafetyFigures>(columns));
}

}  // namespace tactum
