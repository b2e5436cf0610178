#pragma once
/// The sections of a scene file, one reader each. They add to `errors` of their TomlReader and go on.
/// For scene_file.cpp only.

#include <string>
#include <vector>

#include "tactum/scene/scene.h"
#include "tactum/scene/shape.h"
#include "tactum/scene/toml_reader.h"

namespace tactum {

/// Folders in which meshes are looked for, in this order; "" is the working directory.
using SearchFolders = std::vector<std::string>;

/// The path of a file by its name, absolute or in one of the folders; an error says where it was looked for.
Result<std::string> found_file(const std::string& name, const SearchFolders& folders);

/// `part = { gear = {...} }` and its kin, of the body's table.
Shape read_shape(const TomlReader& body, const SearchFolders& folders);

/// `[[body.component]]` of the body's table: shapes placed in the body's frame or on one another, as one
/// shape of convex pieces.
Shape read_components(const TomlReader& body, const SearchFolders& folders);

/// The keys of `part` whose shapes are made by rule.
const std::vector<std::string>& made_shapes();

/// The shape under the key `kind`, one of made_shapes(), of the table `part`.
Shape read_made_shape(const TomlReader& part, const std::string& kind);

/// Every `[[body]]`, into scene.world.bodies and remarks.
void read_bodies(const TomlReader& root, const SearchFolders& folders, Scene& scene);

/// Every `[[field]]`: needs the bodies, which get sample points when there are fields.
void read_fields(const TomlReader& root, const SearchFolders& folders, Scene& scene);

/// [workspace] [coupling] [penalty] [shading] [smoothing] [safety] [budget] and [tool]: needs the bodies,
/// since the device's place in the world is told by where the handle starts.
void read_settings(const TomlReader& root, Scene& scene);

/// [hand]: needs the settings, since the motion is told in the world and played in the device frame.
void read_hand(const TomlReader& root, Scene& scene);

/// Every [[goal]]: needs the bodies.
void read_goals(const TomlReader& root, Scene& scene);

/// The body called by the text under `key`; -1 with an error when there is none.
int body_called(const TomlReader& reader, const char* key, const World& world);

/// Degrees as a file has them, in radians.
inline double radians(double degrees) { return degrees * (kPi / 180.0); }

}  // namespace tactum
