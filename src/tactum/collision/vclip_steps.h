#pragma once
/// The steps of the walk of vclip.h, inline: under haptic motion nearly every query is one step, and calls
/// and copies of answers around it would take half of its time.

#include <cmath>
#include <limits>

#include "tactum/collision/feature_walk.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1::vclip {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One step as seen from the piece P that owns the feature of lower dimension; Q is the other. `Swapped`: P
/// is B.
template <bool Swapped>
struct Sides {
  const Polytope& P;
  const Polytope& Q;
  const Pose& X_AB;
  double crossing_tolerance;

  explicit Sides(const PiecePair& pair, double given_tolerance) noexcept
      : P(Swapped ? pair.B : pair.A),
        Q(Swapped ? pair.A : pair.B),
        X_AB(pair.X_AB),
        crossing_tolerance(given_tolerance) {}

  /// A point of P, in Q's frame.
  Vec3 in_Q(const Vec3& p) const noexcept { return Swapped ? X_AB * p : rotated_back(X_AB.R, p - X_AB.p); }
  /// A point of Q, in P's frame.
  Vec3 in_P(const Vec3& q) const noexcept { return Swapped ? rotated_back(X_AB.R, q - X_AB.p) : X_AB * q; }
  /// Of a point of each piece, in its own frame, the one of A.
  static const Vec3& of_A(const Vec3& p, const Vec3& q) noexcept { return Swapped ? q : p; }
  /// The normal from B to A, in A's frame, of a vector from P to Q given in both frames.
  static Vec3 normal(const Vec3& d_P, const Vec3& d_Q) noexcept { return Swapped ? d_Q : Vec3(-d_P); }
  Vec3 turned_to_Q(const Vec3& d) const noexcept {
    return Swapped ? rotated(X_AB.R, d) : rotated_back(X_AB.R, d);
  }
  Vec3 turned_to_P(const Vec3& d) const noexcept {
    return Swapped ? rotated_back(X_AB.R, d) : rotated(X_AB.R, d);
  }
};

/// How far the piece may extend beyond a plane through `v` when the steepest of the edges at `v` rises by
/// `slope` over it (sine). A point of the piece is v + sum c_i u_i, c_i >= 0 over the edges at v, and the sum
/// of the c_i is at most its distance from v over the least cosine between an edge and their mean.
inline double height_beyond(const Polytope& P, int v, double slope) noexcept {
  if (slope <= 0.0) return 0.0;
  Vec3 mean = Vec3::Zero();
  for (const Polytope::Ray& ray : P.rays_at(v)) mean += ray.direction;
  double least = kInfinity;
  for (const Polytope::Ray& ray : P.rays_at(v)) least = std::min(least, ray.direction.dot(mean));
  return least > 0.0 ? slope * P.extent.size * mean.norm() / least : kInfinity;
}

/// The same at an edge whose steeper face rises by `slope`: the piece lies in the wedge of its two faces. The
/// rise of the edge's own line is added, over the whole size: the wedge continues beyond the edge's ends.
inline double height_beyond(const Polytope& P, const Polytope::Edge& e, double slope) noexcept {
  if (slope <= 0.0) return 0.0;
  const double cosine = P.sides[e.left_slot].normal.dot(P.sides[e.right_slot].normal);
  return cosine > -1.0 ? slope * P.extent.size * std::sqrt(2.0 / (1.0 + cosine)) : kInfinity;
}

/// The edge at a vertex that rises most along a direction, and the sine by which it rises.
struct Steepest {
  int edge;
  double slope;
};

/// Selects without a branch: which edge it is cannot be predicted from vertex to vertex, and a mispredicted
/// branch costs as much as all the edges.
inline Steepest steepest_edge(const Polytope& P, int v, const Vec3& d) noexcept {
  const std::span<const Polytope::Ray> rays = P.rays_at(v);
  const Polytope::Ray* steepest = rays.data();
  double most = -kInfinity;
  for (const Polytope::Ray& ray : rays) {
    const double slope = ray.direction.dot(d);
    steepest = slope > most ? &ray : steepest;
    most = std::max(most, slope);
  }
  return {steepest->edge, most};
}

enum class Outcome : std::uint8_t { kClosest, kMoved, kOverlap, kBehind };

/// The outcome of a step, and the features of P and Q: to go on from, or where it ended.
struct Step {
  Outcome outcome = Outcome::kMoved;
  Feature p, q;
};

/// The start of a step: the closest points of its two features, each in its own piece's frame.
struct Place {
  double gap = kInfinity;  ///< the points' distance; infinite where the step does not compute them [m]
  Vec3 p, q;               ///< known when the gap is [m]
};

