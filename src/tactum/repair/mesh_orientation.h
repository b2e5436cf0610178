#pragma once
/// The orientation of the triangles of a mesh, corrected by component.
///
/// A component is a set of triangles connected over edges of two triangles; within it all triangles are made
/// to agree with the first. Edges of more separate components, since no two of their triangles are neighbours
/// for sure; but components that are open there and close together, with an even number of triangles at every
/// edge, count as one. Their orientation is the file's where it bounds a volume, else each faces away from
/// the points around which a ray crosses an odd number of its triangles. Then the component as a whole is
/// turned or left:
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
/// (surface_crossings.h), of at most seven points for each component whose box cuts another's: a ray costs
/// as many boxes as it passes, which is n where long triangles lie across all axes about one place. All else
/// costs n log n. Components that cut through each other are left facing outward, and reported. The result
/// does not depend on the number of threads.

#include "tactum/geometry/triangle_mesh.h"
#include "tactum/repair/mesh_components.h"

namespace tactum::inline v0_1 {

/// Turns triangles in place. They must have three different corners each.
OrientedMesh orient_components(TriangleMesh& mesh, int threads = 1);

}  // namespace tactum::inline v0_1
