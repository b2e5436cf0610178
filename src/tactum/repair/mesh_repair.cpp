#include "tactum/repair/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <utility>

#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/weld.h"
#include "tactum/repair/cap_triangles.h"
#include "tactum/repair/hole_filling.h"
#include "tactum/repair/inner_walls.h"
#include "tactum/repair/repeated_triangles.h"

namespace tactum::inline v0_1 {
namespace {

/// What stands behind the count of a finding: behind "1", and behind more.
struct Clause {
  std::string of_one, of_many;
};

/// Collects findings with the place of the first triangle of each.
class Notes {
 public:
  Notes(const TriangleMesh& given, std::vector<RepairNote>& notes) : given_(given), notes_(notes) {}

  void add(bool mended, const char* kind, const Clause& clause, int count, int triangle = -1) {
    if (count == 0) return;
    RepairNote note{kind, count == 1 ? clause.of_one : clause.of_many, count, triangle, Vec3::Zero(), mended};
    if (triangle >= 0) {
      for (int corner : given_.triangles[triangle]) note.place += given_.vertices[corner] / 3.0;
    }
    notes_.push_back(std::move(note));
  }
  void add(bool mended, const char* kind, const Clause& clause, const std::vector<int>& triangles) {
    add(mended, kind, clause, static_cast<int>(triangles.size()), triangles.empty() ? -1 : triangles.front());
  }

 private:
  const TriangleMesh& given_;
  std::vector<RepairNote>& notes_;
};

/// Drops the triangles listed, whose numbers become those in the mesh given.
void drop(RepairedMesh& out, std::initializer_list<std::vector<int>*> lists) {
  std::vector<bool> dropped(out.mesh.triangles.size(), false);
  for (std::vector<int>* list : lists) {
    for (int& triangle : *list) {
      dropped[triangle] = true;
      triangle = out.source[triangle];
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < dropped.size(); ++t) {
    if (dropped[t]) continue;
    out.mesh.triangles[kept] = out.mesh.triangles[t];
    out.source[kept++] = out.source[t];
  }
  out.mesh.triangles.resize(kept);
  out.source.resize(kept);
}

/// Drops what stands twice and what lies inside a solid, with notes.
void drop_repeated(RepairedMesh& out, int threads, Notes& notes) {
  RepeatedTriangles repeated = find_repeated_triangles(out.mesh, threads);
  drop(out, {&repeated.copies, &repeated.walls, &repeated.sheets});
  std::vector<int> single_walls = find_inner_walls(out.mesh);
  drop(out, {&single_walls});
  notes.add(true, "duplicate_triangles",
            {"triangle stood twice and was dropped", "triangles stood twice and were dropped"},
            repeated.copies);
  notes.add(true, "inner_walls",
            {"triangle of a wall between two solids was dropped",
             "triangles of walls between two solids were dropped"},
            repeated.walls);
  notes.add(true, "single_walls",
            {"triangle was a wall inside a solid and was dropped",
             "triangles were walls inside a solid and were dropped"},
            single_walls);
  std::merge(repeated.walls.begin(), repeated.walls.end(), single_walls.begin(), single_walls.end(),
             std::back_inserter(out.walls));
  notes.add(true, "two_sided_sheets",
            {"triangle is the second side of a sheet, which has two sides anyway",
             "triangles are the second side of a sheet, which has two sides anyway"},
            repeated.sheets);
}

void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<int> target(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles)
    for (int corner : t) target[corner] = 0;
  int kept = 0;
  for (std::size_t v = 0; v < target.size(); ++v) {
    if (target[v] < 0) continue;
    target[v] = kept;
    mesh.vertices[kept++] = mesh.vertices[v];
  }
  mesh.vertices.resize(kept);
  for (Triangle& t : mesh.triangles)
    for (int& corner : t) corner = target[corner];
}

/// Vertices at which fans of triangles meet that have no edge in common there.
std::vector<int> pinched_at(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides) {
  DisjointSets fans(static_cast<int>(3 * mesh.triangles.size()));  // corners of triangles
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    for (const HalfEdge* side = first; side != last; ++side) {
      const int next = (side->corner + 1) % 3;
      const int next_first = (first->corner + 1) % 3;
      const bool same = side->forward == first->forward;
      fans.join(3 * first->triangle + first->corner, 3 * side->triangle + (same ? side->corner : next));
      fans.join(3 * first->triangle + next_first, 3 * side->triangle + (same ? next : side->corner));
    }
  });
  std::vector<int> fan_of(mesh.vertices.size(), -1);
  std::vector<bool> noted(mesh.vertices.size(), false);
  std::vector<int> triangles;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = mesh.triangles[t][corner];
      const int fan = fans.find(3 * t + corner);
      if (fan_of[vertex] < 0) fan_of[vertex] = fan;
      if (fan_of[vertex] == fan || noted[vertex]) continue;
      noted[vertex] = true;
      triangles.push_back(t);
    }
  }
  return triangles;
}

