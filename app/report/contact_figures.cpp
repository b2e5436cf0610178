/// Where it touched, and how hard: the contact map.

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/report/bounded_series.h"
#include "app/report/run_figures.h"

namespace tactum {
namespace {

constexpr std::size_t kMapPoints = 2000;

/// What two bodies did to each other.
struct PairOfBodies {
  std::uint64_t points = 0, slipping = 0, sticking = 0;
  RunningMean force_N;
};

class ContactFigures final : public FigureMaker {
 public:
  ContactFigures(FrameColumns& columns, const std::vector<std::string>& bodies)
      : bodies_(bodies),
        points_(columns("grasped_contact_points")),
        distance_(columns("min_distance_m")),
        penetrating_(columns("penetrating")) {}

  void frame(const FrameNumbers& frame) override {
    count_.add(frame.time_s, frame.number(points_));
    touching_ += frame.number(points_) > 0.0;
    impossible_ += frame.number(penetrating_) > 0.0;
    if (frame.number(penetrating_) > 0.0) deepest_m_ = std::max(deepest_m_, -frame.number(distance_));
  }

  void contacts(const RecordedContacts& recorded) override {
    left_out_ += static_cast<std::uint64_t>(std::max(recorded.left_out, 0));
    for (const ShownContact& contact : recorded.contacts) {
      ++recorded_;
      if (!(contact.force_N > 0.0)) continue;
      PairOfBodies& pair = pairs_[{contact.body_a, contact.body_b}];
      ++pair.points;
      pair.slipping += contact.grip == Grip::kSlips;
      pair.sticking += contact.grip == Grip::kSticks;
      pair.force_N.add(contact.force_N);
      largest_N_ = std::max(largest_N_, contact.force_N);
      const Vec3& p = contact.p_W;
      above_.add({p.x(), p.y(), contact.force_N});
      beside_.add({p.x(), p.z(), contact.force_N});
    }
  }

  void finish(RunFigures& figures) const override {
    const char* section = "Contact";
    auto& numbers = figures.quantities;
    const auto count = [&](const char* key, const char* label, std::uint64_t value) {
      numbers.push_back({section, key, label, static_cast<double>(value), ""});
    };
    count("contact_frames", "frames in which something pushed the grasped part", touching_);
    count("penetrating_frames", "frames with an overlap, by the gaps at the ends of steps", impossible_);
    numbers.push_back({section, "deepest_overlap_m", "deepest overlap", deepest_m_, "um", 1e6});
    count("contact_points", "contact points recorded", recorded_);
    count("contact_points_left_out", "contact points beyond those of a frame that are recorded", left_out_);
    numbers.push_back(
        {section, "largest_contact_force_N", "largest force of a contact point", largest_N_, "N"});
    figures.panels.push_back({"Contact points that push the grasped part", "time [s]", "points in a frame"});
    figures.panels.back().bands = {band_of("", count_)};
    figures.panels.push_back(map_of("Contact map from above, axes of the world", "y [mm]", above_));
    figures.panels.push_back(map_of("Contact map from the side, axes of the world", "z [mm]", beside_));
    FigureTable table{"Pairs of bodies that pushed each other",
                      {"on", "by", "points", "mean force [N]", "largest force [N]", "sticking", "slipping"},
                      {}};
    for (const auto& [bodies, pair] : pairs_)
      table.rows.push_back({name_of(bodies.first), name_of(bodies.second), fmt::format("{}", pair.points),
                            fmt::format("{:.4g}", pair.force_N.mean()),
                            fmt::format("{:.4g}", pair.force_N.largest()), fmt::format("{}", pair.sticking),
                            fmt::format("{}", pair.slipping)});
    figures.tables.push_back(std::move(table));
  }

 private:
  using Points = SampledPoints<kMapPoints>;

  std::string name_of(int body) const {
    const auto i = static_cast<std::size_t>(body);
    return body >= 0 && i < bodies_.size() ? bodies_[i] : fmt::format("body {}", body);
  }
  Panel map_of(const std::string& title, const std::string& up, const Points& points) const {
    Panel panel{title, "x [mm]", up};
    panel.equal_scales = true;
    if (points.points().empty()) return panel;
    PanelDots dots{fmt::format("the area of a dot is its force, at most {:.3g} N", largest_N_), {}};
    for (const auto& [x, y, force_N] : points.points())
      dots.points.push_back({x * 1e3, y * 1e3, force_N / largest_N_});
    panel.dots = {std::move(dots)};
    return panel;
  }

  const std::vector<std::string>& bodies_;
  std::size_t points_, distance_, penetrating_;
  BoundedSeries count_;
  std::uint64_t touching_ = 0, impossible_ = 0, recorded_ = 0, left_out_ = 0;
  double deepest_m_ = 0.0, largest_N_ = 0.0;
  std::map<std::pair<int, int>, PairOfBodies> pairs_;
  Points above_, beside_;
};

}  // namespace

void add_contact_figures(FigureMakers& makers, FrameColumns& columns,
                         const std::vector<std::string>& bodies) {
  makers.push_back(std::make_unique<ContactFigures>(columns, bodies));
}

}  // namespace tactum
