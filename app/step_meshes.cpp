#include "step_meshes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

namespace tactum {
namespace {

namespace fs = std::filesystem;

constexpr double kChordsInFit = 20.0;  // a fit is felt to a twentieth

/// Beside this program, else on PATH.
Result<std::string> find_step_program() {
  std::error_code failure;
  const fs::path beside = fs::read_symlink("/proc/self/exe", failure).parent_path();
  std::vector<fs::path> folders{beside};
  const char* path = std::getenv("PATH");
  std::istringstream names(path != nullptr ? path : "");
  for (std::string name; std::getline(names, name, ':');) folders.emplace_back(name);
  for (const fs::path& folder : folders) {
    const fs::path program = folder / "tactum-step";
    if (fs::is_regular_file(program, failure) && ::access(program.c_str(), X_OK) == 0)
      return program.string();
  }
  return Error{
      "STEP files need the program tactum-step, which is not installed",
      fmt::format("none in {} or on PATH", beside.string()),
      "a build of Tactum on a machine with OpenCASCADE (libocct-data-exchange-dev), or the triangles of "
      "the part as OBJ or STL",
      ""};
}

/// Runs a program with its output in a file; returns its exit code, or -1.
int run_into(const std::string& output, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, argv.front(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failed != 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

/// What tactum-step has printed, without its advice for people who call it themselves.
std::string said(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line);)
    if (!line.starts_with("next:")) text += line + "\n";
  return text;
}

/// The lines of an error in one, without its end.
std::string one_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

bool is_step_name(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return ending == ".step" || ending == ".stp";
}

Result<double> length_with_unit(const std::string& text) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  constexpr std::array kUnits{Unit{"um", 1e-6}, Unit{"\u00b5m", 1e-6}, Unit{"\u03bcm", 1e-6},
                              Unit{"mm", 1e-3}, Unit{"cm", 1e-2},      Unit{"m", 1.0}};
  double value = 0.0;
  const auto [end, trouble] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  for (const Unit& known : kUnits)
    if (trouble == std::errc() && unit == known.name && value > 0.0 && std::isfinite(value))
      return value * known.metres;
  return Error{"no length", fmt::format("\"{}\"", text),
               "a number above 0 with um, mm, cm or m, such as 20um", ""};
}

StepMeshes::~StepMeshes() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

Result<std::vector<std::string>> StepMeshes::make(const std::vector<std::string>& files,
                                                  std::optional<double> fit_m) {
  const Result<std::string> program = find_step_program();
  if (!program) return program.error();
  std::string name = (fs::temp_directory_path() / "tactum-step-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    return Error{"no folder for the triangles", std::strerror(errno), "a folder that can be written", name};
  folder_ = name;
  std::vector<std::string> meshes;
  for (const std::string& file : files) {
    const std::string mesh = (folder_ / fmt::format("{}.obj", meshes.size())).string();
    std::vector<std::string> arguments{*program, file, "-o", mesh};
    if (fit_m) {
      arguments.insert(arguments.end(), {"--deviation", fmt::format("{}", 1e3 * *fit_m / kChordsInFit)});
      report_ += fmt::format("{}: chord error of at most {:.4g} um, a twentieth of the fit of {:.4g} um\n",
                             file, 1e6 * *fit_m / kChordsInFit, 1e6 * *fit_m);
    } else {
      report_ +=
          fmt::format("{}: chord error of 1e-4 of the diagonal; --fit makes it a twentieth of a fit\n", file);
    }
    const std::string output = (folder_ / "output").string();
    const int code = run_into(output, arguments);
    if (code != 0)
      return Error{"tactum-step has failed", one_line(said(output)), fmt::format("exit code 0, not {}", code),
                   file};
    report_ += said(output);
    meshes.push_back(mesh);
  }
  return meshes;
}

}  // namespace tactum
