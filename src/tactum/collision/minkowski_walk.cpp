#include "tactum/collision/minkowski_walk.h"

#include <cmath>
#include <limits>

#include "tactum/collision/segments.h"

namespace tactum::inline v0_1 {
namespace {

using Kind = FeatureKind;

/// The arc of an edge of P in the Gauss maps' overlay: P's outward direction turns from `m0` with tangent
/// `t0` toward the normal of `end`, while `vertex` of the other piece Q stays its support.
struct Arc {
  int edge = -1;    // of P
  int end = -1;     // face of P
  int vertex = -1;  // of Q
  Vec3 m0 = Vec3::Zero();
  Vec3 t0 = Vec3::Zero();
};

/// The first event on the arc: P's outward direction there is cosine m0 + sine t0.
struct ArcEnd {
  int edge = -1;  // of Q; -1: the end face
  double cosine = 1.0, sine = 0.0;
};

/// Whether (cosine, sine) comes before the end along an arc. Angles are from 0 to a half circle (a flat
/// piece's), so the earlier one has the larger cotangent; compared without dividing.
bool comes_before(double cosine, double sine, const ArcEnd& end) noexcept {
  return cosine * end.sine > end.cosine * sine;
}

ArcEnd follow_arc(const Polytope& P, const Polytope& Q, const Mat3& R_QP, const Arc& arc,
                  int excluded) noexcept {
  const Vec3& m1 = P.faces[arc.end].normal;
  // Never quite zero: the end of a half circle comes after an event at the start.
  ArcEnd end{-1, arc.m0.dot(m1), std::max(arc.t0.dot(m1), tolerances::kSameArc * tolerances::kSameArc)};
  const Vec3 o0 = -rotated(R_QP, arc.m0);  // Q's outward direction
  const Vec3 o_t = -rotated(R_QP, arc.t0);
  for (const Polytope::Ray& ray : Q.rays_at(arc.vertex)) {
    if (ray.edge == excluded) continue;
    const double below = std::max(0.0, -ray.direction.dot(o0));  // how much lower the far end is, per metre
    const double rising = ray.direction.dot(o_t);
    if (rising <= tolerances::kSameArc && below <= tolerances::kSameArc) continue;  // rolls on the edge
    if (comes_before(rising, below, end)) end = {ray.edge, rising, below};
  }
  if (end.edge >= 0) {
    const double length = std::sqrt(end.cosine * end.cosine + end.sine * end.sine);
    end.cosine /= length;
    end.sine /= length;
  }
  return end;
}

/// Outward direction of N on two crossing arcs, by the edges; `near` decides the sign, and replaces the cross
/// product where the edges are so nearly parallel that it has no digits.
Vec3 crossing_normal(const Vec3& u_a, const Vec3& u_b, const Vec3& near) noexcept {
  const Vec3 c = u_a.cross(u_b);
  const double sine = c.norm();
  if (sine < tolerances::kParallelSine) return near;
  return c.dot(near) < 0.0 ? Vec3(-c / sine) : Vec3(c / sine);
}

MinkowskiFacet edge_facet(const PairView& pair, int edge_a, int edge_b, const Vec3& near) noexcept {
  const Polytope::Edge& ea = pair.A.edges[edge_a];
  const Polytope::Edge& eb = pair.B.edges[edge_b];
  MinkowskiFacet facet;
  facet.a = {Kind::kEdge, edge_a};
  facet.b = {Kind::kEdge, edge_b};
  facet.n = crossing_normal(ea.direction, rotated(pair.X_AB.R, eb.direction), near);
  facet.height = facet.n.dot(pair.vertex_b(eb.tail) - pair.vertex_a(ea.tail));
  return facet;
}

/// The arc that leads across a border of a facet: of an edge of A (`on_a`) or of B. The other piece's edge
/// `excluded` ends where the arc begins and is not met.
struct Passage {
  Arc arc;
  bool on_a = true;
  int excluded = -1;
};

ArcEnd end_of(const PairView& pair, const Passage& passage) noexcept {
  return passage.on_a ? follow_arc(pair.A, pair.B, pair.X_BA.R, passage.arc, passage.excluded)
                      : follow_arc(pair.B, pair.A, pair.X_AB.R, passage.arc, passage.excluded);
}

/// The facet of N at the passage's end.
MinkowskiFacet facet_at(const PairView& pair, const Passage& passage, const ArcEnd& end) noexcept {
  const Arc& arc = passage.arc;
  if (end.edge < 0) return facet_of_face(pair, passage.on_a, arc.end, arc.vertex);
  const Vec3 m = arc.m0 * end.cosine + arc.t0 * end.sine;
  return passage.on_a ? edge_facet(pair, arc.edge, end.edge, -m)
                      : edge_facet(pair, end.edge, arc.edge, rotated(pair.X_AB.R, m));
}

MinkowskiFacet facet_behind(const PairView& pair, const Passage& passage) noexcept {
  return facet_at(pair, passage, end_of(pair, passage));
}

/// A border of a facet that the target point lies beyond, and how far.
struct Crossing {
  double outside = 0.0;
  int slot = -1;        // face facets: the side plane
  bool on_a = true;     // edge facets: whose edge ends there
  bool at_tail = true;  // ... and at which end
};

/// The two worst borders among those with less than `cap` outside.
struct Worst {
  double cap;
  Crossing first{-std::numeric_limits<double>::infinity()};
  Crossing second{-std::numeric_limits<double>::infinity()};

