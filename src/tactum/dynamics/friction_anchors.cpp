#include "tactum/dynamics/friction_anchors.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Patches of one plane have normals at no larger angle than the largest turn of a body in a step, and a bit
/// more.
constexpr double kSameDirection = 0.998;  // cosine

auto key(const SurfacePair& pair) { return std::tuple(pair.body_a, pair.body_b, pair.group_a, pair.group_b); }

}  // namespace

const FrictionAnchor* FrictionAnchors::find(const SurfacePair& surfaces) const noexcept {
  const auto found = std::lower_bound(
      last_.begin(), last_.end(), surfaces,
      [](const FrictionAnchor& anchor, const SurfacePair& pair) { return key(anchor.surfaces) < key(pair); });
  return found != last_.end() && found->surfaces == surfaces ? &*found : nullptr;
}

const FrictionAnchor* FrictionAnchors::find(const FrictionPatch& patch, std::span<const Pose> X_WB,
                                            double same_plane_m) const noexcept {
  if (const FrictionAnchor* const same = find(patch.surfaces)) return same;
  const FrictionAnchor* nearest = nullptr;
  double most_alike = kSameDirection;
  const int body_a = patch.surfaces.fixed_a ? -1 : patch.surfaces.body_a;  // -1: any that is fixed
  auto anchor = std::lower_bound(last_.begin(), last_.end(), body_a,
                                 [](const FrictionAnchor& a, int body) { return a.surfaces.body_a < body; });
  for (; anchor != last_.end() && (body_a < 0 || anchor->surfaces.body_a == body_a); ++anchor) {
    if (!same_bodies(anchor->surfaces, patch.surfaces)) continue;
    const Pose& X_WA = X_WB[Index(anchor->surfaces.body_a)];
    const double alike = patch.place.n_BA_W.dot(X_WA.R * anchor->n_A);
    const double off_plane = patch.place.n_BA_W.dot(X_WA * anchor->centre_A - patch.place.centre_W);
    if (!(alike > most_alike) || std::abs(off_plane) > same_plane_m) continue;
    most_alike = alike;
    nearest = &*anchor;
  }
  return nearest;
}

void FrictionAnchors::sort_and_exchange() noexcept {
  // No stable sort, because that allocates: the index decides between equal keys.
  order_.clear();
  for (Index i = 0; i < now_.size(); ++i) order_.push_back(static_cast<int>(i));
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const auto key_a = key(now_[Index(a)].surfaces);
    const auto key_b = key(now_[Index(b)].surfaces);
    return key_a != key_b ? key_a < key_b : a < b;
  });
  last_.clear();
  for (const int i : order_) {
    if (!last_.empty() && last_.back().surfaces == now_[Index(i)].surfaces) last_.pop_back();
    last_.push_back(now_[Index(i)]);
  }
  now_.clear();
}

}  // namespace tactum::inline v0_1
