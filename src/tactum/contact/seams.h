#pragma once
/// Seams that cannot be felt. A part of solid pieces that share walls must feel like the part uncut, so the
/// contacts of its pairs of pieces are not taken one by one:
///
///         ___A___              1  |: A's side and the wall between the pieces. No such contact exists on the
///        |       |                   part: at that point the normal is not one that all pieces there allow.
///     ___|_1_____|___             It is *internal*, and its neighbour is its representative.
///    |     |2    |   |         2  both pieces' tops belong to one true face: one contact, of which the
///    |     |     |   |            nearest is the representative; the other is merged with its part of
///    |_____|_____|___|            the face.
///
/// An internal contact without a representative (a part deep in a small piece; a wall touched where it meets
/// the floor) is found again on the true surface by the least depth. Which contacts are true follows from the
/// pieces that touch each feature: geometry/true_surface.h. Features that no other piece touches cost one
/// look-up.

#include <optional>

#include "tactum/collision/contact.h"
#include "tactum/collision/pair_view.h"
#include "tactum/geometry/part.h"

namespace tactum::inline v0_1 {

/// Whether the whole part could be touched at `p` on `feature` of `piece`, or on the piece within `margin`
/// [m] of it, outward along unit `outward`; both in the part's frame. Cost: 2 ns, and 30-60 ns for each piece
/// that touches the feature; with a margin ten times as much where p is covered.
bool allowed_by_neighbours(const Part& part, int piece, const Feature& feature, const Vec3& p,
                           const Vec3& outward, double margin = 0.0) noexcept;

/// Whether the whole parts could touch as two of their pieces do.
bool is_true_contact(const Part& part_a, int piece_a, const Part& part_b, int piece_b, const Pose& X_AB,
                     const PairDistance& found, double margin = 0.0) noexcept;

/// The feature of the whole part in whose middle `p` (part's frame) on `feature` of `piece` lies, by its
/// number on the piece: a corner that cuts made is in the middle of an edge or of a face. Of several faces,
/// as at a corner of a hole, it is the one that faces most along `outward`, the contact's normal (unit,
/// part's frame). Cost: as above, for each edge at it.
Feature true_feature(const Part& part, int piece, const Feature& feature, const Vec3& p,
                     const Vec3& outward) noexcept;

/// The feature of `piece` that is the same as `feature` of `of_piece`: itself, the stretch of the same true
/// face or edge, or the corner at the same place of a piece beside it. Index -1: none.
Feature same_feature(const Part& part, int of_piece, const Feature& feature, int piece) noexcept;

/// The least depth (or distance) on the true surface: along the normal of a true face that has the other
/// piece's deepest point under it, within `margin` [m], since the point may lie in a neighbour, as in the
/// corner of a floor and a wall; or square to two true edges that cross. Where such a place is covered, the
/// exposed one within `beside` [m] counts. Empty when there is none. Of pieces with more than 16384 pairs of
/// true edges only faces are tried. Cost: the faces and pairs of edges, 10 ns each.
std::optional<PairDistance> depth_on_true_surface(const Part& part_a, int piece_a, const Part& part_b,
                                                  int piece_b, const Pose& X_AB, const PairDistance& found,
                                                  double margin, double beside) noexcept;

/// Whether moving A along unit `n` by -`distance` would separate these pieces too: another contact, with this
/// normal and distance, then covers this one.
bool answered_by(const PairView& pair, const PairDistance& found, const Vec3& n, double distance) noexcept;

}  // namespace tactum::inline v0_1
