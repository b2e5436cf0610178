/// The `tactum` command: one file per subcommand, listed in commands.h.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "commands.h"

int main(int argc, char** argv) {
  using namespace tactum;
  CLI::App app("Feel polygonal models: six degree-of-freedom haptic rendering.", "tactum");
  app.require_subcommand(1);
  for (auto* add :
       {add_feel, add_scenes, add_devices, add_prepare, add_inspect, add_clearance, add_distance, add_bench})
    add(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tactum: %s\n", error.what());
    return 1;
  }
  return 0;
}
