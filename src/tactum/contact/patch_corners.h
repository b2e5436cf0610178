#pragma once
/// Every corner of a contact patch, each with its gap, for a response in which nothing may penetrate.
///
///        A  /.........../        seen along the normal, A's face and B's face overlap in a polygon; the gap
///    ------c-----------c---      between them is linear over it, so that no point of the polygon comes
///    B     `-----------'         nearer than its corners do
///
/// The four weighted points of a manifold (manifold.h) carry a force as well as the whole area does, but lie
/// inside it: with gaps kept open there, the corners overlap. Here the polygon is cut only where the gap
/// exceeds the tolerance, never by how the faces lean. An edge or vertex that touches is replaced by its
/// reference face. Where no face is nearly square to the normal there are only the manifold's own points.
///
/// Cost: 0.1 us for boxes.

#include <vector>

#include "tactum/collision/planar_patch.h"
#include "tactum/contact/contact_patch.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

struct PatchCorner {
  Vec3 p_A = Vec3::Zero();  ///< halfway between the two surfaces, A's frame [m]
  double distance = 0.0;    ///< across the patch's normal [m]
};

using PatchCorners = StaticVector<PatchCorner, PatchPolygon::capacity() + 4>;

/// The reference face at feature `f`: the one whose normal is nearest to `n` (unit, P's frame). Its corners
/// count.
int reference_face(const Polytope& P, const Feature& f, const Vec3& n) noexcept;

/// The corners of `patch`, found at distance `distance` [m], whose gap is at most `tolerance` [m]. Where none
/// of them has as small a gap as `distance`, the manifold's own points are added, and the answer is false: so
/// the least gap is among them, unless the manifold has no points.
bool patch_corners(const Polytope& A, const Polytope& B, const Pose& X_AB, const Manifold& patch,
                   double distance, double tolerance, PatchCorners& corners) noexcept;

/// A cache of the corners of patches whose pieces lie as they lay at the last query, so that bodies at rest
/// cost a comparison. A pair has one slot, which it may share with other pairs; allocated at load time.
class CornerMemory {
 public:
  explicit CornerMemory(std::size_t slots) : slots_(slots) {}
  void corners_of(const Polytope& A, const Polytope& B, const Pose& X_AB, const ContactPatch& patch,
                  PatchCorners& corners) noexcept;

 private:
  /// The corners of one patch, with everything that they were computed from. A patch of more corners than
  /// there is room for is not stored.
  struct Slot {
    std::array<int, 4> pair{-1, -1, -1, -1};
    FeaturePair features;
    Pose X_AB;
    Vec3 normal = Vec3::Zero();
    double distance = 0.0, tolerance = 0.0;
    StaticVector<PatchCorner, 8> corners;
  };
  std::vector<Slot> slots_;
};

}  // namespace tactum::inline v0_1
