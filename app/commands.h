#pragma once
/// The subcommands of `tactum`: each adds itself to the command line and does its work when it is called.

#include "app/command_line.h"

namespace tactum {

void add_bench(CLI::App& app);
void add_clearance(CLI::App& app);
void add_devices(CLI::App& app);
void add_distance(CLI::App& app);
void add_doctor(CLI::App& app);
void add_export(CLI::App& app);
void add_feel(CLI::App& app);
void add_import(CLI::App& app);
void add_inspect(CLI::App& app);
void add_prepare(CLI::App& app);
void add_replay(CLI::App& app);
void add_report(CLI::App& app);
void add_scenes(CLI::App& app);
void add_sweep(CLI::App& app);

}  // namespace tactum
