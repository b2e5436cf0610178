#include <fmt/format.h>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/geometry/hull.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

using Pieces = std::vector<Polytope>;

/// One `[[body.component]]`, its pieces in the body's frame P.
struct Component {
  std::string name;
  Pose X_PC;
  Pieces pieces;
};

/// Seen from `X`; the hull of the corners that have moved.
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

/// How far two components are inside each other [m]: the deepest pair of pieces.
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

/// The frame that a component's pose is told in.
Pose parent_frame(const TomlReader& reader, const std::vector<Component>& before) {
  if (!reader.has("on")) return Pose{};
  const std::string name = reader.text("on");
  std::vector<std::string> names;
  for (const Component& component : before) {
    if (!component.name.empty() && component.name == name) return component.X_PC;
    names.push_back(component.name);
  }
  const std::string nearest = nearest_word(name, names);
  reader.fail("on", "no earlier component of this name, in " + reader.section(), fmt::format("\"{}\"", name),
              nearest.empty() ? "the name of a component before this one" : fmt::format("\"{}\"", nearest));
  return Pose{};
}

Component read_component(const TomlReader& reader, const SearchFolders& folders,
                         const std::vector<Component>& before) {
  Component component;
  component.name = reader.text("name", "");
  for (const Component& other : before)
    if (!component.name.empty() && other.name == component.name)
      reader.fail("name", "two components of one name", fmt::format("\"{}\"", component.name),
                  "a name of its own");
  component.X_PC =
      parent_frame(reader, before) * Pose{reader.rotation(), reader.vector3("pos_m", Vec3::Zero())};
  const Shape shape = read_shape(reader, folders);
  if (reader.errors()) return component;
  const Result<Pieces> pieces = pieces_of(shape);
  if (!pieces) {
    reader.fail("part", pieces.error().what, pieces.error().found, pieces.error().expected);
    return component;
  }
  for (const Polytope& piece : *pieces) {
    Result<Polytope> placed = moved(piece, component.X_PC);
    if (!placed) {
      reader.fail("part", placed.error().message());
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

Shape read_components(const TomlReader& body, const SearchFolders& folders) {
  Shape shape;
  if (body.has("part")) {
    body.fail("part", "two ways to make " + body.section(), "part and component", "one of them");
    return shape;
  }
  std::vector<Component> components;
  for (const TomlReader& reader :
       body.tables("component", {"name", "part", "on", "pos_m", "quat_wxyz", "rpy_deg"})) {
    Component component = read_component(reader, folders, components);
    if (body.errors()) return shape;
    for (std::size_t i = 0; i < components.size(); ++i) {
      const double depth = overlap(component, components[i]);
      if (depth <= tolerances::kPenetrating * (size_of(component) + size_of(components[i]))) continue;
      reader.fail("part", "two components of one body overlap",
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

}  // namespace tactum
