#pragma once
/// What every generated part asks of the measures it is made from.

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Whether a measure is a finite number above 0.
inline bool positive(double measure) { return std::isfinite(measure) && measure > 0.0; }

/// Whether a measure is a finite number, 0 or more.
inline bool not_negative(double measure) { return std::isfinite(measure) && measure >= 0.0; }

/// The error of a part whose measure `what` was found to be `found`.
inline Error impossible(const char* what, double found, const std::string& expected) {
  return {fmt::format("the part's {} cannot be", what), fmt::format("{}", found), expected, ""};
}

}  // namespace tactum::inline v0_1
