#pragma once
/// A closed convex polyhedron with everything the contact core walks on: vertices, edges and faces with their
/// adjacency, face planes, and the planes that bound the external Voronoi regions of its features.
///
///        head                 A point p is in the Voronoi region of
///         ^                     face f    when it is above f and inside every side plane of f;
///   left  |  right              edge e    when it is outside both side planes at e and between its ends;
///   face  |  face               vertex v  when it is behind the end plane of every edge at v.
///        tail                 (Lin and Canny 1991; Mirtich 1998.)
///
/// A flat polygon or a single triangle is legal: it has two faces with opposite normals (front is face 0).
/// Everything lies in flat arrays; the adjacency of vertices and the loops of faces are in compressed rows.
/// Coplanar facets are merged and corners that are no corners are dropped: see hull.h.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tactum/base/large_array.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct Polytope {
  /// Seen from outside, the left face runs tail -> head and the right face head -> tail.
  struct Edge {
    int tail = 0, head = 0;             ///< vertices
    int left = 0, right = 0;            ///< faces
    int left_slot = 0, right_slot = 0;  ///< where the edge stands in face_vertices, sides
    double length = 0.0;                ///< [m]
    Vec3 direction = Vec3::Zero();      ///< unit, tail to head
  };
  /// The plane is normal . x = offset, the solid below it.
  struct Face {
    Vec3 normal = Vec3::Zero();  ///< unit, outward
    double offset = 0.0;         ///< [m]
    int first = 0, count = 0;    ///< the loop: slots [first, first + count)
    bool rectangle = false;      ///< four corners, all square up to rounding
  };

  /// A plane that bounds a face's column, normal . x <= offset inside, and the face beyond it: stored here as
  /// well, so that a walk that leaves the face over it need not wait for the edge and the face.
  struct Side {
    Vec3 normal = Vec3::Zero();  ///< unit, in the face's plane, pointing away from the face across the edge
    double offset = 0.0;         ///< [m]
    int edge = 0;                ///< that it goes through
    int across = 0;              ///< the face beyond
    int first = 0, count = 0;    ///< its loop
  };
  /// An edge as seen from one of its ends, with everything that a climb and a Voronoi test of a vertex read.
  struct Ray {
    Vec3 direction = Vec3::Zero();  ///< unit, away from the vertex
    int edge = 0;
    int far = 0;  ///< the vertex at the other end
  };
  /// Where the polytope lies and how large it is.
  struct Extent {
    Vec3 center = Vec3::Zero();  ///< mean of the vertices: inside
    double radius = 0.0;         ///< largest distance of a vertex from center [m]
    double size = 0.0;           ///< diagonal of the bounding box [m]
    double magnitude = 0.0;      ///< size + |center|: of the numbers that are added up about it [m]
  };

  std::vector<Vec3> vertices;  ///< [m]
  LargeArray<Edge> edges;
  LargeArray<Face> faces;

  // Loops of the faces, counter-clockwise seen from outside; slot i runs from its vertex to the next slot's.
  std::vector<int> face_vertices;
  LargeArray<Side> sides;

  // Edges around each vertex: rays[ray_first[v] .. ray_first[v + 1]).
  std::vector<int> ray_first;
  LargeArray<Ray> rays;

  Extent extent;
  bool flat = false;            ///< a polygon with two faces, no inside
  std::array<int, 3> counts{};  ///< of vertices, edges and faces

  /// Direction lookup table [Ehmann and Lin 2000]: for directions on a cube around the center, the vertex
  /// farthest along each. 6 x 8 x 8 entries of two bytes: 768 bytes.
  static constexpr int kTableSide = 8;
  std::array<std::uint16_t, 6 * kTableSide * kTableSide> direction_table{};

  std::span<const Ray> rays_at(int vertex) const noexcept {
    const int first = ray_first[static_cast<std::size_t>(vertex)];
    const int last = ray_first[static_cast<std::size_t>(vertex) + 1];
    return {rays.data() + first, static_cast<std::size_t>(last - first)};
  }
};

/// A vertex near the farthest one along `direction` (any length but zero): one table look-up.
int table_vertex(const Polytope& polytope, const Vec3& direction) noexcept;

/// A step up: the neighbour of a vertex up the steepest ray, or the vertex when none is higher. `height`,
/// that of the vertex along `direction`, is set to the neighbour's.
int uphill(const Polytope& polytope, const Vec3& direction, int vertex, double& height) noexcept;

/// The vertex farthest along `direction`, climbing from vertex `start`. Exact up to rounding; a climb over a
/// convex polytope cannot stop at a lesser peak. Cost: the features climbed over.
int support_vertex(const Polytope& polytope, const Vec3& direction, int start) noexcept;

/// The same from the table: no coherence needed.
inline int support_vertex(const Polytope& polytope, const Vec3& direction) noexcept {
  return support_vertex(polytope, direction, table_vertex(polytope, direction));
}

/// Completes a polytope of which vertices and the loops of the faces (faces[].first, count; face_vertices)
/// are given: planes, edges, adjacency, Voronoi planes, table. False when the loops do not close up to a
/// two-manifold sphere (V - E + F = 2), with the reason in `why`.
bool complete_polytope(Polytope& polytope, const char** why);

/// Largest height of a vertex above a face plane [m]: zero up to rounding for a convex polytope.
double convexity_defect(const Polytope& polytope) noexcept;

}  // namespace tactum::inline v0_1