  void consider(const Crossing& next) noexcept {
    if (!(next.outside < cap)) return;
    if (next.outside > first.outside) {
      second = first;
      first = next;
    } else if (next.outside > second.outside) {
      second = next;
    }
  }
};

Worst worst_side(const Polytope& P, int face_index, const Vec3& point, double cap) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  Worst worst{cap};
  // Local numbers, chosen without branches: which sides are worst is hard to predict.
  double first = worst.first.outside;
  double second = first;
  int first_slot = -1;
  int second_slot = -1;
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const double out = P.sides[slot].normal.dot(point) - P.sides[slot].offset;
    const bool counts = out < cap;
    const bool is_first = counts && out > first;
    const bool is_second = counts && out > second;
    second = is_first ? first : is_second ? out : second;
    second_slot = is_first ? first_slot : is_second ? slot : second_slot;
    first = is_first ? out : first;
    first_slot = is_first ? slot : first_slot;
  }
  worst.first = {first, first_slot};
  worst.second = {second, second_slot};
  return worst;
}

/// Puts the witness points (p_b - p_a = target) on the features and returns the worst borders they are
/// beyond, of those with less than `cap` outside.
Worst place(const PairView& pair, const MinkowskiFacet& facet, const Vec3& target, double cap,
            MinkowskiWalk& walk) noexcept {
  if (facet.a.kind == Kind::kFace) {
    walk.p_b = pair.vertex_b(facet.b.index);
    walk.p_a = walk.p_b - target;
    return worst_side(pair.A, facet.a.index, walk.p_a, cap);
  }
  if (facet.b.kind == Kind::kFace) {
    walk.p_a = pair.vertex_a(facet.a.index);
    walk.p_b = walk.p_a + target;
    return worst_side(pair.B, facet.b.index, pair.X_BA * walk.p_b, cap);
  }
  const Polytope::Edge& ea = pair.A.edges[facet.a.index];
  const Polytope::Edge& eb = pair.B.edges[facet.b.index];
  const Vec3& a0 = pair.vertex_a(ea.tail);
  const Vec3 b0 = pair.vertex_b(eb.tail);
  const Vec3 u_b = rotated(pair.X_AB.R, eb.direction);
  double s = 0.0;
  double t = 0.0;
  const Vec3 r = b0 - target - a0;
  if (!nearest_on_lines(ea.direction, u_b, r, ea.direction.cross(u_b), tolerances::kSameArc, s, t)) {
    s = std::clamp(ea.direction.dot(b0 - target - a0), 0.0, ea.length);
    t = u_b.dot(a0 + ea.direction * s - b0 + target);
    walk.outside =
        (b0 + u_b * t - a0 - ea.direction * s - target).norm();  // no facet: the lines run side by side
  }
  walk.p_a = a0 + ea.direction * s;
  walk.p_b = b0 + u_b * t;
  Worst worst{cap};
  worst.consider({-s, -1, true, true});
  worst.consider({s - ea.length, -1, true, false});
  worst.consider({-t, -1, false, true});
  worst.consider({t - eb.length, -1, false, false});
  return worst;
}

Passage across_face_border(const PairView& pair, const MinkowskiFacet& facet, int slot) noexcept {
  Passage passage;
  passage.on_a = facet.a.kind == Kind::kFace;
  const Polytope& P = passage.on_a ? pair.A : pair.B;
  const int face = passage.on_a ? facet.a.index : facet.b.index;
  Arc& arc = passage.arc;
  arc.edge = P.sides[slot].edge;
  arc.end = P.sides[slot].across;
  arc.vertex = passage.on_a ? facet.b.index : facet.a.index;
  arc.m0 = P.faces[face].normal;
  arc.t0 = P.sides[slot].normal;
  return passage;
}

