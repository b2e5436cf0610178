#include "tactum/mesh/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactum/base/parallel.h"
#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

/// The nearest point of a segment, squared distance from p.
double to_segment_sq(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double length_sq = along.squaredNorm();
  const double t = length_sq > 0.0 ? std::clamp(along.dot(p - a) / length_sq, 0.0, 1.0) : 0.0;
  return (p - (a + t * along)).squaredNorm();
}

double area_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
}

/// The samples of a mesh.
class Samples {
 public:
  Samples(const TriangleMesh& mesh, int area_samples)
      : mesh_(mesh), area_samples_(area_samples), first_at_(mesh.vertices.size(), -1) {
    for (int i = 0; i < static_cast<int>(mesh.triangles.size()); ++i) {
      area_ += area_of(mesh, mesh.triangles[i]);
      for (int corner : mesh.triangles[i])
        if (first_at_[corner] < 0) first_at_[corner] = i;
    }
  }

  /// Calls visit(point) for every sample on the triangle; a corner belongs to the first that has it.
  template <class Visitor>
  void on(int triangle, Visitor&& visit) const {
    constexpr int kFinest = 64;  // rows of the grid on one triangle
    const Triangle& t = mesh_.triangles[triangle];
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3& from = mesh_.vertices[t[corner]];
      visit(Vec3(0.5 * (from + mesh_.vertices[t[(corner + 1) % 3]])));
      if (first_at_[t[corner]] == triangle) visit(from);
    }
    const double share = area_ > 0.0 ? area_of(mesh_, t) / area_ : 0.0;
    const int rows = std::clamp(static_cast<int>(std::ceil(std::sqrt(area_samples_ * share))), 1, kFinest);
    for (int u = 0; u < rows; ++u) {
      for (int v = 0; u + v < rows; ++v) {  // centres of the upright cells: one row, the centre
        const double a = (u + 1.0 / 3.0) / rows;
        const double b = (v + 1.0 / 3.0) / rows;
        visit(
            Vec3((1.0 - a - b) * mesh_.vertices[t[0]] + a * mesh_.vertices[t[1]] + b * mesh_.vertices[t[2]]));
      }
    }
  }

 private:
  const TriangleMesh& mesh_;
  int area_samples_;
  double area_ = 0.0;          ///< [m^2]
  std::vector<int> first_at_;  ///< of each vertex, the first triangle
};

/// The sample that is farthest from the other surface, of some samples.
struct Farthest {
  double distance = 0.0;  ///< [m]
  Vec3 place = Vec3::Zero();
  int samples = 0;
  int inner = 0;  ///< that are on cuts, and do not count
};

/// The farthest of the samples of `from` that count; on_cut(triangle, point, distance) tells those that do
/// not, and is asked for such only as would be farther than all before them in their range.
template <class OnCut>
Farthest farthest_sample(const TriangleMesh& from, const TriangleMesh& to, int area_samples, int threads,
                         OnCut&& on_cut) {
  constexpr std::size_t kTrianglesAtOnce = 1024;
  const Samples samples(from, area_samples);
  const NearestOnMesh surface(to, threads);
  std::vector<Farthest> ranges((from.triangles.size() + kTrianglesAtOnce - 1) / kTrianglesAtOnce);
  for_ranges(threads, from.triangles.size(), kTrianglesAtOnce, [&](std::size_t first, std::size_t last) {
    Farthest found;
    int nearest = 0;
    for (std::size_t t = first; t < last; ++t) {
      samples.on(static_cast<int>(t), [&](const Vec3& point) {
        ++found.samples;
        const double distance = surface.distance(point, nearest, found.distance);
        if (distance <= found.distance) return;
        if (on_cut(static_cast<int>(t), point, distance)) {
          ++found.inner;
          return;
        }
        found.distance = distance;
        found.place = point;
      });
    }
    ranges[first / kTrianglesAtOnce] = found;
  });
  Farthest all;
  for (const Farthest& range : ranges) {
    all.samples += range.samples;
    all.inner += range.inner;
    if (range.distance <= all.distance) continue;
    all.distance = range.distance;
    all.place = range.place;
  }
  return all;
}

/// Whether the point lies on or in a solid piece other than `own`.
bool in_other_piece(const Part& part, int own, const Vec3& point, double tolerance) {
  const std::vector<Bvh::Node>& nodes = part.hierarchy.nodes();
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const int at = stack.back();
    stack.pop_back();
    const Bvh::Node& node = nodes[at];
    if (((point - node.center).cwiseAbs() - node.half).maxCoeff() > tolerance) continue;
    if (!node.leaf()) {
      stack.push_back(node.second);
      stack.push_back(at + 1);
      continue;
    }
    for (int i = node.second; i < node.second + node.count; ++i) {
      const int other = part.hierarchy.order()[i];
      const Polytope& piece = part.pieces[other];
      if (other == own || piece.flat) continue;
      const auto below = [&](const Polytope::Face& face) {
        return face.normal.dot(point) <= face.offset + tolerance;
      };
      if (std::all_of(piece.faces.begin(), piece.faces.end(), below)) return true;
    }
  }
  return false;
}

}  // namespace

