#include "tactum/contact/seams.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// The angle by which a normal is tilted over an edge to see whether the surface bends there [rad, small]: an
/// edge that bends less is flat to a patch, whose features lean by as much anyway.
constexpr double kLeanOver = 0.05 * tolerances::kPatchAngle;

double noise_of(const Part& part) noexcept { return tolerances::kCoplanarMeshOffset * part.size; }

int number_of(const Part& part, int piece, const Feature& feature) noexcept {
  return part.true_surface.number(piece, static_cast<int>(feature.kind), feature.index);
}

/// Whether `p` is in P, or no farther than `margin` beyond a face.
bool holds(const Polytope& P, const Vec3& p, double margin) noexcept {
  return std::all_of(P.faces.begin(), P.faces.end(), [&](const Polytope::Face& plane) {
    return plane.normal.dot(p) <= plane.offset + margin;
  });
}

bool in_column(const Polytope& P, int face, const Vec3& p, double margin) noexcept {
  const Polytope::Face& loop = P.faces[face];
  for (int slot = loop.first; slot < loop.first + loop.count; ++slot)
    if (P.sides[slot].normal.dot(p) > P.sides[slot].offset + margin) return false;
  return true;
}

/// For one side: the faces of `F`, in its own frame, against the support of `S`. Calls take(face, vertex of
/// S, distance) for those that could be nearer than `best`.
template <class Take>
void for_true_faces(const Part& part, int piece, const Polytope& S, const Pose& X_FS, int start,
                    const Take& take) noexcept {
  const Polytope& F = part.pieces[Index(piece)];
  int vertex = start;
  for (int face = 0; face < F.counts[2]; ++face) {
    const bool covered =
        !part.true_surface.single_piece() &&
        part.true_surface.group[Index(number_of(part, piece, {FeatureKind::kFace, face}))] < 0;
    if (covered) continue;
    const Vec3& normal = F.faces[face].normal;
    vertex = support_vertex(S, -rotated_back(X_FS.R, normal), vertex);
    take(face, vertex, normal.dot(X_FS * S.vertices[vertex]) - F.faces[face].offset);
  }
}

/// The side of `face` at its edge `edge`: unit, in its plane, outward.
const Vec3& side_at(const Polytope& P, int face, int edge) noexcept {
  const Polytope::Edge& e = P.edges[edge];
  return P.sides[face == e.left ? e.left_slot : e.right_slot].normal;
}

/// Whether the surface bends at `edge` of `piece`, at point `p` on `at`: a normal tilted a little over the
/// edge is one of the whole part's.
bool is_true_edge(const Part& part, int piece, int edge, const Feature& at, const Vec3& p) noexcept {
  const Polytope& P = part.pieces[Index(piece)];
  for (const int face : {P.edges[edge].left, P.edges[edge].right}) {
    if (part.true_surface.group_of(piece, 2, face) < 0) continue;
    const Vec3 over = P.faces[face].normal + kLeanOver * side_at(P, face, edge);
    if (allowed_by_neighbours(part, piece, at, p, over.normalized())) return true;
  }
  return false;
}

/// The exposed face that faces most along `outward`, of those looked at.
class ExposedFace {
 public:
  ExposedFace(const Part& part, int piece, const Vec3& outward) noexcept
      : part_(part), piece_(piece), outward_(outward) {}

  /// Looks at the two faces of an edge.
  void look_at(int edge) noexcept {
    const Polytope& P = part_.pieces[Index(piece_)];
    for (const int face : {P.edges[edge].left, P.edges[edge].right}) {
      const double along = P.faces[face].normal.dot(outward_);
      if (along > along_ && part_.true_surface.group_of(piece_, 2, face) >= 0) face_ = face, along_ = along;
    }
  }
  Feature found_or(const Feature& otherwise) const noexcept {
    return face_ < 0 ? otherwise : Feature{FeatureKind::kFace, face_};
  }

 private:
  const Part& part_;
  int piece_;
  const Vec3& outward_;
  int face_ = -1;
  double along_ = -2.0;  // below any cosine
};