inline Feature vertex(int index) noexcept { return {FeatureKind::kVertex, index}; }
inline Feature edge(int index) noexcept { return {FeatureKind::kEdge, index}; }
inline Feature face(int index) noexcept { return {FeatureKind::kFace, index}; }

/// The end of a walk at the point `p_a` of A, across the normal `n` from B to A, in A's frame. Written number
/// by number: a copy as a whole waits for parts that have just been written.
inline void set_answer(const Vec3& p_a, const Vec3& n, double gap, double error_bound,
                       PairDistance& x) noexcept {
  x.p_a << p_a.x(), p_a.y(), p_a.z();
  x.normal << n.x(), n.y(), n.z();
  x.p_b = x.p_a - x.normal * gap;
  x.distance = gap;
  x.error_bound = error_bound;
}

/// The points of a place that proves nothing.
template <bool Swapped>
void set_points(const Sides<Swapped>& S, const Place& at, PairDistance& x) noexcept {
  x.p_a = Swapped ? at.q : at.p;
  x.p_b = S.X_AB * (Swapped ? at.p : at.q);
  x.normal.setZero();
  x.distance = at.gap;
  x.error_bound = kInfinity;
}

/// The feature that a point leads to from an edge: the edge, its ends or its faces.
inline Feature beside_edge(const Polytope& Q, int index, const Vec3& p, double crossing_tolerance) noexcept {
  const Polytope::Edge& g = Q.edges[index];
  const double along = g.direction.dot(p - Q.vertices[g.tail]);
  if (along < -crossing_tolerance) return vertex(g.tail);
  if (along > g.length + crossing_tolerance) return vertex(g.head);
  const Polytope::Side& left = Q.sides[g.left_slot];
  const Polytope::Side& right = Q.sides[g.right_slot];
  const double above_left = left.normal.dot(p) - left.offset;
  const double above_right = right.normal.dot(p) - right.offset;
  if (std::min(above_left, above_right) >= -crossing_tolerance) return edge(index);
  return face(above_left < above_right ? g.left : g.right);
}

template <bool Swapped>
Step vertex_vertex(const Sides<Swapped>& S, Feature fp, Feature fq, Place& at, PairDistance& x) noexcept {
  at.p = S.P.vertices[fp.index];
  at.q = S.Q.vertices[fq.index];
  const Vec3 d_Q = at.q - S.in_Q(at.p);
  const Vec3 d_P = S.turned_to_P(d_Q);
  at.gap = d_Q.norm();
  const Steepest at_p = steepest_edge(S.P, fp.index, d_P);
  if (at_p.slope > S.crossing_tolerance) return {Outcome::kMoved, edge(at_p.edge), fq};
  const Steepest at_q = steepest_edge(S.Q, fq.index, -d_Q);
  if (at_q.slope > S.crossing_tolerance) return {Outcome::kMoved, fp, edge(at_q.edge)};
  if (at.gap <= tolerances::kTouching * S.P.extent.size) {
    set_points(S, at, x);
  } else {
    set_answer(
        S.of_A(at.p, at.q), S.normal(d_P, d_Q) / at.gap, at.gap,
        height_beyond(S.P, fp.index, at_p.slope / at.gap) + height_beyond(S.Q, fq.index, at_q.slope / at.gap),
        x);
  }
  return {Outcome::kClosest, fp, fq};
}

template <bool Swapped>
Step vertex_edge(const Sides<Swapped>& S, Feature fp, Feature fq, Place& at, PairDistance& x) noexcept {
  at.p = S.P.vertices[fp.index];
  const Polytope::Edge& g = S.Q.edges[fq.index];
  const Vec3& tail = S.Q.vertices[g.tail];
  const Vec3 p_Q = S.in_Q(at.p);
  const double along = g.direction.dot(p_Q - tail);
  at.q = tail + g.direction * std::clamp(along, 0.0, g.length);
  const Vec3 d_Q = at.q - p_Q;
  at.gap = d_Q.norm();
  if (const Feature next = beside_edge(S.Q, fq.index, p_Q, S.crossing_tolerance); next != fq)
    return {Outcome::kMoved, fp, next};
  const Polytope::Side& left = S.Q.sides[g.left_slot];
  const Polytope::Side& right = S.Q.sides[g.right_slot];
  const Vec3 d_P = S.turned_to_P(d_Q);
  const Steepest at_p = steepest_edge(S.P, fp.index, d_P);
  if (at_p.slope > S.crossing_tolerance) return {Outcome::kMoved, edge(at_p.edge), fq};
  if (at.gap <= tolerances::kTouching * S.P.extent.size) {
    set_points(S, at, x);
  } else {
    // The normal itself is judged: over a small gap its error is larger than the point's.
    const double rise = std::max(left.normal.dot(d_Q), right.normal.dot(d_Q));
    const double error_bound = height_beyond(S.P, fp.index, at_p.slope / at.gap) +
                               height_beyond(S.Q, g, rise / at.gap) +
                               std::abs(g.direction.dot(d_Q)) / at.gap * S.Q.extent.size;
    set_answer(S.of_A(at.p, at.q), S.normal(d_P, d_Q) / at.gap, at.gap, error_bound, x);
  }
  return {Outcome::kClosest, fp, fq};
}

