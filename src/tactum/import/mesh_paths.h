#pragma once
/// Where the files are that URDF and MJCF name.

#include <optional>
#include <string>

namespace tactum::inline v0_1 {

/// The path of a mesh that a file in `folder` names: absolute, relative to that folder, "file://PATH", or
/// "package://NAME/PATH" and "model://NAME/PATH". A package is a folder NAME above `folder` or beside one
/// above it, or one in the folders of the environment's ROS_PACKAGE_PATH and TACTUM_DATA. None when there
/// is no such file.
std::optional<std::string> find_mesh_file(const std::string& name, const std::string& folder);

/// Where find_mesh_file() looks for a name, as a clause.
std::string places_of_meshes(const std::string& name, const std::string& folder);

}  // namespace tactum::inline v0_1
