#pragma once
/// The subcommands of `tactum-bench`.

#include "app/command_line.h"

namespace tactum {

void add_bench_clearance(CLI::App& parent);
void add_bench_feel(CLI::App& parent);
void add_bench_impact(CLI::App& parent);
void add_bench_manifold(CLI::App& parent);
void add_bench_mechanics(CLI::App& parent);
void add_bench_pairs(CLI::App& parent);
void add_bench_penetration(CLI::App& parent);
void add_bench_schedule(CLI::App& parent);
void add_bench_surfaces(CLI::App& parent);
void add_bench_stability(CLI::App& parent);

}  // namespace tactum
