#include "app/report/run_figures.h"

#include <algorithm>
#include <optional>

#include "app/report/bounded_series.h"

namespace tactum {
namespace {

class FigureReading final : public RecordingVisitor {
 public:
  explicit FigureReading(const std::string& name) : RecordingVisitor(name) {}
  RunFigures figures;
  std::uint64_t frames = 0, dropped = 0;
  std::optional<Error> cannot;

  void finish() {
    const double duration_s = static_cast<double>(frames) * head().dt_s;
    figures.quantities.push_back({"Run", "frames", "frames", static_cast<double>(frames), ""});
    figures.quantities.push_back({"Run", "duration_s", "duration", duration_s, "s"});
    figures.quantities.push_back({"Run", "rate_Hz", "nominal rate", 1.0 / head().dt_s, "Hz"});
    figures.quantities.push_back(
        {"Run", "dropped_frames", "frames lost by the recorder", static_cast<double>(dropped), ""});
    for (const auto& maker : makers_) maker->finish(figures);
    figures.head = head();
    figures.file = name();
  }

 private:
  Result<void> begin(Files) override {
    FrameColumns columns(head().columns);
    time_ = columns("time_s");
    add_force_figures(makers_, columns);
    add_contact_figures(makers_, columns, head().bodies);
    add_energy_figures(makers_, columns);
    add_time_figures(makers_, columns);
    add_safety_figures(makers_, columns);
    if (columns.missing().empty()) return {};
    cannot = Error{"a column of the recording is missing", columns.missing(), "the columns of docs/trace.md",
                   name()};
    return *cannot;
  }
  Result<void> input(const RecordedInput& input) override {
    input_ = input;
    dropped = input.dropped;
    return {};
  }
  Result<void> row(const std::vector<double>& row) override {
    ++frames;
    for (const auto& maker : makers_) maker->frame({input_, row, row[time_]});
    return {};
  }
  Result<void> contacts(const RecordedContacts& contacts) override {
    for (const auto& maker : makers_) maker->contacts(contacts);
    return {};
  }

  FigureMakers makers_;
  std::size_t time_ = 0;
  RecordedInput input_;
};

}  // namespace

std::size_t FrameColumns::operator()(const std::string& name) {
  const auto found =
      std::find_if(columns_.begin(), columns_.end(), [&](const auto& column) { return column.name == name; });
  if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
  if (missing_.empty()) missing_ = name;
  return 0;
}

Result<RunFigures> figures_of(const McapSource& source, const std::string& name) {
  FigureReading reading(name);
  McapEnd end = read_recording(source, reading);
  if (reading.cannot) return *reading.cannot;
  if (!reading.begun()) return *end.wrong;
  if (reading.frames == 0)
    return Error{"there is nothing to report", "a recording without a whole frame", "at least one", name};
  reading.finish();
  reading.figures.end = std::move(end);
  return std::move(reading.figures);
}

PanelBand band_of(const std::string& legend, const BoundedSeries& series, double scale) {
  PanelBand band{legend, {}};
  for (const BoundedSeries::Stretch& stretch : series.stretches())
    band.points.push_back({stretch.from_s, scale * stretch.least, scale * stretch.largest});
  return band;
}

}  // namespace tactum
