#include "tactum/repair/two_sided.h"

#include <vector>

namespace tactum::inline v0_1 {

TriangleMesh with_backs(const RepairedMesh& repaired) {
  TriangleMesh out = repaired.mesh;
  std::vector<int> back_of(repaired.mesh.vertices.size(), -1);
  const auto back = [&](int vertex) {
    if (back_of[vertex] < 0) {
      back_of[vertex] = static_cast<int>(out.vertices.size());
      out.vertices.push_back(repaired.mesh.vertices[vertex]);
    }
    return back_of[vertex];
  };
  for (std::size_t t = 0; t < repaired.mesh.triangles.size(); ++t) {
    if (repaired.components[repaired.component[t]].closed) continue;
    const Triangle& front = repaired.mesh.triangles[t];
    out.triangles.push_back({back(front[0]), back(front[2]), back(front[1])});
  }
  return out;
}

double open_area(const RepairedMesh& repaired) {
  double area = 0.0;
  for (const MeshComponent& component : repaired.components) area += component.closed ? 0.0 : component.area;
  return area;
}

}  // namespace tactum::inline v0_1
