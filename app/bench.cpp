/// tactum bench: the paper's table (bench_table1.cpp), the contact queries (bench_queries.cpp), surfaces
/// (bench_surfaces.cpp), the walls that devices hold (bench_stability.cpp), what is felt
/// (bench_feel.cpp), and what a work budget costs (bench_schedule.cpp).

#include "bench_commands.h"

namespace tactum {

void add_bench(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Measure");
  bench->require_subcommand(1);
  for (auto* add :
       {add_bench_table1, add_bench_pairs, add_bench_penetration, add_bench_manifold, add_bench_impact,
        add_bench_surfaces, add_bench_stability, add_bench_feel, add_bench_schedule})
    add(*bench);
}

}  // namespace tactum
