#pragma once
/// The part of the pieces' own surfaces that is the part's true surface. Pieces that share walls have faces,
/// edges and corners that nobody can touch, and true faces that were cut into several:
///
///      ____________            a  the corner is in the middle of a true face: its only normal is up
///     |     a|     |           b  the face is covered by the neighbour: nothing can touch it
///     |     b|     |           c  two faces in one plane: one true face, one group
///     |__c___|__c__|           d  a corner of both
///            d
///
/// The normals with which a union of convex pieces can be touched at a point are those that each piece there
/// allows: the normal cone of a union is the intersection of its pieces' cones. So only the pieces that touch
/// each feature are stored; most features are touched by none, and are true as they are. Pieces may share
/// walls; where they overlap, the part inside another counts as covered.

#include <array>
#include <span>
#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

struct TrueSurface {
  /// Number of the first vertex, edge and face of each piece. Empty when no two pieces touch.
  std::vector<std::array<int, 3>> first;
  /// Per feature: its neighbours are touching[touching_first[f] .. touching_first[f + 1]).
  std::vector<int> touching_first;
  std::vector<int> touching;  ///< pieces
  /// Per feature: of faces in one plane that meet, and of edges in one line that meet, the same number; -1
  /// for faces that are covered wholly, and for vertices.
  std::vector<int> group;
  /// Per group: its features are members[members_first[g] .. members_first[g + 1]), rising.
  std::vector<int> members_first;
  struct Member {
    int piece = -1, index = -1;  ///< the edge or face of that piece
  };
  std::vector<Member> members;
  double exposed_area = 0.0;  ///< of all faces, without covered parts [m^2]

  /// No two pieces touch: every feature is true as it is.
  bool single_piece() const noexcept { return first.empty(); }
  /// The number of a vertex (kind 0), edge (1) or face (2) of a piece.
  int number(int piece, int kind, int index) const noexcept {
    return first[static_cast<std::size_t>(piece)][static_cast<std::size_t>(kind)] + index;
  }
  /// Of a face, -1 when it is wholly covered; of an edge.
  int group_of(int piece, int kind, int index) const noexcept {
    return group[static_cast<std::size_t>(number(piece, kind, index))];
  }
  /// The edges, or faces, that are one.
  std::span<const Member> members_of(int of_group) const noexcept {
    const int begin = members_first[static_cast<std::size_t>(of_group)];
    const int end = members_first[static_cast<std::size_t>(of_group) + 1];
    return {members.data() + begin, static_cast<std::size_t>(end - begin)};
  }
  std::span<const int> neighbours(int feature) const noexcept {
    const int begin = touching_first[static_cast<std::size_t>(feature)];
    const int end = touching_first[static_cast<std::size_t>(feature) + 1];
    return {touching.data() + begin, static_cast<std::size_t>(end - begin)};
  }
};

/// Of solid pieces. `noise` [m]: pieces nearer than that touch. Cost: near pairs times their features and
/// faces.
TrueSurface true_surface(const std::vector<Polytope>& pieces, const Bvh& hierarchy, double noise);

}  // namespace tactum::inline v0_1
