#include "app/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "app/manual.h"
#include "tactum/base/nearest_word.h"
#include "tactum/version.h"

namespace tactum {
namespace {

/// The command that was read last: that of `tactum bench table1` is table1.
const CLI::App& last_command(const CLI::App& app) {
  const std::vector<CLI::App*> read = app.get_subcommands();
  return read.empty() ? app : last_command(*read.back());
}

/// "tactum bench" of that command.
std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The error about a word that is no command or option, or more than there should be; empty when every word
/// was understood.
std::string unknown_word(const CLI::App& app) {
  const CLI::App& command = last_command(app);
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return "";
  const std::string& word = words.front();
  const bool option = word.starts_with("-");
  const std::vector<std::string> known = option ? names_of_options(command) : names_of_commands(command);
  const std::string name = full_name(command);
  if (known.empty())
    return Error{name + " has no such argument", fmt::format("\"{}\"", word), "none", ""}.message();
  const std::string nearest = nearest_word(word.substr(0, word.find('=')), known);
  const Error error{
      fmt::format("{} has no such {}", name, option ? "option" : "command"), fmt::format("\"{}\"", word),
      nearest.empty() ? fmt::format("one of {}", fmt::join(known, ", ")) : fmt::format("\"{}\"", nearest),
      ""};
  return fmt::format("{}; see: {} --help", error.message(), name);
}

/// `tactum help` and `tactum help COMMAND`.
int print_help(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const CLI::App* next = nullptr;
    for (const CLI::App* candidate : command->get_subcommands({}))
      if (candidate->get_name() == word) next = candidate;
    if (next == nullptr) {
      const std::vector<std::string> known = names_of_commands(*command);
      const std::string nearest = nearest_word(word, known);
      fmt::print(stderr, "{} has no such command: found \"{}\", expected {}\n", full_name(*command), word,
                 nearest.empty() ? fmt::format("one of {}", fmt::join(known, ", ")) : "\"" + nearest + "\"");
      return 2;
    }
    command = next;
  }
  fmt::print("{}", command->help());
  return 0;
}

/// The value of an option as a number; false where it is none.
bool read_number(const std::string& text, double& number) {
  try {
    std::size_t end = 0;
    number = std::stod(text, &end);
    return end == text.size();
  } catch (const std::exception&) {
    return false;
  }
}

/// A check of a number by a rule, which `expected` says in words.
CLI::Validator number_check(const std::function<bool(double)>& allows, const std::string& expected) {
  return {[allows, expected](std::string& text) -> std::string {
            double number = 0.0;
            if (read_number(text, number) && allows(number)) return "";
            return fmt::format("found \"{}\", expected {}", text, expected);
          },
          ""};
}

}  // namespace

int run_command_line(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", fmt::format("{} {}.{}.{}", app.get_name(), TACTUM_VERSION_MAJOR,
                                                TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH));
  if (print_manual(app, argc, argv)) return 0;
  if (argc > 1 && std::string(argv[1]) == "help") return print_help(app, {argv + 2, argv + argc});
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    const std::string unknown = error.get_exit_code() == 0 ? "" : unknown_word(app);
    if (unknown.empty()) return app.exit(error) == 0 ? 0 : 2;
    fmt::print(stderr, "{}\n", unknown);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
    return 1;
  }
  return 0;
}

void fail(const Error& error) { throw std::runtime_error(error.message()); }

void end_with(int exit_code) { throw CLI::RuntimeError(exit_code); }

CLI::Validator number_between(double low, double high, const std::string& what) {
  return number_check([low, high](double number) { return number >= low && number <= high; },
                      fmt::format("{} from {} to {}", what, low, high));
}

CLI::Validator whole_number_between(double low, double high, const std::string& what) {
  return number_check(
      [low, high](double number) { return number >= low && number <= high && std::floor(number) == number; },
      fmt::format("{} from {} to {}, without a fraction", what, low, high));
}

CLI::Validator one_word_of(const std::vector<std::string>& words) {
  return {[words](std::string& text) -> std::string {
            for (const std::string& word : words)
              if (text == word) return "";
            const std::string nearest = nearest_word(text, words);
            return fmt::format("found \"{}\", expected {}", text,
                               nearest.empty()
                                   ? fmt::format("one of {}", fmt::join(words, ", "))
                                   : fmt::format("\"{}\" (of {})", nearest, fmt::join(words, ", ")));
          },
          ""};
}

void write_json(const std::string& path, const nlohmann::ordered_json& json) {
  const std::string text = json.dump(2) + "\n";
  if (path == "-") {
    std::fputs(text.c_str(), stdout);
    return;
  }
  write_text(path, text);
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) fail({"cannot write the file", "", "", path});
}

void check_writable(const std::string& path) {
  if (path.empty() || path == "-") return;
  std::FILE* file = std::fopen(path.c_str(), "a");  // keeps what is there
  if (file == nullptr)
    fail({"cannot write the file", std::strerror(errno), "a file in a folder that is there", path});
  std::fclose(file);
}

}  // namespace tactum
