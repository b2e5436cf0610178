#pragma once
/// Flush bodies: a part that slides over bodies that lie side by side, as over boards, feels one floor.
///
///         ___S___ ->           S rests on B; that contact, R, has the plane of B's top. The nearest points
///        |       |             of S and C are on edges, and the normal there points sideways: as a contact
///     ___|___R___|P____        of its own, P would stop S at the seam.
///    |     B     |  C  |
///
/// P is *implied* by R when the plane of R has all of C's piece on B's side and all of S's piece on the other
/// one: as long as R keeps S on its side, S does not meet C. C may stand out of the plane by a small step,
/// which S rides over. Within one body, whose pieces share walls, seams.h has the rule.
///
/// An implied contact has no force of its own. Where a patch is one closest point it stays in the list, with
/// the normal of R and the points at which S would meet a step, so that a response can move S over the step
/// when its motion would meet it; where a patch is an area it is removed.

#include <span>

#include "tactum/base/grouped_indices.h"
#include "tactum/contact/collision_body.h"
#include "tactum/contact/contact_patch.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The height of a step between two bodies that a part rides over, by the part's size.
inline constexpr double kRiddenStep = 1e-4;  ///< [m/m]

class FlushBodies {
 public:
  FlushBodies(std::size_t bodies, std::size_t most_patches) : of_body_(bodies, 2 * most_patches) {}

  /// Marks the implied contacts among `patches` with `ContactPatch::implied` and gives them the normal of the
  /// contact that implies them. Surfaces without pieces are left as they are. Cost: nothing while only two
  /// bodies touch; else, for every body that moves, the square of the number of its patches.
  void mark_implied(std::span<const CollisionBody> bodies, std::span<const Pose> X_WB,
                    std::span<ContactPatch> patches) noexcept;

 private:
  GroupedIndices of_body_;  // the patches of each body, twice as many as there are
};

}  // namespace tactum::inline v0_1
