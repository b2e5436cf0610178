#include "tactum/contact/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/polygon_clip.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Faces with more corners are flat ends, not parts of curved surfaces.
constexpr int kMostCorners = 16;

/// The sum of weighted normals inside a convex polygon: w_i = A(i-1,i,i+1) prod_{j != i-1,i} A(j,j+1,p). The
/// first area is in the corner's weighted normal; the product is that of all before times that of all behind.
inline Vec3 weighted_sum(const ShadedCorner* corners, int n, const Vec3& point) {
  const auto area_beside = [&](int i) {
    return std::max(0.0, corners[i].inward.dot(point) - corners[i].offset);
  };
  // A ruled face, as a swept surface has: see ruled().
  if (n == 2) return area_beside(0) * corners[0].weighted + area_beside(1) * corners[1].weighted;
  if (n == 4) {  // as most faces of a turned surface: the same products, written out
    const double a0 = area_beside(0);
    const double a1 = area_beside(1);
    const double a2 = area_beside(2);
    const double a3 = area_beside(3);
    return a1 * a2 * corners[0].weighted + a2 * a3 * corners[1].weighted + a0 * a3 * corners[2].weighted +
           a0 * a1 * corners[3].weighted;
  }
  double area[kMostCorners];
  for (int i = 0; i < n; ++i) area[i] = area_beside(i);
  double behind[kMostCorners + 1];  // area[i] area[i + 1] ... area[n - 1]
  behind[n] = 1.0;
  for (int i = n; i-- > 0;) behind[i] = behind[i + 1] * area[i];
  // The last side meets the first corner: area[n - 1] is left out there.
  double without_last = 1.0;
  for (int i = 1; i + 1 < n; ++i) without_last *= area[i];
  Vec3 sum = without_last * corners[0].weighted;
  double before = 1.0;  // area[0] ... area[i - 2]
  for (int i = 1; i < n; ++i) {
    sum += before * behind[i + 1] * corners[i].weighted;
    before *= area[i - 1];
  }
  return sum;
}

/// The interpolated normal of a face with corners.
inline Vec3 interpolated(const ShadedFace& face, const ShadedCorner* corners, const Vec3& point) {
  const Vec3 sum = weighted_sum(corners, face.count, point);
  const double length_sq = sum.squaredNorm();
  return length_sq > 0.0 ? Vec3(sum * (1.0 / std::sqrt(length_sq))) : face.normal;
}

/// A corner by its number on one of the pieces that have it.
struct CornerName {
  int piece = -1, vertex = -1;
};

/// Normals of the true faces around corners, each true face once.
class NormalsAround {
 public:
  explicit NormalsAround(const Part& part) : part_(part) {}

  const std::vector<Vec3>& of(const CornerName& corner) {
    known_.clear();
    normals_.clear();
    const Polytope& P = part_.pieces[Index(corner.piece)];
    for (const Polytope::Ray& ray : P.rays_at(corner.vertex))
      for (int face : {P.edges[Index(ray.edge)].left, P.edges[Index(ray.edge)].right})
        add(corner.piece, face);
    const TrueSurface& surface = part_.true_surface;
    if (surface.single_piece()) return normals_;
    const double noise = tolerances::kCoplanarMeshOffset * part_.size;
    const Vec3& p = P.vertices[Index(corner.vertex)];
    for (int neighbour : surface.neighbours(surface.number(corner.piece, 0, corner.vertex))) {
      const Polytope& N = part_.pieces[Index(neighbour)];
      for (int face = 0; face < N.counts[2]; ++face) {
        const Polytope::Face& plane = N.faces[Index(face)];
        if (std::abs(plane.normal.dot(p) - plane.offset) <= noise) add(neighbour, face);
      }
    }
    return normals_;
  }

 private:
  void add(int piece, int face) {
    const TrueSurface& surface = part_.true_surface;
    const int name = surface.single_piece() ? face : surface.group_of(piece, 2, face);
    if (name < 0 || std::find(known_.begin(), known_.end(), name) != known_.end()) return;
    known_.push_back(name);
    normals_.push_back(part_.pieces[Index(piece)].faces[Index(face)].normal);
  }

  const Part& part_;
  std::vector<int> known_;
  std::vector<Vec3> normals_;
};

std::vector<CornerName> corners_of(const Part& part, int piece, int face) {
  const Polytope& P = part.pieces[Index(piece)];
  const Polytope::Face& loop = P.faces[Index(face)];
  std::vector<CornerName> corners;
  for (int slot = loop.first; slot < loop.first + loop.count; ++slot)
    corners.push_back({piece, P.face_vertices[Index(slot)]});
  return corners;
}

