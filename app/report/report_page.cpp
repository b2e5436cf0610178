#include "app/report/report_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactum/haptics/setting_table.h"
#include "tactum/version.h"

namespace tactum {
namespace {

const char* const kStyle = R"(
:root { --back: #ffffff; --ink: #16202a; --soft: #52616e; --line: #d9e0e6; --panel: #f6f8fa;
  --c0: #0b6fb8; --c1: #c2410c; --c2: #157a5b; --c3: #7a3fb0; --c4: #8a6d00; color-scheme: light; }
@media screen and (prefers-color-scheme: dark) {
  :root { --back: #10161d; --ink: #e8eef4; --soft: #9fb0bf; --line: #2c3a47; --panel: #17202a;
    --c0: #62b5f0; --c1: #ff955c; --c2: #4fd0a2; --c3: #bd9bff; --c4: #e8c65a; color-scheme: dark; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1280px; padding: 24px; background: var(--back); color: var(--ink);
  font: 15px/1.45 system-ui, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 19px; margin: 34px 0 10px; }
p { margin: 4px 0; } .soft { color: var(--soft); }
.note { border-left: 4px solid var(--c1); padding: 4px 12px; background: var(--panel); }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(430px, 1fr)); gap: 20px; }
.pair { grid-column: 1 / -1; display: grid; grid-template-columns: 1fr 1fr; gap: 20px; }
figure { margin: 0; padding: 10px; background: var(--panel); border: 1px solid var(--line); border-radius: 8px;
  break-inside: avoid; min-width: 0; }
figcaption { font-size: 13.5px; margin-bottom: 6px; } figcaption b { margin-right: 4px; }
svg { width: 100%; height: auto; display: block; }
svg text { fill: var(--ink); font-size: 12px; font-family: inherit; } svg .tick { fill: var(--soft); font-size: 11px; }
svg .legend { font-size: 11.5px; paint-order: stroke; stroke: var(--panel); stroke-width: 3px; stroke-linejoin: round; }
.grid { stroke: var(--line); stroke-width: 1; fill: none; } .frame { stroke: var(--soft); fill: none; }
.mark { stroke: var(--ink); stroke-width: 1; stroke-dasharray: 4 3; fill: none; }
.c0 { color: var(--c0); } .c1 { color: var(--c1); } .c2 { color: var(--c2); } .c3 { color: var(--c3); }
.c4 { color: var(--c4); }
.band { fill: currentColor; fill-opacity: 0.55; stroke: currentColor; stroke-width: 1; stroke-linejoin: round; }
.line { fill: none; stroke: currentColor; stroke-width: 1.5; } .bar, .key { fill: currentColor; }
.dots { fill: currentColor; fill-opacity: 0.45; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 6px 0 16px; }
caption { text-align: left; font-weight: 600; padding: 4px 0; } .tables { display: flex; flex-wrap: wrap; align-items: flex-start; gap: 8px 40px; }
th, td { text-align: right; padding: 3px 12px; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; padding-left: 0; } thead th { color: var(--soft); font-weight: 600; }
details { margin: 8px 0; } summary { cursor: pointer; } .scroll { overflow-x: auto; }
@media print { body { max-width: none; padding: 0; font-size: 11px; } }
@media (max-width: 900px) { .pair { grid-template-columns: 1fr; } .figures { grid-template-columns: 1fr; } }
)";

std::string value_text(const Quantity& quantity) {
  const double shown = quantity.value * quantity.scale;
  return fmt::format("{:.6g}{}{}", shown, quantity.unit.empty() ? "" : " ", quantity.unit);
}

std::string facts_of(const RunFigures& run) {
  const RunHead& head = run.head;
  return fmt::format("<p>{}: {} at {:.0f} Hz on {}, recorded {} UTC by Tactum {} ({})</p>\n",
                     html_text(run.file), html_text(head.scene), 1.0 / head.dt_s, html_text(head.device.name),
                     html_text(head.date), html_text(head.version), html_text(head.compiler));
}

std::string notes_of(const RunFigures& run, bool several) {
  std::string html;
  const std::string of = several ? run.file + ": " : "";
  if (!run.end.complete)
    html += fmt::format("<p class=\"note\">{}The recording {}: {}</p>\n", html_text(of),
                        run.end.cut ? "has no end" : "is damaged",
                        html_text(run.end.wrong ? run.end.wrong->message() : ""));
  for (const std::string& note : run.notes)
    html += fmt::format("<p class=\"note\">{}{}</p>\n", html_text(of), html_text(note));
  return html;
}

/// The quantities, a table a section; of two runs with a column for each and one for the difference.
std::string quantities_of(const std::vector<RunFigures>& runs) {
  std::string html = "<div class=\"tables\">", section;
  const std::vector<Quantity>& first = runs.front().quantities;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].section != section) {
      if (!section.empty()) html += "</tbody></table>\n";
      section = first[i].section;
      html += fmt::format("<table><caption>{}</caption>", html_text(section));
      if (runs.size() > 1) html += "<thead><tr><th></th><th>A</th><th>B</th><th>B less A</th></tr></thead>";
      html += "<tbody>\n";
    }
    html += fmt::format("<tr><td>{}</td>", html_text(first[i].label));
    for (const RunFigures& run : runs)
      html += fmt::format("<td data-key=\"{}\" data-value=\"{}\">{}</td>", run.quantities[i].key,
                          run.quantities[i].value, value_text(run.quantities[i]));
    if (runs.size() > 1) {
      Quantity difference = runs[1].quantities[i];
      difference.value -= first[i].value;
      html += fmt::format("<td>{}</td>", value_text(difference));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string figure_of(const Panel& panel, const PanelRanges& ranges, const std::string& number) {
  return fmt::format("<figure><figcaption><b>Figure {}.</b>{}</figcaption>{}</figure>\n", number,
                     html_text(panel.title), svg_of(panel, ranges));
}

std::string figures_html(const std::vector<RunFigures>& runs) {
  std::string html = "<div class=\"figures\">\n";
  for (std::size_t i = 0; i < runs.front().panels.size(); ++i) {
    PanelRanges ranges = ranges_of(runs.front().panels[i]);
    if (runs.size() == 1) {
      html += figure_of(runs.front().panels[i], ranges, fmt::format("{}", i + 1));
      continue;
    }
    ranges = together(ranges, ranges_of(runs[1].panels[i]));
    html += "<div class=\"pair\">" + figure_of(runs[0].panels[i], ranges, fmt::format("{} A", i + 1)) +
            figure_of(runs[1].panels[i], ranges, fmt::format("{} B", i + 1)) + "</div>\n";
  }
  return html + "</div>\n";
}

std::string table_html(const FigureTable& table, const std::string& of) {
  std::string html = fmt::format("<div class=\"scroll\"><table><caption>{}{}</caption><thead><tr>",
                                 html_text(table.title), html_text(of));
  for (const std::string& head : table.heads) html += fmt::format("<th>{}</th>", html_text(head));
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += fmt::format("<td>{}</td>", html_text(cell));
    html += "</tr>\n";
  }
  if (table.rows.empty()) html += fmt::format("<tr><td colspan=\"{}\">none</td></tr>\n", table.heads.size());
  return html + "</tbody></table></div>\n";
}

