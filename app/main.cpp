#include <CLI/CLI.hpp>

#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app("Feel polygonal models: six degree-of-freedom haptic rendering.", "tactum");
  app.require_subcommand(1);
  using Add = void (*)(CLI::App&);
  for (Add add : std::initializer_list<Add>{tactum::add_inspect, tactum::add_clearance}) add(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}