/// The slot of the side plane that `p` is farthest outside of, and by more than `most`; -1 inside the column
/// of the face with this loop.
inline int slot_outside(const Polytope& Q, int first, int count, const Vec3& p, double most) noexcept {
  int best = -1;
  for (int slot = first; slot < first + count; ++slot) {
    const double out = Q.sides[slot].normal.dot(p) - Q.sides[slot].offset;
    if (out > most) {
      most = out;
      best = slot;
    }
  }
  return best;
}

template <bool Swapped>
Step vertex_face(const Sides<Swapped>& S, Feature fp, Feature fq, Place& at, PairDistance& x) noexcept {
  const Vec3& p = S.P.vertices[fp.index];
  const Vec3 p_Q = S.in_Q(p);
  const int began_at = fq.index;
  const Polytope::Face* at_face = &S.Q.faces[fq.index];
  if (const int slot = slot_outside(S.Q, at_face->first, at_face->count, p_Q, S.crossing_tolerance);
      slot >= 0) {
    // Mostly above the next face: one step leads there, and its loop is stored beside the side. Below it
    // there is nowhere to go on to: at a sharp edge rounding alone leads there, and from there back.
    const Polytope::Side& side = S.Q.sides[slot];
    at_face = &S.Q.faces[side.across];
    if (slot_outside(S.Q, side.first, side.count, p_Q, S.crossing_tolerance) >= 0 ||
        at_face->normal.dot(p_Q) - at_face->offset < -S.crossing_tolerance)
      return {Outcome::kMoved, fp, beside_edge(S.Q, side.edge, p_Q, S.crossing_tolerance)};
    fq.index = side.across;
  }
  const Polytope::Face& f = *at_face;
  const double height = f.normal.dot(p_Q) - f.offset;
  if (height < -S.crossing_tolerance) {
    if (!S.Q.flat) return {Outcome::kBehind, fp, fq};
    return {Outcome::kMoved, fp, face(1 - fq.index)};
  }
  const Vec3 outward_P = S.turned_to_P(-f.normal);
  const Steepest at_p = steepest_edge(S.P, fp.index, outward_P);
  if (at_p.slope > tolerances::kVoronoiTolerance) {
    if (fq.index == began_at) {
      at.gap = std::abs(height);
      at.p = p;
      at.q = p_Q - f.normal * height;
    }
    return {Outcome::kMoved, edge(at_p.edge), fq};
  }
  set_answer(S.of_A(p, p_Q - f.normal * height), S.normal(outward_P, -f.normal), std::abs(height),
             height_beyond(S.P, fp.index, at_p.slope), x);
  return {Outcome::kClosest, fp, fq};
}

/// A direction from an edge, along the side planes' normals of its faces: how far it leads out of the column
/// of each (as long as the direction; negative: into it).
struct OutOfColumns {
  double left, right;
};

/// Of `sign` (1 or -1) times `d`: the same numbers, and the sign may be known later than the direction.
inline OutOfColumns out_of_columns(const Polytope& P, const Polytope::Edge& e, double sign,
                                   const Vec3& d) noexcept {
  return {sign * P.sides[e.left_slot].normal.dot(d), sign * P.sides[e.right_slot].normal.dot(d)};
}

/// The face at an edge into whose column a direction leads most, and how far (negative when it leads into
/// neither).
struct Toward {
  int face;
  double slope;
};

inline Toward face_toward(const Polytope::Edge& e, const OutOfColumns& out) noexcept {
  return out.left < out.right ? Toward{e.left, -out.left} : Toward{e.right, -out.right};
}

/// For edges of any kind: nearly parallel, nearest at an end, far off, parallel to a face. Out of line and
/// from the start, so that the frequent case of crossing edges keeps no registers for it.
[[gnu::noinline]] Step edges_along(const PiecePair& pair, double crossing_tolerance, int a, int b, Place& at,
                                   PairDistance& x) noexcept;

