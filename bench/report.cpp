#include "bench/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

namespace tactum::bench {
namespace {

using Job = std::tuple<std::string, std::string, std::string>;

/// The rows of one pair and regime, in the order they were measured.
struct Group {
  std::string pair, regime;
  int vertices = 0;
  std::vector<const Row*> rows;

  const Row* ours() const {
    const auto found =
        std::find_if(rows.begin(), rows.end(), [](const Row* row) { return row->engine == kOurs; });
    return found == rows.end() ? nullptr : *found;
  }
  const Row* fastest_accurate_peer() const {
    const Row* best = nullptr;
    for (const Row* row : rows)
      if (row->engine != kOurs && row->accurate() && (!best || row->median_ns < best->median_ns)) best = row;
    return best;
  }
  const Row* peer_least_wrong() const {
    const auto rank = [](const Row& row) {
      return std::pair(static_cast<double>(row.depths_wrong + row.missed) / std::max(1, row.depths_checked),
                       row.median_ns);
    };
    const Row* best = nullptr;
    for (const Row* row : rows)
      if (row->engine != kOurs && (!best || rank(*row) < rank(*best))) best = row;
    return best;
  }
};

std::vector<Group> groups(const std::vector<Row>& rows) {
  std::vector<Group> result;
  std::map<Job, std::size_t> place;
  for (const Row& row : rows) {
    const auto [at, fresh] = place.emplace(Job(row.shape_a, row.shape_b, row.regime), result.size());
    if (fresh) {
      const std::string pair = row.shape_a == row.shape_b ? row.shape_a : row.shape_a + "/" + row.shape_b;
      result.push_back({pair, row.regime, row.vertices, {}});
    }
    result[at->second].rows.push_back(&row);
  }
  return result;
}

std::string wrong_text(const Row& row) {
  if (row.depths_checked == 0) return "";
  return fmt::format("{:.2f} %", 100.0 * row.depths_wrong / row.depths_checked);
}

std::string ratio_text(double ratio) {
  return ratio < 10.0 ? fmt::format("{:.1f}", ratio) : fmt::format("{:.0f}", ratio);
}

std::size_t width_of(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
  std::size_t width = 3;
  for (const auto& row : rows) width = std::max(width, row[column].size());
  return width;
}

}  // namespace

std::string Table::text() const {
  std::string result;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      result += i < left ? fmt::format("{:<{}}  ", row[i], width_of(rows, i))
                         : fmt::format("{:>{}}  ", row[i], width_of(rows, i));
    while (result.back() == ' ') result.pop_back();
    result += '\n';
  }
  return result;
}

std::string Table::markdown() const {
  std::string result;
  for (const auto& row : rows) {
    result += "|";
    for (const std::string& cell : row) result += " " + cell + " |";
    result += '\n';
    if (&row != &rows.front()) continue;
    result += "|";
    for (std::size_t i = 0; i < row.size(); ++i) result += i < left ? "---|" : "---:|";
    result += '\n';
  }
  return result;
}

Table every_row(const std::vector<Row>& rows) {
  Table table;
  table.left = 3;
  table.rows.push_back({"pair", "regime", "engine", "vertices", "frames", "median", "p99", "p99.9", "max",
                        "batched", "error", "missed", "steps", "x ours"});
  for (const Group& group : groups(rows)) {
    const Row* ours = group.ours();
    const Row* best = group.fastest_accurate_peer();
    for (const Row* row : group.rows)
      table.rows.push_back(
          {group.pair, group.regime, row->engine + (row == best ? " *" : ""), fmt::to_string(row->vertices),
           fmt::to_string(row->frames), time_text(row->median_ns), time_text(row->p99_ns),
           time_text(row->p999_ns), time_text(row->max_ns), time_text(row->batched_ns),
           length_text(row->max_error_m), fmt::to_string(row->missed),
           row->engine == kOurs ? fmt::format("{:.1f}/{}", row->steps_mean, row->steps_max) : "",
           ours ? ratio_text(row->median_ns / ours->median_ns) : ""});
  }
  return table;
}

