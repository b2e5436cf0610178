#include "tactum/collision/vclip.h"

#include "tactum/collision/segments.h"
#include "tactum/collision/vclip_steps.h"

namespace tactum::inline v0_1 {
namespace vclip {
namespace {

/// The unit direction from edge to edge and its angular error: the points' difference `d`, or the cross
/// product `c` of the edges where it has more digits.
struct Across {
  Vec3 direction;
  double crossing_sine;  // by which an edge must rise to be crossed
  double aside;          // of the points, from the direction [m]
};

Across across_edges(double size, double crossing_tolerance, const Vec3& c, const Vec3& d,
                    double gap) noexcept {
  const double sine_sq = c.squaredNorm();
  if (gap * gap >= sine_sq * size * size)
    return gap > 0.0 ? Across{d / gap, crossing_tolerance / gap, 0.0} : Across{d, 0.0, kInfinity};
  const double sine = std::sqrt(sine_sq);
  const Vec3 direction = c.dot(d) < 0.0 ? Vec3(-c / sine) : Vec3(c / sine);
  return {direction, std::max(crossing_tolerance / size, tolerances::kVoronoiTolerance) / sine,
          (d - direction * gap).norm()};
}

}  // namespace

Step edges_along(const PiecePair& pair, double crossing_tolerance, int a, int b, Place& at,
                 PairDistance& x) noexcept {
  const Sides<false> S(pair, crossing_tolerance);
  const Polytope::Edge& e = S.P.edges[a];
  const Polytope::Edge& g = S.Q.edges[b];
  const Vec3& e_tail = S.P.vertices[e.tail];
  const Vec3& g_tail = S.Q.vertices[g.tail];
  const Vec3 w = S.turned_to_P(g.direction);
  const Vec3 r = S.in_P(g_tail) - e_tail;
  const Vec3 c = e.direction.cross(w);
  const SegmentPair near = nearest_on_segments(e.direction, e.length, w, g.length, r, c);
  at.p = e_tail + e.direction * near.s;
  at.q = g_tail + g.direction * near.t;
  const Vec3 d = r + w * near.t - e.direction * near.s;
  at.gap = d.norm();
  const Feature end_p = end_or_edge(e, near.s, edge(a));
  const Feature end_q = end_or_edge(g, near.t, edge(b));
  if (end_p != edge(a) || end_q != edge(b)) return {Outcome::kMoved, end_p, end_q};
  const Across across = across_edges(S.P.extent.size, crossing_tolerance, c, d, at.gap);
  const Toward of_p = face_toward(e, out_of_columns(S.P, e, 1.0, across.direction));
  if (of_p.slope > across.crossing_sine) return {Outcome::kMoved, face(of_p.face), edge(b)};
  const Toward of_q = face_toward(g, out_of_columns(S.Q, g, -1.0, S.turned_to_Q(across.direction)));
  if (of_q.slope > across.crossing_sine) return {Outcome::kMoved, edge(a), face(of_q.face)};
  const double error_bound = height_beyond(S.P, e, of_p.slope) + height_beyond(S.Q, g, of_q.slope) +
                             std::abs(e.direction.dot(across.direction)) * S.P.extent.size +
                             std::abs(w.dot(across.direction)) * S.Q.extent.size + across.aside;
  set_answer(at.p, -across.direction, at.gap, error_bound, x);
  return {Outcome::kClosest, edge(a), edge(b)};
}

namespace {

/// The edge of a face nearest to a segment that lies wholly outside the face's column.
int nearest_edge(const Polytope& Q, const Polytope::Face& face, const Vec3& p0, const Vec3& u,
                 double length) noexcept {
  int best = Q.sides[face.first].edge;
  double least = std::numeric_limits<double>::infinity();
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const Polytope::Edge& g = Q.edges[Q.sides[slot].edge];
    const Vec3& q0 = Q.vertices[g.tail];
    const SegmentPair at =
        nearest_on_segments(u, length, g.direction, g.length, q0 - p0, u.cross(g.direction));
    const double gap = (p0 + u * at.s - q0 - g.direction * at.t).squaredNorm();
    if (gap < least) {
      least = gap;
      best = Q.sides[slot].edge;
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
                    double length, double crossing_tolerance) noexcept {
  Clip clip;
  clip.high = length;
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const double along = Q.sides[slot].normal.dot(u);
    const double room = Q.sides[slot].offset - Q.sides[slot].normal.dot(p0);
    if (std::abs(along) < tolerances::kVoronoiTolerance) {
      clip.empty |= room < -crossing_tolerance;
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

}  // namespace

Step edge_face(const Polytope& Q, const Polytope::Edge& e, const Vec3& p0, const Vec3& u,
               double crossing_tolerance, Feature fp, Feature fq) noexcept {
  const Polytope::Face& f = Q.faces[fq.index];
  const Clip clip = clip_to_column(Q, f, p0, u, e.length, crossing_tolerance);
  if (clip.empty) return {Outcome::kMoved, fp, edge(nearest_edge(Q, f, p0, u, e.length))};
  const double low = f.normal.dot(p0 + u * clip.low) - f.offset;
  const double high = f.normal.dot(p0 + u * clip.high) - f.offset;
  if (std::min(low, high) < -crossing_tolerance && std::max(low, high) > crossing_tolerance)
    return {Outcome::kOverlap, fp, fq};
  const bool take_low = std::abs(low) <= std::abs(high);
  const int slot = take_low ? clip.low_slot : clip.high_slot;
  if (slot >= 0) return {Outcome::kMoved, fp, edge(Q.sides[slot].edge)};
  return {Outcome::kMoved, vertex(take_low ? e.tail : e.head), fq};
}

void set_features(const PiecePair& pair, double crossing_tolerance, PairDistance& x) noexcept {
  FeaturePair at = {x.a, x.b};
  Place place;
  step_on(pair, crossing_tolerance, at, place, x);
  if (place.gap == kInfinity) {  // the step did not compute them: take a corner of each
    const Sides<false> S(pair, crossing_tolerance);
    place.p = pair.A.vertices[vertex_of(pair.A, x.a)];
    place.q = pair.B.vertices[vertex_of(pair.B, x.b)];
    place.gap = (S.in_Q(place.p) - place.q).norm();
    set_points(S, place, x);
    return;
  }
  if (x.a.kind > x.b.kind)
    set_points(Sides<true>(pair, crossing_tolerance), place, x);
  else
    set_points(Sides<false>(pair, crossing_tolerance), place, x);
}

}  // namespace vclip

FeatureWalk feature_walk(const PiecePair& pair, Feature a, Feature b, double crossing_tolerance,
                         PairDistance& x) noexcept {
  return vclip::walk_features(pair, {a, b}, crossing_tolerance, x);
}

}  // namespace tactum::inline v0_1