/// For a place along an edge, the end it lies beyond; else the edge.
inline Feature end_or_edge(const Polytope::Edge& e, double at, Feature whole) noexcept {
  if (at > 0.0 && at < e.length) return whole;
  return vertex(at > 0.0 ? e.head : e.tail);
}

/// Two lines along the unit vectors u and w, r from a point of the first to one of the second.
struct Crossing {
  double cosine, sine_sq;  ///< of their angle
  double r_u, r_w;         ///< r . u, r . w [m]
  double s, t;             ///< where along each they are nearest, times sine_sq [m]
};

/// Where the edges are nearest at an end of one: there, the place on the other is nearest to that end.
inline Step past_an_end(const Polytope::Edge& e, const Polytope::Edge& g, Feature fp, Feature fq,
                        const Crossing& x) noexcept {
  const bool past_e = !(x.s > 0.0 && x.s < e.length * x.sine_sq);
  double on_e = x.s > 0.0 ? e.length : 0.0;
  double on_g = past_e ? on_e * x.cosine - x.r_w : (x.t > 0.0 ? g.length : 0.0);
  if (!past_e || on_g < 0.0 || on_g > g.length) {
    on_g = std::clamp(on_g, 0.0, g.length);
    on_e = x.r_u + on_g * x.cosine;
  }
  return {Outcome::kMoved, end_or_edge(e, on_e, fp), end_or_edge(g, on_g, fq)};
}

/// Where a hand moves two parts half of all walks end at edges that cross at an angle and are nearest between
/// their ends. There the points are not needed: the normal is the edges' cross product c, the gap r . c /
/// |c|, and the places along the edges, s and t times the sine squared, are dot products. The rounding error
/// is known beforehand.
inline Step edge_edge(const PiecePair& pair, const Sides<false>& S, Feature fp, Feature fq, Place& at,
                      PairDistance& x) noexcept {
  const Polytope::Edge& e = S.P.edges[fp.index];
  const Polytope::Edge& g = S.Q.edges[fq.index];
  const Vec3& e_tail = S.P.vertices[e.tail];
  const Vec3& g_tail = S.Q.vertices[g.tail];
  const Vec3 w = S.turned_to_P(g.direction);
  const Vec3 r = S.in_P(g_tail) - e_tail;
  const Vec3 c = e.direction.cross(w);
  const double sine_sq = c.squaredNorm();
  const double cosine = e.direction.dot(w);
  const double r_e = r.dot(e.direction);
  const double r_g = r.dot(w);
  const double s = r_e - r_g * cosine;
  const double t = r_e * cosine - r_g;
  const bool between = s > 0.0 && s < e.length * sine_sq && t > 0.0 && t < g.length * sine_sq;
  const bool crossing = sine_sq >= tolerances::kCrossingSine * tolerances::kCrossingSine;
  if (!between && crossing) return past_an_end(e, g, fp, fq, {cosine, sine_sq, r_e, r_g, s, t});
  if (!crossing) return edges_along(pair, S.crossing_tolerance, fp.index, fq.index, at, x);

  const double along = r.dot(c);
  const double sign = std::copysign(1.0, along + 0.0);  // of the outward direction along c; -0 is +0
  const double per_square = 1.0 / sine_sq;
  const double per_sine = std::sqrt(sine_sq) * per_square;
  const double gap = std::abs(along) * per_sine;
  const Vec3 p = e_tail + e.direction * (s * per_square);
  const OutOfColumns out_p = out_of_columns(S.P, e, sign, c);
  const OutOfColumns out_q = out_of_columns(S.Q, g, -sign, S.turned_to_Q(c));
  if (out_p.left < 0.0 || out_p.right < 0.0 || out_q.left < 0.0 || out_q.right < 0.0) {
    const Toward of_p = face_toward(e, out_p);
    const Toward of_q = face_toward(g, out_q);
    if (std::max(of_p.slope, of_q.slope) * S.P.extent.size <= S.crossing_tolerance)
      return edges_along(pair, S.crossing_tolerance, fp.index, fq.index, at, x);
    at.gap = gap;
    at.p = p;
    at.q = g_tail + g.direction * (t * per_square);
    if (of_p.slope * S.P.extent.size > S.crossing_tolerance) return {Outcome::kMoved, face(of_p.face), fq};
    return {Outcome::kMoved, fp, face(of_q.face)};
  }
  const double lengths = S.P.extent.size + S.Q.extent.size + r.lpNorm<1>();
  const double error_bound = (tolerances::kCrossingRounding * lengths + S.crossing_tolerance) * per_square;
  if (error_bound > tolerances::kCertificate * pair.size)
    return edges_along(pair, S.crossing_tolerance, fp.index, fq.index, at, x);
  set_answer(p, c * (-sign * per_sine), gap, error_bound, x);
  return {Outcome::kClosest, fp, fq};
}