const Vec3& place_of(const Part& part, const CornerName& corner) {
  return part.pieces[Index(corner.piece)].vertices[Index(corner.vertex)];
}

/// The corners of faces in one plane as those of one face; none when their union is not convex.
std::vector<CornerName> corners_as_one(const Part& part, const std::vector<std::pair<int, int>>& faces) {
  const auto [first_piece, first_face] = faces.front();
  const Vec3& normal = part.pieces[Index(first_piece)].faces[Index(first_face)].normal;
  std::vector<CornerName> all;
  std::vector<Vec3> cloud;
  double area = 0.0;
  for (const auto& [piece, face] : faces) {
    area += polygon_area(face_corners(part.pieces[Index(piece)], face), normal);
    for (const CornerName& corner : corners_of(part, piece, face)) {
      all.push_back(corner);
      cloud.push_back(place_of(part, corner));
    }
  }
  const Result<Polytope> hull = convex_hull(cloud);
  if (!hull || !hull->flat) return {};
  const std::vector<Vec3> outline = face_corners(*hull, hull->faces[0].normal.dot(normal) > 0.0 ? 0 : 1);
  const double tolerance = tolerances::kCoplanarMeshOffset * part.size * part.size;
  if (polygon_area(outline, normal) > area + tolerance) return {};
  std::vector<CornerName> corners;
  for (const Vec3& p : outline)
    corners.push_back(
        *std::min_element(all.begin(), all.end(), [&](const CornerName& a, const CornerName& b) {
          return (place_of(part, a) - p).squaredNorm() < (place_of(part, b) - p).squaredNorm();
        }));
  return corners;
}

/// In a parallelogram whose opposite sides i and i + 2 have one normal each the areas beside the other two
/// sides add up to the same everywhere: the rest of the sum is linear, a2 n0 + a0 n2. Two corners describe
/// it.
void ruled(const Part& part, const std::vector<CornerName>& names, std::vector<ShadedCorner>& corners) {
  if (corners.size() != 4) return;
  const auto p = [&](Index i) -> const Vec3& { return place_of(part, names[i % 4]); };
  if ((p(0) - p(1) + p(2) - p(3)).norm() > tolerances::kCoplanar * part.size) return;
  const auto normal = [&](Index i) { return corners[i % 4].weighted.normalized(); };
  for (Index i = 0; i < 2; ++i) {
    if ((normal(i) - normal(i + 1)).norm() >= tolerances::kSameNormal ||
        (normal(i + 2) - normal(i + 3)).norm() >= tolerances::kSameNormal)
      continue;
    const ShadedCorner& low = corners[i];
    const ShadedCorner& high = corners[i + 2];
    corners = {{normal(i), high.inward, high.offset}, {normal(i + 2), low.inward, low.offset}};
    return;
  }
}

/// The corners' weights in the shading; none when all have the face's own normal, or the face is a flat end.
std::vector<ShadedCorner> shaded(const Part& part, const std::vector<CornerName>& names, const Vec3& normal,
                                 double cosine, NormalsAround& around) {
  if (names.size() > Index(kMostCorners)) return {};
  std::vector<ShadedCorner> corners;
  bool curved = false;
  for (Index i = 0; i < names.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& other : around.of(names[i]))
      if (other.dot(normal) >= cosine) sum += other;
    const Vec3 mean = sum.normalized();
    const bool own = (mean - normal).norm() < tolerances::kSameNormal;
    curved |= !own;
    const Vec3& p = place_of(part, names[i]);
    const Vec3& last = place_of(part, names[(i + names.size() - 1) % names.size()]);
    const Vec3& next = place_of(part, names[(i + 1) % names.size()]);
    const Vec3 inward = normal.cross(next - p);
    corners.push_back({(own ? normal : mean) * inward.dot(last - p), inward, inward.dot(p)});
  }
  if (!curved) return {};
  ruled(part, names, corners);
  return corners;
}

}  // namespace

ShadingNormals::ShadingNormals(const Part& part, double crease_rad) : part_(&part) {
  const double cosine = std::cos(crease_rad);
  shade_pieces(cosine);
  shade_surface(cosine);
}

