#pragma once
/// A maker's shared library, loaded when a device is asked for: Tactum is built without it, and starts
/// without it. What is missing is told in one sentence: which files were looked for and where, why one that
/// was found does not load (the loader's own words), or which functions an old one lacks, and the cure.
///
///   variable set    the file or the folder it names, and nothing else
///   otherwise       the folders, then the loader's own path (ldconfig, LD_LIBRARY_PATH)

#include <string>
#include <vector>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Where a library is looked for.
struct LibrarySearch {
  std::string maker;                 ///< "Force Dimension": for sentences
  std::string variable;              ///< of the environment: names the library, or the folder that holds it
  std::vector<std::string> names;    ///< "libdrd.so", the best first; versions behind a dot are tried, too
  std::vector<std::string> folders;  ///< the best first; empty names are passed over
  std::string cure;                  ///< "install the Force Dimension SDK"
  /// Libraries of the system that it uses and does not name as needed: they are loaded before it, for all to
  /// see. One that is absent is passed over; the loader then says which function is missing.
  std::vector<std::string> companions{};
};

class VendorLibrary {
 public:
  VendorLibrary() = default;
  ~VendorLibrary() { unload(); }
  VendorLibrary(VendorLibrary&& other) noexcept { *this = std::move(other); }
  VendorLibrary& operator=(VendorLibrary&& other) noexcept;

  /// Loads the first library that is found. Slow: reads folders and runs the library's constructors.
  static Result<VendorLibrary> load(const LibrarySearch& search);
  /// After this no function of it may be called. Safe to call twice.
  void unload() noexcept;
  bool loaded() const noexcept { return handle_ != nullptr; }
  const std::string& path() const noexcept { return path_; }

  /// The address of a function; null when the library lacks it. `require` remembers that, for check().
  template <class Function>
  bool find(const char* name, Function*& function) const noexcept {
    function = reinterpret_cast<Function*>(address(name));
    return function != nullptr;
  }
  template <class Function>
  void require(const char* name, Function*& function) {
    if (!find(name, function)) missing_.emplace_back(name);
  }
  /// An error that names every function that was required and is not there.
  Result<void> check() const;

 private:
  void* address(const char* name) const noexcept;

  void* handle_ = nullptr;
  std::vector<void*> companions_;
  std::string path_;
  std::string cure_;
  std::vector<std::string> missing_;
};

/// The value of a variable of the environment; empty when it is not set.
std::string environment(const char* name);

}  // namespace tactum::inline v0_1
