#include "tactum/collision/voronoi_march.h"

#include <cmath>

#include "tactum/collision/segments.h"

namespace tactum {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One step as seen from the piece P that owns the feature of lower dimension; Q is the other. `swapped`: P
/// is B.
template <bool swapped>
struct Sides {
  const Polytope& P;
  const Polytope& Q;
  const Pose& X_AB;
  double slack;

  explicit Sides(const PiecePair& pair, double crossing_slack) noexcept
      : P(swapped ? pair.B : pair.A), Q(swapped ? pair.A : pair.B), X_AB(pair.X_AB), slack(crossing_slack) {}

  /// A point of P, in Q's frame.
  Vec3 in_Q(const Vec3& p) const noexcept { return swapped ? X_AB * p : rotated_back(X_AB.R, p - X_AB.p); }
  /// A point of Q, in P's frame.
  Vec3 in_P(const Vec3& q) const noexcept { return swapped ? rotated_back(X_AB.R, q - X_AB.p) : X_AB * q; }
  Vec3 turned_to_Q(const Vec3& d) const noexcept {
    return swapped ? rotated(X_AB.R, d) : rotated_back(X_AB.R, d);
  }
  Vec3 turned_to_P(const Vec3& d) const noexcept {
    return swapped ? rotated_back(X_AB.R, d) : rotated(X_AB.R, d);
  }
};

enum class Step : std::uint8_t { kClosest, kMoved, kOverlap, kBehind };

/// Where a step stands: the closest points of its two features, each in its own piece's frame, and at the end
/// of the walk what it proves.
struct Place {
  double gap = kInfinity;    // the points' distance; infinite where the step does not know them
  double doubt = kInfinity;  // of the lower bound on the distance
  Vec3 p, q;                 // in P's and Q's frame, when the gap is known
  Vec3 outward_P;            // unit normal from P to Q, in P's frame, when the doubt is known
  Vec3 outward_Q;            // the same in Q's frame
};

/// How far beyond a plane through `v` the piece may reach when the steepest of the edges at `v` rises by
/// `slope` over it (sine). A point of the piece is v + sum c_i u_i, c_i >= 0 over the edges at v, and the sum
/// of the c_i is at most its distance from v over the least cosine between an edge and their mean.
double reach_beyond(const Polytope& P, int v, double slope) noexcept {
  if (slope <= 0.0) return 0.0;
  Vec3 mean = Vec3::Zero();
  for (const Polytope::Ray& ray : P.rays_at(v)) mean += ray.direction;
  double least = kInfinity;
  for (const Polytope::Ray& ray : P.rays_at(v)) least = std::min(least, ray.direction.dot(mean));
  return least > 0.0 ? slope * P.size * mean.norm() / least : kInfinity;
}

/// The same at an edge whose steeper face rises by `slope`: the piece lies in the wedge of its two faces.
double reach_beyond(const Polytope& P, const Polytope::Edge& edge, double slope) noexcept {
  if (slope <= 0.0) return 0.0;
  const double cosine = P.sides[edge.left_slot].normal.dot(P.sides[edge.right_slot].normal);
  return cosine > -1.0 ? slope * P.size * std::sqrt(2.0 / (1.0 + cosine)) : kInfinity;
}

/// The edge at a vertex that rises most along a direction.
struct Steepest {
  int edge = -1;
  double slope = -kInfinity;
};

Steepest steepest_edge(const Polytope& P, int v, const Vec3& d) noexcept {
  Steepest best;
  for (const Polytope::Ray& ray : P.rays_at(v))
    if (const double slope = ray.direction.dot(d); slope > best.slope) best = {ray.edge, slope};
  return best;
}

Step to_edge(Feature& f, int edge) noexcept {
  f = {FeatureKind::kEdge, edge};
  return Step::kMoved;
}

Step to_face(Feature& f, int face) noexcept {
  f = {FeatureKind::kFace, face};
  return Step::kMoved;
}

/// The unit vector of the points' difference `d_Q` (from p to q); no doubt is told where it has no direction.
bool set_normal(double size, const Vec3& d_Q, const Vec3& d_P, Place& x) noexcept {
  if (x.gap <= tolerances::kTouching * size) return false;
  x.outward_Q = d_Q / x.gap;
  x.outward_P = d_P / x.gap;
  return true;
}

template <bool swapped>
Step vertex_vertex(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  x.p = S.P.vertices[fp.index];
  x.q = S.Q.vertices[fq.index];
  const Vec3 d_Q = x.q - S.in_Q(x.p);
  const Vec3 d_P = S.turned_to_P(d_Q);
  x.gap = d_Q.norm();
  const Steepest at_p = steepest_edge(S.P, fp.index, d_P);
  if (at_p.slope > S.slack) return to_edge(fp, at_p.edge);
  const Steepest at_q = steepest_edge(S.Q, fq.index, -d_Q);
  if (at_q.slope > S.slack) return to_edge(fq, at_q.edge);
  if (set_normal(S.P.size, d_Q, d_P, x))
    x.doubt =
        reach_beyond(S.P, fp.index, at_p.slope / x.gap) + reach_beyond(S.Q, fq.index, at_q.slope / x.gap);
  return Step::kClosest;
}

template <bool swapped>
Step vertex_edge(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  x.p = S.P.vertices[fp.index];
  const Polytope::Edge& edge = S.Q.edges[fq.index];
  const Vec3& tail = S.Q.vertices[edge.tail];
  const Vec3 p_Q = S.in_Q(x.p);
  const double along = edge.direction.dot(p_Q - tail);
  x.q = tail + edge.direction * std::clamp(along, 0.0, edge.length);
  const Vec3 d_Q = x.q - p_Q;
  x.gap = d_Q.norm();
  if (along < -S.slack || along > edge.length + S.slack) {
    fq = {FeatureKind::kVertex, along < 0.0 ? edge.tail : edge.head};
    return Step::kMoved;
  }
  const Polytope::Side& left = S.Q.sides[edge.left_slot];
  const Polytope::Side& right = S.Q.sides[edge.right_slot];
  const double above_left = left.normal.dot(p_Q) - left.offset;
  const double above_right = right.normal.dot(p_Q) - right.offset;
  if (std::min(above_left, above_right) < -S.slack)
    return to_face(fq, above_left < above_right ? edge.left : edge.right);
  const Vec3 d_P = S.turned_to_P(d_Q);
  const Steepest at_p = steepest_edge(S.P, fp.index, d_P);
  if (at_p.slope > S.slack) return to_edge(fp, at_p.edge);
  // The normal itself is judged: over a small gap it is off by more than the point is.
  const double rise = std::max(left.normal.dot(d_Q), right.normal.dot(d_Q));
  if (set_normal(S.P.size, d_Q, d_P, x))
    x.doubt = reach_beyond(S.P, fp.index, at_p.slope / x.gap) + reach_beyond(S.Q, edge, rise / x.gap) +
              std::abs(edge.direction.dot(x.outward_Q)) * edge.length;
  return Step::kClosest;
}

/// The slot of the side plane that `p` is farthest outside of, beyond `slack`; -1 inside the face's column.
int slot_outside(const Polytope& Q, const Polytope::Face& face, const Vec3& p, double slack) noexcept {
  int best = -1;
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const double out = Q.sides[slot].normal.dot(p) - Q.sides[slot].offset;
    if (out > slack) {
      slack = out;
      best = slot;
    }
  }
  return best;
}

