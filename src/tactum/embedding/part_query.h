#pragma once
/// A part as other programs ask about it: loaded or prepared once, then queried for distance and clearance at
/// any poses. Poses are those of the frame P of the part's mesh, as its file has it; the body's frame, at the
/// centre of mass, is not seen here.
///
/// A part is constant once it is made: any number of threads may query it at once.

#include <memory>
#include <string>
#include <vector>

#include "tactum/mesh/prepare_part.h"
#include "tactum/repair/mesh_interior.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::inline v0_1 {

class QueriedPart {
 public:
  /// A prepared part, or a mesh file, which is then prepared: repaired, cut into pieces and verified. An
  /// error says what is wrong and where. Slow; allocates.
  static Result<std::shared_ptr<const QueriedPart>> load(const std::string& path,
                                                         const PrepareOptions& options = {});
  /// The same of a mesh in memory, whose numbers are metres unless the options say another unit.
  static Result<std::shared_ptr<const QueriedPart>> from_mesh(TriangleMesh mesh,
                                                              const PrepareOptions& options = {});
  explicit QueriedPart(PartFile file);

  const PartFile& file() const noexcept { return file_; }
  /// Its surface in the frame P [m].
  const TriangleMesh& mesh() const noexcept { return mesh_; }
  /// The trees of its triangles, in P.
  const Surface& surface() const noexcept { return surface_; }
  /// The inside of its solids, in P.
  const MeshInterior& interior() const noexcept { return interior_; }

 private:
  PartFile file_;
  TriangleMesh mesh_;
  Surface surface_;
  MeshInterior interior_;
};

/// Where two parts stand to each other, in world axes. The normal points from B to A.
struct PartDistance {
  double distance = 0.0;       ///< [m]
  Vec3 p_a_W = Vec3::Zero();   ///< closest point on A [m]
  Vec3 p_b_W = Vec3::Zero();   ///< closest point on B [m]
  Vec3 n_BA_W = Vec3::Zero();  ///< unit; zero where a clearance is zero, which leaves it open [-]
  int touching_pairs = 0;      ///< of triangles with a common point; only of a clearance
  bool inside = false;         ///< one lies wholly in a solid of the other; only of a clearance
  bool certified = true;       ///< the distance is proved to 1e-9 of the size
};

/// Clearance of the two surfaces, of any shape, open or closed: the exact distance; zero where they touch or
/// cross, and where one lies inside a solid of the other. `cache` makes the next query along a motion cheap
/// and does not change the answer. Cost: 1 to 100 us.
PartDistance clearance(const QueriedPart& a, const Pose& X_WA, const QueriedPart& b, const Pose& X_WB,
                       SurfacePairCache& cache) noexcept;

/// Signed distance of two parts of solid convex pieces: the smallest over all pairs of pieces, negative by
/// the depth of the deepest pair where they overlap. An error where a part is felt by its surface, which has
/// no depth. Cost: 1 us a pair of pieces, much more for pairs that overlap.
Result<PartDistance> signed_distance(const QueriedPart& a, const Pose& X_WA, const QueriedPart& b,
                                     const Pose& X_WB);

/// An error that says that the pose `name` is none: not finite, or its matrix no rotation to six decimals.
Result<void> check_pose(const Pose& X, const char* name);

}  // namespace tactum::inline v0_1
