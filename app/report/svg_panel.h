#pragma once
/// A chart as SVG: axes with units, a legend, and what is drawn. Colours are classes, c0 to c4, which the
/// page sets for a light and for a dark ground.

#include <array>
#include <string>
#include <vector>

namespace tactum {

/// A quantity along x as a band from its least to its largest value; where these are one, a line.
struct PanelBand {
  std::string legend;
  struct Point {
    double x, least, largest;
  };
  std::vector<Point> points;
};

/// Points with a weight from 0 to 1, which is their size.
struct PanelDots {
  std::string legend;
  std::vector<std::array<double, 3>> points;
};

struct PanelBar {
  double from, to, height;
};

/// A line across the chart, at x, with a word.
struct PanelMark {
  double x;
  std::string word;
};

struct PanelRange {
  double low = 0.0, high = 0.0;  ///< the same: nothing is drawn
};

struct Panel {
  std::string title;  ///< a sentence, also for those who hear the page
  std::string x_label, y_label;
  bool log_x = false;         ///< powers of ten; all x are positive
  bool equal_scales = false;  ///< a map: a millimetre is as long along y as along x
  std::vector<PanelBand> bands = {};
  std::vector<PanelDots> dots = {};
  std::vector<PanelBar> bars = {};
  std::vector<PanelMark> marks = {};
};

struct PanelRanges {
  PanelRange x, y;
};

/// What the chart's data covers.
PanelRanges ranges_of(const Panel& panel);
/// Both together, for charts that are compared.
PanelRanges together(const PanelRanges& a, const PanelRanges& b);

/// The chart, drawn over these ranges.
std::string svg_of(const Panel& panel, const PanelRanges& ranges);

/// Text as HTML shows it, with what HTML would read as its own replaced.
std::string html_text(const std::string& text);

}  // namespace tactum
