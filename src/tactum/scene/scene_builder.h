#pragma once
/// The steps of build_scene, for src/tactum/scene/*.cpp only. They add to the builder's errors and go on.

#include <optional>
#include <string>
#include <vector>

#include "tactum/math/spatial.h"
#include "tactum/scene/item_errors.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"
#include "tactum/scene/shape.h"

namespace tactum::inline v0_1 {

/// The description and the first of its errors.
class SceneBuilder {
 public:
  explicit SceneBuilder(const SceneDescription& description) : description_(description) {}

  const SceneDescription& description() const { return description_; }
  FirstError& errors() { return errors_; }
  /// An error at an item by its path.
  void fail(const std::string& path, std::string what, std::string found = "", std::string expected = "") {
    errors_.add({std::move(what), std::move(found), std::move(expected), description_.source.where(path)});
  }
  /// The same for an error without a place.
  void fail(const std::string& path, const Error& error) {
    fail(path, error.what, error.found, error.expected);
  }
  /// The name of the table at a path in messages.
  std::string section(const std::string& path) const { return description_.source.section(path); }
  /// The path of a file by its name, absolute or in one of the source's folders; when there is none, an error
  /// at the item, with the folders that were searched.
  std::optional<std::string> find_file(const std::string& path, const char* kind, const std::string& name);
  /// The index of a body by name; -1 and an error at the item when there is none.
  int find_body(const std::string& path, const std::string& name, const World& world);

 private:
  const SceneDescription& description_;
  FirstError errors_;
};

/// The name of a body or component and what it is placed on.
struct Placement {
  std::string name, on;
};

/// The error of an item that is placed on itself, on a later one, or in a circle: each is placed on one
/// before it. `noun` is "body" or "component".
std::optional<Error> order_error(const std::vector<Placement>& items, std::size_t index, const char* noun);

/// The shape of a part whose table is at `path`.
Shape build_shape(SceneBuilder& builder, const std::string& path, const PartDescription& part);

/// The components of a body, as one shape of convex pieces.
Shape build_components(SceneBuilder& builder, const std::string& path, const BodyDescription& body);

/// Bodies, into scene.world.bodies and remarks.
void build_bodies(SceneBuilder& builder, Scene& scene);

/// Fields; bodies without sample points get some when there are fields.
void build_fields(SceneBuilder& builder, Scene& scene);

/// Settings, coefficients of pairs, the grasp and the device's place.
void build_settings(SceneBuilder& builder, Scene& scene);

/// The hand's motion: needs the settings, since it is described in the world and played in the device frame.
void build_hand(SceneBuilder& builder, Scene& scene);

void build_goals(SceneBuilder& builder, Scene& scene);

}  // namespace tactum::inline v0_1