/// Beyond an end of one edge, that end is the vertex and the *other* edge's arc is followed, in the direction
/// in which the end becomes the support.
Passage across_edge_border(const PairView& pair, const MinkowskiFacet& facet,
                           const Crossing& crossing) noexcept {
  const Polytope& P = crossing.on_a ? pair.B : pair.A;  // whose arc is followed
  const Polytope& Q = crossing.on_a ? pair.A : pair.B;
  const int followed = crossing.on_a ? facet.b.index : facet.a.index;
  const int ended = crossing.on_a ? facet.a.index : facet.b.index;
  const Polytope::Edge& edge = P.edges[followed];
  const Polytope::Edge& other = Q.edges[ended];
  Passage passage;
  passage.on_a = !crossing.on_a;
  passage.excluded = ended;
  Arc& arc = passage.arc;
  arc.edge = followed;
  arc.vertex = crossing.at_tail ? other.tail : other.head;
  arc.m0 = crossing.on_a ? Vec3(rotated(pair.X_BA.R, facet.n)) : Vec3(-facet.n);
  arc.t0 = edge.direction.cross(arc.m0);
  // Q's outward direction turns by -t0; the end must rise over the other end.
  const Vec3 u_P = rotated(crossing.on_a ? pair.X_BA.R : pair.X_AB.R, other.direction);
  const double toward_head = -arc.t0.dot(u_P);
  const bool backward = (toward_head > 0.0) == crossing.at_tail;
  if (backward) arc.t0 = -arc.t0;
  arc.end =
      backward ? edge.left : edge.right;  // about +direction an arc turns from the left face to the right
  return passage;
}

Passage across(const PairView& pair, const MinkowskiFacet& facet, const Crossing& crossing) noexcept {
  const bool edges = facet.a.kind == Kind::kEdge && facet.b.kind == Kind::kEdge;
  return edges ? across_edge_border(pair, facet, crossing) : across_face_border(pair, facet, crossing.slot);
}

/// The distance square to the border, of the foot that is `inside` of it as measured by place(): for two
/// edges that is along one of them, not square to the other.
double square_to_border(const PairView& pair, const MinkowskiFacet& facet, double inside) noexcept {
  if (facet.a.kind != Kind::kEdge || facet.b.kind != Kind::kEdge) return inside;
  const double along =
      pair.A.edges[facet.a.index].direction.dot(rotated(pair.X_AB.R, pair.B.edges[facet.b.index].direction));
  return inside * std::sqrt(std::max(0.0, 1.0 - along * along));
}

/// The quantity that the walk reduces: the height of a facet's plane, or the length of the ray to it.
struct Measure {
  const Vec3* ray;  // null: the foot

  double operator()(const MinkowskiFacet& f) const noexcept {
    if (!ray) return f.height;
    const double across = f.n.dot(*ray);
    return across > 0.0 ? f.height / across : std::numeric_limits<double>::infinity();
  }
  Vec3 target(const MinkowskiFacet& f) const noexcept { return (ray ? *ray : f.n) * (*this)(f); }
};

/// Whether to go across the worst border, or where rounding has bent the facets the next worst, whose plane
/// is not farther.
bool leads_outward(const PairView& pair, const Measure& measure, Crossing crossing, double limit,
                   double crossing_tolerance, const MinkowskiFacet& from, MinkowskiFacet& next) noexcept {
  const Vec3 target = measure.target(from);
  MinkowskiWalk again;
  while (crossing.outside > crossing_tolerance) {
    next = facet_behind(pair, across(pair, from, crossing));
    if (measure(next) <= limit) return true;
    crossing = place(pair, from, target, crossing.outside, again).first;
  }
  return false;
}

/// Whether to go on although the foot is inside: the nearest borders may still have a lower facet behind
/// them: two local minima side by side, of which the walk takes the better. Seen along the common ridge, a
/// foot at depth d and `inside` from a ridge where the planes turn by alpha is at depth d cos alpha + inside
/// sin alpha under the other.
bool leads_past_ridge(const PairView& pair, const Worst& nearest, double level, const MinkowskiFacet& from,
                      MinkowskiFacet& next) noexcept {
  const double d = from.height;
  const double limit = d - level;
  for (const Crossing* border : {&nearest.first, &nearest.second}) {
    if (!(-border->outside < d)) return false;
    const Passage passage = across(pair, from, *border);
    const double inside = square_to_border(pair, from, -border->outside);
    const Vec3& end_normal = (passage.on_a ? pair.A : pair.B).faces[passage.arc.end].normal;
    const double farthest = passage.arc.m0.dot(end_normal);  // no arc turns more: alpha at most
    if (inside * inside * (1.0 + farthest) >= d * d * (1.0 - farthest)) continue;
    const ArcEnd end = end_of(pair, passage);
    if (d * end.cosine + inside * end.sine >= limit) continue;
    next = facet_at(pair, passage, end);
    if (next.height < limit) return true;
  }
  return false;
}

