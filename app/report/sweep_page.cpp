#include "app/report/sweep_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "app/report/report_page.h"
#include "app/sweep/sweep_table.h"

namespace tactum {
namespace {

constexpr std::uint64_t kMostMaps = 40;
constexpr double kMapWidth = 320.0, kMapHeight = 240.0, kMapLeft = 92.0, kMapTop = 8.0, kMapBottom = 44.0;

struct MapMetric {
  const char* name;
  const char* title;
};
constexpr std::array kMapMetrics = {
    MapMetric{"success", "Success: 1 where all goals were met"},
    MapMetric{"success_time_s", "Time of success [s]"},
    MapMetric{"peak_force_N", "Peak force sent [N]"},
    MapMetric{"longest_jam_s", "Jam map: the longest time on end that the part was jammed [s]"},
    MapMetric{"jam_pz_m", "Jam map: height of the handle where that began, z of the world [m]"},
};

std::size_t place_of_metric(const char* name) {
  for (std::size_t i = 0; i < kSweepMetrics.size(); ++i)
    if (std::string_view(kSweepMetrics[i].name) == name) return i;
  return 0;
}

/// From dark blue over green to yellow, of even steps in lightness.
std::string colour_of(double share) {
  static constexpr double kStops[5][3] = {
      {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  const double at = std::clamp(share, 0.0, 1.0) * 4.0;
  const int below = std::min(static_cast<int>(at), 3);
  std::string colour = "#";
  for (int i = 0; i < 3; ++i)
    colour += fmt::format(
        "{:02x}", static_cast<int>(std::lround(kStops[below][i] +
                                               (at - below) * (kStops[below + 1][i] - kStops[below][i]))));
  return colour;
}

std::string tick_of(const SweepAxis& axis, std::size_t place) {
  if (const auto* word = std::get_if<std::string>(&axis.values[place])) return *word;
  return fmt::format("{:.3g}", number_of(axis, place));
}

/// How many maps a metric has.
std::uint64_t slices_of(const SweepPlan& plan) {
  std::uint64_t slices = 1;
  for (std::size_t i = 2; i < plan.axes.size(); ++i) slices *= plan.axes[i].values.size();
  return slices;
}

/// One metric of a sweep, and the range of its colours.
class MetricMaps {
 public:
  MetricMaps(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results, std::size_t metric)
      : plan_(plan), results_(results), metric_(metric) {
    for (const auto& [run, result] : results) {
      const double value = result.numbers[metric];
      if (!std::isfinite(value)) continue;
      low_ = any_ ? std::min(low_, value) : value;
      high_ = any_ ? std::max(high_, value) : value;
      any_ = true;
    }
  }

  /// The map for one choice of the axes beyond the second, which is counted by `slice`.
  std::string svg(std::uint64_t slice) const {
    const SweepAxis& up = plan_.axes[0];
    const std::size_t columns = plan_.axes.size() > 1 ? plan_.axes[1].values.size() : 1;
    const std::size_t rows = up.values.size();
    const double wide = (kMapWidth - kMapLeft - 8.0) / static_cast<double>(columns);
    const double high = (kMapHeight - kMapTop - kMapBottom) / static_cast<double>(rows);
    std::string svg = fmt::format(R"(<svg viewBox="0 0 {} {}" role="img">)", kMapWidth, kMapHeight);
    for (std::size_t row = 0; row < rows; ++row) {
      const double y = kMapHeight - kMapBottom - static_cast<double>(row + 1) * high;
      if (row % (1 + rows / 12) == 0)
        svg += fmt::format(R"(<text class="tick" x="{}" y="{:.1f}" text-anchor="end">{}</text>)",
                           kMapLeft - 5.0, y + 0.5 * high + 4.0, html_text(tick_of(up, row)));
      for (std::size_t column = 0; column < columns; ++column)
        svg += cell(run_at(row, column, slice), kMapLeft + static_cast<double>(column) * wide, y, wide, high);
    }
    for (std::size_t column = 0; column < columns && plan_.axes.size() > 1; ++column)
      if (column % (1 + columns / 8) == 0)
        svg += fmt::format(R"(<text class="tick" x="{:.1f}" y="{}" text-anchor="middle">{}</text>)",
                           kMapLeft + (static_cast<double>(column) + 0.5) * wide,
                           kMapHeight - kMapBottom + 15.0, html_text(tick_of(plan_.axes[1], column)));
    svg += fmt::format(R"(<text class="label" x="{}" y="{}" text-anchor="middle">{}</text>)",
                       0.5 * (kMapLeft + kMapWidth), kMapHeight - 8.0,
                       html_text(plan_.axes.size() > 1 ? plan_.axes[1].name : ""));
    svg += fmt::format(
        R"svg(<text class="label" transform="translate(13 {}) rotate(-90)" text-anchor="middle">{}</text>)svg",
        0.5 * (kMapHeight - kMapBottom), html_text(up.name));
    return svg + "</svg>";
  }

  std::string scale() const {
    if (!any_) return "<p class=\"soft\">no run has this number</p>\n";
    std::string html =
        fmt::format("<p class=\"soft\">{:.4g} <svg class=\"ramp\" viewBox=\"0 0 100 6\">", low_);
    for (int i = 0; i < 50; ++i)
      html += fmt::format(R"(<rect x="{}" y="0" width="2.2" height="6" fill="{}"/>)", 2 * i,
                          colour_of(static_cast<double>(i) / 49.0));
    return html + fmt::format("</svg> {:.4g}; empty where there is none</p>\n", high_);
  }

 private:
  std::uint64_t run_at(std::size_t row, std::size_t column, std::uint64_t slice) const {
    const std::uint64_t columns = plan_.axes.size() > 1 ? plan_.axes[1].values.size() : 1;
    return (row * columns + column) * slices_of(plan_) + slice;
  }
  std::string cell(std::uint64_t run, double x, double y, double wide, double high) const {
    const auto found = results_.find(run);
    const double value = found == results_.end() ? NAN : found->second.numbers[metric_];
    const std::string fill =
        std::isfinite(value) ? colour_of(high_ > low_ ? (value - low_) / (high_ - low_) : 1.0) : "none";
    return fmt::format(
        R"(<rect class="cell" x="{:.1f}" y="{:.1f}" width="{:.2f}" height="{:.2f}" fill="{}"><title>{}: {:.6g}</title></rect>)",
        x, y, wide, high, fill, html_text(values_of(plan_, run)), value);
  }

  const SweepPlan& plan_;
  const std::map<std::uint64_t, SweepResult>& results_;
  std::size_t metric_;
  double low_ = 0.0, high_ = 0.0;
  bool any_ = false;
};

/// "friction = 0.2", of the axes beyond the second.
std::string words_of_slice(const SweepPlan& plan, std::uint64_t slice) {
  const std::vector<std::size_t> places = plan.places(slice);
  std::string text;
  for (std::size_t i = 2; i < plan.axes.size(); ++i)
    text += fmt::format("{}{} = {}", i == 2 ? "" : ", ", plan.axes[i].name, tick_of(plan.axes[i], places[i]));
  return text;
}

}  // namespace

std::string sweep_page(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results) {
  const std::string title = plan.description.empty() ? "A sweep of " + plan.scene_name : plan.description;
  std::string html = page_head(title);
  html +=
      "<style>.maps { display: grid; grid-template-columns: repeat(auto-fill, minmax(230px, 1fr)); gap: "
      "14px; }\n"
      ".cell { stroke: var(--line); stroke-width: 0.5; } .ramp { display: inline-block; width: 220px; "
      "vertical-align: middle; }</style>\n";
  html += fmt::format("<h1>{}</h1>\n<p>{}, scene {}: {}</p>\n", html_text(title), html_text(plan.file),
                      html_text(plan.scene_name), html_text(sentence_on(results)));
  const std::uint64_t slices = slices_of(plan);
  if (slices > kMostMaps)
    html += fmt::format("<p class=\"note\">Of {} maps of each number the first {} are drawn.</p>\n", slices,
                        kMostMaps);
  for (const MapMetric& metric : kMapMetrics) {
    const MetricMaps maps(plan, results, place_of_metric(metric.name));
    html += fmt::format("<h2>{}</h2>\n{}<div class=\"maps\">\n", html_text(metric.title), maps.scale());
    for (std::uint64_t slice = 0; slice < std::min(slices, kMostMaps); ++slice)
      html += fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n",
                          html_text(words_of_slice(plan, slice)), maps.svg(slice));
    html += "</div>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace tactum
