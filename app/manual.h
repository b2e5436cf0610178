#pragma once
/// What packages carry beside a program, made of its own command line, so that it cannot say anything else.

#include <CLI/CLI.hpp>
#include <string>

namespace tactum {

/// The manual page of the program in the form of man(7): every command and option with what `--help` says of
/// it.
std::string manual_page(const CLI::App& app);

/// A completion for bash: commands, the options of the command at hand, else names of files.
std::string bash_completion(const CLI::App& app);

/// The same for fish, which shows what each command and option means beside it.
std::string fish_completion(const CLI::App& app);

/// Answers `PROGRAM help --man`, `--bash` and `--fish` on standard output. False when something else was
/// asked, and nothing is printed.
bool print_manual(const CLI::App& app, int argc, char** argv);

}  // namespace tactum
