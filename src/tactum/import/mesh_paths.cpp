#include "tactum/import/mesh_paths.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <vector>

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

/// The text behind "package://" or "model://"; none without one.
std::optional<std::string> in_package(const std::string& name) {
  for (const std::string_view scheme : {"package://", "model://"})
    if (name.starts_with(scheme)) return name.substr(scheme.size());
  return std::nullopt;
}

/// The folders of two variables of the environment, with colons between them.
std::vector<fs::path> folders_of_packages() {
  std::vector<fs::path> folders;
  for (const char* variable : {"ROS_PACKAGE_PATH", "TACTUM_DATA"}) {
    const char* named = std::getenv(variable);
    std::string_view rest = named != nullptr ? named : "";
    while (!rest.empty()) {
      const std::size_t colon = rest.find(':');
      if (colon != 0) folders.emplace_back(rest.substr(0, colon));
      rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
    }
  }
  return folders;
}

}  // namespace

std::optional<std::string> find_mesh_file(const std::string& name, const std::string& folder) {
  const auto there = [](const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
  };
  const std::optional<std::string> inside = in_package(name);
  if (!inside) {
    constexpr std::string_view kFile = "file://";
    const fs::path path = fs::path(folder) / (name.starts_with(kFile) ? name.substr(kFile.size()) : name);
    return there(path) ? std::optional(path.string()) : std::nullopt;
  }
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (fs::path above = fs::absolute(folder.empty() ? "." : folder, ignored).lexically_normal(); !ignored;
       above = above.parent_path()) {
    folders.push_back(above);
    if (above == above.parent_path()) break;
  }
  for (const fs::path& more : folders_of_packages()) folders.push_back(more);
  for (const fs::path& candidate : folders)
    if (there(candidate / *inside)) return (candidate / *inside).string();
  return std::nullopt;
}

std::string places_of_meshes(const std::string& name, const std::string& folder) {
  const std::string here = folder.empty() ? "the folder of the file" : folder;
  if (!in_package(name)) return fmt::format("a file, seen from {}", here);
  return fmt::format(
      "a package that is a folder of this name at or above {}, or in a folder that ROS_PACKAGE_PATH or "
      "TACTUM_DATA names",
      here);
}

}  // namespace tactum::inline v0_1
