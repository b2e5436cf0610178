#include "tactum/referee/mesh_loops.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using Ends = std::pair<Index, Index>;  // the smaller vertex first

struct Edge {
  Ends ends;
  std::vector<Index> triangles;
  bool in_a_tree = false;
};

/// The edges of a mesh, those at every vertex, and those of every triangle.
struct EdgeGraph {
  std::vector<Edge> edges;
  std::vector<std::vector<Index>> at_vertex;
  std::vector<std::array<Index, 3>> of_triangle;

  explicit EdgeGraph(const TriangleMesh& mesh)
      : at_vertex(mesh.vertices.size()), of_triangle(mesh.triangles.size()) {
    std::map<Ends, Index> known;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      for (Index k = 0; k < 3; ++k) {
        const Index from = Index(mesh.triangles[t][k]);
        const Index to = Index(mesh.triangles[t][(k + 1) % 3]);
        const Ends ends = std::minmax(from, to);
        const auto [place, is_new] = known.try_emplace(ends, edges.size());
        if (is_new) {
          edges.push_back({ends, {}, false});
          at_vertex[from].push_back(place->second);
          at_vertex[to].push_back(place->second);
        }
        edges[place->second].triangles.push_back(t);
        of_triangle[t][k] = place->second;
      }
    }
  }
};

constexpr Index kRoot = ~Index{0};

/// The vertex before each one on the way to its root, and how many edges it is away.
struct VertexTree {
  std::vector<Index> before;
  std::vector<Index> depth;
};

VertexTree grow_over_vertices(EdgeGraph& graph) {
  const Index count = graph.at_vertex.size();
  VertexTree tree{std::vector<Index>(count, kRoot), std::vector<Index>(count, 0)};
  std::vector<char> reached(count, 0);
  for (Index root = 0; root < count; ++root) {
    if (reached[root]) continue;
    reached[root] = 1;
    std::vector<Index> front{root};
    for (Index next = 0; next < front.size(); ++next) {  // breadth first: short ways
      const Index vertex = front[next];
      for (const Index e : graph.at_vertex[vertex]) {
        const Ends& ends = graph.edges[e].ends;
        const Index other = ends.first == vertex ? ends.second : ends.first;
        if (reached[other]) continue;
        reached[other] = 1;
        graph.edges[e].in_a_tree = true;
        tree.before[other] = vertex;
        tree.depth[other] = tree.depth[vertex] + 1;
        front.push_back(other);
      }
    }
  }
  return tree;
}

void grow_over_triangles(EdgeGraph& graph) {
  std::vector<char> reached(graph.of_triangle.size(), 0);
  for (Index root = 0; root < reached.size(); ++root) {
    if (reached[root]) continue;
    reached[root] = 1;
    std::vector<Index> front{root};
    for (Index next = 0; next < front.size(); ++next) {
      for (const Index e : graph.of_triangle[front[next]]) {
        Edge& edge = graph.edges[e];
        if (edge.in_a_tree) continue;
        for (const Index other : edge.triangles) {
          if (reached[other]) continue;
          reached[other] = 1;
          edge.in_a_tree = true;
          front.push_back(other);
          break;  // a tree crosses an edge once
        }
      }
    }
  }
}

/// From one end of an edge down the tree and up again to the other.
ClosedLine close(const TriangleMesh& mesh, const VertexTree& tree, const Ends& ends) {
  std::vector<Index> there{ends.first};
  std::vector<Index> back{ends.second};
  while (there.back() != back.back()) {
    std::vector<Index>& deeper = tree.depth[there.back()] >= tree.depth[back.back()] ? there : back;
    deeper.push_back(tree.before[deeper.back()]);
  }
  ClosedLine line;
  for (const Index vertex : there) line.push_back(mesh.vertices[vertex]);
  for (Index i = back.size() - 1; i-- > 0;) line.push_back(mesh.vertices[back[i]]);
  return line;
}

}  // namespace

std::vector<ClosedLine> mesh_loops(const TriangleMesh& mesh) {
  EdgeGraph graph(mesh);
  const VertexTree tree = grow_over_vertices(graph);
  grow_over_triangles(graph);
  std::vector<ClosedLine> loops;
  for (const Edge& edge : graph.edges) {
    if (edge.in_a_tree) continue;
    ClosedLine line = close(mesh, tree, edge.ends);
    if (line.size() >= 3) loops.push_back(std::move(line));
  }
  return loops;
}

}  // namespace tactum::inline v0_1
