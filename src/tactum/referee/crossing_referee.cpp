#include "tactum/referee/crossing_referee.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tactum/geometry/mesh_report.h"
#include "tactum/referee/linking.h"
#include "tactum/referee/winding_number.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The first corner of every connected piece of a mesh.
std::vector<Vec3> witnesses_of(const TriangleMesh& mesh) {
  std::vector<Index> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto find = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    const Index of_first = find(Index(t[0]));
    for (const Index k : {Index{1}, Index{2}}) parent[find(Index(t[k]))] = of_first;
  }
  std::vector<char> seen(parent.size(), 0);
  std::vector<Vec3> witnesses;
  for (const Triangle& t : mesh.triangles) {
    const Index piece = find(Index(t[0]));
    if (seen[piece]) continue;
    seen[piece] = 1;
    witnesses.push_back(mesh.vertices[t[0]]);
  }
  return witnesses;
}

}  // namespace

CrossingReferee::CrossingReferee(std::span<const RefereedBody> bodies, std::span<const Pose> X_WB) {
  for (const RefereedBody& body : bodies) {
    const Aabb box = bounds(body.surface->vertices);
    const MeshReport report = report_mesh(*body.surface, 0.0);
    bodies_.push_back({body, CrossingMesh(*body.surface), report.closed && report.oriented,
                       witnesses_of(*body.surface), mesh_loops(*body.surface), box.center(),
                       0.5 * box.diagonal()});
  }
  for (Index a = 0; a < bodies_.size(); ++a) {
    for (Index b = a + 1; b < bodies_.size(); ++b) {
      if (!judges(a, b)) continue;
      const Pose X_AB = relative_pose(X_WB[a], X_WB[b]);
      const bool crosses = !crossing_triangles(bodies_[a].mesh, bodies_[b].mesh, X_AB, 1).empty();
      crossed_at_start_[{a, b}] = crosses;
      crossing_at_start_ += crosses ? 1 : 0;
      at_start_[{a, b}] = topology(a, b, X_AB);
    }
  }
}

bool CrossingReferee::judges(Index a, Index b) const {
  const RefereedBody& of_a = bodies_[a].body;
  const RefereedBody& of_b = bodies_[b].body;
  return (of_a.moves || of_b.moves) && of_a.no_contact_with != static_cast<int>(b) &&
         of_b.no_contact_with != static_cast<int>(a);
}

bool CrossingReferee::near(Index a, Index b, std::span<const Pose> X_WB) const {
  const Judged& of_a = bodies_[a];
  const Judged& of_b = bodies_[b];
  return (X_WB[a] * of_a.center - X_WB[b] * of_b.center).norm() <= of_a.radius + of_b.radius;
}

CrossingReferee::Topology CrossingReferee::topology(Index a, Index b, const Pose& X_AB) const {
  const Judged& A = bodies_[a];
  const Judged& B = bodies_[b];
  const Pose X_BA = X_AB.inverse();
  const auto inside = [](const Judged& body, const Vec3& point) -> char {
    return body.encloses && std::abs(winding_number(body.mesh.mesh(), point)) > 0.5 ? 1 : 0;
  };
  Topology found;
  for (const Vec3& p_B : B.witnesses) found.inside.push_back(inside(A, X_AB * p_B));
  for (const Vec3& p_A : A.witnesses) found.inside.push_back(inside(B, X_BA * p_A));
  for (const ClosedLine& of_a : A.loops)
    for (const ClosedLine& of_b : B.loops)
      found.links.push_back(static_cast<int>(std::lround(linking_number(of_a, of_b, X_AB))));
  return found;
}

std::vector<Crossing> CrossingReferee::judge(std::span<const Pose> X_WB) const {
  std::vector<Crossing> faults;
  for (Index a = 0; a < bodies_.size(); ++a) {
    for (Index b = a + 1; b < bodies_.size(); ++b) {
      if (!judges(a, b)) continue;
      if (crossed_at_start_.at({a, b})) continue;
      const Topology& start = at_start_.at({a, b});
      Crossing fault{static_cast<int>(a), static_cast<int>(b), false, false, false, {-1, -1}};
      if (near(a, b, X_WB)) {
        const Pose X_AB = relative_pose(X_WB[a], X_WB[b]);
        const auto crossing = crossing_triangles(bodies_[a].mesh, bodies_[b].mesh, X_AB, 1);
        if (!crossing.empty()) {
          fault.surfaces_cross = true;
          fault.triangles = crossing.front();
        } else {
          const Topology now = topology(a, b, X_AB);
          fault.inside = now.inside != start.inside;
          fault.links_changed = now.links != start.links;
        }
      } else {  // apart: nothing is inside, nothing goes through
        const auto any = [](const auto& of) {
          return std::any_of(of.begin(), of.end(), [](auto n) { return n != 0; });
        };
        fault.inside = any(start.inside);
        fault.links_changed = any(start.links);
      }
      if (fault.surfaces_cross || fault.inside || fault.links_changed) faults.push_back(fault);
    }
  }
  return faults;
}

}  // namespace tactum::inline v0_1