template <bool swapped>
Step vertex_face(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  x.p = S.P.vertices[fp.index];
  const Polytope::Face& face = S.Q.faces[fq.index];
  const Vec3 p_Q = S.in_Q(x.p);
  if (const int slot = slot_outside(S.Q, face, p_Q, S.slack); slot >= 0)
    return to_edge(fq, S.Q.face_edges[slot]);
  const double height = face.normal.dot(p_Q) - face.offset;
  if (height < -S.slack) {
    if (!S.Q.flat) return Step::kBehind;
    return to_face(fq, 1 - fq.index);
  }
  x.q = p_Q - face.normal * height;
  x.gap = std::abs(height);
  x.outward_Q = -face.normal;
  x.outward_P = S.turned_to_P(x.outward_Q);
  const Steepest at_p = steepest_edge(S.P, fp.index, x.outward_P);
  if (at_p.slope > tolerances::kVoronoiSlack) return to_edge(fp, at_p.edge);
  x.doubt = reach_beyond(S.P, fp.index, at_p.slope);
  return Step::kClosest;
}

/// A segment's end as its vertex, when the closest point is there.
bool at_end(const Polytope::Edge& edge, double s, Feature& f) noexcept {
  if (s > 0.0 && s < edge.length) return false;
  f = {FeatureKind::kVertex, s > 0.0 ? edge.head : edge.tail};
  return true;
}

/// The face at `edge` toward whose column a direction from the edge leads most, and how much it leads there
/// (sine; negative when it leads away from both).
struct Toward {
  int face = -1;
  double slope = 0.0;
};

Toward face_toward(const Polytope& P, const Polytope::Edge& edge, const Vec3& d) noexcept {
  const double left = P.sides[edge.left_slot].normal.dot(d);
  const double right = P.sides[edge.right_slot].normal.dot(d);
  return left < right ? Toward{edge.left, -left} : Toward{edge.right, -right};
}

