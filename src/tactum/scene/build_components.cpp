#include <fmt/format.h>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/geometry/hull.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

using Pieces = std::vector<Polytope>;

/// One component, its pieces in the body's frame P.
struct Component {
  std::string name;
  Pose X_PC;
  Pieces pieces;
};

/// The piece in the frame that `X` is stated in: the hull of the corners that have moved.
Result<Polytope> moved(const Polytope& piece, const Pose& X) {
  std::vector<Vec3> points = piece.vertices;
  for (Vec3& point : points) point = X * point;
  return convex_hull(points);
}

/// The convex pieces of a shape in its own frame.
Result<Pieces> pieces_of(const Shape& shape) {
  if (!shape.pieces.empty()) return shape.pieces;
  const Result<std::shared_ptr<const Part>> part = part_of(shape, 1.0);
  if (!part) return part.error();
  if ((*part)->is_surface())
    return Error{"a component that is felt by its surface", (*part)->notes.pieces,
                 "convex pieces: a shape made of them, or a mesh with pieces = \"solid\" or \"given\"", ""};
  Pieces pieces;
  for (const Polytope& piece : (*part)->pieces) {
    Result<Polytope> back = moved(piece, {Mat3::Identity(), (*part)->origin});
    if (!back) return back.error();
    pieces.push_back(std::move(*back));
  }
  return pieces;
}

/// The penetration depth of two components [m]: that of the deepest pair of pieces.
double overlap(const Component& x, const Component& y) {
  double deepest = 0.0;
  for (const Polytope& a : x.pieces) {
    for (const Polytope& b : y.pieces) {
      PairCache cache{};
      deepest = std::max(deepest, -closest_features(a, b, Pose{}, cache).distance);
    }
  }
  return deepest;
}

double size_of(const Component& component) {
  Aabb box;
  for (const Polytope& piece : component.pieces)
    for (const Vec3& vertex : piece.vertices) box.extend(vertex);
  return box.diagonal();
}

/// The frame that a component's pose is described in.
Pose parent_frame(SceneBuilder& builder, const std::string& path, const std::string& name,
                  const std::vector<Component>& before) {
  if (name.empty()) return Pose{};
  std::vector<std::string> names;
  for (const Component& component : before) {
    if (component.name == name) return component.X_PC;
    names.push_back(component.name);
  }
  const std::string nearest = nearest_word(name, names);
  builder.fail(item_path(path, "on"), "no earlier component of this name, in " + builder.section(path),
               fmt::format("\"{}\"", name),
               nearest.empty() ? "the name of a component before this one" : fmt::format("\"{}\"", nearest));
  return Pose{};
}

Component build_component(SceneBuilder& builder, const std::string& path,
                          const ComponentDescription& description, const std::vector<Component>& before) {
  Component component;
  component.name = description.name;
  for (const Component& other : before)
    if (!component.name.empty() && other.name == component.name)
      builder.fail(item_path(path, "name"), "two components of one name",
                   fmt::format("\"{}\"", component.name), "a name of its own");
  component.X_PC = parent_frame(builder, path, description.on, before) * description.X_OC;
  const std::string part = item_path(path, "part");
  const Shape shape = build_shape(builder, part, *description.part);
  if (builder.errors()) return component;
  const Result<Pieces> pieces = pieces_of(shape);
  if (!pieces) {
    builder.fail(part, pieces.error());
    return component;
  }
  for (const Polytope& piece : *pieces) {
    Result<Polytope> placed = moved(piece, component.X_PC);
    if (!placed) {
      builder.fail(part, placed.error().message());
      return component;
    }
    component.pieces.push_back(std::move(*placed));
  }
  return component;
}

std::string called(const Component& component, std::size_t index) {
  return component.name.empty() ? fmt::format("component {}", index + 1)
                                : fmt::format("\"{}\"", component.name);
}

}  // namespace

Shape build_components(SceneBuilder& builder, const std::string& path, const BodyDescription& body) {
  Shape shape;
  std::vector<Component> components;
  std::vector<Placement> placements;
  for (const ComponentDescription& component : body.components)
    placements.push_back({component.name, component.on});
  for (const ComponentDescription& description : body.components) {
    const std::string item = item_path(path, "component", components.size());
    if (const auto fault = order_error(placements, components.size(), "component")) {
      builder.fail(item_path(item, "on"), *fault);
      return shape;
    }
    Component component = build_component(builder, item, description, components);
    if (builder.errors()) return shape;
    for (std::size_t i = 0; i < components.size(); ++i) {
      const double depth = overlap(component, components[i]);
      if (depth <= tolerances::kPenetrating * (size_of(component) + size_of(components[i]))) continue;
      builder.fail(item_path(item, "part"), "two components of one body overlap",
                   fmt::format("{} and {} are {:.6g} m inside each other", called(components[i], i),
                               called(component, components.size()), depth),
                   "components that touch or stand apart: what is in both would weigh twice");
      return shape;
    }
    shape.pieces.insert(shape.pieces.end(), component.pieces.begin(), component.pieces.end());
    components.push_back(std::move(component));
  }
  return shape;
}

}  // namespace tactum::inline v0_1
