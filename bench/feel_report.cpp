#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/feel.h"
#include "bench/svg.h"

namespace tactum::bench {
namespace {

/// Three digits with a unit's prefix: "1.2 µN", "-" where nothing was measured.
std::string quantity(double value, const std::string& unit) {
  if (std::isnan(value)) return "-";
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  const std::pair<double, const char*> prefixes[] = {{1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}};
  for (const auto& [scale, prefix] : prefixes)
    if (size >= scale) return fmt::format("{:.3g} {}{}", value / scale, prefix, unit);
  return "< 1 n" + unit;
}

std::string setup_text(const FeelSetup& setup, const std::string& engine) {
  return engine == "tactum" ? "" : fmt::format("{} x, ERP {:g}", setup.substeps, setup.erp);
}

nlohmann::ordered_json number(double value) {
  return std::isnan(value) ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(value);
}

const char* colour_of(const std::string& engine) {
  return engine == "tactum" ? "#0f766e" : engine == "bullet" ? "#b45309" : "#7a5bc7";
}

}  // namespace

nlohmann::ordered_json to_json(const FeelRow& row) {
  return {{"scene", row.scene},
          {"engine", row.engine},
          {"substeps", row.setup.substeps},
          {"erp", row.setup.erp},
          {"force_error_N", row.force_error_N},
          {"direction_error_rad", row.direction_error_rad},
          {"torque_error_Nm", row.torque_error_Nm},
          {"force_step_N", row.force_step_N},
          {"penetration_m", row.penetration_m},
          {"energy_made_J", row.energy_made_J},
          {"friction_error", number(row.friction_error)},
          {"creep_m_per_s", number(row.creep_m_per_s)},
          {"frame_us", row.frame_us}};
}

nlohmann::ordered_json to_json(const PegRow& row) {
  return {{"scene", "peg"},
          {"engine", row.engine},
          {"substeps", row.setup.substeps},
          {"erp", row.setup.erp},
          {"clearance_m", row.clearance_m},
          {"hands", row.hands},
          {"inserted", row.inserted},
          {"penetration_m", row.penetration_m},
          {"force_step_N", row.force_step_N},
          {"frame_us", row.frame_us}};
}

Table table_of(const std::vector<FeelRow>& rows) {
  Table table;
  table.left = 3;
  table.rows.push_back({"scene", "engine", "setup", "force", "direction", "torque", "force step", "overlap",
                        "energy made", "friction", "creep", "step"});
  for (const FeelRow& row : rows)
    table.rows.push_back(
        {row.scene, row.engine, setup_text(row.setup, row.engine), quantity(row.force_error_N, "N"),
         quantity(row.direction_error_rad, "rad"), quantity(row.torque_error_Nm, "N m"),
         quantity(row.force_step_N, "N"), quantity(row.penetration_m, "m"), quantity(row.energy_made_J, "J"),
         std::isnan(row.friction_error) ? "-" : fmt::format("{:.2g} %", 100.0 * row.friction_error),
         quantity(row.creep_m_per_s, "m/s"), fmt::format("{:.1f} µs", row.frame_us)});
  return table;
}

Table table_of(const std::vector<PegRow>& rows) {
  Table table;
  table.left = 3;
  table.rows.push_back({"clearance", "engine", "setup", "inserted", "overlap", "force step", "step"});
  for (const PegRow& row : rows)
    table.rows.push_back({quantity(row.clearance_m, "m"), row.engine, setup_text(row.setup, row.engine),
                          fmt::format("{} of {}", row.inserted, row.hands), quantity(row.penetration_m, "m"),
                          quantity(row.force_step_N, "N"), fmt::format("{:.1f} µs", row.frame_us)});
  return table;
}

std::string peg_plot(const std::vector<PegRow>& rows) {
  constexpr double kTop = 96, kBottom = 380, kWidth = 320, kLeft = 90, kApart = 450;
  const std::string small = R"(font-size="12" fill="#4b5563")";
  Svg svg(2 * kApart + 20, 450);
  svg.text({24, 30}, "A 25 mm peg goes into its hole", R"(font-size="18" font-weight="600" fill="#111827")");
  svg.text({24, 52},
           "over the clearance; filled: every hand got it in and out, hollow: not; the best of all setups",
           R"(font-size="13" fill="#4b5563")");
  const LogScale clearance = {5e-6, 2e-3, 0, kWidth};
  const struct {
    const char* title;
    const char* unit;
    double PegRow::*value;
    LogScale scale;
  } panels[] = {
      {"deepest overlap", "m", &PegRow::penetration_m, {1e-9, 1e-2, kBottom, kTop}},
      {"largest force step in a millisecond", "N", &PegRow::force_step_N, {1e-2, 1e3, kBottom, kTop}}};
  double left = kLeft;
  for (const auto& panel : panels) {
    svg.text({left, kTop - 14}, panel.title, R"(font-size="14" font-weight="600" fill="#111827")");
    for (double tick = panel.scale.low; tick <= 1.01 * panel.scale.high; tick *= 10) {
      svg.line({left, panel.scale(tick)}, {left + kWidth, panel.scale(tick)}, R"(stroke="#e4e7eb")");
      const bool none = tick == panel.scale.low && panel.value == &PegRow::penetration_m;
      svg.text({left - 6, panel.scale(tick) + 4}, none ? "none" : quantity(tick, panel.unit),
               R"(font-size="11" fill="#4b5563" text-anchor="end")");
    }
    for (const double c : kClearances_m)
      svg.text({left + clearance(c), kBottom + 20}, quantity(c, "m"), "text-anchor=\"middle\" " + small);
    if (panel.value == &PegRow::penetration_m) {
      std::vector<SheetPoint> fit;
      for (const double c : kClearances_m) fit.push_back({left + clearance(c), panel.scale(c)});
      svg.path(fit, R"(stroke="#9aa3af" stroke-dasharray="5 4")");
      svg.text({fit.front().x + 12, fit.front().y - 6}, "the clearance", small);
    }
    for (const char* engine : {"tactum", "bullet", "ode"}) {
      std::vector<SheetPoint> points;
      for (const PegRow& row : rows)
        if (row.engine == engine)
          points.push_back({left + clearance(row.clearance_m),
                            panel.scale(std::clamp(row.*panel.value, panel.scale.low, panel.scale.high))});
      if (points.empty()) continue;
      const std::string colour = colour_of(engine);
      svg.path(points, fmt::format(R"(stroke="{}" stroke-width="2")", colour));
      for (const PegRow& row : rows)
        if (row.engine == engine)
          svg.dot({left + clearance(row.clearance_m),
                   panel.scale(std::clamp(row.*panel.value, panel.scale.low, panel.scale.high))},
                  4.5,
                  fmt::format(R"(stroke="{}" stroke-width="2" fill="{}")", colour,
                              row.inserted == row.hands ? colour : "#fff"));
      svg.text({points.front().x + 12, points.front().y + 4}, engine,
               fmt::format(R"(font-size="13" font-weight="600" fill="{}")", colour));
    }
    left += kApart;
  }
  return svg.finished();
}

}  // namespace tactum::bench