/// Pairs of true edges up to which all are tried.
constexpr std::size_t kMostEdgePairs = 16384;
using EdgeList = StaticVector<int, 1024>;

/// Lists the edges of `piece` where the surface bends, judged at their middles; no more than there is room
/// for.
void true_edges(const Part& part, int piece, EdgeList& edges) noexcept {
  const Polytope& P = part.pieces[Index(piece)];
  for (int e = 0; e < P.counts[1]; ++e) {
    const Feature edge{FeatureKind::kEdge, e};
    const bool bends =
        part.true_surface.single_piece() ||
        part.true_surface.neighbours(number_of(part, piece, edge)).empty() ||
        is_true_edge(part, piece, e, edge, 0.5 * (P.vertices[P.edges[e].tail] + P.vertices[P.edges[e].head]));
    if (bends && !edges.push_back(e)) return;
  }
}

/// An edge of a piece in some frame; its references are valid as long as what they refer to.
struct PlacedEdge {
  int edge;
  const Vec3 &tail, &direction;
  const Vec3 &left, &right;  // sides of the faces there: unit, in their planes, outward
  double length;

  /// Whether `outward` (square to the edge) is a normal there, by the sign: +1, or -1 for its opposite; 0
  /// when neither is.
  double sign_of(const Vec3& outward) const noexcept {
    const double on_left = left.dot(outward);
    const double on_right = right.dot(outward);
    return on_left >= 0.0 && on_right >= 0.0 ? 1.0 : on_left <= 0.0 && on_right <= 0.0 ? -1.0 : 0.0;
  }
};

PlacedEdge placed_edge(const Polytope& P, int edge) noexcept {
  const Polytope::Edge& e = P.edges[edge];
  return {edge,    P.vertices[e.tail], e.direction, side_at(P, e.left, edge), side_at(P, e.right, edge),
          e.length};
}

/// Two edges whose common normal both pieces have, where they cross.
std::optional<PairDistance> crossing_edges(const PlacedEdge& a, const PlacedEdge& b) noexcept {
  Vec3 n = a.direction.cross(b.direction);
  const double sign = a.sign_of(-n);
  if (sign == 0.0 || b.sign_of(sign * n) != 1.0) return std::nullopt;
  const double sine = n.norm();
  if (!(sine > tolerances::kSamePlane)) return std::nullopt;  // parallel: the faces have covered them
  n *= sign / sine;
  // Where the lines cross, seen along n: in metres from their tails.
  const Vec3 between = b.tail - a.tail;
  const double on_a = sign / sine * between.cross(b.direction).dot(n);
  const double on_b = sign / sine * between.cross(a.direction).dot(n);
  if (on_a < 0.0 || on_a > a.length || on_b < 0.0 || on_b > b.length) return std::nullopt;
  const Vec3 p_a = a.tail + on_a * a.direction;
  const Vec3 p_b = b.tail + on_b * b.direction;
  return PairDistance{.distance = n.dot(p_a - p_b),
                      .p_a = p_a,
                      .p_b = p_b,
                      .normal = n,
                      .a = {FeatureKind::kEdge, a.edge},
                      .b = {FeatureKind::kEdge, b.edge},
                      .stop = Stop::kFallback};
}

/// The vertex of `piece` where that of `of_piece` is.
Feature same_corner(const Part& part, int of_piece, const Feature& vertex, int piece) noexcept {
  const auto neighbours = part.true_surface.neighbours(number_of(part, of_piece, vertex));
  if (std::find(neighbours.begin(), neighbours.end(), piece) == neighbours.end()) return {vertex.kind, -1};
  const Vec3& p = part.pieces[Index(of_piece)].vertices[Index(vertex.index)];
  const auto& vertices = part.pieces[Index(piece)].vertices;
  const double noise = noise_of(part);
  const auto same = std::find_if(vertices.begin(), vertices.end(),
                                 [&](const Vec3& other) { return (other - p).norm() <= noise; });
  return {vertex.kind, same == vertices.end() ? -1 : static_cast<int>(same - vertices.begin())};
}

}  // namespace