Table against_peers(const std::vector<Row>& rows) {
  Table table;
  table.left = 2;
  table.rows.push_back({"pair", "regime", "vertices", "median", "p99", "p99.9", "steps", "error", "missed",
                        "fastest accurate peer", "its median", "its p99.9", "median x", "p99.9 x"});
  for (const Group& group : groups(rows)) {
    const Row* ours = group.ours();
    if (!ours) continue;
    std::vector<std::string> cells = {group.pair,
                                      group.regime,
                                      fmt::to_string(group.vertices),
                                      time_text(ours->median_ns),
                                      time_text(ours->p99_ns),
                                      time_text(ours->p999_ns),
                                      fmt::format("{:.1f}/{}", ours->steps_mean, ours->steps_max),
                                      length_text(ours->max_error_m),
                                      fmt::to_string(ours->missed)};
    if (const Row* best = group.fastest_accurate_peer())
      cells.insert(cells.end(), {best->engine, time_text(best->median_ns), time_text(best->p999_ns),
                                 ratio_text(best->median_ns / ours->median_ns),
                                 ratio_text(best->p999_ns / ours->p999_ns)});
    else
      cells.insert(cells.end(), {"none", "", "", "", ""});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

Table depth_rows(const std::vector<Row>& rows) {
  Table table;
  table.left = 3;
  table.rows.push_back({"pair", "regime", "engine", "vertices", "frames", "median", "p99", "p99.9", "max",
                        "missed", "depths checked", "not the smallest", "off by"});
  for (const Group& group : groups(rows))
    for (const Row* row : group.rows)
      table.rows.push_back({group.pair, group.regime, row->engine, fmt::to_string(row->vertices),
                            fmt::to_string(row->frames), time_text(row->median_ns), time_text(row->p99_ns),
                            time_text(row->p999_ns), time_text(row->max_ns), fmt::to_string(row->missed),
                            fmt::to_string(row->depths_checked), wrong_text(*row),
                            length_text(row->max_error_m)});
  return table;
}

Table depths_against_peers(const std::vector<Row>& rows) {
  Table table;
  table.left = 2;
  table.rows.push_back({"pair", "regime", "vertices", "median", "p99", "p99.9", "missed", "depths checked",
                        "not the smallest", "off by", "best peer", "its median", "its p99", "missed",
                        "not the smallest"});
  for (const Group& group : groups(rows)) {
    const Row* ours = group.ours();
    if (!ours) continue;
    std::vector<std::string> cells = {group.pair,
                                      group.regime,
                                      fmt::to_string(group.vertices),
                                      time_text(ours->median_ns),
                                      time_text(ours->p99_ns),
                                      time_text(ours->p999_ns),
                                      fmt::to_string(ours->missed),
                                      fmt::to_string(ours->depths_checked),
                                      wrong_text(*ours),
                                      length_text(ours->max_error_m)};
    if (const Row* best = group.peer_least_wrong())
      cells.insert(cells.end(), {best->engine, time_text(best->median_ns), time_text(best->p99_ns),
                                 fmt::to_string(best->missed), wrong_text(*best)});
    else
      cells.insert(cells.end(), {"none", "", "", "", ""});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::string length_text(double length_m) {
  constexpr double kNanometre_m = 1e-9;
  if (length_m < kNanometre_m / 1000.0) return "0";
  if (length_m < 1000.0 * kNanometre_m) return fmt::format("{:.3g} nm", length_m / kNanometre_m);
  if (length_m < 1e-3) return fmt::format("{:.3g} µm", length_m * 1e6);
  return fmt::format("{:.3g} mm", length_m * 1e3);
}

std::string time_text(double time_ns) {
  if (time_ns < 1e3) return fmt::format("{:.0f} ns", time_ns);
  if (time_ns < 1e6) return fmt::format("{:.3g} µs", time_ns * 1e-3);
  return fmt::format("{:.3g} ms", time_ns * 1e-6);
}

bool write_between_marks(const std::string& path, const std::string& name, const std::string& text) {
  std::ostringstream old;
  old << std::ifstream(path).rdbuf();
  std::string page = old.str();
  const std::string begin = "<!-- " + name + " -->\n";
  const std::string end = "<!-- end " + name + " -->";
  const std::size_t from = page.find(begin);
  const std::size_t to = page.find(end);
  if (from != std::string::npos && to != std::string::npos && from < to)
    page.replace(from + begin.size(), to - from - begin.size(), "\n" + text + "\n");
  else
    page = text;
  std::ofstream file(path);
  file << page;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace tactum::bench
