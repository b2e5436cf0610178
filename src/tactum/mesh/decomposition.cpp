#include "tactum/mesh/decomposition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <string_view>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/decomposition_check.h"
#include "tactum/mesh/decomposition_cut.h"

namespace tactum::inline v0_1 {
namespace {

using detail::CutPlane;
using detail::Solid;
using detail::SolidEdge;

/// While cutting there may be this many times more pieces than asked for: joining brings them down.
constexpr int kPiecesBeforeJoining = 4;
/// So many reflex edges for each piece allowed, at most: one cut seldom frees more.
constexpr int kReflexEdgesPerPiece = 8;
/// Planes through two reflex edges are tried in bodies with at most this many: their number grows as the
/// square.
constexpr std::size_t kMostPaired = 32;
/// Planes tried where the better ones fail.
constexpr std::size_t kMostTries = 8;

struct Candidate {
  CutPlane plane;
  int freed = 0;    ///< reflex edges that are none after the cut
  int crossed = 0;  ///< reflex edges cut in two
  int edges = 0;    ///< all edges cut in two
  bool better_than(const Candidate& other) const {
    if (freed - crossed != other.freed - other.crossed) return freed - crossed > other.freed - other.crossed;
    return edges < other.edges;
  }
};

/// The body to be cut, as the choice of planes sees it.
struct Body {
  const std::vector<Vec3>& corners;
  const Solid& solid;
  const std::vector<SolidEdge>& edges;
  double noise;

  int side(const CutPlane& plane, int corner) const {
    const double height = plane.normal.dot(corners[corner]) - plane.offset;
    return height > noise ? 1 : height < -noise ? -1 : 0;
  }

  /// Whether a plane through the reflex edge leaves no reflex wedge on either side.
  bool frees(const CutPlane& plane, const SolidEdge& edge) const {
    const Vec3 along = (corners[edge.head] - corners[edge.tail]).normalized();
    const Vec3 from = solid[edge.left].normal.cross(along);
    const Vec3 in_plane = plane.normal.cross(along);
    for (double sign : {1.0, -1.0}) {
      double angle = std::atan2(-solid[edge.left].normal.dot(sign * in_plane), from.dot(sign * in_plane));
      if (angle < 0.0) angle += 2.0 * kPi;
      if (angle <= kPi + tolerances::kCoplanarMeshSine &&
          edge.wedge - angle <= kPi + tolerances::kCoplanarMeshSine && angle < edge.wedge)
        return true;
    }
    return false;
  }

  Candidate judged(const CutPlane& plane) const {
    Candidate candidate{plane};
    for (const SolidEdge& edge : edges) {
      const int tail = side(plane, edge.tail);
      const int head = side(plane, edge.head);
      if (tail * head < 0) {
        ++candidate.edges;
        if (edge.reflex) ++candidate.crossed;
      } else if (edge.reflex && tail == 0 && head == 0 && frees(plane, edge)) {
        ++candidate.freed;
      }
    }
    return candidate;
  }
};

/// The planes of both faces at every reflex edge, and those through two reflex edges; best first.
std::vector<Candidate> candidates_of(const Body& body) {
  std::vector<const SolidEdge*> reflex;
  for (const SolidEdge& edge : body.edges)
    if (edge.reflex) reflex.push_back(&edge);
  std::vector<Candidate> candidates;
  const auto consider = [&](const Vec3& normal, const SolidEdge& edge) {
    const double offset = normal.dot(0.5 * (body.corners[edge.tail] + body.corners[edge.head]));
    for (const Candidate& known : candidates)
      if (std::abs(known.plane.normal.dot(normal)) > 1.0 - tolerances::kSameNormal &&
          body.side(known.plane, edge.tail) == 0 && body.side(known.plane, edge.head) == 0)
        return;
    const Candidate candidate = body.judged({normal, offset});
    if (candidate.freed > 0) candidates.push_back(candidate);
  };
  for (const SolidEdge* edge : reflex) {
    consider(body.solid[edge->left].normal, *edge);
    consider(body.solid[edge->right].normal, *edge);
  }
  for (std::size_t i = 0; i < reflex.size() && reflex.size() <= kMostPaired; ++i)
    for (std::size_t j = i + 1; j < reflex.size(); ++j) {
      const Vec3 tail = body.corners[reflex[i]->tail];
      const Vec3 along = body.corners[reflex[i]->head] - tail;
      const Vec3 p = body.corners[reflex[j]->tail] - tail;
      const Vec3 q = body.corners[reflex[j]->head] - tail;
      const Vec3 normal = along.cross(p.squaredNorm() > q.squaredNorm() ? p : q);
      if (!(normal.norm() > body.noise * along.norm())) continue;
      const CutPlane plane{normal.normalized(), normal.normalized().dot(tail)};
      if (body.side(plane, reflex[j]->tail) == 0 && body.side(plane, reflex[j]->head) == 0)
        consider(plane.normal, *reflex[i]);
    }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.better_than(b); });
  return candidates;
}

