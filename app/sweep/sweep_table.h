#pragma once
/// The result of a sweep as an HDF5 file: a column for each axis and each metric, one row a run. It is a
/// function of the plan and the results alone: the same bytes wherever, and in whatever order, they were
/// computed.

#include <map>
#include <string>

#include "app/sweep/sweep_run.h"

namespace tactum {

/// Writes the results of all runs. An error where that cannot be.
Result<void> write_sweep(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results,
                         const std::string& path);

/// The unit that the name of an axis ends with; "1" for none.
std::string unit_of_axis(const std::string& name);

/// The number that stands for a value in a column: itself, or the place of a word among the axis's values.
double number_of(const SweepAxis& axis, std::size_t place);

/// A sentence on the results: how many succeeded, and how many could not be computed.
std::string sentence_on(const std::map<std::uint64_t, SweepResult>& results);

}  // namespace tactum
