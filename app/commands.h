#pragma once
/// The subcommands of `tactum`: each adds itself to the command line and does its work when it is called.
/// Exit codes: 0 done, 1 an error told on stderr, 2 the command line is wrong.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tactum/base/result.h"

namespace tactum {

void add_bench(CLI::App& app);
void add_clearance(CLI::App& app);
void add_devices(CLI::App& app);
void add_distance(CLI::App& app);
void add_feel(CLI::App& app);
void add_inspect(CLI::App& app);
void add_prepare(CLI::App& app);
void add_scenes(CLI::App& app);

/// Tells the error and ends the command with exit code 1.
[[noreturn]] inline void fail(const Error& error) {
  std::fprintf(stderr, "tactum: %s\n", error.message().c_str());
  throw CLI::RuntimeError(1);
}

}  // namespace tactum
