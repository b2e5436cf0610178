/// The picture of `tactum-bench stability`.

#include <fmt/format.h>

#include <algorithm>

#include "bench/stability.h"
#include "bench/svg.h"

namespace tactum::bench {
namespace {

constexpr double kPanelWidth = 300, kPanelTop = 96, kPanelBottom = 420, kLeft = 76, kApart = 372;
constexpr double kPrompt_s = 0.001;  // width of a panel without delays

const std::vector<std::string>& colours() {
  static const std::vector<std::string> table = {"#0b57d0", "#c2570c", "#0f8a6d", "#7a5bc7", "#b8336a"};
  return table;
}

/// One panel: stiffness of a device's walls over the delay, one curve a rate.
struct Panel {
  std::string title;
  std::vector<const WallRow*> rows;
};

std::string stiffness_text(double value, bool turning) {
  if (turning) return fmt::format("{:g} N m/rad", value);
  return value < 1000 ? fmt::format("{:g} N/m", value) : fmt::format("{:g} N/mm", value / 1000);
}

void draw(Svg& svg, const Panel& panel, double left) {
  const std::string small = R"(font-size="12" fill="#4b5563")";
  double low = 1e300, high = 0.0, longest_s = 0.0;
  for (const WallRow* row : panel.rows) {
    low = std::min({low, row->bound, row->at_rest});
    high = std::max({high, row->bound, row->at_rest});
    longest_s = std::max(longest_s, row->delay_s);
  }
  const LogScale stiffness = {low * 0.8, high * 1.25, kPanelBottom, kPanelTop};
  const auto at = [&](double delay_s) {
    return left + kPanelWidth * delay_s / std::max(longest_s, kPrompt_s);
  };
  svg.text({left, kPanelTop - 14}, panel.title, R"(font-size="14" font-weight="600" fill="#111827")");
  for (double decade = 0.001; decade < 1e7; decade *= 10)
    for (const double value : {decade, 2 * decade, 5 * decade})
      if (stiffness.shows(value)) {
        svg.line({left, stiffness(value)}, {left + kPanelWidth, stiffness(value)}, R"(stroke="#e4e7eb")");
        svg.text({left - 6, stiffness(value) + 4}, stiffness_text(value, panel.rows.front()->turning),
                 R"(font-size="10" fill="#4b5563" text-anchor="end")");
      }
  std::vector<double> rates;
  for (const WallRow* row : panel.rows)
    if (std::find(rates.begin(), rates.end(), row->rate_Hz) == rates.end()) rates.push_back(row->rate_Hz);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    std::vector<SheetPoint> bound, at_rest;
    for (const WallRow* row : panel.rows)
      if (row->rate_Hz == rates[i]) {
        bound.push_back({at(row->delay_s), stiffness(row->bound)});
        at_rest.push_back({at(row->delay_s), stiffness(row->at_rest)});
      }
    const std::string& colour = colours()[i % colours().size()];
    svg.path(bound, fmt::format(R"(stroke="{}" stroke-width="1.5" stroke-dasharray="5 4")", colour));
    svg.path(at_rest, fmt::format(R"(stroke="{}" stroke-width="2.5")", colour));
    for (const SheetPoint& p : at_rest) svg.dot(p, 3, fmt::format(R"(fill="{}")", colour));
    svg.text({left + kPanelWidth - 66, kPanelTop + 16 + 18 * static_cast<double>(i)},
             fmt::format("{:g} kHz", rates[i] / 1000),
             fmt::format(R"(font-size="13" font-weight="600" fill="{}")", colour));
  }
  for (const double delay_s : {0.0, 0.5 * longest_s, longest_s})
    svg.text({at(delay_s), kPanelBottom + 18}, fmt::format("{:g} ms", 1e3 * delay_s),
             "text-anchor=\"middle\" " + small);
  svg.line({left, kPanelBottom}, {left + kPanelWidth, kPanelBottom}, R"(stroke="#9aa3af")");
}

std::vector<Panel> panels_of(const std::vector<WallRow>& rows) {
  std::vector<Panel> panels;
  for (const WallRow& row : rows) {
    if (row.hand != "medium") continue;
    const std::string title = row.device + (row.turning ? ", turned" : ", pressed");
    auto found = std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.title == title; });
    if (found == panels.end()) found = panels.insert(panels.end(), {title, {}});
    found->rows.push_back(&row);
  }
  return panels;
}

}  // namespace

std::string z_width_plot(const std::vector<WallRow>& rows) {
  const std::vector<Panel> panels = panels_of(rows);
  constexpr double kRowHeight = 390;
  constexpr std::size_t kAcross = 4;
  const auto lines = static_cast<double>((panels.size() + kAcross - 1) / kAcross);
  Svg svg(kApart * kAcross + 20, 96 + kRowHeight * lines);
  svg.text({24, 30}, "The stiffest wall that a device holds in a medium hand",
           R"(font-size="18" font-weight="600" fill="#111827")");
  svg.text({24, 52},
           "over the delay from command to motor; lines: simulated, comes to rest; dashed: passivity bound",
           R"(font-size="13" fill="#4b5563")");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double left = kLeft + kApart * static_cast<double>(i % kAcross);
    svg.group(kRowHeight * static_cast<double>(i / kAcross));
    draw(svg, panels[i], left);
    svg.end_group();
  }
  return svg.finished();
}

}  // namespace tactum::bench
