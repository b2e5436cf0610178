#pragma once
/// A mesh made fit to be a part, with a report of every change.
///
///   weld           vertices in one place become one; triangles with two equal corners go       (weld.h)
///   duplicates     a triangle that stands twice once, the wall between two solids not at all
///                                                                                     (repeated_triangles.h)
///   inner walls    that a solid has between its rooms go                                   (inner_walls.h)
///   caps           a triangle without area gives its middle corner to the neighbour:
///
///             c                      c            T = a b c has no height. Its neighbour N = b a d is cut
///        a---------b   ->       a----*----b       at c: nothing moves, no edge is left with a corner in
///          \  N  /                \  |  /         its middle.
///             d                      d
///
///   orientation    outward by component, cavities inward                                (mesh_orientation.h)
///   cracks         closed; holes only when asked, up to a number of edges                   (hole_filling.h)
///
/// No vertex is ever moved, so the surface stays the file's to the last bit except for removed parts, which
/// lie on the rest to kWeld and kDegenerateTriangle of its size. Deterministic; the cost is that of
/// its steps.

#include <string>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/repair/mesh_orientation.h"

namespace tactum::inline v0_1 {

struct RepairOptions {
  int close_holes = 0;  ///< holes of at most this many edges are closed; 0: none
  int threads = 1;      ///< the result does not depend on it
};

/// One kind of finding: how often, and where the first one is.
struct RepairNote {
  std::string kind;           ///< a key: "duplicate_triangles"
  std::string text;           ///< a clause behind the count: "triangles stood twice and were dropped"
  int count = 0;              ///< how many
  int triangle = -1;          ///< number in the mesh given of the first; -1: none
  Vec3 place = Vec3::Zero();  ///< of the first [m]
  bool mended = false;        ///< the mesh that comes out no longer has it

  /// "COUNT TEXT (triangle N at X Y Z)".
  std::string sentence() const;
};

struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<int> source;                ///< number in the mesh given of each triangle; -1: closes a hole
  std::vector<MeshComponent> components;  ///< as they stand after repair
  std::vector<int> component;             ///< of each triangle
  std::vector<int> walls;         ///< triangles of the mesh given that were walls inside a solid, and went
  std::vector<RepairNote> notes;  ///< kinds that occurred, only
};

/// The mesh without vertices that no triangle uses; the others keep their order. Linear.
TriangleMesh with_used_vertices(TriangleMesh mesh);

RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace tactum::inline v0_1
