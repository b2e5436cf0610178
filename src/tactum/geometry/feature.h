#pragma once
/// The features of a shape: vertex, edge, face.

#include <cstdint>

namespace tactum::inline v0_1 {

enum class FeatureKind : std::uint8_t { kVertex, kEdge, kFace };

/// A vertex, edge or face of a polytope, or of a surface (surface_tree.h), by its index.
struct Feature {
  FeatureKind kind = FeatureKind::kVertex;
  int index = -1;  ///< -1: none yet
  bool operator==(const Feature&) const = default;
};

}  // namespace tactum::inline v0_1
