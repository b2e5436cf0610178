/// What the contact finder answers about motions (gap_oracle.h).

#include "tactum/collision/penetration.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/contact/seams.h"

namespace tactum {
namespace {

using Index = std::size_t;

}  // namespace

double ContactFinder::depth_along(int patch, std::span<const Pose> X_WB, const Vec3& direction_W) noexcept {
  const ContactPatch& at = patches_[Index(patch)];
  if (at.of_surfaces || tests_left_ <= 0) return 0.0;
  --tests_left_;
  const Part& part_a = *bodies_[Index(at.body_a)].part;
  const Part& part_b = *bodies_[Index(at.body_b)].part;
  const Pose& X_WA = X_WB[Index(at.body_a)];
  const Pose X_AB = relative_pose(X_WA, X_WB[Index(at.body_b)]);
  const Vec3 direction = rotated_back(X_WA.R, direction_W);
  const PairDistance exit = tactum::depth_along(part_a.pieces[Index(at.piece_a)],
                                                part_b.pieces[Index(at.piece_b)], X_AB, direction);
  if (!exit.certified()) return 0.0;
  if (is_true_contact(part_a, at.piece_a, part_b, at.piece_b, X_AB, exit)) return -exit.distance;
  const double across = at.manifold.normal.dot(direction);
  return across > 0.0 ? -at.distance / across : 0.0;
}

}  // namespace tactum