void ShadingNormals::shade_pieces(double cosine) {
  const Part& part = *part_;
  NormalsAround around(part);
  const auto add_face = [&](const std::vector<CornerName>& names, const Vec3& normal) {
    const std::vector<ShadedCorner> corners = shaded(part, names, normal, cosine, around);
    faces_.push_back({normal, static_cast<int>(corners_.size()), static_cast<int>(corners.size())});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    return static_cast<int>(faces_.size()) - 1;
  };
  std::map<int, std::vector<std::pair<int, int>>> groups;  // of true faces that were cut
  for (Index p = 0; p < part.pieces.size(); ++p) {
    const int piece = static_cast<int>(p);
    first_face_.push_back(static_cast<int>(face_of_.size()));
    for (int face = 0; face < part.pieces[p].counts[2]; ++face) {
      const bool single_piece = part.true_surface.single_piece();
      const int group = single_piece ? 0 : part.true_surface.group_of(piece, 2, face);
      const bool covered = group < 0;  // by other pieces: nothing there is curved
      face_of_.push_back(add_face(covered ? std::vector<CornerName>{} : corners_of(part, piece, face),
                                  part.pieces[p].faces[Index(face)].normal));
      if (!single_piece && !covered) groups[group].emplace_back(piece, face);
    }
  }
  for (const auto& [group, faces] : groups) {
    if (faces.size() < 2) continue;
    const std::vector<CornerName> names = corners_as_one(part, faces);
    if (names.empty()) continue;
    const auto [first_piece, first_face] = faces.front();
    const int whole = add_face(names, part.pieces[Index(first_piece)].faces[Index(first_face)].normal);
    for (const auto& [piece, face] : faces) face_of_[Index(first_face_[Index(piece)] + face)] = whole;
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
  bool curved = false;
  for (Index t = 0; t < mesh.triangles.size(); ++t)
    for (Index k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (int other : around[Index(mesh.triangles[t][k])])
        if (own[Index(other)].dot(own[t]) >= cosine) sum += own[Index(other)];
      const Vec3 mean = sum.normalized();
      const bool same = (mean - own[t]).norm() < tolerances::kSameNormal;
      triangle_normals_[t][k] = same ? own[t] : mean;
      curved |= !same;
    }
  if (!curved) triangle_normals_.clear();
}

const ShadedFace* ShadingNormals::bent_face(int piece, const Feature& feature) const noexcept {
  if (feature.kind != FeatureKind::kFace) return nullptr;
  const ShadedFace& face = faces_[Index(face_of_[Index(first_face_[Index(piece)] + feature.index)])];
  return face.count > 0 ? &face : nullptr;
}

Vec3 ShadingNormals::deviation(const ShadedFace& face, const Vec3& point) const noexcept {
  return interpolated(face, &corners_[Index(face.first)], point) - face.normal;
}

Vec3 ShadingNormals::deviation(int piece, const Feature& feature, const Vec3& point) const noexcept {
  const ShadedFace* face = bent_face(piece, feature);
  return face != nullptr ? deviation(*face, point) : Vec3::Zero();
}

/// Barycentric coordinates weigh the corners of a triangle.
Vec3 ShadingNormals::deviation_on_surface(const Feature& feature, const Vec3& point) const noexcept {
  if (feature.kind != FeatureKind::kFace || triangle_normals_.empty()) return Vec3::Zero();
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

void shaded_normals(const ShadingNormals& a, const ShadingNormals& b, const Pose& X_AB, const Pose& X_BA,
                    const ContactPatch& patch, std::span<Vec3> normals) noexcept {
  const Manifold& manifold = patch.manifold;
  const bool on_pieces = !patch.of_surfaces;
  const ShadedFace* bent_a = on_pieces ? a.bent_face(patch.piece_a, manifold.a) : nullptr;
  const ShadedFace* bent_b = on_pieces ? b.bent_face(patch.piece_b, manifold.b) : nullptr;
  for (Index i = 0; i < std::min(normals.size(), manifold.points.size()); ++i) {
    const ContactPoint& point = manifold.points[i];
    Vec3 normal = manifold.normal;
    if (bent_b != nullptr) normal += rotated(X_AB.R, b.deviation(*bent_b, X_BA * point.p_b));
    if (bent_a != nullptr) normal -= a.deviation(*bent_a, point.p_a);
    if (patch.of_surfaces)
      normal += rotated(X_AB.R, b.deviation_on_surface(manifold.b, X_BA * point.p_b)) -
                a.deviation_on_surface(manifold.a, point.p_a);
    const double length_sq = normal.squaredNorm();
    normals[i] = length_sq > 0.0 ? Vec3(normal * (1.0 / std::sqrt(length_sq))) : manifold.normal;
  }
}

}  // namespace tactum::inline v0_1
