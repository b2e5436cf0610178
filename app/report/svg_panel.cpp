#include "app/report/svg_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tactum {
namespace {

// The drawing's own units; the page scales them.
constexpr double kWidth = 560.0, kHeight = 300.0;
constexpr double kLeft = 62.0, kRight = 14.0, kTop = 28.0, kBottom = 44.0;
constexpr int kTicks = 6;  // about so many

void widen(PanelRange& range, double value, bool& any) {
  range.low = any ? std::min(range.low, value) : value;
  range.high = any ? std::max(range.high, value) : value;
  any = true;
}

/// The same range with room for what is constant.
PanelRange opened(PanelRange range) {
  if (range.high > range.low) return range;
  const double room = range.low == 0.0 ? 1.0 : std::abs(range.low) * 0.1;
  return {range.low - room, range.high + room};
}

/// One, two or five times a power of ten.
double step_for(double span) {
  const double raw = span / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double times : {1.0, 2.0, 5.0})
    if (raw <= times * power) return times * power;
  return 10.0 * power;
}

/// From the data's coordinates to the drawing's.
class PanelScale {
 public:
  PanelScale(const Panel& panel, const PanelRanges& ranges) : log_x_(panel.log_x) {
    x_ = opened({along(ranges.x.low), along(ranges.x.high)});
    y_ = opened(ranges.y);
    const double room = 0.04 * (y_.high - y_.low);
    y_.high += room;
    if (ranges.y.low < 0.0 || panel.equal_scales) y_.low -= room;
    if (!panel.equal_scales) return;
    const double each = std::max((x_.high - x_.low) / (kWidth - kLeft - kRight),
                                 (y_.high - y_.low) / (kHeight - kTop - kBottom));
    centre(x_, each * (kWidth - kLeft - kRight));
    centre(y_, each * (kHeight - kTop - kBottom));
  }
  double x(double value) const {
    return kLeft + (along(value) - x_.low) / (x_.high - x_.low) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    return kHeight - kBottom - (value - y_.low) / (y_.high - y_.low) * (kHeight - kTop - kBottom);
  }
  const PanelRange& across() const { return x_; }
  const PanelRange& up() const { return y_; }

 private:
  double along(double value) const { return log_x_ ? std::log10(value) : value; }
  static void centre(PanelRange& range, double span) {
    const double middle = 0.5 * (range.low + range.high);
    range = {middle - 0.5 * span, middle + 0.5 * span};
  }

  bool log_x_;
  PanelRange x_, y_;
};

std::vector<double> ticks_of(const PanelRange& range) {
  std::vector<double> ticks;
  const double step = step_for(range.high - range.low);
  const double first = std::ceil(range.low / step);
  for (int i = 0; first + i <= range.high / step; ++i) ticks.push_back((first + i) * step);
  return ticks;
}

/// Whole powers of ten, with two and five times them where there are few.
std::vector<double> log_ticks_of(const PanelRange& range) {
  std::vector<double> ticks;
  const bool few = range.high - range.low < 2.5;
  for (int power = static_cast<int>(std::floor(range.low)); power <= std::ceil(range.high); ++power)
    for (const double times : {1.0, 2.0, 5.0}) {
      const double value = times * std::pow(10.0, power);
      const double at = std::log10(value);
      if ((few || times == 1.0) && at >= range.low && at <= range.high) ticks.push_back(value);
    }
  return ticks;
}

