#include "tactum/haptics/contact_force.h"

#include <algorithm>
#include <tuple>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;
using Facet = ContactRows::Facet;

auto key(const Facet& f) { return std::tie(f.body_a, f.body_b, f.group_a, f.group_b, f.patch); }

bool same_facet(const Facet& a, const Facet& b) {
  return std::tie(a.body_a, a.body_b, a.group_a, a.group_b) == std::tie(b.body_a, b.body_b, b.group_a, b.group_b);
}

/// A patch's claim on its facet's stiffness: its area, or next to nothing for points and segments.
double claim(const ContactPatch& patch) {
  return std::max(patch.manifold.area, tolerances::kPointArea_m2);
}

}  // namespace

void make_contact_rows(const World& world, std::span<const Pose> X_WB, std::span<const ContactPatch> patches,
                       const std::vector<ShadingNormals>& shading, double stiffness_N_per_m,
                       ContactRows& out) noexcept {
  out.rows.clear();
  out.facets.clear();
  out.full = false;
  for (Index i = 0; i < patches.size() && i < out.facets.capacity(); ++i) {
    const ContactPatch& patch = patches[i];
    out.facets.push_back({patch.body_a, patch.body_b,
                          world.bodies[Index(patch.body_a)].part->surface_group[Index(patch.piece_a)],
                          world.bodies[Index(patch.body_b)].part->surface_group[Index(patch.piece_b)],
                          static_cast<int>(i)});
  }
  std::sort(out.facets.begin(), out.facets.end(), [](const Facet& a, const Facet& b) { return key(a) < key(b); });

  for (auto first = out.facets.begin(); first != out.facets.end();) {
    const auto last = std::find_if(first, out.facets.end(), [&](const Facet& f) { return !same_facet(f, *first); });
    double claims = 0.0;
    for (auto f = first; f != last; ++f) claims += claim(patches[Index(f->patch)]);
    for (; first != last; ++first) {
      const ContactPatch& patch = patches[Index(first->patch)];
      const Pose& X_WA = X_WB[Index(patch.body_a)];
      const double share = stiffness_N_per_m * claim(patch) / claims;
      for (const ContactPoint& point : patch.manifold.points) {
        if (out.rows.size() == out.rows.capacity()) {
          out.full = true;
          return;
        }
        Vec3 normal_A = patch.manifold.normal;
        if (!shading.empty()) {
          normal_A = shaded_normal(shading[Index(patch.body_a)], patch.piece_a, shading[Index(patch.body_b)],
                                   patch.piece_b, relative_pose(X_WA, X_WB[Index(patch.body_b)]), patch.manifold, point);
        }
        ContactRow& row = out.rows.emplace_back();
        row.body_a = patch.body_a;
        row.body_b = patch.body_b;
        row.n_BA_W = X_WA.R * normal_A;
        row.p_W = X_WA * (0.5 * (point.p_a + point.p_b));
        row.distance = point.distance;
        row.tolerance = patch.tolerance;
        row.stiffness = share * point.weight;
      }
    }
  }
}

Wrench contact_wrench(std::span<const ContactRow> rows, int body, const Vec3& p_WB, double h) noexcept {
  Wrench sum;
  if (h <= 0.0) return sum;
  for (const ContactRow& row : rows) {
    if (row.body_a != body && row.body_b != body) continue;
    const Vec3 force = (row.body_a == body ? row.impulse : -row.impulse) / h * row.n_BA_W;
    sum.f += force;
    sum.t += (row.p_W - p_WB).cross(force);
  }
  return sum;
}

}  // namespace tactum
