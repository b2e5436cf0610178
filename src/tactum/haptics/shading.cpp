#include "tactum/haptics/shading.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// Wachspress' product form needs n^2 products; faces with more corners are flat ends, not parts of curved
/// surfaces.
constexpr int kMostCorners = 16;

/// The interpolated normal inside a convex polygon: w_i = A(i-1,i,i+1) prod_{j != i-1,i} A(j,j+1,p).
Vec3 interpolated(const Polytope& piece, const Polytope::Face& face, const Vec3* normals, const Vec3& point) {
  const int n = face.count;
  double area[kMostCorners];
  const auto corner = [&](int i) -> const Vec3& {
    return piece.vertices[Index(piece.face_vertices[Index(face.first + (i + n) % n)])];
  };
  for (int i = 0; i < n; ++i)
    area[i] = std::max(0.0, face.normal.dot((corner(i) - point).cross(corner(i + 1) - point)));
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < n; ++i) {
    double weight = face.normal.dot((corner(i) - corner(i - 1)).cross(corner(i + 1) - corner(i)));
    for (int j = 0; j < n; ++j)
      if (j != i && j != (i + n - 1) % n) weight *= area[j];
    sum += weight * normals[i];
  }
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : face.normal;
}

}  // namespace

ShadingNormals::ShadingNormals(const Part& part, double crease_rad) : part_(&part) {
  const double cosine = std::cos(crease_rad);
  for (const Polytope& piece : part.pieces) {
    first_slot_.push_back(static_cast<int>(normals_.size()));
    first_face_.push_back(static_cast<int>(curved_face_.size()));
    shade_polytope(piece, cosine);
  }
  if (part.one_sided) shade_surface(part, cosine);
  for (Index p = 0; p < part.pieces.size(); ++p) {
    const Polytope& piece = part.pieces[p];
    for (Index f = 0; f < piece.faces.size(); ++f) {
      const Polytope::Face& face = piece.faces[f];
      const bool curved = std::any_of(&normals_[Index(first_slot_[p] + face.first)],
                                      &normals_[Index(first_slot_[p] + face.first)] + face.count,
                                      [&](const Vec3& normal) { return normal != face.normal; });
      curved_face_[Index(first_face_[p]) + f] = curved && face.count <= kMostCorners;
    }
  }
}

void ShadingNormals::shade_polytope(const Polytope& piece, double cosine) {
  const Index first = normals_.size();
  normals_.resize(first + piece.face_vertices.size());
  curved_face_.resize(curved_face_.size() + piece.faces.size());
  for (const Polytope::Face& face : piece.faces)
    for (int slot = face.first; slot < face.first + face.count; ++slot) {
      Vec3 sum = Vec3::Zero();
      for (const Polytope::Ray& ray : piece.rays_at(piece.face_vertices[Index(slot)])) {
        // Every face around the corner is on the left or the right of two of its edges: counted twice, all
        // alike.
        for (int f : {piece.edges[Index(ray.edge)].left, piece.edges[Index(ray.edge)].right}) {
          const Vec3& normal = piece.faces[Index(f)].normal;
          if (normal.dot(face.normal) >= cosine) sum += normal;
        }
      }
      const bool alone = (sum.normalized() - face.normal).norm() < tolerances::kSameNormal;
      normals_[first + Index(slot)] = alone ? face.normal : Vec3(sum.normalized());
    }
}

/// The pieces of a surface are single triangles: what meets at a corner is known by the mesh alone.
void ShadingNormals::shade_surface(const Part& part, double cosine) {
  std::vector<std::vector<int>> around(part.surface.vertices.size());
  for (Index t = 0; t < part.surface.triangles.size(); ++t)
    for (int v : part.surface.triangles[t]) around[Index(v)].push_back(static_cast<int>(t));
  for (Index t = 0; t < part.pieces.size(); ++t) {
    const Polytope& piece = part.pieces[t];
    const Vec3& own = part.piece_normal[t];
    const Index front = piece.faces[0].normal.dot(own) > 0.0 ? 0 : 1;
    for (int v : part.surface.triangles[t]) {
      Vec3 sum = Vec3::Zero();
      for (int other : around[Index(v)])
        if (part.piece_normal[Index(other)].dot(own) >= cosine) sum += part.piece_normal[Index(other)];
      const Vec3 normal = sum.normalized();
      if ((normal - own).norm() < tolerances::kSameNormal) continue;
      const Polytope::Face& face = piece.faces[front];
      for (int slot = face.first; slot < face.first + face.count; ++slot)
        if (piece.vertices[Index(piece.face_vertices[Index(slot)])] == part.surface.vertices[Index(v)])
          normals_[Index(first_slot_[t] + slot)] = normal;
    }
  }
}

Vec3 ShadingNormals::deviation(int piece, const Feature& feature, const Vec3& point) const noexcept {
  if (feature.kind != FeatureKind::kFace) return Vec3::Zero();
  if (!curved_face_[Index(first_face_[Index(piece)] + feature.index)]) return Vec3::Zero();
  const Polytope& polytope = part_->pieces[Index(piece)];
  const Polytope::Face& face = polytope.faces[Index(feature.index)];
  return interpolated(polytope, face, &normals_[Index(first_slot_[Index(piece)] + face.first)], point) -
         face.normal;
}

Vec3 shaded_normal(const ShadingNormals& a, int piece_a, const ShadingNormals& b, int piece_b,
                   const Pose& X_AB, const Manifold& manifold, const ContactPoint& point) noexcept {
  const Vec3 from_a = a.deviation(piece_a, manifold.a, point.p_a);
  const Vec3 from_b = b.deviation(piece_b, manifold.b, X_AB.inverse() * point.p_b);
  return (manifold.normal + X_AB.R * from_b - from_a).normalized();
}

}  // namespace tactum
