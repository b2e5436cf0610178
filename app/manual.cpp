#include "app/manual.h"

#include <fmt/format.h>

#include <cstdio>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "tactum/version.h"

namespace tactum {
namespace {

using Command = CLI::App;

std::vector<const Command*> commands_of(const Command& command) {
  return command.get_subcommands([](const Command* below) { return !below->get_name().empty(); });
}

/// The options of a command, with those of its groups: CLI11 keeps a group as a command without a name.
std::vector<const CLI::Option*> all_options(const Command& command) {
  const auto named = [](const CLI::Option* option) { return option->get_name() != "--help"; };
  std::vector<const CLI::Option*> options = command.get_options([](const CLI::Option*) { return true; });
  for (const Command* group : command.get_subcommands([](const Command* c) { return c->get_name().empty(); }))
    for (const CLI::Option* option : group->get_options(named)) options.push_back(option);
  return options;
}

/// Text as man(7) shows it letter by letter: no letter of it is an instruction.
std::string as_roff(const std::string& text) {
  std::string roff;
  bool starts_line = true;
  for (const char letter : text) {
    if (starts_line && (letter == '.' || letter == '\'')) roff += "\\&";
    starts_line = letter == '\n';
    if (letter == '-')
      roff += "\\-";
    else if (letter == '\\')
      roff += "\\e";
    else
      roff += letter;
  }
  return roff;
}

std::string in_capitals(std::string text) {
  for (char& letter : text)
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  return text;
}

/// "feel" of the command "feel"; "table1 ..." need their parents: "bench table1".
std::string words_below(const Command& command, const Command& app) {
  if (&command == &app) return "";
  const std::string before = words_below(*command.get_parent(), app);
  return before.empty() ? command.get_name() : before + " " + command.get_name();
}

/// A long list of words may be broken behind each comma.
std::string with_breaks(const std::string& roff) {
  std::string text;
  for (const char letter : roff) {
    text += letter;
    if (letter == ',') text += "\\:";
  }
  return text;
}

/// "-o, --output FILE" of an option, "SCENE" of a positional.
std::string heading_of(const CLI::Option& option) {
  if (option.nonpositional()) {
    std::string names;
    for (const std::string& name : option.get_snames())
      names += (names.empty() ? "" : ", ") + ("\\fB" + as_roff("-" + name) + "\\fR");
    for (const std::string& name : option.get_lnames())
      names += (names.empty() ? "" : ", ") + ("\\fB" + as_roff("--" + name) + "\\fR");
    const std::string type = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
    return type.empty() ? names : names + " \\fI" + with_breaks(as_roff(type)) + "\\fR";
  }
  return "\\fI" + as_roff(option.get_name(true, false)) + "\\fR";
}

/// ". Not with --updates." and its like.
std::string relations_of(const CLI::Option& option) {
  std::string text = option.get_required() ? " (required)" : "";
  const std::string value = option.get_default_str();
  if (!value.empty()) text += fmt::format(" (default: {})", value);
  for (const CLI::Option* other : option.get_needs())
    text += fmt::format(" (with {} only)", other->get_name());
  for (const CLI::Option* other : option.get_excludes())
    text += fmt::format(" (not with {})", other->get_name());
  return text;
}

std::string options_of(const Command& command) {
  std::string page;
  for (const bool positional : {true, false})
    for (const CLI::Option* option : all_options(command))
      if (option->nonpositional() != positional)
        page += fmt::format(".TP\n{}\n{}\n", heading_of(*option),
                            as_roff(option->get_description() + relations_of(*option)));
  return page;
}

/// The sections of the commands below `parent`, each followed by those below it.
std::string command_sections(const Command& parent, const Command& app) {
  std::string page;
  for (const Command* command : commands_of(parent)) {
    const std::string words = words_below(*command, app);
    page += fmt::format(".SS {}\n{}.\n", as_roff(app.get_name() + " " + words),
                        as_roff(command->get_description()));
    page += options_of(*command);
    if (!command->get_footer().empty()) page += fmt::format(".PP\n{}\n", as_roff(command->get_footer()));
    page += command_sections(*command, app);
  }
  return page;
}

std::string version_text() {
  return fmt::format("{}.{}.{}", TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH);
}

/// Every name an option can be called by, with a blank between them.
std::string option_words(const Command& command) {
  std::string words;
  for (const CLI::Option* option : all_options(command)) {
    for (const std::string& name : option->get_snames()) words += " -" + name;
    for (const std::string& name : option->get_lnames()) words += " --" + name;
  }
  return words.empty() ? words : words.substr(1);
}

std::string command_words(const Command& command) {
  std::string words;
  for (const Command* below : commands_of(command)) words += " " + below->get_name();
  return words;
}

/// A line of the shell's `case` for the command and each below it: what may follow its words.
std::string bash_cases(const Command& command, const Command& app) {
  std::string below = command_words(command);
  if (&command == &app && !below.empty()) below += " help";
  std::string cases =
      fmt::format("    \"{}\") options=\"{}\" commands=\"{}\" ;;\n", words_below(command, app),
                  option_words(command), below.empty() ? below : below.substr(1));
  for (const Command* next : commands_of(command)) cases += bash_cases(*next, app);
  return cases;
}

constexpr std::string_view kBashFunction = R"(# Completion of NAME for bash; `NAME help --bash` prints it.
FUNCTION() {
  local word=${COMP_WORDS[COMP_CWORD]} path="" options="" commands="" names="" i
  FUNCTION_known() {
    case "$1" in
CASES    *) return 1 ;;
    esac
  }
  FUNCTION_known ""
  for ((i = 1; i < COMP_CWORD; i++)); do
    if [[ $i == 1 && ${COMP_WORDS[1]} == help ]]; then options=""; continue; fi
    if FUNCTION_known "${path:+$path }${COMP_WORDS[i]}"; then path="${path:+$path }${COMP_WORDS[i]}"; fi
    if [[ ${COMP_WORDS[1]} == help ]]; then options=""; fi
  done
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  if [[ -n $commands ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
    return
  fi
  if [[ $path == feel ]]; then
    names=$("${COMP_WORDS[0]}" scenes 2>/dev/null | while read -r name _; do [[ $name == "("* ]] || echo "$name"; done)
  fi
  mapfile -t COMPREPLY < <(compgen -W "$names" -- "$word"; compgen -f -- "$word")
  compopt -o filenames 2>/dev/null
}
complete -F FUNCTION NAME
)";

std::string replaced(std::string text, const std::string& word, const std::string& by) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + by.size()))
    text.replace(at, word.size(), by);
  return text;
}

