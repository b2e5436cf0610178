/// The `tactum-bench` command: what is measured, a subcommand each, listed in commands.h.

#include "bench/main/commands.h"

int main(int argc, char** argv) {
  using namespace tactum;
  CLI::App app("Measure what Tactum computes, beside other libraries where they are installed.",
               "tactum-bench");
  app.require_subcommand(1);
  for (auto* add :
       {add_bench_pairs, add_bench_penetration, add_bench_manifold, add_bench_impact, add_bench_surfaces,
        add_bench_clearance, add_bench_stability, add_bench_feel, add_bench_mechanics, add_bench_schedule})
    add(app);
  return run_command_line(app, argc, argv);
}
