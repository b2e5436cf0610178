#include "tactum/collision/manifold.h"

#include <array>

#include "tactum/base/tolerances.h"
#include "tactum/collision/patch_work.h"

namespace tactum::inline v0_1 {
namespace {

using detail::PatchWork;

using Handler = void (*)(const PatchWork&) noexcept;

/// The six combinations (nine with A and B exchanged), by the kinds of A's and B's feature.
constexpr std::array<std::array<Handler, 3>, 3> kHandlers = {{
    // B: vertex       edge               face
    {detail::point_contact, detail::point_contact, detail::point_contact},      // A: vertex
    {detail::point_contact, detail::edge_edge_contact, detail::edge_a_face_b},  // A: edge
    {detail::point_contact, detail::face_a_edge_b, detail::face_face_contact},  // A: face
}};

void make_patch(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                double tolerance, double angle, std::span<const Stretch> others, Manifold& out) noexcept {
  out.points.clear();
  out.area = 0.0;
  out.normal = closest.normal;
  out.a = closest.a;
  out.b = closest.b;
  if (!(closest.distance < tolerance) || !(closest.normal.squaredNorm() > 0.0) || closest.a.index < 0 ||
      closest.b.index < 0)
    return;
  const PatchWork work(A, B, X_AB, closest, tolerance, angle, others, out);
  out.a = work.a.feature;
  out.b = work.b.feature;
  kHandlers[static_cast<std::size_t>(out.a.kind)][static_cast<std::size_t>(out.b.kind)](work);
}

}  // namespace

void contact_manifold_within(const Polytope& A, const Polytope& B, const Pose& X_AB,
                             const PairDistance& closest, double tolerance, double angle,
                             Manifold& out) noexcept {
  make_patch(A, B, X_AB, closest, tolerance, angle, {}, out);
}

void contact_manifold(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                      double tolerance, Manifold& out) noexcept {
  make_patch(A, B, X_AB, closest, tolerance, tolerances::kPatchAngle, {}, out);
}

void contact_manifold_over(const Polytope& A, const Polytope& B, const Pose& X_AB,
                           const PairDistance& closest, double tolerance, std::span<const Stretch> others,
                           Manifold& out) noexcept {
  make_patch(A, B, X_AB, closest, tolerance, tolerances::kPatchAngle, others, out);
}

}  // namespace tactum::inline v0_1
