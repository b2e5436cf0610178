/// What the hand felt: force, torque, and force against position.

#include <array>
#include <cmath>

#include "app/report/bounded_series.h"
#include "app/report/run_figures.h"

namespace tactum {
namespace {

constexpr std::array kAxes = {"x", "y", "z"};
constexpr std::size_t kForcePoints = 1500;  // dots of a chart; more are one blot

class ForceFigures final : public FigureMaker {
 public:
  explicit ForceFigures(FrameColumns& columns)
      : sent_f_(columns("sent_fx_N")),
        sent_t_(columns("sent_tx_Nm")),
        computed_f_(columns("computed_fx_N")),
        computed_t_(columns("computed_tx_Nm")),
        hand_(columns("hand_px_m")),
        proxy_(columns("proxy_px_m")),
        grasped_(columns("grasped_body")) {}

  void frame(const FrameNumbers& frame) override {
    const Vec3 f = frame.vector(sent_f_), p = frame.vector(hand_);
    const double force_N = f.norm(), torque_Nm = frame.vector(sent_t_).norm();
    force_mean_.add(force_N);
    torque_mean_.add(torque_Nm);
    force_.add(frame.time_s, force_N);
    torque_.add(frame.time_s, torque_Nm);
    computed_force_.add(frame.time_s, frame.vector(computed_f_).norm());
    computed_torque_.add(frame.time_s, frame.vector(computed_t_).norm());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double force = f[static_cast<int>(axis)], place = p[static_cast<int>(axis)];
      along_[axis].add(frame.time_s, force);
      place_[axis].add(frame.time_s, place);
      against_[axis].add({place, force, 0.0});
    }
    if (frame.number(grasped_) < 0.0) return;
    const double stretch_m = (p - frame.vector(proxy_)).norm();
    stretch_.add(frame.time_s, stretch_m);
    stretch_mean_.add(stretch_m);
  }

  void finish(RunFigures& figures) const override {
    const char* section = "Force and torque";
    auto& numbers = figures.quantities;
    numbers.push_back({section, "largest_sent_force_N", "largest force sent", force_mean_.largest(), "N"});
    numbers.push_back({section, "mean_sent_force_N", "mean force sent", force_mean_.mean(), "N"});
    numbers.push_back(
        {section, "largest_sent_torque_Nm", "largest torque sent", torque_mean_.largest(), "mN m", 1e3});
    numbers.push_back({section, "mean_sent_torque_Nm", "mean torque sent", torque_mean_.mean(), "mN m", 1e3});
    numbers.push_back({section, "largest_stretch_m", "largest distance of hand and proxy",
                       stretch_mean_.largest(), "mm", 1e3});
    numbers.push_back(
        {section, "mean_stretch_m", "mean distance of hand and proxy", stretch_mean_.mean(), "mm", 1e3});
    auto& panels = figures.panels;
    panels.push_back({"Force on the hand: what the contacts, field and coupling ask for, and what was sent",
                      "time [s]", "magnitude of force [N]"});
    panels.back().bands = {band_of("computed", computed_force_), band_of("sent", force_)};
    panels.push_back({"Torque on the hand: what was asked for, and what was sent", "time [s]",
                      "magnitude of torque [mN m]"});
    panels.back().bands = {band_of("computed", computed_torque_, 1e3), band_of("sent", torque_, 1e3)};
    panels.push_back({"Components of the force sent, axes of the world", "time [s]", "force [N]"});
    panels.push_back({"Place of the hand, axes of the world", "time [s]", "place [mm]"});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      panels[panels.size() - 2].bands.push_back(band_of(kAxes[axis], along_[axis]));
      panels.back().bands.push_back(band_of(kAxes[axis], place_[axis], 1e3));
    }
    panels.push_back(
        {"Distance of hand and proxy: how far the coupling is stretched", "time [s]", "distance [mm]"});
    panels.back().bands = {band_of("", stretch_, 1e3)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name = kAxes[axis];
      panels.push_back({"Force sent against the place of the hand, along " + name + " of the world",
                        name + " of the hand [mm]", "force along " + name + " [N]"});
      PanelDots dots{"one frame in " + std::to_string(every(against_[axis])) + " has a dot", {}};
      if (every(against_[axis]) == 1) dots.legend = "a dot for every frame";
      for (const auto& point : against_[axis].points())
        dots.points.push_back({point[0] * 1e3, point[1], 0.0});
      panels.back().dots = {std::move(dots)};
    }
  }

 private:
  using Points = SampledPoints<kForcePoints>;
  static std::uint64_t every(const Points& points) { return points.stride(); }

  std::size_t sent_f_, sent_t_, computed_f_, computed_t_, hand_, proxy_, grasped_;
  BoundedSeries force_, torque_, computed_force_, computed_torque_, stretch_;
  RunningMean force_mean_, torque_mean_, stretch_mean_;
  std::array<BoundedSeries, 3> along_, place_;
  std::array<Points, 3> against_;
};

}  // namespace

void add_force_figures(FigureMakers& makers, FrameColumns& columns) {
  makers.push_back(std::make_unique<ForceFigures>(columns));
}

}  // namespace tactum
