#include "bench/mechanics.h"

#include <fmt/format.h>

#include <cmath>

namespace tactum::bench {
namespace {

/// An error that rounding alone may leave is none [-].
constexpr double kRounding = 1e-12;
constexpr double kManyTimes = 10.0;

std::string error_text(const MechanicsCase& at, double seen) {
  const double error = at.error(seen);
  if (!std::isfinite(error)) return "not finite";
  if (error < kRounding) return "0";
  if (at.right == 0.0) return "";  // the value is the error
  if (error > kManyTimes) return fmt::format("{:.0f} times", error);
  return error < 1.0 ? fmt::format("{:.2g} %", 100.0 * error) : fmt::format("{:.0f} %", 100.0 * error);
}

std::string value_text(double value, const std::string& unit) {
  const std::string number = std::abs(value) < kRounding ? "0" : fmt::format("{:.5g}", value);
  return unit.empty() ? number : number + " " + unit;
}

std::string cell(const MechanicsCase& at, double seen) {
  const std::string error = error_text(at, seen);
  return value_text(seen, at.unit) + (error.empty() || error == "0" ? "" : " (" + error + ")");
}

std::string peer_cell(const MechanicsCase& at, MakeMotion engine) {
  return at.free && engine != nullptr ? cell(at, at.free(engine)) : "-";
}

}  // namespace

double MechanicsCase::error(double seen) const {
  return right == 0.0 ? std::abs(seen) : std::abs(seen / right - 1.0);
}

double seen_by_ours(const MechanicsCase& at, ResponseModel response) {
  if (at.grasped) return at.grasped(response);
  return at.free(response == ResponseModel::kConstraint ? make_constraint_motion : make_penalty_motion);
}

Table mechanics_table(const std::function<void(const std::string&)>& progress) {
  const MotionPeers peers = motion_peers();
  Table table;
  table.left = 2;
  table.rows.push_back(
      {"case", "closed form", "right", "constraint response", "penalty response", "Bullet", "ODE", "MuJoCo"});
  for (const MechanicsCase& at : mechanics_cases()) {
    progress(at.name);
    table.rows.push_back({at.name, at.law, value_text(at.right, at.unit),
                          cell(at, seen_by_ours(at, ResponseModel::kConstraint)),
                          cell(at, seen_by_ours(at, ResponseModel::kPenalty)), peer_cell(at, peers.bullet),
                          peer_cell(at, peers.ode), peer_cell(at, peers.mujoco)});
  }
  return table;
}

}  // namespace tactum::bench
