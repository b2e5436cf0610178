#include "tactum/scene/scene_description.h"

#include <fmt/format.h>

#include "tactum/scene/item_errors.h"

namespace tactum::inline v0_1 {

Mat3 rotation_rpy_deg(const Vec3& rpy_deg) {
  const Vec3 rpy = rpy_deg * (kPi / 180.0);
  const Eigen::AngleAxisd roll(rpy.x(), Vec3::UnitX());
  const Eigen::AngleAxisd pitch(rpy.y(), Vec3::UnitY());
  const Eigen::AngleAxisd yaw(rpy.z(), Vec3::UnitZ());
  return (yaw * pitch * roll).toRotationMatrix();
}

std::string SceneSource::where(const std::string& path) const {
  if (file.empty()) return path;
  for (std::string item = path;;) {
    const auto found = places.find(item);
    if (found != places.end()) return fmt::format("{}:{}:{}", file, found->second.line, found->second.column);
    if (item.empty()) return file;
    const std::size_t dot = item.rfind('.');
    item.resize(dot == std::string::npos ? 0 : dot);
  }
}

std::string SceneSource::section(const std::string& path) const {
  if (path.empty()) return "the scene";
  return file.empty() ? path : file_section(path);
}

}  // namespace tactum::inline v0_1
