#include "tactum/response/contact_force.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using Facet = ContactRows::Facet;

auto key(const Facet& f) { return std::tie(f.body_a, f.body_b, f.group_a, f.group_b, f.patch); }

bool same_facet(const Facet& a, const Facet& b) {
  return std::tie(a.body_a, a.body_b, a.group_a, a.group_b) ==
         std::tie(b.body_a, b.body_b, b.group_a, b.group_b);
}

/// The poses of the bodies of a facet, which the next facet has too as a rule.
struct BodyPoses {
  int a, b;
  Pose X_WA, X_AB, X_BA;
  BodyPoses(std::span<const Pose> X_WB, const Facet& facet) noexcept
      : a(facet.body_a),
        b(facet.body_b),
        X_WA(X_WB[Index(a)]),
        X_AB(relative_pose(X_WA, X_WB[Index(b)])),
        X_BA(X_AB.inverse()) {}
  bool are_of(const Facet& facet) const noexcept { return facet.body_a == a && facet.body_b == b; }
};

/// The points of a run of patches on one facet, weighted by area.
void gather_points(const ContactSource& from, const BodyPoses& poses, std::span<const Facet> facet,
                   std::vector<FacetPoint>& points) {
  points.clear();
  double weights = 0.0;
  for (const Facet& f : facet) weights += patch_weight(from.patches[Index(f.patch)].manifold);
  for (const Facet& f : facet) {
    const ContactPatch& patch = from.patches[Index(f.patch)];
    const double share = patch_weight(patch.manifold) / weights;
    std::array<Vec3, Manifold::kMostPoints> normals_A;
    const Index count = patch.manifold.points.size();
    if (from.shading.empty())
      std::fill_n(normals_A.begin(), count, patch.manifold.normal);
    else
      shaded_normals(from.shading[Index(patch.body_a)], from.shading[Index(patch.body_b)], poses.X_AB,
                     poses.X_BA, patch, {normals_A.data(), count});
    const double scale = from.depth_scale.empty() ? 1.0 : from.depth_scale[Index(f.patch)];
    for (Index i = 0; i < count; ++i) {
      const ContactPoint& point = patch.manifold.points[i];
      points.push_back({poses.X_WA * (0.5 * (point.p_a + point.p_b)), rotated(poses.X_WA.R, normals_A[i]),
                        point.distance < 0.0 ? scale * point.distance : point.distance,
                        share * point.weight});
    }
  }
}

/// Four points with the mean, the second moments and the linear gap of many: mean +- sqrt(2 l) e for the two
/// principal axes e of the spread in the facet's plane, l its variance along e.
void reduce_to_four(std::vector<FacetPoint>& points) {
  Vec3 mean = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double gap = 0.0;
  for (const FacetPoint& point : points) {
    mean += point.weight * point.p_W;
    normal += point.weight * point.n_BA_W;
    gap += point.weight * point.distance;
  }
  normal.normalize();
  const Vec3 u = any_orthogonal(normal);
  const Vec3 v = normal.cross(u);
  double uu = 0.0, uv = 0.0, vv = 0.0, ud = 0.0, vd = 0.0;
  for (const FacetPoint& point : points) {
    const double x = u.dot(point.p_W - mean);
    const double y = v.dot(point.p_W - mean);
    uu += point.weight * x * x;
    uv += point.weight * x * y;
    vv += point.weight * y * y;
    ud += point.weight * x * (point.distance - gap);
    vd += point.weight * y * (point.distance - gap);
  }
  const double angle = 0.5 * std::atan2(2.0 * uv, uu - vv);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double variance[2] = {c * c * uu + 2.0 * c * s * uv + s * s * vv,
                              s * s * uu - 2.0 * c * s * uv + c * c * vv};
  const double slope[2] = {c * ud + s * vd,
                           c * vd - s * ud};  // of the gap along each axis, times the variance
  const Vec3 axis[2] = {c * u + s * v, c * v - s * u};
  points.clear();
  for (int i = 0; i < 2; ++i) {
    const double spread = std::sqrt(2.0 * std::max(variance[i], 0.0));
    const double rise = variance[i] > tolerances::kPointArea_m2 ? slope[i] / variance[i] * spread : 0.0;
    points.push_back({mean + spread * axis[i], normal, gap + rise, 0.25});
    points.push_back({mean - spread * axis[i], normal, gap - rise, 0.25});
  }
}

}  // namespace

void make_contact_rows(const ContactSource& from, double stiffness_N_per_m, ContactRows& out) noexcept {
  out.rows.clear();
  out.facets.clear();
  out.full = false;
  for (Index i = 0; i < from.patches.size() && i < out.facets.capacity(); ++i) {
    const ContactPatch& patch = from.patches[i];
    if (!from.of_bodies.empty() && !from.of_bodies[Index(patch.body_a)] &&
        !from.of_bodies[Index(patch.body_b)])
      continue;
    out.facets.push_back({patch.body_a, patch.body_b, patch.facets.a, patch.facets.b, static_cast<int>(i)});
  }
  std::sort(out.facets.begin(), out.facets.end(),
            [](const Facet& a, const Facet& b) { return key(a) < key(b); });

  if (out.facets.empty()) return;
  BodyPoses poses(from.X_WB, out.facets.front());
  for (auto first = out.facets.begin(); first != out.facets.end();) {
    const auto last =
        std::find_if(first, out.facets.end(), [&](const Facet& f) { return !same_facet(f, *first); });
    if (!poses.are_of(*first)) poses = BodyPoses(from.X_WB, *first);
    gather_points(from, poses, {first, last}, out.points);
    if (out.points.size() > 4) reduce_to_four(out.points);
    const double tolerance = from.patches[Index(first->patch)].tolerance;
    for (const FacetPoint& point : out.points) {
      if (out.rows.size() == out.rows.capacity()) {
        out.full = true;
        return;
      }
      ContactRow& row = out.rows.emplace_back();
      row.body_a = first->body_a;
      row.body_b = first->body_b;
      row.patch = first->patch;
      row.n_BA_W = point.n_BA_W;
      row.p_W = point.p_W;
      row.distance = point.distance;
      row.margin = tolerance;
      row.stiffness = stiffness_N_per_m * point.weight;
    }
    first = last;
  }
}

void append_friction(const FrictionPatch& patch, int number, const Vec3& force_W, double h,
                     std::vector<ContactRow>& rows) noexcept {
  const double size_N = force_W.norm();
  if (rows.size() == rows.capacity() || !(size_N > 0.0)) return;
  ContactRow& row = rows.emplace_back();
  static_cast<SurfacePair&>(row) = patch.surfaces;
  row.patch = patch.source_patch;
  row.friction_patch = number;
  row.p_W = patch.place.centre_W;
  row.n_BA_W = force_W / size_N;
  row.distance = patch.place.gap_m;
  row.impulse = size_N * h;
}

Wrench contact_wrench(std::span<const ContactRow> rows, int body, const Vec3& p_WB, double h) noexcept {
  Wrench sum;
  if (h <= 0.0) return sum;
  for (const ContactRow& row : rows) {
    if ((row.body_a != body && row.body_b != body) || row.impulse == 0.0) continue;
    const Vec3 force = (row.body_a == body ? row.impulse : -row.impulse) / h * row.n_BA_W;
    sum.f += force;
    sum.t += (row.p_W - p_WB).cross(force);
  }
  return sum;
}

}  // namespace tactum::inline v0_1