bool allowed_by_neighbours(const Part& part, int piece, const Feature& feature, const Vec3& p,
                           const Vec3& outward, double margin) noexcept {
  if (part.true_surface.single_piece()) return true;
  const double noise = noise_of(part);
  const auto neighbours = part.true_surface.neighbours(number_of(part, piece, feature));
  const auto covered_by = [&](int neighbour, const Vec3& at) {
    const Polytope& N = part.pieces[Index(neighbour)];
    return outward.dot(N.vertices[support_vertex(N, outward)]) > outward.dot(at) + 2.0 * noise &&
           holds(N, at, 2.0 * noise);
  };
  const auto is_open = [&](const Vec3& at) {
    return std::none_of(neighbours.begin(), neighbours.end(),
                        [&](int neighbour) { return covered_by(neighbour, at); });
  };
  if (is_open(p)) return true;
  if (margin == 0.0) return false;
  // The nearest places beside p, square to `outward`, that some neighbour no longer covers.
  for (const int neighbour : neighbours) {
    if (!covered_by(neighbour, p)) continue;
    for (const Polytope::Face& plane : part.pieces[Index(neighbour)].faces) {
      const Vec3 aside = plane.normal - outward * outward.dot(plane.normal);
      const double sine = aside.norm();
      const double depth = plane.offset + 3.0 * noise - plane.normal.dot(p);
      if (!(depth <= margin * sine)) continue;
      const Vec3 beside = p + aside * (depth / (sine * sine));
      if (holds(part.pieces[Index(piece)], beside, noise) && is_open(beside)) return true;
    }
  }
  return false;
}

bool is_true_contact(const Part& part_a, int piece_a, const Part& part_b, int piece_b, const Pose& X_AB,
                     const PairDistance& found, double margin) noexcept {
  return allowed_by_neighbours(part_a, piece_a, found.a, found.p_a, -found.normal, margin) &&
         (part_b.true_surface.single_piece() ||
          allowed_by_neighbours(part_b, piece_b, found.b, rotated_back(X_AB.R, found.p_b - X_AB.p),
                                rotated_back(X_AB.R, found.normal), margin));
}

Feature true_feature(const Part& part, int piece, const Feature& feature, const Vec3& p,
                     const Vec3& outward) noexcept {
  if (feature.kind == FeatureKind::kFace || part.true_surface.single_piece() ||
      part.true_surface.neighbours(number_of(part, piece, feature)).empty())
    return feature;
  const Polytope& P = part.pieces[Index(piece)];
  ExposedFace exposed(part, piece, outward);
  if (feature.kind == FeatureKind::kEdge) {
    if (is_true_edge(part, piece, feature.index, feature, p)) return feature;
    exposed.look_at(feature.index);
    return exposed.found_or(feature);
  }
  int edges = 0;
  Feature edge = feature;
  for (const Polytope::Ray& ray : P.rays_at(feature.index))
    if (is_true_edge(part, piece, ray.edge, feature, p)) {
      ++edges;
      edge = {FeatureKind::kEdge, ray.edge};
    }
  if (edges == 1) return edge;
  if (edges > 1) return feature;
  for (const Polytope::Ray& ray : P.rays_at(feature.index)) exposed.look_at(ray.edge);
  return exposed.found_or(feature);
}

Feature same_feature(const Part& part, int of_piece, const Feature& feature, int piece) noexcept {
  if (piece == of_piece) return feature;
  if (part.true_surface.single_piece()) return {feature.kind, -1};
  if (feature.kind == FeatureKind::kVertex) return same_corner(part, of_piece, feature, piece);
  const int group = part.true_surface.group[Index(number_of(part, of_piece, feature))];
  if (group < 0) return {feature.kind, -1};
  const auto members = part.true_surface.members_of(group);
  const auto same = std::lower_bound(members.begin(), members.end(), piece,
                                     [](const TrueSurface::Member& m, int p) { return m.piece < p; });
  return {feature.kind, same != members.end() && same->piece == piece ? same->index : -1};
}

