#include "bench/svg.h"

#include <fmt/format.h>

namespace tactum::bench {
namespace {

std::string escaped(const std::string& words) {
  std::string result;
  for (const char c : words) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else
      result += c;
  }
  return result;
}

}  // namespace

Svg::Svg(double width, double height)
    : body_(fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
                        "height=\"{1}\" font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\n"
                        "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
                        width, height)) {}

void Svg::group(double lower) { body_ += fmt::format("<g transform=\"translate(0 {:.1f})\">\n", lower); }

void Svg::line(SheetPoint from, SheetPoint to, const std::string& style) {
  body_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", from.x, from.y,
                       to.x, to.y, style);
}

void Svg::path(const std::vector<SheetPoint>& points, const std::string& style) {
  std::string d;
  for (const SheetPoint& p : points) d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : " L", p.x, p.y);
  body_ += fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", d, style);
}

void Svg::dot(SheetPoint at, double radius, const std::string& style) {
  body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>\n", at.x, at.y, radius, style);
}

void Svg::text(SheetPoint at, const std::string& words, const std::string& style) {
  body_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", at.x, at.y, style, escaped(words));
}

}  // namespace tactum::bench
