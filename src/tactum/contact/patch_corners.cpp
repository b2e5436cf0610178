#include "tactum/contact/patch_corners.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/collision/face_projection.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {
namespace {

/// A face whose normal makes a smaller cosine with the contact normal (an angle above 84 degrees) is seen as
/// an edge.
constexpr double kSteep = 0.1;

/// The contact plane, in A's frame.
struct ContactPlane {
  Vec3 origin, e1, e2, n;

  ContactPlane(const Vec3& from, const Vec3& normal) noexcept
      : origin(from), e1(any_orthogonal(normal)), e2(normal.cross(e1)), n(normal) {}
  Vec2 flat(const Vec3& p) const noexcept { return {e1.dot(p - origin), e2.dot(p - origin)}; }
  Height height_of(const Vec3& normal, const Vec3& on_plane) const noexcept {
    const double per_up = 1.0 / normal.dot(n);
    return {normal.dot(on_plane - origin) * per_up, Vec2(-normal.dot(e1), -normal.dot(e2)) * per_up};
  }
};

int corner_of(const Polytope& P, const Polytope::Face& face, int i) noexcept {
  return P.face_vertices[face.first + i];
}

/// Cuts out the polygon over which both faces lie. False when there is none.
bool overlap_of_faces(const Polytope& A, const Polytope::Face& on_a, const Polytope& B,
                      const Polytope::Face& on_b, const Pose& X_AB, const ContactPlane& plane,
                      PatchPolygon& polygon) noexcept {
  PatchPolygon window;
  const int stride_a = (on_a.count + kPatchCorners - 1) / kPatchCorners;
  const int stride_b = (on_b.count + kPatchCorners - 1) / kPatchCorners;
  for (int i = on_a.count - 1; i >= 0; i -= stride_a)
    polygon.push_back(plane.flat(A.vertices[corner_of(A, on_a, i)]));
  for (int i = 0; i < on_b.count; i += stride_b)
    window.push_back(plane.flat(X_AB * B.vertices[corner_of(B, on_b, i)]));
  clip_polygon(polygon, window);
  return !polygon.empty();
}

void corners_of_faces(const Polytope& A, int face_a, const Polytope& B, int face_b, const Pose& X_AB,
                      const Manifold& patch, double tolerance, PatchCorners& corners) noexcept {
  const Polytope::Face& on_a = A.faces[face_a];
  const Polytope::Face& on_b = B.faces[face_b];
  const Vec3 origin = A.vertices[corner_of(A, on_a, 0)];
  const ContactPlane plane(origin, patch.normal);
  const Height za = plane.height_of(on_a.normal, origin);
  const Height zb = plane.height_of(rotated(X_AB.R, on_b.normal), X_AB * B.vertices[corner_of(B, on_b, 0)]);
  PatchPolygon polygon;
  if (!overlap_of_faces(A, on_a, B, on_b, X_AB, plane, polygon)) return;
  const Vec2 opening = za.slope - zb.slope;
  const double gap = za.at_origin - zb.at_origin;
  clip_polygon(polygon, opening, tolerance - gap);
  for (const Vec2& x : polygon) {
    const double middle = 0.5 * (za.at_origin + zb.at_origin + (za.slope + zb.slope).dot(x));
    corners.push_back(
        {plane.origin + plane.e1 * x.x() + plane.e2 * x.y() + plane.n * middle, gap + opening.dot(x)});
  }
}

}  // namespace

int reference_face(const Polytope& P, const Feature& f, const Vec3& n) noexcept {
  int best = -1;
  double cosine = -2.0;
  const auto consider = [&](int face) {
    const double along = P.faces[face].normal.dot(n);
    if (along <= cosine) return;
    cosine = along;
    best = face;
  };
  if (f.kind == FeatureKind::kFace) return f.index;
  if (f.kind == FeatureKind::kEdge) {
    consider(P.edges[f.index].left);
    consider(P.edges[f.index].right);
  } else {
    for (const Polytope::Ray& ray : P.rays_at(f.index)) {
      consider(P.edges[ray.edge].left);
      consider(P.edges[ray.edge].right);
    }
  }
  return best;
}

bool patch_corners(const Polytope& A, const Polytope& B, const Pose& X_AB, const Manifold& patch,
                   double distance, double tolerance, PatchCorners& corners) noexcept {
  corners.clear();
  const Vec3 normal_B = rotated_back(X_AB.R, patch.normal);
  const int face_a = reference_face(A, patch.a, -patch.normal);
  const int face_b = reference_face(B, patch.b, normal_B);
  if (-A.faces[face_a].normal.dot(patch.normal) > kSteep && B.faces[face_b].normal.dot(normal_B) > kSteep)
    corners_of_faces(A, face_a, B, face_b, X_AB, patch, tolerance, corners);
  double least = tolerance;
  for (const PatchCorner& corner : corners) least = std::min(least, corner.distance);
  if (!corners.empty() &&
      least <= distance + tolerances::kCertificate * std::max(A.extent.size, B.extent.size))
    return true;
  for (const ContactPoint& point : patch.points)
    corners.push_back({0.5 * (point.p_a + point.p_b), point.distance});
  return false;
}

void CornerMemory::corners_of(const Polytope& A, const Polytope& B, const Pose& X_AB,
                              const ContactPatch& patch, PatchCorners& corners) noexcept {
  const Manifold& manifold = patch.manifold;
  const std::array<int, 4> pair{patch.body_a, patch.body_b, patch.piece_a, patch.piece_b};
  std::size_t hash = 0;
  for (const int number : pair) hash = hash * 31 + static_cast<std::size_t>(number);
  Slot& slot = slots_[hash % slots_.size()];
  if (slot.pair == pair && slot.features.a == manifold.a && slot.features.b == manifold.b &&
      slot.X_AB.R == X_AB.R && slot.X_AB.p == X_AB.p && slot.normal == manifold.normal &&
      slot.distance == patch.distance && slot.tolerance == patch.tolerance) {
    corners.clear();
    for (const PatchCorner& corner : slot.corners) corners.push_back(corner);
    return;
  }
  const bool of_faces = patch_corners(A, B, X_AB, manifold, patch.distance, patch.tolerance, corners);
  if (!of_faces || corners.size() > slot.corners.capacity()) return;
  slot = {pair, {manifold.a, manifold.b}, X_AB, manifold.normal, patch.distance, patch.tolerance, {}};
  for (const PatchCorner& corner : corners) slot.corners.push_back(corner);
}

}  // namespace tactum::inline v0_1
