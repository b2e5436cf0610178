/// The `tactum` command: one file per subcommand, listed in commands.h.

#include "commands.h"

int main(int argc, char** argv) {
  using namespace tactum;
  CLI::App app("Feel polygonal models: six degree-of-freedom haptic rendering.", "tactum");
  app.require_subcommand(1);
  for (auto* add : {add_feel, add_replay, add_export, add_report, add_sweep, add_scenes, add_devices,
                    add_doctor, add_prepare, add_import, add_inspect, add_clearance, add_distance, add_bench})
    add(app);
  return run_command_line(app, argc, argv);
}