std::optional<PairDistance> depth_on_true_surface(const Part& part_a, int piece_a, const Part& part_b,
                                                  int piece_b, const Pose& X_AB, const PairDistance& found,
                                                  double margin, double beside) noexcept {
  const Polytope& A = part_a.pieces[Index(piece_a)];
  const Polytope& B = part_b.pieces[Index(piece_b)];
  const Pose X_BA = X_AB.inverse();
  std::optional<PairDistance> best;
  const auto take = [&](const PairDistance& candidate) {
    if (is_true_contact(part_a, piece_a, part_b, piece_b, X_AB, candidate, beside)) best = candidate;
  };
  const auto nearer = [&](double distance) { return !best || distance > best->distance; };
  for_true_faces(part_b, piece_b, A, X_BA, vertex_of(A, found.a), [&](int face, int vertex, double distance) {
    const Vec3& normal = B.faces[face].normal;
    const Vec3 foot = X_BA * A.vertices[vertex] - normal * distance;
    if (!nearer(distance) || !in_column(B, face, foot, margin + beside)) return;
    take({.distance = distance,
          .p_a = A.vertices[vertex],
          .p_b = X_AB * foot,
          .normal = X_AB.R * normal,
          .a = {FeatureKind::kVertex, vertex},
          .b = {FeatureKind::kFace, face},
          .stop = Stop::kFallback});
  });
  for_true_faces(part_a, piece_a, B, X_AB, vertex_of(B, found.b), [&](int face, int vertex, double distance) {
    const Vec3& normal = A.faces[face].normal;
    const Vec3 deepest = X_AB * B.vertices[vertex];
    const Vec3 foot = deepest - normal * distance;
    if (!nearer(distance) || !in_column(A, face, foot, margin + beside)) return;
    take({.distance = distance,
          .p_a = foot,
          .p_b = deepest,
          .normal = -normal,
          .a = {FeatureKind::kFace, face},
          .b = {FeatureKind::kVertex, vertex},
          .stop = Stop::kFallback});
  });
  EdgeList edges_a;
  EdgeList edges_b;
  true_edges(part_a, piece_a, edges_a);
  true_edges(part_b, piece_b, edges_b);
  if (edges_a.size() * edges_b.size() > kMostEdgePairs) return best;
  for (const int b : edges_b) {
    const PlacedEdge in_B = placed_edge(B, b);
    const Vec3 tail = X_AB * in_B.tail;
    const Vec3 direction = X_AB.R * in_B.direction;
    const Vec3 left = X_AB.R * in_B.left;
    const Vec3 right = X_AB.R * in_B.right;
    const PlacedEdge in_A{b, tail, direction, left, right, in_B.length};
    for (const int a : edges_a)
      if (const std::optional<PairDistance> crossing = crossing_edges(placed_edge(A, a), in_A);
          crossing && nearer(crossing->distance))
        take(*crossing);
  }
  return best;
}

bool answered_by(const PairView& pair, const PairDistance& found, const Vec3& n, double distance) noexcept {
  const double least = distance - tolerances::kCoplanarMeshOffset * pair.size;
  const Vec3 n_B = pair.X_BA.R * n;
  int a = vertex_of(pair.A, found.a);
  int b = vertex_of(pair.B, found.b);
  double height_a = -n.dot(pair.A.vertices[Index(a)]);
  double height_b = n_B.dot(pair.B.vertices[Index(b)]);
  const double apart = -n.dot(pair.X_AB.p);  // of the origins
  // Climbs to the supports a step at a time: most neighbours prove at the first not to separate the pieces.
  for (;;) {
    if (apart - height_a - height_b < least) return false;
    const int next_a = uphill(pair.A, -n, a, height_a);
    const int next_b = uphill(pair.B, n_B, b, height_b);
    if (next_a == a && next_b == b) return true;
    a = next_a;
    b = next_b;
  }
}

}  // namespace tactum::inline v0_1