/// The bodies after one cut by the best plane that works; none when every plane has the whole body on one
/// side: its reflex edges are then noise of the coordinates only.
Result<std::vector<Solid>> cut_once(std::vector<Vec3>& corners, const Body& body) {
  std::optional<Error> failure;
  const std::vector<Candidate> candidates = candidates_of(body);
  for (std::size_t i = 0; i < std::min(kMostTries, candidates.size()); ++i) {
    Result<detail::Halves> halves = detail::cut(corners, body.solid, candidates[i].plane, body.noise);
    if (!halves) {
      failure = halves.error();
      continue;
    }
    if (halves->below.empty() || halves->above.empty()) continue;
    std::vector<Solid> all;
    bool sound = true;
    for (const Solid* half : {&halves->below, &halves->above}) {
      Result<std::vector<Solid>> bodies = detail::bodies_of(corners, *half);
      if (!bodies) {
        failure = bodies.error();
        sound = false;
        break;
      }
      for (Solid& one : *bodies) all.push_back(std::move(one));
    }
    if (sound) return all;
  }
  if (failure) return *failure;
  return std::vector<Solid>{};
}

/// "1 open edge", "2 open edges".
std::string edge_count(int count, std::string_view kind = "") {
  return fmt::format("{} {}edge{}", count, kind, count == 1 ? "" : "s");
}

Error too_many(int most_pieces, std::string found) {
  return {"the solid does not fall into few convex pieces", std::move(found),
          fmt::format("at most {} pieces: use surface pieces", most_pieces), ""};
}
Error too_many(int reflex_edges, int most_pieces) {
  return too_many(most_pieces, edge_count(reflex_edges, "reflex "));
}

Error no_solid(std::string found, const TriangleMesh& mesh, int triangle) {
  if (triangle >= 0) found += " at " + detail::place(mesh.vertices[mesh.triangles[triangle][0]]);
  return {"the surface bounds no solid", std::move(found), "a closed surface of two triangles at every edge",
          ""};
}

/// Whether the mesh is closed, and of few components: each is a piece at least, or a cavity, which takes
/// pieces around it. Joining costs the square of the pieces.
Result<void> check_usable(const TriangleMesh& mesh, int most_pieces) {
  const MeshReport report = report_mesh(mesh, 0.0);
  if (report.non_manifold_edges > 0)
    return no_solid(fmt::format("{} of more than two triangles", edge_count(report.non_manifold_edges)), mesh,
                    report.first_non_manifold);
  if (!report.closed)
    return no_solid(edge_count(report.boundary_edges, "open "), mesh, report.first_boundary);
  if (!report.oriented)
    return no_solid(
        fmt::format("{} where triangles face opposite ways", edge_count(report.misoriented_edges)), mesh, -1);
  if (!(report.volume > 0.0)) return no_solid("normals that point inward", mesh, -1);
  if (report.components > kPiecesBeforeJoining * most_pieces)
    return too_many(most_pieces, fmt::format("{} components", report.components));
  return {};
}

/// Cuts until no body has a reflex edge.
Result<SolidPieces> cut_apart(std::vector<Vec3>& corners, Solid whole, double noise, int most_pieces) {
  Result<std::vector<Solid>> bodies = detail::bodies_of(corners, whole);
  if (!bodies) return bodies.error();
  if (static_cast<int>(bodies->size()) > kPiecesBeforeJoining * most_pieces)  // they may touch in corners
    return too_many(most_pieces, fmt::format("{} bodies", bodies->size()));
  std::deque<Solid> open(bodies->begin(), bodies->end());
  SolidPieces result;
  for (bool first_round = true; !open.empty();) {
    const Solid solid = std::move(open.front());
    open.pop_front();
    const Result<std::vector<SolidEdge>> edges = detail::edges_of(corners, solid);
    if (!edges) return edges.error();
    const auto reflex = static_cast<int>(
        std::count_if(edges->begin(), edges->end(), [](const SolidEdge& edge) { return edge.reflex; }));
    first_round = first_round && result.cuts == 0;
    if (first_round) result.reflex_edges += reflex;
    if (result.reflex_edges > kReflexEdgesPerPiece * most_pieces)
      return too_many(result.reflex_edges, most_pieces);
    std::vector<Solid> apart;
    if (reflex > 0) {
      Result<std::vector<Solid>> bodies_left = cut_once(corners, {corners, solid, *edges, noise});
      if (!bodies_left) return bodies_left.error();
      apart = std::move(*bodies_left);
    }
    if (apart.empty()) {
      Result<Polytope> piece = detail::convex_piece(corners, solid, noise);
      if (!piece) return piece.error();
      result.pieces.push_back(std::move(*piece));
      continue;
    }
    ++result.cuts;
    for (Solid& body : apart) open.push_back(std::move(body));
    if (result.pieces.size() + open.size() > static_cast<std::size_t>(kPiecesBeforeJoining * most_pieces))
      return too_many(result.reflex_edges, most_pieces);
  }
  return result;
}

}  // namespace

Result<SolidPieces> solid_pieces(const TriangleMesh& mesh, int most_pieces) {
  if (Result<void> usable = check_usable(mesh, most_pieces); !usable) return usable.error();
  const double size = bounds(mesh.vertices).diagonal();
  const double noise = tolerances::kCoplanarMeshOffset * size;
  std::vector<Vec3> corners = mesh.vertices;
  Result<Solid> whole = detail::solid_of_mesh(mesh, noise);
  if (!whole) return whole.error();
  const double volume = detail::volume_of(corners, *whole);
  const double area = detail::area_of(corners, *whole);
  Result<SolidPieces> result = cut_apart(corners, std::move(*whole), noise, most_pieces);
  if (!result) return result.error();
  result->joined = detail::join_convex(result->pieces, noise);
  if (result->pieces.size() > static_cast<std::size_t>(most_pieces))
    return too_many(result->reflex_edges, most_pieces);
  if (Result<void> proved = detail::check_pieces(result->pieces, volume, noise, noise * area); !proved)
    return proved.error();
  return result;
}

}  // namespace tactum::inline v0_1
