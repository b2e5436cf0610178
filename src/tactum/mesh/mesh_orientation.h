#pragma once
/// The orientation of the triangles of a mesh, corrected by component.
///
/// A component is a set of triangles connected over edges of two triangles; edges of more separate
/// components, since no two of their triangles are neighbours for sure. Within a component all triangles are
/// made to agree with the first; then the component as a whole is turned or left:
///
///        +-------------+
///        |  +-------+  |     closed:  outward, by the sign of the enclosed volume; inside an odd number of
///        |  | depth |  |              others it is a cavity and faces inward, so that the solid is always
///        |  |   1   |  |              behind the triangles
///        |  +-------+  |     open:    as most of its area faced in the file
///        |   depth 0   |     one-sided bands (Moebius) cannot be set right; they are reported
///        +-------------+
///
/// Whether a point is inside is determined by winding numbers along rays of a tree of boxes
/// (surface_crossings.h). Components that cut through each other are left facing outward, and reported. n log
/// n.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct MeshComponent {
  int first_triangle = 0;   ///< its lowest number
  int triangles = 0;        ///< how many
  bool closed = false;      ///< every edge has an even number of its triangles
  int twisted_edges = 0;    ///< edges where its triangles cannot agree
  int depth = 0;            ///< closed components around it, when closed
  bool cuts_other = false;  ///< it lies partly inside another closed component
  bool turned = false;      ///< as a whole, against most of it in the file (set by repair_mesh)
  double volume = 0.0;      ///< signed, as it faces at last; of closed ones [m^3]
  double area = 0.0;        ///< [m^2]
  Aabb box;                 ///< [m]

  /// Closed but of negligible volume: below tolerances::kNoVolume of its size cubed.
  bool empty_inside() const;
};

struct OrientedMesh {
  std::vector<MeshComponent> components;  ///< in the order of their first triangles
  std::vector<int> component;             ///< of each triangle
  std::vector<int> flipped;               ///< triangles that were turned round
};

/// Turns triangles in place. They must have three different corners each.
OrientedMesh orient_components(TriangleMesh& mesh);

}  // namespace tactum::inline v0_1