/// P has the edge, Q the face. Never the end of the walk: the nearer end of the clipped edge is a vertex or
/// on an edge.
[[gnu::noinline]] Step edge_face(const Polytope& Q, const Polytope::Edge& e, const Vec3& p0, const Vec3& u,
                                 double crossing_tolerance, Feature fp, Feature fq) noexcept;

/// Dispatches on the kinds, P owning the lower one. Sets in `x` where the features are closest, and returns
/// the place where it moved on, if it was computed. Two faces, from which only a caller starts, go on from a
/// vertex of the second.
template <bool Swapped>
Step step(const PiecePair& pair, const Sides<Swapped>& S, Feature fp, Feature fq, Place& at,
          PairDistance& x) noexcept {
  if (fp.kind == FeatureKind::kVertex) {
    if (fq.kind == FeatureKind::kFace) return vertex_face(S, fp, fq, at, x);
    return fq.kind == FeatureKind::kEdge ? vertex_edge(S, fp, fq, at, x) : vertex_vertex(S, fp, fq, at, x);
  }
  if constexpr (!Swapped) {
    if (fq.kind == FeatureKind::kEdge) return edge_edge(pair, S, fp, fq, at, x);
    if (fp.kind == FeatureKind::kFace) return {Outcome::kMoved, fp, vertex(vertex_of(S.Q, fq))};
  }
  const Polytope::Edge& e = S.P.edges[fp.index];
  return edge_face(S.Q, e, S.in_Q(S.P.vertices[e.tail]), S.turned_to_Q(e.direction), S.crossing_tolerance, fp,
                   fq);
}

/// A step from the features `at` of A and B, which are set to those of its end.
inline Outcome step_on(const PiecePair& pair, double crossing_tolerance, FeaturePair& at, Place& place,
                       PairDistance& x) noexcept {
  if (at.a.kind > at.b.kind) {
    const Step next = step(pair, Sides<true>(pair, crossing_tolerance), at.b, at.a, place, x);
    at = {next.q, next.p};
    return next.outcome;
  }
  const Step next = step(pair, Sides<false>(pair, crossing_tolerance), at.a, at.b, place, x);
  at = {next.p, next.q};
  return next.outcome;
}

/// Sets the end of a walk that proves nothing: where the features `x.a`, `x.b` are nearest.
[[gnu::noinline]] void set_features(const PiecePair& pair, double crossing_tolerance,
                                    PairDistance& x) noexcept;

/// feature_walk(), inline.
inline FeatureWalk walk_features(const PiecePair& pair, FeaturePair at, double crossing_tolerance,
                                 PairDistance& x) noexcept {
  double least = kInfinity;
  FeaturePair nearest = at;
  FeaturePair mark;  // a state to be met again if the walk cycles [Brent 1980]
  int next_mark = 8;
  const auto bound = [&] { return 64 + static_cast<int>(pair.A.edges.size() + pair.B.edges.size()) / 4; };
  FeatureWalk walk;
  while (walk.steps < 64 || walk.steps < bound()) {
    const FeaturePair was = at;
    Place place;
    const Outcome outcome = step_on(pair, crossing_tolerance, at, place, x);
    ++walk.steps;
    if (outcome != Outcome::kMoved) {
      x.a = at.a;
      x.b = at.b;
      if (outcome == Outcome::kClosest) {
        x.error_bound += crossing_tolerance;  // of the numbers that were added up
        return {x.error_bound, FeatureWalkEnd::kClosest, walk.steps};
      }
      walk.end = outcome == Outcome::kOverlap ? FeatureWalkEnd::kOverlap : FeatureWalkEnd::kBehind;
      return walk;
    }
    if (place.gap < least) {
      least = place.gap;
      nearest = was;
    }
    if (at.a == mark.a && at.b == mark.b) {
      walk.end = FeatureWalkEnd::kCircle;
      break;
    }
    if (walk.steps == next_mark) {
      mark = at;
      next_mark *= 2;
    }
  }
  x.a = nearest.a;
  x.b = nearest.b;
  set_features(pair, crossing_tolerance, x);
  return walk;
}

}  // namespace tactum::inline v0_1::vclip