/// Triangles at the rims that were closed.
struct Filled {
  std::vector<int> cracks, holes;
};

/// Notes holes, and faults at edges and vertices.
void note_topology(const RepairedMesh& out, const Filled& filled, Notes& notes) {
  notes.add(true, "closed_cracks",
            {"crack between corners and edges that meet was closed",
             "cracks between corners and edges that meet were closed"},
            filled.cracks);
  notes.add(true, "closed_holes", {"hole was closed", "holes were closed"}, filled.holes);
  std::vector<int> open;
  std::size_t shortest = out.mesh.triangles.size() * 3;
  std::size_t longest = 0;
  for (const Rim& rim : rims_of(out.mesh)) {
    open.push_back(out.source[rim.triangle]);
    shortest = std::min(shortest, rim.vertices.size());
    longest = std::max(longest, rim.vertices.size());
  }
  notes.add(false, "holes",
            {fmt::format("rim of {} edges is open: of a hole, or of a sheet", longest),
             fmt::format("rims of {} to {} edges are open: of holes, or of sheets", shortest, longest)},
            open);
  std::vector<int> crowded;  // edges of more than two triangles
  const std::vector<HalfEdge> sides = sorted_half_edges(out.mesh);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first > 2) crowded.push_back(out.source[first->triangle]);
  });
  notes.add(false, "non_manifold_edges",
            {"edge has more than two triangles", "edges have more than two triangles"}, crowded);
  std::vector<int> pinched = pinched_at(out.mesh, sides);
  for (int& triangle : pinched) triangle = out.source[triangle];
  notes.add(false, "pinched_vertices",
            {"vertex joins fans of triangles that share no edge",
             "vertices join fans of triangles that share no edge"},
            pinched);
}

void note_components(const RepairedMesh& out, Notes& notes) {
  struct Kind {
    const char* kind;
    const char *of_one, *of_many;
    bool mended;
    bool (*holds)(const MeshComponent&);
  };
  constexpr Kind kKinds[] = {
      {"turned_components", "component faced the wrong way and was turned round",
       "components faced the wrong way and were turned round", true,
       [](const MeshComponent& c) { return c.turned; }},
      {"cavities", "component lies inside another and is taken for a cavity, facing inward",
       "components lie inside another and are taken for cavities, facing inward", true,
       [](const MeshComponent& c) { return c.depth % 2 != 0; }},
      {"cutting_components", "component lies partly inside another: where they overlap counts twice",
       "components lie partly inside another: where they overlap counts twice", false,
       [](const MeshComponent& c) { return c.cuts_other; }},
      {"empty_components", "closed component encloses no volume", "closed components enclose no volume",
       false, [](const MeshComponent& c) { return c.empty_inside(); }},
      {"twisted_components", "component has one side only (a Moebius band) and cannot face outward",
       "components have one side only (a Moebius band) and cannot face outward", false,
       [](const MeshComponent& c) { return c.twisted_edges > 0; }}};
  for (const Kind& kind : kKinds) {
    std::vector<int> first;
    for (const MeshComponent& component : out.components)
      if (kind.holds(component)) first.push_back(out.source[component.first_triangle]);
    notes.add(kind.mended, kind.kind, {kind.of_one, kind.of_many}, first);
  }
}

