#include <fmt/format.h>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/geometry/hull.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

using Pieces = std::vector<Polytope>;

/// One component, in the body's frame P.
struct Component {
  std::string name;
  Pose X_PC;
  Pieces pieces;
  TriangleMesh surface;  ///< of one that has no convex pieces
};

/// The piece in the frame that `X` is stated in: the hull of the corners that have moved.
Result<Polytope> moved(const Polytope& piece, const Pose& X) {
  std::vector<Vec3> points = piece.vertices;
  for (Vec3& point : points) point = X * point;
  return convex_hull(points);
}

/// The convex pieces of a shape, or its surface, in the frame that `X` is stated in.
Result<void> place(const Shape& shape, const Pose& X, Component& component) {
  Pieces pieces = shape.pieces;
  Pose X_own = X;
  if (pieces.empty()) {
    const Result<std::shared_ptr<const Part>> part = part_of(shape, 1.0);
    if (!part) return part.error();
    X_own = X * Pose{Mat3::Identity(), (*part)->origin};
    pieces = (*part)->pieces;
    if ((*part)->is_surface()) component.surface = (*part)->surface;
  }
  for (Vec3& vertex : component.surface.vertices) vertex = X_own * vertex;
  for (const Polytope& piece : pieces) {
    Result<Polytope> placed = moved(piece, X_own);
    if (!placed) return placed.error();
    component.pieces.push_back(std::move(*placed));
  }
  return {};
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
  if (const Result<void> placed = place(shape, component.X_PC, component); !placed)
    builder.fail(part, placed.error());
  return component;
}

std::string called(const Component& component, std::size_t index) {
  return component.name.empty() ? fmt::format("component {}", index + 1)
                                : fmt::format("\"{}\"", component.name);
}

/// Whether mass and inertia follow from the components, so that material in two of them would count twice.
bool weighs_components(const BodyDescription& body) {
  const bool fixed = std::holds_alternative<FixedJoint>(body.joint) && parent_of(body.joint).parent.empty();
  return !body.mass.inertial && !fixed;
}

/// Refuses a component that is inside one before it, or that has no convex pieces.
void check_component(SceneBuilder& builder, const std::string& path, const Component& component,
                     const std::vector<Component>& before) {
  if (component.pieces.empty())
    return builder.fail(path, "a component that is felt by its surface, in a body whose mass follows from it",
                        called(component, before.size()),
                        "convex pieces: a shape made of them, or a mesh with pieces = \"solid\" or "
                        "\"given\"; or the key inertial");
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double depth = overlap(component, before[i]);
    if (depth <= tolerances::kPenetrating * (size_of(component) + size_of(before[i]))) continue;
    return builder.fail(path, "two components of one body overlap",
                        fmt::format("{} and {} are {:.6g} m inside each other", called(before[i], i),
                                    called(component, before.size()), depth),
                        "components that touch or stand apart, since what is in both would weigh twice; or "
                        "the key inertial");
  }
}

void append(const TriangleMesh& more, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Triangle& t : more.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// All convex pieces as one shape; where a component has none, the triangles of all.
Shape joined(const std::vector<Component>& components) {
  Shape shape;
  bool surface = false;
  for (const Component& component : components) {
    surface = surface || component.pieces.empty();
    shape.pieces.insert(shape.pieces.end(), component.pieces.begin(), component.pieces.end());
  }
  if (!surface) return shape;
  TriangleMesh& mesh = shape.mesh.mesh;
  for (const Component& component : components) append(component.surface, mesh);
  for (const Polytope& piece : shape.pieces)
    if (const Result<Part> solid = part_from_clouds({piece.vertices})) append(solid->surface, mesh);
  shape.pieces.clear();
  shape.piece_source = PieceSource::kSurface;
  return shape;
}

}  // namespace

Shape build_components(SceneBuilder& builder, const std::string& path, const BodyDescription& body) {
  std::vector<Component> components;
  std::vector<Placement> placements;
  for (const ComponentDescription& component : body.components)
    placements.push_back({component.name, component.on});
  for (const ComponentDescription& description : body.components) {
    const std::string item = item_path(path, "component", components.size());
    if (const auto fault = order_error(placements, components.size(), "component")) {
      builder.fail(item_path(item, "on"), *fault);
      return {};
    }
    Component component = build_component(builder, item, description, components);
    if (builder.errors()) return {};
    if (weighs_components(body)) check_component(builder, item_path(item, "part"), component, components);
    if (builder.errors()) return {};
    components.push_back(std::move(component));
  }
  return joined(components);
}

}  // namespace tactum::inline v0_1
