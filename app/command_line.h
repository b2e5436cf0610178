#pragma once
/// Functions common to the command lines of `tactum` and `tactum-bench`.
/// Exit codes: 0 done, 1 an error reported on stderr, 2 the command line is wrong or a goal was not met.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactum/base/result.h"

namespace tactum {

/// Reads the command line, and so runs the command that it names; `help`, `help COMMAND` and `--version` are
/// answered here. A command or option that there is not is an error with the nearest one. Returns the exit
/// code.
int run_command_line(CLI::App& app, int argc, char** argv);

/// Ends the command with exit code 1, after the program's name and the error were written to stderr. Works in
/// commands that run_command_line() has called, in its thread.
[[noreturn]] void fail(const Error& error);

/// Ends the command with this exit code, without a word.
[[noreturn]] void end_with(int exit_code);

/// Checks for the values of options, with errors that name what was found: a number from `low` to `high`,
/// `what` it is; the same without a fraction; one of some words, with the nearest.
CLI::Validator number_between(double low, double high, const std::string& what);
CLI::Validator whole_number_between(double low, double high, const std::string& what);
CLI::Validator one_word_of(const std::vector<std::string>& words);

/// Writes to a file, or to standard output for "-". Ends the command when it cannot.
void write_json(const std::string& path, const nlohmann::ordered_json& json);

/// The same for a text and a file.
void write_text(const std::string& path, const std::string& text);

/// Ends the command when the file cannot be written, before the work whose result it is for.
void check_writable(const std::string& path);

}  // namespace tactum