/// The unit direction from edge to edge and its angular error: the points' difference `d`, or the cross
/// product `c` of the edges where it has more digits.
struct Across {
  Vec3 direction;
  double slack;
  double aside;  // of the points, from the direction [m]
};

Across across_edges(double size, double slack, const Vec3& c, const Vec3& d, double gap) noexcept {
  const double sine_sq = c.squaredNorm();
  if (gap * gap >= sine_sq * size * size)
    return gap > 0.0 ? Across{d / gap, slack / gap, 0.0} : Across{d, 0.0, 0.0};
  const double sine = std::sqrt(sine_sq);
  const Vec3 direction = c.dot(d) < 0.0 ? Vec3(-c / sine) : Vec3(c / sine);
  return {direction, std::max(slack / size, tolerances::kVoronoiSlack) / sine, (d - direction * gap).norm()};
}

template <bool swapped>
Step edge_edge(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  const Polytope::Edge& e = S.P.edges[fp.index];
  const Polytope::Edge& g = S.Q.edges[fq.index];
  const Vec3& p0 = S.P.vertices[e.tail];
  const Vec3& g_tail = S.Q.vertices[g.tail];
  const Vec3 w = S.turned_to_P(g.direction);
  const Vec3 c = e.direction.cross(w);
  const Vec3 r = S.in_P(g_tail) - p0;
  const SegmentPair at = nearest_on_segments(e.direction, e.length, w, g.length, r, c);
  x.p = p0 + e.direction * at.s;
  x.q = g_tail + g.direction * at.t;
  const Vec3 d = r + w * at.t - e.direction * at.s;
  x.gap = d.norm();
  const bool p_end = at_end(e, at.s, fp);
  const bool q_end = at_end(g, at.t, fq);
  if (p_end || q_end) return Step::kMoved;
  const Across across = across_edges(S.P.size, S.slack, c, d, x.gap);
  const Toward of_p = face_toward(S.P, e, across.direction);
  if (of_p.slope > across.slack) return to_face(fp, of_p.face);
  x.outward_P = across.direction;
  x.outward_Q = S.turned_to_Q(across.direction);
  const Toward of_q = face_toward(S.Q, g, -x.outward_Q);
  if (of_q.slope > across.slack) return to_face(fq, of_q.face);
  x.doubt = reach_beyond(S.P, e, of_p.slope) + reach_beyond(S.Q, g, of_q.slope) +
            std::abs(e.direction.dot(across.direction)) * e.length +
            std::abs(w.dot(across.direction)) * g.length + across.aside;
  return Step::kClosest;
}

/// The edge of a face nearest to a segment that lies wholly outside the face's column.
int nearest_edge(const Polytope& Q, const Polytope::Face& face, const Vec3& p0, const Vec3& u,
                 double length) noexcept {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const Polytope::Edge& g = Q.edges[Q.face_edges[slot]];
    const Vec3& q0 = Q.vertices[g.tail];
    const SegmentPair at =
        nearest_on_segments(u, length, g.direction, g.length, q0 - p0, u.cross(g.direction));
    const double gap = (p0 + u * at.s - q0 - g.direction * at.t).squaredNorm();
    if (gap < least) {
      least = gap;
      best = Q.face_edges[slot];
    }
  }
  return best;
}

/// The part of an edge inside a face's column, and the slots of the planes that cut it (-1: its own end).
struct Clip {
  double low = 0.0, high = 0.0;
  int low_slot = -1, high_slot = -1;
  bool empty = false;
};

Clip clip_to_column(const Polytope& Q, const Polytope::Face& face, const Vec3& p0, const Vec3& u,
                    double length, double slack) noexcept {
  Clip clip;
  clip.high = length;
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const double along = Q.sides[slot].normal.dot(u);
    const double room = Q.sides[slot].offset - Q.sides[slot].normal.dot(p0);
    if (std::abs(along) < tolerances::kVoronoiSlack) {
      clip.empty |= room < -slack;
    } else if (along > 0.0 && room < clip.high * along) {
      clip.high = room / along;
      clip.high_slot = slot;
    } else if (along < 0.0 && room < clip.low * along) {
      clip.low = room / along;
      clip.low_slot = slot;
    }
  }
  clip.empty |= clip.low > clip.high;
  return clip;
}

