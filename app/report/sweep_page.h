#pragma once
/// The result of a sweep as one HTML page: maps of its metrics over two axes, for each value of the others.

#include <map>
#include <string>

#include "app/sweep/sweep_run.h"

namespace tactum {

/// The first axis goes up and the second to the right; each map is for one choice of the others, of which at
/// most 40 are drawn. The values stand in the cells' titles.
std::string sweep_page(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results);

}  // namespace tactum
