#pragma once
/// The components of a mesh: sets of triangles that hang together over their edges (mesh_orientation.h).

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

}  // namespace tactum::inline v0_1
