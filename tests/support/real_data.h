#pragma once
/// Real meshes and motions for the tests: the folder named by TACTUM_DATA, or shared/data beside the source
/// tree. They are not part of the project; a test that misses them reports so and is skipped.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace tactum::testing {

/// The folder, or an empty path when there is none.
inline std::filesystem::path real_data() {
  const char* named = std::getenv("TACTUM_DATA");
  const std::filesystem::path path = named != nullptr ? named : TACTUM_SOURCE_DIR "/../shared/data";
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? path : std::filesystem::path();
}

/// The first file of this name anywhere below the folder.
inline std::filesystem::path find_real(const std::string& name) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(real_data())) {
    if (entry.path().filename() == name) return entry.path();
  }
  return {};
}

}  // namespace tactum::testing

/// Leaves the test with a printed line when the real data is not there.
#define TACTUM_NEEDS_REAL_DATA()                                                    \
  do {                                                                              \
    if (::tactum::testing::real_data().empty()) {                                   \
      std::printf("[  no data ] set TACTUM_DATA to the folder of real meshes\n");   \
      GTEST_SKIP() << "real data is absent (TACTUM_DATA is unset or not a folder)"; \
    }                                                                               \
  } while (false)
