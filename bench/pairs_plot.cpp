#include "bench/pairs_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "bench/report.h"
#include "bench/svg.h"

namespace tactum::bench {
namespace {

constexpr double kWidth = 920, kHeight = 560;
constexpr LogScale kVertices = {7, 50000, 74, 760};
constexpr LogScale kTime_ns = {20, 1e7, 478, 74};

struct Series {
  std::string engine, colour;
  std::vector<const Row*> rows;  // by vertices
  bool ours() const { return engine == kOurs; }
};

bool belongs(const Row& row) {
  return row.regime == "near" && row.shape_a == row.shape_b &&
         (row.shape_a == "box" || row.shape_a.rfind("sphere", 0) == 0);
}

std::vector<Series> series_of(const std::vector<Row>& rows) {
  const std::vector<std::string> colours = {"#c2570c", "#0f8a6d", "#7a5bc7", "#b8336a", "#8a6d1a", "#546374"};
  std::vector<Series> all;
  std::size_t next_colour = 0;
  for (const Row& row : rows) {
    if (!belongs(row)) continue;
    auto found =
        std::find_if(all.begin(), all.end(), [&](const Series& one) { return one.engine == row.engine; });
    if (found == all.end()) {
      const std::string colour = row.engine == kOurs ? "#0b57d0" : colours[next_colour++ % colours.size()];
      found = all.insert(all.end(), {row.engine, colour, {}});
    }
    found->rows.push_back(&row);
  }
  for (Series& one : all)
    std::stable_sort(one.rows.begin(), one.rows.end(),
                     [](const Row* a, const Row* b) { return a->vertices < b->vertices; });
  // Ours is drawn last, over the others.
  std::stable_partition(all.begin(), all.end(), [](const Series& one) { return !one.ours(); });
  return all;
}

void draw_grid(Svg& svg) {
  const std::string grid = "stroke=\"#e4e7eb\"";
  const std::string minor = "stroke=\"#f3f4f6\"";
  const std::string label = "font-size=\"13\" fill=\"#4b5563\"";
  for (const double decade : {1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7})
    for (int k = 1; k < 10; ++k) {
      const double value = k * decade;
      const std::string& style = k == 1 ? grid : minor;
      if (kVertices.shows(value))
        svg.line({kVertices(value), kTime_ns.from}, {kVertices(value), kTime_ns.to}, style);
      if (kTime_ns.shows(value))
        svg.line({kVertices.from, kTime_ns(value)}, {kVertices.to, kTime_ns(value)}, style);
    }
  for (const int value : {10, 100, 1000, 10000})
    svg.text({kVertices(value), kTime_ns.from + 20},
             value < 1000 ? fmt::to_string(value) : fmt::format("{} 000", value / 1000),
             "text-anchor=\"middle\" " + label);
  const std::pair<double, const char*> times[] = {{1e2, "100 ns"}, {1e3, "1 µs"}, {1e4, "10 µs"},
                                                  {1e5, "100 µs"}, {1e6, "1 ms"}, {1e7, "10 ms"}};
  for (const auto& [value, words] : times)
    svg.text({kVertices.from - 8, kTime_ns(value) + 4}, words, "text-anchor=\"end\" " + label);
  svg.line({kVertices.from, kTime_ns.from}, {kVertices.to, kTime_ns.from}, "stroke=\"#9aa3af\"");
  svg.text({0.5 * (kVertices.from + kVertices.to), kTime_ns.from + 40}, "vertices of each piece",
           "text-anchor=\"middle\" " + label);
}

void draw_curve(Svg& svg, const Series& series, double Row::*time, const std::string& style) {
  std::vector<SheetPoint> points;
  for (const Row* row : series.rows)
    points.push_back({kVertices(row->vertices), kTime_ns(std::max(row->*time, kTime_ns.low))});
  svg.path(points, fmt::format("stroke=\"{}\" stroke-linejoin=\"round\" {}", series.colour, style));
}

void draw(Svg& svg, const Series& series) {
  draw_curve(svg, series, &Row::p999_ns,
             series.ours() ? R"(stroke-width="2" stroke-dasharray="6 4")"
                           : R"(stroke-width="1.2" stroke-dasharray="4 4" opacity="0.65")");
  draw_curve(svg, series, &Row::median_ns, series.ours() ? R"(stroke-width="3.5")" : R"(stroke-width="1.8")");
  for (const Row* row : series.rows)
    svg.dot({kVertices(row->vertices), kTime_ns(std::max(row->median_ns, kTime_ns.low))},
            series.ours() ? 4.5 : 3.2,
            fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"",
                        row->accurate() ? series.colour : "#fff", series.colour));
}

/// Names at the right ends of the curves, pushed apart where they would overlap.
void draw_names(Svg& svg, std::vector<Series> all) {
  constexpr double kApart = 18;
  std::sort(all.begin(), all.end(), [](const Series& a, const Series& b) {
    return a.rows.back()->median_ns > b.rows.back()->median_ns;
  });
  std::vector<double> heights;
  for (const Series& one : all) {
    const double wanted = kTime_ns(one.rows.back()->median_ns) + 4;
    heights.push_back(heights.empty() ? wanted : std::max(wanted, heights.back() + kApart));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Row& last = *all[i].rows.back();
    svg.text({kVertices.to + 10, heights[i]}, fmt::format("{}  {}", all[i].engine, time_text(last.median_ns)),
             fmt::format("font-size=\"13\" fill=\"{}\"{}", all[i].colour,
                         all[i].ours() ? " font-weight=\"700\"" : ""));
  }
}

}  // namespace

std::string pairs_plot(const std::vector<Row>& rows) {
  const std::vector<Series> all = series_of(rows);
  Svg svg(kWidth, kHeight);
  svg.text({24, 30}, "Distance of two convex pieces, moved by a hand at 1 kHz",
           "font-size=\"18\" font-weight=\"600\" fill=\"#111827\"");
  svg.text({24, 52},
           "0.1 to 2 mm apart, the same poses for all; a box, then spheres of triangles; time of a query",
           "font-size=\"13\" fill=\"#4b5563\"");
  draw_grid(svg);
  for (const Series& one : all) draw(svg, one);
  draw_names(svg, all);
  const double y = kHeight - 14;
  const std::string small = "font-size=\"12\" fill=\"#4b5563\"";
  svg.line({74, y - 4}, {104, y - 4}, R"(stroke="#4b5563" stroke-width="2")");
  svg.text({112, y}, "median", small);
  svg.line({180, y - 4}, {210, y - 4}, R"(stroke="#4b5563" stroke-width="1.5" stroke-dasharray="5 4")");
  svg.text({218, y}, "99.9th percentile", small);
  svg.dot({350, y - 4}, 3.5, R"(fill="#fff" stroke="#4b5563" stroke-width="1.5")");
  svg.text({362, y}, "queries missed, or wrong by more than 1 µm", small);
  return svg.finished();
}

bool write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace tactum::bench
