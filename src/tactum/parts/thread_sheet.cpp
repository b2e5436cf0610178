#include "tactum/parts/thread_sheet.h"

#include <cmath>
#include <utility>

namespace tactum::inline v0_1::detail {
namespace {

/// A column in the mesh: lines, and the first of its vertices.
struct Placed {
  const ThreadColumn* column;
  int first = 0;
  int shift = 0;  ///< added to the lines

  int size() const { return static_cast<int>(column->size()); }
  int line(int i) const { return (*column)[static_cast<std::size_t>(i)].line + shift; }
  int vertex(int i) const { return first + i; }
};

class Strip {
 public:
  Strip(bool inward, TriangleMesh& mesh) : inward_(inward), mesh_(mesh) {}

  void add(const Placed& left, const Placed& right) {
    const int last_left = left.size() - 1;
    const int last_right = right.size() - 1;
    int i = 0;
    int k = 0;
    while (i < last_left || k < last_right) {
      const bool both_last = i + 1 == last_left && k + 1 == last_right;
      const bool both_more = i < last_left && k < last_right;
      if (both_more && (both_last || left.line(i + 1) == right.line(k + 1))) {
        square(left.vertex(i), right.vertex(k), right.vertex(k + 1), left.vertex(i + 1));
        ++i;
        ++k;
      } else if (k == last_right || (both_more && left.line(i + 1) < right.line(k + 1))) {
        triangle(left.vertex(i), right.vertex(k), left.vertex(i + 1));
        ++i;
      } else {
        triangle(left.vertex(i), right.vertex(k), right.vertex(k + 1));
        ++k;
      }
    }
  }

 private:
  /// Corners counter-clockwise seen from far away from the axis.
  void triangle(int a, int b, int c) {
    if (inward_) std::swap(b, c);
    mesh_.triangles.push_back({a, b, c});
  }

  /// The diagonal ac is a valley when d lies above the plane of abc.
  void square(int a, int b, int c, int d) {
    const auto& p = mesh_.vertices;
    const double above = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[d] - p[a]);
    if (inward_ ? above <= 0.0 : above >= 0.0) {
      triangle(a, b, c);
      triangle(a, c, d);
    } else {
      triangle(a, b, d);
      triangle(b, c, d);
    }
  }

  bool inward_;
  TriangleMesh& mesh_;
};

}  // namespace

ThreadRims add_thread_sheet(const std::vector<ThreadColumn>& columns, int lines_per_turn, bool inward,
                            TriangleMesh& mesh) {
  ThreadRims rims;
  std::vector<Placed> placed;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double angle = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(columns.size());
    placed.push_back({&columns[k], static_cast<int>(mesh.vertices.size())});
    for (const ThreadCorner& corner : columns[k])
      mesh.vertices.emplace_back(corner.radius_m * std::cos(angle), corner.radius_m * std::sin(angle),
                                 corner.z_m);
    rims.low.push_back(placed.back().first);
    rims.high.push_back(static_cast<int>(mesh.vertices.size()) - 1);
  }
  Strip strip(inward, mesh);
  for (std::size_t k = 0; k + 1 < placed.size(); ++k) strip.add(placed[k], placed[k + 1]);
  Placed round = placed.front();
  round.shift = -lines_per_turn;
  strip.add(placed.back(), round);
  return rims;
}

}  // namespace tactum::inline v0_1::detail