/// No bound on the moves but the walk's own.
constexpr int kAllMoves = std::numeric_limits<int>::max();

/// `ray`: to where it leaves N; null: to a foot. `past_ridges`: goes on from a foot to one that is lower
/// behind a border. Most walks end where they begin, and have copied no feet.
MinkowskiWalk walk(const PairView& pair, const MinkowskiFacet& start, const Vec3* ray, bool past_ridges,
                   int most_moves) noexcept {
  constexpr int kLevelSteps = 16;  // between facets of one plane, without improvement
  const Measure measure{ray};
  const double crossing_tolerance = tolerances::kVoronoiTolerance * pair.scale;
  const double level = tolerances::kCoplanar * pair.scale;  // facets of one plane, by rounding this far apart
  const int bound = 32 + static_cast<int>(pair.A.edges.size() + pair.B.edges.size()) / 2;
  const auto place_feet = [&](MinkowskiWalk& at) {
    at.outside = 0.0;
    const Worst worst =
        place(pair, at.facet, measure.target(at.facet), std::numeric_limits<double>::infinity(), at);
    at.outside = std::max(at.outside, worst.first.outside);
    return worst;
  };
  MinkowskiWalk best;
  best.facet = start;
  Worst worst = place_feet(best);
  MinkowskiWalk here;               // from the first move on
  const MinkowskiWalk* on = &best;  // the walk's present facet: the start, then `here`
  MinkowskiFacet next;
  int improved = 1;
  for (int step = 1; step <= bound && step - improved <= kLevelSteps; ++step) {
    if (step > 1) {
      here.facet = next;
      worst = place_feet(here);
      on = &here;
      const double longer = measure(here.facet) - measure(best.facet);
      if (longer < -level || (longer < level && here.outside < best.outside)) {
        best = here;
        improved = step;
      }
    }
    best.steps = step;
    if (step > most_moves) {  // the next walk goes on from there; it is not above the best
      best = *on;
      best.steps = step;
      break;
    }
    const bool inside = on->outside <= crossing_tolerance;
    const bool leads_on = inside ? past_ridges && leads_past_ridge(pair, worst, level, on->facet, next)
                                 : leads_outward(pair, measure, worst.first, measure(best.facet) + level,
                                                 crossing_tolerance, on->facet, next);
    if (!leads_on) {
      best.settled = true;
      break;
    }
  }
  return best;
}

/// The face at `vertex` whose normal is most along `d`, and the projection. It is a face at the vertex even
/// where `d` is not a number.
int aligned_face(const Polytope& P, int vertex, const Vec3& d, double& along) noexcept {
  int best = -1;
  along = -std::numeric_limits<double>::infinity();
  for (const Polytope::Ray& ray : P.rays_at(vertex)) {
    const Polytope::Edge& edge = P.edges[ray.edge];
    const int face = edge.tail == vertex ? edge.left : edge.right;  // each face once
    if (const double cosine = P.faces[face].normal.dot(d); best < 0 || cosine > along) {
      along = cosine;
      best = face;
    }
  }
  return best;
}

/// The better of the best aligned faces at vertices `a` and `b`; `n_B`: the direction in B's frame.
MinkowskiFacet aligned_facet(const PairView& pair, const Vec3& n, const Vec3& n_B, int a, int b) noexcept {
  double along_a = 0.0;
  double along_b = 0.0;
  const int face_a = aligned_face(pair.A, a, -n, along_a);
  const int face_b = aligned_face(pair.B, b, n_B, along_b);
  return along_a >= along_b ? facet_of_face(pair, true, face_a, b) : facet_of_face(pair, false, face_b, a);
}

}  // namespace

