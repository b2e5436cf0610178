#include "tactum/parts/metric_thread.h"

#include <cmath>

namespace tactum::inline v0_1 {
namespace {

// Pitch, hexagon and heights in mm; tolerances of the pitch diameter and the allowance of class g in um.
// Zero: the standard has none.
struct ThreadRow {
  const char* name;
  double major, pitch;
  double across_flats, head, nut;
  int bolt_4, bolt_6, bolt_8;
  int nut_5, nut_6, nut_7;
  int allowance_g;
};
constexpr ThreadRow kThreadRows[] = {
    {"M3", 3, 0.5, 5.5, 2.0, 2.4, 48, 75, 0, 80, 100, 125, 20},
    {"M4", 4, 0.7, 7, 2.8, 3.2, 56, 90, 0, 95, 118, 150, 22},
    {"M5", 5, 0.8, 8, 3.5, 4.7, 60, 95, 150, 100, 125, 160, 24},
    {"M6", 6, 1.0, 10, 4.0, 5.2, 71, 112, 180, 118, 150, 190, 26},
    {"M8", 8, 1.25, 13, 5.3, 6.8, 75, 118, 190, 125, 160, 200, 28},
    {"M10", 10, 1.5, 16, 6.4, 8.4, 85, 132, 212, 140, 180, 224, 32},
    {"M12", 12, 1.75, 18, 7.5, 10.8, 95, 150, 236, 160, 200, 250, 34},
    {"M14", 14, 2.0, 21, 8.8, 12.8, 100, 160, 250, 170, 212, 265, 38},
    {"M16", 16, 2.0, 24, 10.0, 14.8, 100, 160, 250, 170, 212, 265, 38},
    {"M18", 18, 2.5, 27, 11.5, 15.8, 106, 170, 265, 180, 224, 280, 42},
    {"M20", 20, 2.5, 30, 12.5, 18.0, 106, 170, 265, 180, 224, 280, 42},
    {"M22", 22, 2.5, 34, 14.0, 19.4, 106, 170, 265, 180, 224, 280, 42},
    {"M24", 24, 3.0, 36, 15.0, 21.5, 125, 200, 315, 212, 265, 335, 48},
};

constexpr double kPerMillimetre = 1.0 / 1000.0;
constexpr double kPerMicrometre = 1.0 / 1e6;

Result<const ThreadRow*> row_of(const std::string& name) {
  std::string known;
  for (const ThreadRow& row : kThreadRows) {
    if (name == row.name) return &row;
    known += (known.empty() ? "" : " ") + std::string(row.name);
  }
  return Error{"an unknown thread", "\"" + name + "\"", "one of " + known, ""};
}

/// H, the height of the sharp triangle [ISO 1998, 68-1].
double triangle_height(double pitch) { return 0.5 * std::sqrt(3.0) * pitch; }

}  // namespace

double MetricScrew::pitch_diameter_m() const { return major_m - 0.75 * triangle_height(pitch_m); }

double MetricScrew::minor_m() const { return major_m - 1.25 * triangle_height(pitch_m); }

Result<MetricScrew> metric_screw(const std::string& name) {
  const Result<const ThreadRow*> found = row_of(name);
  if (!found) return found.error();
  const ThreadRow& row = **found;
  return MetricScrew{row.name,
                     row.major * kPerMillimetre,
                     row.pitch * kPerMillimetre,
                     row.across_flats * kPerMillimetre,
                     row.head * kPerMillimetre,
                     row.nut * kPerMillimetre};
}

Result<ThreadFit> thread_fit(const std::string& screw, const std::string& tolerance_class) {
  const Result<const ThreadRow*> found = row_of(screw);
  if (!found) return found.error();
  const ThreadRow& row = **found;
  const auto middle = [](int allowance, int bolt, int nut) {
    return ThreadFit{-(allowance + 0.5 * bolt) * kPerMicrometre, 0.5 * nut * kPerMicrometre};
  };
  if (tolerance_class == "fine") return middle(0, row.bolt_4, row.nut_5);
  if (tolerance_class == "medium") return middle(row.allowance_g, row.bolt_6, row.nut_6);
  if (tolerance_class != "coarse")
    return Error{"an unknown class of threads", "\"" + tolerance_class + "\"", "fine, medium or coarse", ""};
  if (row.bolt_8 == 0) return Error{"no class coarse for this thread", screw, "M5 or larger", ""};
  return middle(row.allowance_g, row.bolt_8, row.nut_7);
}

ThreadFit thread_fit_with(double clearance_m) { return {-2.0 * clearance_m, 2.0 * clearance_m}; }

}  // namespace tactum::inline v0_1