/// P has the edge, Q the face. Never the end of the walk: the nearer end of the clipped edge is a vertex or
/// on an edge.
template <bool swapped>
Step edge_face(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  const Polytope::Edge& e = S.P.edges[fp.index];
  const Polytope::Face& face = S.Q.faces[fq.index];
  const Vec3 p0 = S.in_Q(S.P.vertices[e.tail]);
  const Vec3 u = S.turned_to_Q(e.direction);
  const Clip clip = clip_to_column(S.Q, face, p0, u, e.length, S.slack);
  if (clip.empty) return to_edge(fq, nearest_edge(S.Q, face, p0, u, e.length));
  const double low = face.normal.dot(p0 + u * clip.low) - face.offset;
  const double high = face.normal.dot(p0 + u * clip.high) - face.offset;
  if (std::min(low, high) < -S.slack && std::max(low, high) > S.slack) {
    const double at = clip.low + (clip.high - clip.low) * low / (low - high);
    x.p = S.P.vertices[e.tail] + e.direction * at;
    x.q = p0 + u * at;
    x.gap = 0.0;
    return Step::kOverlap;
  }
  const bool take_low = std::abs(low) <= std::abs(high);
  const int slot = take_low ? clip.low_slot : clip.high_slot;
  if (slot >= 0) return to_edge(fq, S.Q.face_edges[slot]);
  fp = {FeatureKind::kVertex, take_low ? e.tail : e.head};
  return Step::kMoved;
}

/// Dispatch on the kinds, P owning the lower one.
template <bool swapped>
Step step(const Sides<swapped>& S, Feature& fp, Feature& fq, Place& x) noexcept {
  if (fp.kind == FeatureKind::kVertex) {
    if (fq.kind == FeatureKind::kFace) return vertex_face(S, fp, fq, x);
    return fq.kind == FeatureKind::kEdge ? vertex_edge(S, fp, fq, x) : vertex_vertex(S, fp, fq, x);
  }
  return fq.kind == FeatureKind::kEdge ? edge_edge(S, fp, fq, x) : edge_face(S, fp, fq, x);
}

MarchEnd end_of(Step outcome) noexcept {
  if (outcome == Step::kClosest) return MarchEnd::kClosest;
  return outcome == Step::kOverlap ? MarchEnd::kOverlap : MarchEnd::kBehind;
}

/// The place in A's frame. `swapped`: P is B.
void tell(const PiecePair& pair, const Place& at, bool swapped, PairDistance& x) noexcept {
  x.p_a = swapped ? at.q : at.p;
  if (at.doubt < kInfinity) {
    x.normal = swapped ? at.outward_Q : Vec3(-at.outward_P);
    x.p_b = x.p_a - x.normal * at.gap;
  } else {
    x.normal.setZero();
    x.p_b = pair.X_AB * (swapped ? at.p : at.q);
  }
  x.distance = at.gap;
}

/// One step from the features `a`, `b`, which it changes. True in `swapped` when P was B.
Step walk_on(const PiecePair& pair, double slack, Feature& a, Feature& b, bool& swapped, Place& at) noexcept {
  swapped = a.kind > b.kind;
  return swapped ? step(Sides<true>(pair, slack), b, a, at) : step(Sides<false>(pair, slack), a, b, at);
}

/// What follows a first step that moved on from points `least` apart, told in `x`. Keeps the nearest place,
/// in case the walk does not end well, and a state to be met again if it goes in circles [Brent 1980].
March wander(const PiecePair& pair, double slack, Feature a, Feature b, double least,
             PairDistance& x) noexcept {
  const int bound = 64 + static_cast<int>(pair.A.edges.size() + pair.B.edges.size()) / 4;
  Feature mark_a;
  Feature mark_b;
  int next_mark = 8;
  March march;
  march.steps = 1;
  while (march.steps < bound) {
    const Feature was_a = a;
    const Feature was_b = b;
    bool swapped = false;
    Place at;
    const Step outcome = walk_on(pair, slack, a, b, swapped, at);
    ++march.steps;
    if (at.gap < least || outcome != Step::kMoved) {
      least = at.gap;
      x.a = was_a;
      x.b = was_b;
      if (at.gap < kInfinity) tell(pair, at, swapped, x);
    }
    if (outcome != Step::kMoved) {
      march.end = end_of(outcome);
      march.doubt = at.doubt;
      return march;
    }
    if (a == mark_a && b == mark_b) {
      march.end = MarchEnd::kCircle;
      return march;
    }
    if (march.steps == next_mark) {
      mark_a = a;
      mark_b = b;
      next_mark *= 2;
    }
  }
  return march;
}

}  // namespace

March voronoi_march(const PiecePair& pair, Feature a, Feature b, double slack, PairDistance& x) noexcept {
  if (a.kind == FeatureKind::kFace && b.kind == FeatureKind::kFace)
    b = {FeatureKind::kVertex, vertex_of(pair.B, b)};
  x.a = a;
  x.b = b;
  bool swapped = false;
  Place at;
  const Step outcome = walk_on(pair, slack, a, b, swapped, at);
  if (at.gap < kInfinity) tell(pair, at, swapped, x);
  if (outcome == Step::kMoved) return wander(pair, slack, a, b, at.gap, x);
  return {at.doubt, end_of(outcome), 1};
}

}  // namespace tactum
