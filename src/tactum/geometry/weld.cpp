#include "tactum/geometry/weld.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>

#include "tactum/base/hash.h"

namespace tactum::inline v0_1 {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    Hash hash;
    for (std::int64_t axis : cell) hash.add(axis);
    return static_cast<std::size_t>(hash.value());
  }
};

/// Kept vertices by cells of a grid. A cell is many tolerances wide, so a ball mostly lies within one cell.
class VertexGrid {
 public:
  VertexGrid(const std::vector<Vec3>& kept, double tolerance, const Aabb& box)
      : kept_(kept), tolerance_(tolerance), origin_(box.empty() ? Vec3::Zero() : box.min) {
    // At most 2^40 cells along the diagonal: the numbers stay exact.
    cell_ = std::max({kCellsPerTolerance * tolerance, box.diagonal() * 0x1p-40, kLeastCell});
  }

  /// The first kept vertex within the tolerance, or -1.
  int find(const Vec3& point) const {
    int best = -1;
    const Cell low = cell_of(point - Vec3::Constant(tolerance_));
    const Cell high = cell_of(point + Vec3::Constant(tolerance_));
    for (Cell cell = low; cell[0] <= high[0]; ++cell[0]) {
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) find_in(cell, point, best);
      }
    }
    return best;
  }
  void add(int vertex) {
    after_.push_back(-1);
    const auto [ends, is_new] = cells_.try_emplace(cell_of(kept_[vertex]), Ends{vertex, vertex});
    if (is_new) return;
    after_[ends->second.last] = vertex;
    ends->second.last = vertex;
  }

 private:
  static constexpr double kCellsPerTolerance = 16.0;
  static constexpr double kLeastCell = 0x1p-500;  // a mesh of one point

  Cell cell_of(const Vec3& point) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = static_cast<std::int64_t>(std::floor((point[axis] - origin_[axis]) / cell_));
    }
    return cell;
  }
  void find_in(const Cell& cell, const Vec3& point, int& best) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return;
    for (int vertex = found->second.first; vertex >= 0; vertex = after_[vertex]) {
      if (best >= 0 && vertex >= best) break;  // the lists are in ascending order
      if ((kept_[vertex] - point).norm() <= tolerance_) best = vertex;
    }
  }

  const std::vector<Vec3>& kept_;
  double tolerance_;
  Vec3 origin_;
  double cell_ = 1.0;
  /// The first and the last vertex of a cell; after_ leads from one to the next.
  struct Ends {
    int first, last;
  };
  std::unordered_map<Cell, Ends, CellHash> cells_;
  std::vector<int> after_;
};

std::vector<int> weld_vertices(const TriangleMesh& mesh, double tolerance, std::vector<Vec3>& kept) {
  const Aabb box = bounds(mesh.vertices);
  VertexGrid grid(kept, tolerance * box.diagonal(), box);
  std::vector<int> target(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    target[i] = grid.find(mesh.vertices[i]);
    if (target[i] >= 0) continue;
    target[i] = static_cast<int>(kept.size());
    kept.push_back(mesh.vertices[i]);
    grid.add(target[i]);
  }
  return target;
}

}  // namespace

bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest_sq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  // Twice the area is height times longest edge.
  return !((b - a).cross(c - a).norm() > tolerances::kDegenerateTriangle * longest_sq);
}

WeldedMesh weld(const TriangleMesh& mesh, const WeldOptions& options) {
  WeldedMesh out;
  const std::vector<int> target = weld_vertices(mesh, options.tolerance, out.mesh.vertices);
  out.report.vertices_joined = static_cast<int>(mesh.vertices.size() - out.mesh.vertices.size());
  std::set<Triangle> seen;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& given = mesh.triangles[i];
    const Triangle triangle = {target[given[0]], target[given[1]], target[given[2]]};
    const int number = static_cast<int>(i);
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      out.report.index_degenerate.push_back(number);
      continue;
    }
    const auto& v = out.mesh.vertices;
    if (options.drop_zero_area && has_no_area(v[triangle[0]], v[triangle[1]], v[triangle[2]])) {
      out.report.zero_area.push_back(number);
      continue;
    }
    if (options.drop_duplicates) {
      Triangle sorted = triangle;
      std::sort(sorted.begin(), sorted.end());
      if (!seen.insert(sorted).second) {
        out.report.duplicates.push_back(number);
        continue;
      }
    }
    out.mesh.triangles.push_back(triangle);
    out.source.push_back(number);
  }
  return out;
}

}  // namespace tactum::inline v0_1
