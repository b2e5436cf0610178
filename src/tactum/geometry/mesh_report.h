#pragma once
/// Properties of a mesh: closed or not, manifold, oriented, in how many pieces, how large, convex. Determined
/// for the mesh as welded at tolerances::kWeld; triangles that two equal corners make none are counted and
/// left out, triangles without area are counted and kept (their sides close the surface).

#include <string>
#include <vector>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// The unit a file seems to be in. Files seldom give it, so this is a guess with its reason.
struct UnitGuess {
  std::string name;              ///< "metres", "millimetres", "inches"
  double metres_per_unit = 1.0;  ///< [m]
  std::string reason;            ///< a sentence
  bool certain = true;           ///< false when another unit is nearly as likely
};

struct MeshReport {
  int vertices = 0;             ///< after welding, of triangles
  int triangles = 0;            ///< as given
  int duplicate_triangles = 0;  ///< same three corners as an earlier one
  int components = 0;           ///< sets of triangles joined by vertices
  int boundary_edges = 0;       ///< edges with one triangle
  int non_manifold_edges = 0;   ///< edges with more than two
  int misoriented_edges = 0;    ///< edges whose two triangles run the same way along it
  int convex_edges = 0;         ///< of two triangles: bent outward by more than kCoplanarMeshSine
  int reflex_edges = 0;         ///< ... bent inward by more than that; the rest is flat
  int euler = 0;                ///< V - E + F; 2 for each component without handles
  bool closed = false;          ///< every edge has exactly two triangles
  bool oriented = false;        ///< no misoriented edge
  bool balanced = false;  ///< at every edge as many triangles run one way as the other: they bound a volume
  bool convex = false;    ///< closed, one component, Euler 2, every edge convex to tolerances::kConvexMesh
  double volume = 0.0;    ///< by the divergence theorem; negative when the normals point inward [m^3]
  double area = 0.0;      ///< [m^2]
  Aabb box;               ///< [m]

  // Numbers of triangles, as given:
  std::vector<int> index_degenerate;  ///< two corners at one place
  std::vector<int> zero_area;         ///< three corners on a line
  int first_boundary = -1;            ///< a triangle at a boundary edge
  int first_non_manifold = -1;        ///< a triangle at a non-manifold edge

  bool manifold() const { return non_manifold_edges == 0; }
};

/// Vertices within `tolerance` (as a fraction of the diagonal) count as one; 0 joins only equal coordinates,
/// as strict programs do.
MeshReport report_mesh(const TriangleMesh& mesh, double tolerance = tolerances::kWeld);

/// The unit of a mesh whose bounding box is in the units of its file.
UnitGuess guess_unit(const Aabb& box);

/// The report as lines of text, lengths in metres.
std::string describe(const MeshReport& report);

}  // namespace tactum::inline v0_1