std::string axes_of(const Panel& panel, const PanelScale& scale) {
  std::string svg;
  const double bottom = kHeight - kBottom, right = kWidth - kRight;
  for (const double tick : panel.log_x ? log_ticks_of(scale.across()) : ticks_of(scale.across()))
    svg += fmt::format(
        R"(<path class="grid" d="M{0:.1f} {1}V{2}"/><text class="tick" x="{0:.1f}" y="{3}" text-anchor="middle">{4:.6g}</text>)",
        scale.x(tick), kTop, bottom, bottom + 15.0, tick + 0.0);
  for (const double tick : ticks_of(scale.up()))
    svg += fmt::format(
        R"(<path class="grid" d="M{1} {0:.1f}H{2}"/><text class="tick" x="{3}" y="{4:.1f}" text-anchor="end">{5:.6g}</text>)",
        scale.y(tick), kLeft, right, kLeft - 6.0, scale.y(tick) + 3.5, tick + 0.0);
  svg += fmt::format(R"(<path class="frame" d="M{} {}V{}H{}"/>)", kLeft, kTop, bottom, right);
  svg += fmt::format(R"(<text class="label" x="{:.1f}" y="{}" text-anchor="middle">{}</text>)",
                     0.5 * (kLeft + right), kHeight - 8.0, html_text(panel.x_label));
  svg += fmt::format(
      R"svg(<text class="label" transform="translate(13 {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)svg",
      0.5 * (kTop + bottom), html_text(panel.y_label));
  return svg;
}

std::string band_path(const PanelBand& band, const PanelScale& scale) {
  fmt::memory_buffer path;
  const auto to = std::back_inserter(path);
  for (std::size_t i = 0; i < band.points.size(); ++i)
    fmt::format_to(to, "{}{:.1f} {:.1f}", i == 0 ? 'M' : 'L', scale.x(band.points[i].x),
                   scale.y(band.points[i].largest));
  const bool line = std::all_of(band.points.begin(), band.points.end(),
                                [](const PanelBand::Point& point) { return point.least == point.largest; });
  if (!line) {
    for (std::size_t i = band.points.size(); i-- > 0;)
      fmt::format_to(to, "L{:.1f} {:.1f}", scale.x(band.points[i].x), scale.y(band.points[i].least));
    path.push_back('Z');
  }
  return fmt::format(R"(class="{}" d="{}")", line ? "line" : "band", fmt::to_string(path));
}

/// What is drawn, and the legend above the axes.
std::string drawn(const Panel& panel, const PanelScale& scale) {
  std::string svg;
  double legend_x = kLeft;
  const auto legend = [&](const std::string& words, std::size_t colour) {
    if (words.empty()) return;
    svg += fmt::format(
        R"(<g class="c{}"><rect class="key" x="{:.1f}" y="{}" width="10" height="10"/><text class="legend" x="{:.1f}" y="{}">{}</text></g>)",
        colour, legend_x, 5.0, legend_x + 14.0, 14.0, html_text(words));
    legend_x += 30.0 + 6.3 * static_cast<double>(words.size());
  };
  for (const PanelBar& bar : panel.bars) {
    const double x = scale.x(bar.from), y = scale.y(bar.height);
    svg += fmt::format(R"(<rect class="bar c0" x="{:.1f}" y="{:.1f}" width="{:.2f}" height="{:.1f}"/>)", x, y,
                       std::max(scale.x(bar.to) - x - 1.0, 0.5), scale.y(0.0) - y);
  }
  std::size_t colour = 0;
  for (const PanelBand& band : panel.bands) {
    if (!band.points.empty())
      svg += fmt::format("<g class=\"c{}\"><path {}/></g>", colour, band_path(band, scale));
    ++colour;
  }
  for (const PanelDots& dots : panel.dots) {
    svg += fmt::format("<g class=\"dots c{}\">", colour++);
    for (const auto& [x, y, weight] : dots.points)
      svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}"/>)", scale.x(x), scale.y(y),
                         1.2 + 3.3 * std::sqrt(std::clamp(weight, 0.0, 1.0)));
    svg += "</g>";
  }
  for (const PanelMark& mark : panel.marks)
    svg += fmt::format(
        R"(<path class="mark" d="M{0:.1f} {1}V{2}"/><text class="legend" x="{3:.1f}" y="{4}">{5}</text>)",
        scale.x(mark.x), kTop, kHeight - kBottom, scale.x(mark.x) + 3.0,
        kTop + 10.0 + 12.0 * static_cast<double>(&mark - panel.marks.data()), html_text(mark.word));
  colour = 0;
  for (const PanelBand& band : panel.bands) legend(band.legend, colour++);
  for (const PanelDots& dots : panel.dots) legend(dots.legend, colour++);
  return svg;
}

}  // namespace

PanelRanges ranges_of(const Panel& panel) {
  PanelRanges ranges;
  bool any_x = false, any_y = false;
  for (const PanelBand& band : panel.bands)
    for (const PanelBand::Point& point : band.points) {
      widen(ranges.x, point.x, any_x);
      widen(ranges.y, point.least, any_y);
      widen(ranges.y, point.largest, any_y);
    }
  for (const PanelDots& dots : panel.dots)
    for (const auto& point : dots.points) {
      widen(ranges.x, point[0], any_x);
      widen(ranges.y, point[1], any_y);
    }
  for (const PanelBar& bar : panel.bars) {
    widen(ranges.x, bar.from, any_x);
    widen(ranges.x, bar.to, any_x);
    widen(ranges.y, bar.height, any_y);
  }
  for (const PanelMark& mark : panel.marks) widen(ranges.x, mark.x, any_x);
  // Zero is part of every quantity but a place.
  if (!panel.equal_scales && any_y) widen(ranges.y, 0.0, any_y);
  return ranges;
}

PanelRanges together(const PanelRanges& a, const PanelRanges& b) {
  const auto both = [](const PanelRange& one, const PanelRange& other) {
    if (one.low == one.high && one.low == 0.0) return other;
    if (other.low == other.high && other.low == 0.0) return one;
    return PanelRange{std::min(one.low, other.low), std::max(one.high, other.high)};
  };
  return {both(a.x, b.x), both(a.y, b.y)};
}

std::string svg_of(const Panel& panel, const PanelRanges& ranges) {
  std::string svg = fmt::format(R"(<svg viewBox="0 0 {} {}" role="img" aria-label="{}">)", kWidth, kHeight,
                                html_text(panel.title));
  const bool none = panel.dots.empty() && panel.bars.empty() && panel.bands.empty();
  const bool drawable = !panel.log_x || ranges.x.low > 0.0;
  if (none || !drawable)
    return svg + fmt::format(R"(<text class="label" x="{}" y="{}" text-anchor="middle">nothing of this was )"
                             R"(recorded</text></svg>)",
                             0.5 * kWidth, 0.5 * kHeight);
  const PanelScale scale(panel, ranges);
  return svg + axes_of(panel, scale) + drawn(panel, scale) + "</svg>\n";
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return out;
}

}  // namespace tactum
