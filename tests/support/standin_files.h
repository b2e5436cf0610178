#pragma once
/// The stand-ins of the makers' libraries, as files and as libraries (tests/standins).

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace tactum {

/// The file of a stand-in: they lie in a folder beside the test programs.
inline std::string standin_file(const std::string& name) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "standins" / (name + ".so"))
      .string();
}

/// A variable of the environment, set as long as the object lives.
class SetVariable {
 public:
  SetVariable(std::string name, const std::string& value) : name_(std::move(name)) {
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~SetVariable() { unsetenv(name_.c_str()); }
  SetVariable(const SetVariable&) = delete;
  SetVariable& operator=(const SetVariable&) = delete;

 private:
  std::string name_;
};

/// A stand-in, loaded as long as the object lives: what a driver loads meanwhile is the same library.
class LoadedStandin {
 public:
  explicit LoadedStandin(const std::string& name) : handle_(dlopen(standin_file(name).c_str(), RTLD_NOW)) {}
  ~LoadedStandin() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  LoadedStandin(const LoadedStandin&) = delete;
  LoadedStandin& operator=(const LoadedStandin&) = delete;

  template <class Function>
  Function* function(const char* name) const {
    return handle_ == nullptr ? nullptr : reinterpret_cast<Function*>(dlsym(handle_, name));
  }

 private:
  void* handle_;
};

}  // namespace tactum