NearestOnMesh::NearestOnMesh(const TriangleMesh& mesh, int threads) : mesh_(mesh) {
  std::vector<Aabb> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (int corner : mesh.triangles[t]) boxes[t].extend(mesh.vertices[corner]);
  if (!boxes.empty()) tree_ = Bvh(boxes, 2, threads);
}

double NearestOnMesh::to_triangle_sq(int triangle, const Vec3& point) const {
  const Triangle& t = mesh_.triangles[triangle];
  const std::array<Vec3, 3> p = {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]};
  const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  bool above = !normal.isZero(0.0);
  for (int i = 0; i < 3; ++i) above = above && normal.cross(p[(i + 1) % 3] - p[i]).dot(point - p[i]) >= 0.0;
  if (above) {
    const double height = normal.dot(point - p[0]) / normal.norm();
    return height * height;
  }
  double best = to_segment_sq(p[0], p[1], point);
  best = std::min(best, to_segment_sq(p[1], p[2], point));
  return std::min(best, to_segment_sq(p[2], p[0], point));
}

double NearestOnMesh::distance(const Vec3& point, int& nearest, double near_enough) const {
  if (tree_.empty()) return 1e300;
  const double enough_sq = near_enough * near_enough;
  double best = to_triangle_sq(nearest, point);
  // Points that follow a surface go from one triangle to the next of the file.
  if (const int following = nearest + 1;
      best > enough_sq && following < static_cast<int>(mesh_.triangles.size())) {
    if (const double found = to_triangle_sq(following, point); found < best) {
      best = found;
      nearest = following;
    }
  }
  const auto box_sq = [&](int node) {
    const Bvh::Node& box = tree_.nodes()[node];
    return ((point - box.center).cwiseAbs() - box.half).cwiseMax(0.0).squaredNorm();
  };
  std::array<int, 2 * Bvh::kMaxDepth> stack{};
  int size = 0;
  stack[size++] = 0;
  while (size > 0 && best > enough_sq) {
    const int at = stack[--size];
    if (box_sq(at) >= best) continue;
    const Bvh::Node& node = tree_.nodes()[at];
    if (!node.leaf()) {
      const bool second_nearer = box_sq(node.second) < box_sq(at + 1);
      stack[size++] = second_nearer ? at + 1 : node.second;
      stack[size++] = second_nearer ? node.second : at + 1;
      continue;
    }
    for (int i = node.second; i < node.second + node.count; ++i) {
      const int triangle = tree_.order()[i];
      const double found = to_triangle_sq(triangle, point);
      if (found >= best) continue;
      best = found;
      nearest = triangle;
    }
  }
  return std::sqrt(best);
}

TriangleMesh faces_of(const Part& part, const Vec3& origin, std::vector<int>& piece) {
  TriangleMesh faces;
  piece.clear();
  if (part.pieces.empty()) {
    faces = part.surface;
    piece.assign(faces.triangles.size(), 0);
  }
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& of = part.pieces[i];
    const int base = static_cast<int>(faces.vertices.size());
    faces.vertices.insert(faces.vertices.end(), of.vertices.begin(), of.vertices.end());
    for (const Polytope::Face& face : of.faces) {
      const int* loop = of.face_vertices.data() + face.first;
      for (int k = 1; k + 1 < face.count; ++k) {
        faces.triangles.push_back({base + loop[0], base + loop[k], base + loop[k + 1]});
        piece.push_back(static_cast<int>(i));
      }
      if (of.flat) break;  // its back is the same polygon
    }
  }
  for (Vec3& vertex : faces.vertices) vertex += origin;
  return faces;
}

Deviation surface_deviation(const TriangleMesh& mesh, const Part& part, const Vec3& origin, int area_samples,
                            int threads) {
  Deviation out;
  Aabb box;
  for (const Triangle& t : mesh.triangles)
    for (int corner : t) box.extend(mesh.vertices[corner]);
  out.size = box.diagonal();
  std::vector<int> piece;
  const TriangleMesh faces = faces_of(part, origin, piece);
  const Farthest on_mesh =
      farthest_sample(mesh, faces, area_samples, threads, [](int, const Vec3&, double) { return false; });
  const double tolerance = tolerances::kSurfaceDeviation * out.size;
  const Farthest on_part = farthest_sample(
      faces, mesh, area_samples, threads, [&](int triangle, const Vec3& point, double distance) {
        return distance > tolerance && part.pieces.size() > 1 &&
               in_other_piece(part, piece[triangle], point - origin, tolerance);
      });
  out.mesh_to_part = on_mesh.distance;
  out.worst_on_mesh = on_mesh.place;
  out.mesh_samples = on_mesh.samples;
  out.part_to_mesh = on_part.distance;
  out.worst_on_part = on_part.place;
  out.part_samples = on_part.samples;
  out.inner_samples = on_part.inner;
  return out;
}

}  // namespace tactum::inline v0_1