/// A text in the quotes of fish, which know two escapes.
std::string in_fish_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text) {
    if (letter == '\'' || letter == '\\') quoted += '\\';
    quoted += letter == '\n' ? ' ' : letter;
  }
  return quoted + "'";
}

/// The words of every command below this one, quoted.
std::string fish_paths(const Command& command, const Command& app) {
  std::string paths;
  for (const Command* below : commands_of(command))
    paths += " " + in_fish_quotes(words_below(*below, app)) + fish_paths(*below, app);
  return paths;
}

/// What the names of the functions of a program's completion begin with.
std::string fish_function(const Command& app) { return "__" + replaced(app.get_name(), "-", "_"); }

/// The lines of fish for the command and each below it: what may follow its words.
std::string fish_lines(const Command& command, const Command& app) {
  const std::string path = words_below(command, app);
  const std::string begin = "complete -c " + app.get_name();
  const std::string takes = fmt::format(" -n \"{}_takes '{}'\"", fish_function(app), path);
  std::string lines;
  for (const CLI::Option* option : all_options(command)) {
    if (!option->nonpositional()) continue;
    lines += begin + takes;
    for (const std::string& name : option->get_snames()) lines += " -s " + name;
    for (const std::string& name : option->get_lnames()) lines += " -l " + name;
    if (option->get_items_expected_max() > 0) lines += " -r";
    lines += " -d " + in_fish_quotes(option->get_description()) + "\n";
  }
  for (const Command* below : commands_of(command))
    lines += fmt::format("{} -f -n \"{}_is_at '{}'\" -a {} -d {}\n", begin, fish_function(app), path,
                         below->get_name(), in_fish_quotes(below->get_description()));
  if (&command == &app && !commands_of(app).empty())
    lines += begin + " -f" + takes + " -a help -d 'Print what is said of a command'\n";
  for (const Command* below : commands_of(command)) lines += fish_lines(*below, app);
  return lines;
}

