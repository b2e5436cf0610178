#pragma once
/// Runs the programs as their users do: the built ones that lie beside the test programs.

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace tactum::testing {

struct ProgramRun {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// A folder of its own for the test's files, gone with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tactum-test-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

inline void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The path of a program that was built: it lies beside the tests' folder.
inline std::string built_program(const std::string& name) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / name).string();
}

/// `NAME ARGUMENTS` through the shell.
inline ProgramRun run_program(const std::string& name, const std::string& arguments) {
  const ScratchFolder folder;
  const std::string out = folder / "out";
  const std::string err = folder / "err";
  const int status =
      std::system(("'" + built_program(name) + "' " + arguments + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(out), content(err)};
}

/// Whether the run went to its end: a scene whose goals were not met, as in a run cut short, ends with 2.
inline bool ended(const ProgramRun& run) { return run.exit_code == 0 || run.exit_code == 2; }

inline ProgramRun run_tactum(const std::string& arguments) { return run_program("tactum", arguments); }
inline ProgramRun run_bench(const std::string& arguments) { return run_program("tactum-bench", arguments); }

}  // namespace tactum::testing
