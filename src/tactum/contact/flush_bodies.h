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
#include "tactum/base/reserved_vector.h"
#include "tactum/contact/collision_body.h"
#include "tactum/contact/contact_patch.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The height of a step between two bodies that a part rides over, by the part's size.
inline constexpr double kRiddenStep = 1e-4;  ///< [m/m]

class FlushBodies {
 public:
  FlushBodies(std::size_t bodies, std::size_t most_patches) : of_body_(bodies, 2 * most_patches) {
    planes_.reserve(2 * most_patches);
  }

  /// Marks the implied contacts among `patches` with `ContactPatch::implied` and gives them the normal of the
  /// contact that implies them. Of surfaces a contact is judged by the triangles at its features. Cost:
  /// nothing while only two bodies touch; else, for every body that moves, the number of its patches times
  /// that of those that may imply others: of pieces all, of surfaces one for each two faces, and 16 at most.
  void mark_implied(std::span<const CollisionBody> bodies, std::span<const Pose> X_WB,
                    std::span<ContactPatch> patches) noexcept;

 private:
  /// Lists the patches of a body that may imply others.
  void list_planes(std::span<const int> items, std::span<const ContactPatch> patches) noexcept;

  GroupedIndices of_body_;      // the patches of each body, twice as many as there are
  ReservedVector<int> planes_;  // scratch
};

}  // namespace tactum::inline v0_1