MinkowskiFacet facet_of_face(const PairView& pair, bool on_a, int face, int vertex) noexcept {
  MinkowskiFacet facet;
  if (on_a) {
    const Polytope::Face& f = pair.A.faces[face];
    vertex = support_vertex(pair.B, -(rotated(pair.X_BA.R, f.normal)), vertex);
    facet.a = {Kind::kFace, face};
    facet.b = {Kind::kVertex, vertex};
    facet.n = -f.normal;
    facet.height = f.offset - f.normal.dot(pair.vertex_b(vertex));
  } else {
    const Polytope::Face& f = pair.B.faces[face];
    facet.n = rotated(pair.X_AB.R, f.normal);
    vertex = support_vertex(pair.A, -facet.n, vertex);
    facet.a = {Kind::kVertex, vertex};
    facet.b = {Kind::kFace, face};
    facet.height = f.offset - f.normal.dot(pair.X_BA * pair.vertex_a(vertex));
  }
  return facet;
}

bool facet_of_edges(const PairView& pair, int edge_a, int edge_b, MinkowskiFacet& facet) noexcept {
  const Polytope::Edge& ea = pair.A.edges[edge_a];
  const Polytope::Edge& eb = pair.B.edges[edge_b];
  const Vec3 c = ea.direction.cross(rotated(pair.X_AB.R, eb.direction));
  const double a_left = pair.A.sides[ea.left_slot].normal.dot(c);
  const double a_right = pair.A.sides[ea.right_slot].normal.dot(c);
  if (a_left * a_right < 0.0) return false;
  const Vec3 c_B = rotated(pair.X_BA.R, c);
  const double b_left = pair.B.sides[eb.left_slot].normal.dot(c_B);
  const double b_right = pair.B.sides[eb.right_slot].normal.dot(c_B);
  // The normal cone of an edge is outside both its side planes; A's and B's outward directions are opposite.
  if (b_left * b_right < 0.0 || (a_left + a_right) * (b_left + b_right) >= 0.0) return false;
  if (c.squaredNorm() < tolerances::kParallelSine * tolerances::kParallelSine) return false;
  facet = edge_facet(pair, edge_a, edge_b, b_left + b_right > 0.0 ? c : Vec3(-c));
  return true;
}

MinkowskiFacet facet_near(const PairView& pair, const Vec3& n, int from_a, int from_b) noexcept {
  const Vec3 n_B = rotated(pair.X_BA.R, n);
  return aligned_facet(pair, n, n_B, support_vertex(pair.A, -n, from_a), support_vertex(pair.B, n_B, from_b));
}

MinkowskiFacet facet_near(const PairView& pair, const Vec3& n) noexcept {
  const Vec3 n_B = rotated(pair.X_BA.R, n);
  return aligned_facet(pair, n, n_B, support_vertex(pair.A, -n), support_vertex(pair.B, n_B));
}

MinkowskiFacet facet_toward(const PairView& pair, const Vec3& n) noexcept {
  const Vec3 n_B = rotated(pair.X_BA.R, n);
  return aligned_facet(pair, n, n_B, table_vertex(pair.A, -n), table_vertex(pair.B, n_B));
}

bool is_real(const PairView& pair, const MinkowskiFacet& facet) noexcept {
  if (facet.a.kind != Kind::kEdge || facet.b.kind != Kind::kEdge) return true;
  const Polytope::Edge& ea = pair.A.edges[facet.a.index];
  const Polytope::Edge& eb = pair.B.edges[facet.b.index];
  const Vec3 n_B = rotated(pair.X_BA.R, facet.n);
  return pair.A.sides[ea.left_slot].normal.dot(facet.n) <= 0.0 &&
         pair.A.sides[ea.right_slot].normal.dot(facet.n) <= 0.0 &&
         pair.B.sides[eb.left_slot].normal.dot(n_B) >= 0.0 &&
         pair.B.sides[eb.right_slot].normal.dot(n_B) >= 0.0;
}

MinkowskiWalk stand_on(const PairView& pair, const MinkowskiFacet& facet) noexcept {
  MinkowskiWalk here;
  here.facet = facet;
  const Worst worst =
      place(pair, facet, facet.n * facet.height, std::numeric_limits<double>::infinity(), here);
  here.outside = std::max(here.outside, worst.first.outside);
  here.steps = 1;
  return here;
}

MinkowskiWalk walk_to_foot(const PairView& pair, const MinkowskiFacet& start) noexcept {
  return walk(pair, start, nullptr, true, kAllMoves);
}

MinkowskiWalk walk_to_any_foot(const PairView& pair, const MinkowskiFacet& start, int most_moves) noexcept {
  return walk(pair, start, nullptr, false, most_moves);
}

MinkowskiWalk walk_along_ray(const PairView& pair, const MinkowskiFacet& start,
                             const Vec3& direction) noexcept {
  return walk(pair, start, &direction, false, kAllMoves);
}

}  // namespace tactum::inline v0_1
