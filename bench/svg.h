#pragma once
/// Just enough of SVG for a plot: lines, paths, dots, text; and a logarithmic scale.

#include <cmath>
#include <string>
#include <vector>

namespace tactum::bench {

/// A point on the sheet, in pixels, y downwards.
struct SheetPoint {
  double x = 0.0, y = 0.0;
};

class Svg {
 public:
  Svg(double width, double height);
  /// `style` is put in as SVG attributes: stroke="#333" stroke-width="2".
  void line(SheetPoint from, SheetPoint to, const std::string& style);
  void path(const std::vector<SheetPoint>& points, const std::string& style);
  void dot(SheetPoint at, double radius, const std::string& style);
  void text(SheetPoint at, const std::string& words, const std::string& style);
  /// Everything drawn until end_group is lower by this.
  void group(double lower);
  void end_group() { body_ += "</g>\n"; }
  std::string finished() const { return body_ + "</svg>\n"; }

 private:
  std::string body_;
};

/// Values from `low` to `high` laid out over pixels from `from` to `to`, by their logarithm.
struct LogScale {
  double low, high, from, to;
  double operator()(double value) const {
    return from + (to - from) * std::log(value / low) / std::log(high / low);
  }
  bool shows(double value) const { return value >= low && value <= high; }
};

}  // namespace tactum::bench