constexpr std::string_view kFishFunctions = R"(# Completion of NAME for fish; `NAME help --fish` prints it.
function FUNCTION_is_at -d 'Whether the words so far lead to this command of NAME'
    set -l path ''
    for word in (commandline -opc)[2..-1]
        set -l next (string trim "$path $word")
        contains -- $next PATHS; and set path $next
    end
    test "$path" = "$argv[1]"
end
function FUNCTION_takes -d 'The same, where its options and arguments may follow'
    set -l words (commandline -opc)
    test "$words[2]" != help; and FUNCTION_is_at $argv[1]
end
)";

constexpr std::string_view kFishScenes =
    R"fish(complete -c NAME -n "FUNCTION_takes 'feel'" -a "(NAME scenes 2>/dev/null | string match -rv '^\(' | string replace -r ' .*' '')"
)fish";

}  // namespace

std::string manual_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string what = app.get_description();
  if (!what.empty() && what.back() == '.') what.pop_back();
  // .ad l: long lists of words leave lines that no blanks could fill.
  std::string page = fmt::format(".TH {} 1 \"\" \"Tactum {}\" \"User Commands\"\n.ad l\n",
                                 as_roff(in_capitals(name)), version_text());
  page += fmt::format(".SH NAME\n{} \\- {}\n", as_roff(name), as_roff(what));
  const bool has_commands = !commands_of(app).empty();
  page += fmt::format(".SH SYNOPSIS\n.B {}\n[\\fIOPTION\\fR]... {}\n", as_roff(name),
                      has_commands ? "\\fICOMMAND\\fR [\\fIARGUMENT\\fR]..." : "\\fIARGUMENT\\fR...");
  page += fmt::format(".SH OPTIONS\n{}", options_of(app));
  if (has_commands)
    page += fmt::format(".SH COMMANDS\n{} prints what is said here of one of them.\n{}",
                        as_roff(name + " help COMMAND"), command_sections(app, app));
  page +=
      ".SH EXIT STATUS\n0 done; 1 an error, which was written to standard error; 2 the command line is "
      "wrong or a goal was not met.\n";
  if (name != "tactum") page += ".SH SEE ALSO\n.BR tactum (1)\n";
  return page;
}

std::string bash_completion(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string text = replaced(std::string(kBashFunction), "CASES", bash_cases(app, app));
  text = replaced(text, "FUNCTION", "_" + replaced(name, "-", "_"));
  return replaced(text, "NAME", name);
}

std::string fish_completion(const CLI::App& app) {
  const std::string& name = app.get_name();
  const auto named = [&](std::string_view text) {
    return replaced(replaced(std::string(text), "FUNCTION", fish_function(app)), "NAME", name);
  };
  std::string text = replaced(named(kFishFunctions), " PATHS", fish_paths(app, app)) + fish_lines(app, app);
  return name == "tactum" ? text + named(kFishScenes) : text;
}

bool print_manual(const CLI::App& app, int argc, char** argv) {
  if (argc != 3 || std::string_view(argv[1]) != "help") return false;
  const std::string_view asked = argv[2];
  constexpr std::pair<std::string_view, std::string (*)(const CLI::App&)> kForms[] = {
      {"--man", &manual_page}, {"--bash", &bash_completion}, {"--fish", &fish_completion}};
  for (const auto& [name, make] : kForms)
    if (asked == name) {
      std::fputs(make(app).c_str(), stdout);
      return true;
    }
  return false;
}

}  // namespace tactum