std::string settings_of(const std::vector<RunFigures>& runs) {
  FigureTable table{"", {"setting"}, {}};
  for (std::size_t i = 0; i < runs.size(); ++i)
    table.heads.push_back(runs.size() == 1 ? "value" : std::string(1, static_cast<char>('A' + i)));
  for (const auto& [key, value] : runs.front().head.settings) {
    table.rows.push_back({key});
    for (const RunFigures& run : runs) {
      std::string text = "not there";
      for (const auto& [other_key, other] : run.head.settings)
        if (other_key == key) text = setting_text(key, other);
      table.rows.back().push_back(text);
    }
  }
  return "<details><summary>Settings at the start</summary>\n" + table_html(table, "") + "</details>\n";
}

std::string numbers_json(const std::vector<RunFigures>& runs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RunFigures& run : runs) {
    nlohmann::ordered_json one{{"file", run.file}, {"scene", run.head.scene}};
    for (const Quantity& quantity : run.quantities) one[quantity.key] = quantity.value;
    json.push_back(std::move(one));
  }
  std::string text;
  // A name that contains the end of the element must not end it.
  for (const char c : json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace))
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return "<script type=\"application/json\" id=\"numbers\">" + text + "</script>\n";
}

}  // namespace

std::string page_head(const std::string& title) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{}</title><style>{}</style></head>\n<body>\n",
      html_text(title), kStyle);
}

std::string report_page(const std::vector<RunFigures>& runs) {
  const bool several = runs.size() > 1;
  const std::string title = several ? fmt::format("{} compared with {}", runs[0].file, runs[1].file)
                                    : fmt::format("A run of {}", runs[0].head.scene);
  std::string html = page_head(title) + fmt::format("<h1>{}</h1>\n", html_text(title));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (several) html += fmt::format("<p><b>{}</b></p>", i == 0 ? "A" : "B");
    html += facts_of(runs[i]);
  }
  for (const RunFigures& run : runs) html += notes_of(run, several);
  html +=
      "<p class=\"soft\">Vectors have the axes of the world; a wrench acts on the hand at the handle. Bands "
      "go "
      "from the least to the largest value of a stretch of frames.</p>\n";
  html += "<h2>Numbers</h2>\n" + quantities_of(runs);
  html += "<h2>Charts</h2>\n" + figures_html(runs);
  html += "<h2>Tables</h2>\n<div class=\"tables\">\n";
  for (std::size_t i = 0; i < runs.front().tables.size(); ++i)
    for (const RunFigures& run : runs) html += table_html(run.tables[i], several ? ", " + run.file : "");
  html += "</div>\n" + settings_of(runs);
  return html + numbers_json(runs) + "</body></html>\n";
}

}  // namespace tactum
