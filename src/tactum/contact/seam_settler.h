#pragma once
/// Which answers of pairs of pieces are contacts of the whole parts, where parts have seams? The rules are in
/// seams.h; a response that takes forces over areas asks for settle_seams(), one that takes a closest point
/// of each pair for settle_closest_points().
///
/// settle_seams() makes contact patches of the answers:
///
///   for each two bodies, nearest first:  a true contact is a representative. Every other pair with a
///                                        stretch of the same true faces (or edges) is merged: its
///                                        stretch goes into the patch of the first, which is then that
///                                        of the uncut part (manifold.h).
///   then internal contacts:              dropped when they are apart or a representative covers
///                                        them; else they become representatives by the least depth
///                                        on the true surface, or in a corner by that beside it, or
///                                        as they were found.
///
/// The memory of the last frame's contact goes from the representative to all contacts merged with it or
/// covered by it, so that a contact slides over a seam without a step. Cost: that of the patches, and a
/// look-up for each representative and pair.

#include <cstdint>
#include <span>
#include <vector>

#include "tactum/contact/contact_patch.h"
#include "tactum/contact/steady_contact.h"
#include "tactum/geometry/part.h"

namespace tactum::inline v0_1 {

/// A pair within its margin, as tested.
struct SeamCandidate {
  /// One of the two pieces.
  struct Side {
    std::int32_t body = -1;
    std::int32_t piece = -1;     ///< within the part
    const Part* part = nullptr;  ///< of the body

    const Polytope& polytope() const noexcept { return part->pieces[static_cast<std::size_t>(piece)]; }
  };
  Side a, b;
  int pair = -1;                         ///< in the finder's list
  SteadyContact* shown = nullptr;        ///< the pair's memory
  const SteadyLimits* limits = nullptr;  ///< how far it may move; the same for all pairs of two bodies
  double margin = 0.0;                   ///< tolerance of the pair [m]
  PairDistance found;
  PairDistance on_pieces;  ///< of an internal contact that was found again: the first answer
  bool internal = false;
  bool settled = false;
  int patch = -1;   ///< of a representative; of a closest point, its own
  int led_by = -1;  ///< the patch of the representative it was merged with
};

/// Appends the patches of `candidates`, which are marked as settled, and their order is changed. False when
/// `patches` is full.
bool settle_seams(std::span<SeamCandidate*> candidates, std::span<const Pose> X_WB,
                  std::vector<ContactPatch>& patches) noexcept;

/// Settles the internal contacts among `patches` that have one closest point each; `candidates` are those
/// contacts. The representative of one is the patch of the same two bodies that is nearer and whose normal
/// parts these two pieces as well. With a representative the patch loses its point and takes the
/// representative's normal; what counts of it is its stretch of the same true faces, or, where the
/// representative touches with an edge or corner, of the reference face there. Where there is no such stretch
/// the patch keeps no features, and only its distance is watched. Without a representative, as in the corner
/// of two walls, the patch is a contact of its own. Cost: the candidates times the patches, 20 ns each.
void settle_closest_points(std::span<const SeamCandidate> candidates, std::span<const Pose> X_WB,
                           std::span<ContactPatch> patches) noexcept;

}  // namespace tactum::inline v0_1
