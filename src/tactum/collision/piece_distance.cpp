#include "tactum/collision/piece_distance.h"

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"

namespace tactum {
namespace {

/// The way out of the surface may be this much longer than the way through it: then a piece is kept out until
/// two thirds of it have passed the surface.
constexpr double kLongestDetour = 2.0;

}  // namespace

PairDistance piece_distance(const Part& part_a, int piece_a, const Part& part_b, int piece_b,
                            const Pose& X_AB, PairCache& cache) noexcept {
  const Polytope& A = part_a.pieces[static_cast<std::size_t>(piece_a)];
  const Polytope& B = part_b.pieces[static_cast<std::size_t>(piece_b)];
  const PairDistance apart = closest_features(A, B, X_AB, cache);
  const bool overlap = apart.distance < -tolerances::kPenetrating * (A.size + B.size);
  if (!overlap || faces_outward(part_a, piece_a, part_b, piece_b, X_AB, apart)) return apart;

  // The shortest way out leads into the solid behind the surface. The shortest way that does not is the
  // answer while it is of the same order; where it is far longer, the contact belongs to a neighbouring piece
  // of the surface (the rim of a hole when its wall is touched), and `apart`, not facing outward, drops it
  // here.
  OneSided sides;
  if (part_a.one_sided) sides.outward_a = part_a.piece_normal[static_cast<std::size_t>(piece_a)];
  if (part_b.one_sided) sides.outward_b = part_b.piece_normal[static_cast<std::size_t>(piece_b)];
  PairDistance outward = penetration_one_sided(A, B, X_AB, sides, cache);
  // What counts is proved by true support planes: moved out by it, the pieces are apart. That no neighbouring
  // axis is shorter, which the certificate of a solid's depth says, need not hold at the border of the
  // allowed axes.
  outward.stop = Stop::kFallback;
  return outward.distance >= kLongestDetour * apart.distance ? outward : apart;
}

bool faces_outward(const Part& part_a, int piece_a, const Part& part_b, int piece_b, const Pose& X_AB,
                   const PairDistance& found) noexcept {
  if (part_a.one_sided &&
      found.normal.dot(part_a.piece_normal[static_cast<std::size_t>(piece_a)]) > tolerances::kOneSidedSine)
    return false;
  return !part_b.one_sided ||
         found.normal.dot(X_AB.R * part_b.piece_normal[static_cast<std::size_t>(piece_b)]) >=
             -tolerances::kOneSidedSine;
}

}  // namespace tactum