/// Orients and keeps count of which triangles given stand turned now; a component is turned when most of its
/// triangles are.
void orient(RepairedMesh& out, int threads, std::vector<bool>& turned) {
  OrientedMesh oriented = orient_components(out.mesh, threads);
  for (int triangle : oriented.flipped)
    if (const int source = out.source[triangle]; source >= 0) turned[source] = !turned[source];
  std::vector<int> turned_of(oriented.components.size(), 0);
  for (std::size_t t = 0; t < out.source.size(); ++t)
    if (out.source[t] >= 0 && turned[out.source[t]]) ++turned_of[oriented.component[t]];
  out.components = std::move(oriented.components);
  out.component = std::move(oriented.component);
  for (std::size_t c = 0; c < out.components.size(); ++c)
    out.components[c].turned = 2 * turned_of[c] > out.components[c].triangles;
}

}  // namespace

std::string RepairNote::sentence() const {
  std::string text_of = fmt::format("{} {}", count, text);
  if (triangle >= 0)
    text_of += fmt::format(" (the first: triangle {} at {:.6g} {:.6g} {:.6g})", triangle, place.x(),
                           place.y(), place.z());
  return text_of + ".";
}

TriangleMesh with_used_vertices(TriangleMesh mesh) {
  drop_unused_vertices(mesh);
  return mesh;
}

RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options) {
  RepairedMesh out;
  Notes notes(mesh, out.notes);
  WeldedMesh welded = weld(with_used_vertices(mesh));  // others would stretch the box that tolerances go by
  out.mesh = std::move(welded.mesh);
  out.source = std::move(welded.source);
  notes.add(true, "joined_vertices",
            {"vertex stood at the place of another and was joined",
             "vertices stood at the place of another and were joined"},
            welded.report.vertices_joined);
  notes.add(
      true, "degenerate_triangles",
      {"triangle had two equal corners and was dropped", "triangles had two equal corners and were dropped"},
      welded.report.index_degenerate);
  drop_repeated(out, options.threads, notes);

  std::vector<bool> turned(mesh.triangles.size(), false);  // of the triangles given
  orient(out, options.threads, turned);
  Filled filled;
  for (const Rim& rim : close_holes(out.mesh, options.close_holes))
    if (rim.closed) (rim.crack ? filled.cracks : filled.holes).push_back(out.source[rim.triangle]);
  out.source.resize(out.mesh.triangles.size(), -1);
  CapReport caps = mend_caps(out.mesh, out.source);
  const std::size_t given_to_neighbours = caps.mended.size();
  std::erase_if(caps.mended, [](int triangle) { return triangle < 0; });  // within a hole just closed
  notes.add(true, "zero_area_mended",
            {"triangle without area was given to its neighbours",
             "triangles without area were given to their neighbours"},
            caps.mended);
  notes.add(false, "zero_area_left", {"triangle without area is left", "triangles without area are left"},
            caps.left);
  // What is oriented stays so where no triangle came or went.
  if (!(filled.cracks.empty() && filled.holes.empty() && given_to_neighbours == 0))
    orient(out, options.threads, turned);
  std::vector<int> flipped;
  for (std::size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) flipped.push_back(static_cast<int>(t));
  notes.add(true, "flipped_triangles",
            {"triangle faced the wrong way and was turned round",
             "triangles faced the wrong way and were turned round"},
            flipped);
  drop_unused_vertices(out.mesh);
  note_topology(out, filled, notes);
  note_components(out, notes);
  return out;
}

}  // namespace tactum::inline v0_1
