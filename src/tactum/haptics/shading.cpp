#include "tactum/haptics/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// Faces with more corners are flat ends, not parts of curved surfaces.
constexpr int kMostCorners = 16;

/// A corner's part of its Wachspress weight that does not depend on the point: A(i-1,i,i+1).
double corner_area(const Polytope& piece, const Polytope::Face& face, int i) {
  const auto corner = [&](int k) -> const Vec3& {
    return piece.vertices[Index(piece.face_vertices[Index(face.first + (k + face.count) % face.count)])];
  };
  return face.normal.dot((corner(i) - corner(i - 1)).cross(corner(i + 1) - corner(i)));
}

/// The interpolated normal inside a convex polygon: w_i = A(i-1,i,i+1) prod_{j != i-1,i} A(j,j+1,p), the
/// product as that of all before times that of all behind.
Vec3 interpolated(const Polytope& piece, const Polytope::Face& face, const ShadedCorner* corners,
                  const Vec3& point) {
  const int n = face.count;
  const int* vertex = &piece.face_vertices[Index(face.first)];
  double area[kMostCorners];
  Vec3 from_point = piece.vertices[Index(vertex[0])] - point;
  const Vec3 first = from_point;
  for (int i = 0; i < n; ++i) {
    const Vec3 next = i + 1 < n ? Vec3(piece.vertices[Index(vertex[i + 1])] - point) : first;
    area[i] = std::max(0.0, face.normal.dot(from_point.cross(next)));
    from_point = next;
  }
  double behind[kMostCorners + 1];  // area[i] area[i + 1] ... area[n - 1]
  behind[n] = 1.0;
  for (int i = n; i-- > 0;) behind[i] = behind[i + 1] * area[i];
  // The last side meets the first corner: area[n - 1] is left out there.
  double without_last = 1.0;
  for (int i = 1; i + 1 < n; ++i) without_last *= area[i];
  Vec3 sum = corners[0].area * without_last * corners[0].normal;
  double before = 1.0;  // area[0] ... area[i - 2]
  for (int i = 1; i < n; ++i) {
    sum += corners[i].area * before * behind[i + 1] * corners[i].normal;
    before *= area[i - 1];
  }
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length) : face.normal;
}

}  // namespace

ShadingNormals::ShadingNormals(const Part& part, double crease_rad) : part_(&part) {
  const double cosine = std::cos(crease_rad);
  for (const Polytope& piece : part.pieces) {
    first_slot_.push_back(static_cast<int>(corners_.size()));
    first_face_.push_back(static_cast<int>(curved_face_.size()));
    shade_polytope(piece, cosine);
  }
  shade_surface(cosine);
  if (!part.true_surface.alone()) shade_over_seams(part, cosine);
  for (Index p = 0; p < part.pieces.size(); ++p) {
    const Polytope& piece = part.pieces[p];
    for (Index f = 0; f < piece.faces.size(); ++f) {
      const Polytope::Face& face = piece.faces[f];
      const ShadedCorner* corners = &corners_[Index(first_slot_[p] + face.first)];
      const bool curved = std::any_of(corners, corners + face.count, [&](const ShadedCorner& corner) {
        return corner.normal != face.normal;
      });
      curved_face_[Index(first_face_[p]) + f] = curved && face.count <= kMostCorners;
    }
  }
}

void ShadingNormals::shade_polytope(const Polytope& piece, double cosine) {
  const Index first = corners_.size();
  corners_.resize(first + piece.face_vertices.size());
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
      corners_[first + Index(slot)] = {alone ? face.normal : Vec3(sum.normalized()),
                                       corner_area(piece, face, slot - face.first)};
    }
}

