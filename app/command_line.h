#pragma once
/// Functions common to the command lines of `tactum` and `tactum-bench`.
/// Exit codes: 0 done, 1 an error reported on stderr, 2 the command line is wrong.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "tactum/base/result.h"

namespace tactum {

/// Reads the command line, and so runs the command that it names. Returns the exit code.
int run_command_line(CLI::App& app, int argc, char** argv);

/// Ends the command with exit code 1, after the program's name and the error were written to stderr. Works in
/// commands that run_command_line() has called, in its thread.
[[noreturn]] void fail(const Error& error);

/// Writes to a file, or to standard output for "-". Ends the command when it cannot.
void write_json(const std::string& path, const nlohmann::ordered_json& json);

}  // namespace tactum
