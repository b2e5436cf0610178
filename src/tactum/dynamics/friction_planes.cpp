#include "tactum/dynamics/friction_planes.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The normals of one plane differ by no more than this: facets of a curved surface differ by more.
constexpr double kSameNormal_rad = 0.001;
/// Points of one plane are no farther off it than so many skins.
constexpr double kSamePlaneSkins = 20.0;

/// The body by which planes are listed: one that moves.
int lister(const SurfacePair& pair) { return pair.fixed_a ? pair.body_b : pair.body_a; }

bool same_plane(const ContactRow& row, const ContactRow& first) {
  if (!same_bodies(row, first) || row.friction != first.friction) return false;
  if (row.surfaces() == first.surfaces()) return true;
  return (row.n_BA_W - first.n_BA_W).norm() <= kSameNormal_rad &&
         std::abs(first.n_BA_W.dot(row.p_W - first.p_W)) <= kSamePlaneSkins * first.skin_m;
}

}  // namespace

FrictionPlanes::FrictionPlanes(std::size_t bodies, std::size_t most_rows) : first_of_body_(bodies, -1) {
  planes_.reserve(most_rows);
}

void FrictionPlanes::find(std::span<ContactRow> rows) noexcept {
  planes_.clear();
  for (Index r = 0; r < rows.size(); ++r) {
    ContactRow& row = rows[r];
    if (!(row.friction > 0.0)) continue;
    int& first = first_of_body_[Index(lister(row))];
    int plane = first;
    while (plane >= 0 && !same_plane(row, rows[Index(planes_[Index(plane)].row)]))
      plane = planes_[Index(plane)].next;
    if (plane < 0) {
      plane = static_cast<int>(planes_.size());
      planes_.push_back({static_cast<int>(r), first});
      first = plane;
    }
    row.plane = rows[Index(planes_[Index(plane)].row)].surfaces();
  }
  for (const Plane& plane : planes_) first_of_body_[Index(lister(rows[Index(plane.row)]))] = -1;
}

}  // namespace tactum::inline v0_1