/// True faces around a corner, of the piece and of those that touch it there, each true face once.
void ShadingNormals::shade_over_seams(const Part& part, double cosine) {
  const TrueSurface& surface = part.true_surface;
  const double noise = tolerances::kCoplanarMeshOffset * part.size;
  std::vector<std::pair<int, Vec3>> around;  // group and normal
  const auto gather = [&](int piece, const Vec3& corner) {
    const Polytope& P = part.pieces[Index(piece)];
    for (int f = 0; f < P.counts[2]; ++f) {
      const int group = surface.group_of(piece, 2, f);
      const Polytope::Face& face = P.faces[Index(f)];
      if (group < 0 || std::abs(face.normal.dot(corner) - face.offset) > noise) continue;
      const bool known =
          std::any_of(around.begin(), around.end(), [&](const auto& one) { return one.first == group; });
      if (!known) around.emplace_back(group, face.normal);
    }
  };
  for (Index p = 0; p < part.pieces.size(); ++p) {
    const Polytope& piece = part.pieces[p];
    for (int v = 0; v < piece.counts[0]; ++v) {
      around.clear();
      gather(static_cast<int>(p), piece.vertices[Index(v)]);
      for (int neighbour : surface.neighbours(surface.number(static_cast<int>(p), 0, v)))
        gather(neighbour, piece.vertices[Index(v)]);
      for (const Polytope::Face& face : piece.faces)
        for (int slot = face.first; slot < face.first + face.count; ++slot) {
          if (piece.face_vertices[Index(slot)] != v) continue;
          Vec3 sum = Vec3::Zero();
          for (const auto& [group, normal] : around)
            if (normal.dot(face.normal) >= cosine) sum += normal;
          const bool alone = (sum.normalized() - face.normal).norm() < tolerances::kSameNormal;
          corners_[Index(first_slot_[p] + slot)].normal = alone ? face.normal : Vec3(sum.normalized());
        }
    }
  }
}

void ShadingNormals::shade_surface(double cosine) {
  const TriangleMesh& mesh = part_->surface;
  std::vector<Vec3> own(mesh.triangles.size());
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    own[t] = triangle_normal(mesh, t);
    for (int v : mesh.triangles[t]) around[Index(v)].push_back(static_cast<int>(t));
  }
  triangle_normals_.resize(mesh.triangles.size());
  for (Index t = 0; t < mesh.triangles.size(); ++t)
    for (Index k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (int other : around[Index(mesh.triangles[t][k])])
        if (own[Index(other)].dot(own[t]) >= cosine) sum += own[Index(other)];
      const Vec3 mean = sum.normalized();
      triangle_normals_[t][k] = (mean - own[t]).norm() < tolerances::kSameNormal ? own[t] : mean;
    }
}

Vec3 ShadingNormals::deviation(int piece, const Feature& feature, const Vec3& point) const noexcept {
  if (feature.kind != FeatureKind::kFace) return Vec3::Zero();
  if (!curved_face_[Index(first_face_[Index(piece)] + feature.index)]) return Vec3::Zero();
  const Polytope& polytope = part_->pieces[Index(piece)];
  const Polytope::Face& face = polytope.faces[Index(feature.index)];
  return interpolated(polytope, face, &corners_[Index(first_slot_[Index(piece)] + face.first)], point) -
         face.normal;
}

/// Barycentric coordinates weigh the corners of a triangle.
Vec3 ShadingNormals::deviation_on_surface(const Feature& feature, const Vec3& point) const noexcept {
  if (feature.kind != FeatureKind::kFace) return Vec3::Zero();
  const Index t = Index(feature.index);
  const TriangleMesh& mesh = part_->surface;
  const Vec3 own = triangle_normal(mesh, t);
  Vec3 sum = Vec3::Zero();
  for (Index k = 0; k < 3; ++k) {
    const Vec3 from = mesh.vertices[Index(mesh.triangles[t][(k + 1) % 3])] - point;
    const Vec3 to = mesh.vertices[Index(mesh.triangles[t][(k + 2) % 3])] - point;
    sum += std::max(0.0, own.dot(from.cross(to))) * triangle_normals_[t][k];
  }
  const double length = sum.norm();
  return length > 0.0 ? Vec3(sum / length - own) : Vec3::Zero();
}

Vec3 shaded_normal(const ShadingNormals& a, const ShadingNormals& b, const Pose& X_AB, const Pose& X_BA,
                   const ContactPatch& patch, const ContactPoint& point) noexcept {
  const Manifold& manifold = patch.manifold;
  const Vec3 p_b = X_BA * point.p_b;
  const Vec3 from_a = patch.of_surfaces ? a.deviation_on_surface(manifold.a, point.p_a)
                                        : a.deviation(patch.piece_a, manifold.a, point.p_a);
  const Vec3 from_b = patch.of_surfaces ? b.deviation_on_surface(manifold.b, p_b)
                                        : b.deviation(patch.piece_b, manifold.b, p_b);
  return (manifold.normal + rotated(X_AB.R, from_b) - from_a).normalized();
}

}  // namespace tactum
