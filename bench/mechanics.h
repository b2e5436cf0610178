#pragma once
/// Cases of mechanics with a closed form, moved by both of our responses and by the other engines, all in
/// steps of a millisecond: docs/mechanics.md. Cases with a grasped part are ours alone.

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/free_motion.h"
#include "bench/report.h"
#include "tactum/response/settings.h"

namespace tactum::bench {

inline constexpr double kMechanicsStep_s = 1e-3;

/// The largest errors of ours that the tests accept, in the sense of MechanicsCase::error; infinite where the
/// page states that the value is wrong.
struct MechanicsBounds {
  double constraint = std::numeric_limits<double>::infinity();
  double penalty = std::numeric_limits<double>::infinity();
};

/// One number of one case.
struct MechanicsCase {
  std::string name;
  std::string law;     ///< the closed form, as text
  std::string unit;    ///< of the value; empty: none
  double right = 0.0;  ///< by the closed form
  MechanicsBounds bounds;
  std::function<double(MakeMotion)> free = {};        ///< the value with an engine; empty for a grasped part
  std::function<double(ResponseModel)> grasped = {};  ///< ... with a grasped part; empty for free bodies

  /// The value's distance from `right`: relative to it, or absolute where it is zero.
  double error(double seen) const;
};

/// All cases, in the order of the table.
std::span<const MechanicsCase> mechanics_cases();

/// The value that one of our responses gives.
double seen_by_ours(const MechanicsCase& at, ResponseModel response);

/// A line a case. `progress` is called with the name of each.
Table mechanics_table(const std::function<void(const std::string&)>& progress);

}  // namespace tactum::bench
