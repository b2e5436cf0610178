/// The energy that passed between hand and scene.

#include <algorithm>

#include "app/report/bounded_series.h"
#include "app/report/run_figures.h"

namespace tactum {
namespace {

class EnergyFigures final : public FigureMaker {
 public:
  explicit EnergyFigures(FrameColumns& columns)
      : balance_(columns("energy_balance_J")),
        stored_(columns("energy_stored_J")),
        generated_(columns("energy_generated_J")),
        paid_(columns("energy_paid_J")),
        share_(columns("energy_stiffness_share")),
        from_hand_(columns("energy_total_from_hand_J")),
        to_hand_(columns("energy_total_to_hand_J")) {}

  void frame(const FrameNumbers& frame) override {
    balances_.add(frame.time_s, frame.number(balance_));
    stores_.add(frame.time_s, frame.number(stored_));
    given_.add(frame.time_s, frame.number(from_hand_));
    taken_.add(frame.time_s, frame.number(to_hand_));
    generations_.add(frame.time_s, frame.number(generated_));
    shares_.add(frame.time_s, frame.number(share_));
    least_balance_J_ = any_ ? std::min(least_balance_J_, frame.number(balance_)) : frame.number(balance_);
    least_share_ = std::min(least_share_, frame.number(share_));
    any_ = true;
    last_ = {frame.number(from_hand_), frame.number(to_hand_), frame.number(generated_), frame.number(paid_)};
  }

  void finish(RunFigures& figures) const override {
    const char* section = "Energy";
    auto& numbers = figures.quantities;
    const auto joules = [&](const char* key, const char* label, double value) {
      numbers.push_back({section, key, label, value, "mJ", 1e3});
    };
    joules("energy_from_hand_J", "work of the hand on the scene", last_.from_hand);
    joules("energy_to_hand_J", "work of the scene on the hand", last_.to_hand);
    joules("energy_generated_J", "energy that nobody had put in", last_.generated);
    joules("energy_paid_J", "of it, given up by the coupling", last_.paid);
    joules("least_energy_balance_J", "least energy balance", least_balance_J_);
    numbers.push_back({section, "least_stiffness_share", "least share of the coupling's stiffness in use",
                       least_share_, "%", 100.0});
    figures.panels.push_back({"Energy since the start", "time [s]", "energy [mJ]"});
    figures.panels.back().bands = {band_of("from the hand", given_, 1e3), band_of("to the hand", taken_, 1e3),
                                   band_of("stored", stores_, 1e3), band_of("generated", generations_, 1e3)};
    figures.panels.push_back(
        {"Energy balance: negative where energy was generated", "time [s]", "balance [mJ]"});
    figures.panels.back().bands = {band_of("", balances_, 1e3)};
    figures.panels.push_back(
        {"Share of the coupling's stiffness that the energy balance leaves", "time [s]", "share [%]"});
    figures.panels.back().bands = {band_of("", shares_, 100.0)};
  }

 private:
  struct Last {
    double from_hand = 0.0, to_hand = 0.0, generated = 0.0, paid = 0.0;
  };
  std::size_t balance_, stored_, generated_, paid_, share_, from_hand_, to_hand_;
  BoundedSeries balances_, stores_, given_, taken_, generations_, shares_;
  double least_balance_J_ = 0.0, least_share_ = 1.0;
  bool any_ = false;
  Last last_;
};

}  // namespace

void add_energy_figures(FigureMakers& makers, FrameColumns& columns) {
  makers.push_back(std::make_unique<EnergyFigures>(columns));
}

}  // namespace tactum
