#include "tactum/collision/voronoi_march.h"

#include <cmath>
#include <limits>

#include "tactum/collision/segments.h"

namespace tactum {
namespace {

/// One step as seen from the piece P that owns the feature of lower dimension; Q is the other.
struct Sides {
  const Polytope& P;
  const Polytope& Q;
  const Pose& X_PQ;
  const Pose& X_QP;
  double slack;
};

enum class Step : std::uint8_t { kClosest, kMoved, kOverlap };

/// Closest points of the two features, in P's frame, when the step knows them.
struct Points {
  Vec3 p = Vec3::Zero();
  Vec3 q = Vec3::Zero();
  bool known = false;
};

/// The edge at `v` that goes most along `d`, by more than `least`; -1 when none does.
int edge_along(const Polytope& P, int v, const Vec3& d, double least) noexcept {
  int best = -1;
  for (const Polytope::Ray& ray : P.rays_at(v)) {
    const double away = ray.direction.dot(d);
    if (away > least) {
      least = away;
      best = ray.edge;
    }
  }
  return best;
}

Step vertex_vertex(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  const Vec3& p = S.P.vertices[fp.index];
  const Vec3& q_Q = S.Q.vertices[fq.index];
  x = {p, S.X_PQ * q_Q, true};
  if (const int e = edge_along(S.P, fp.index, x.q - p, S.slack); e >= 0) {
    fp = {FeatureKind::kEdge, e};
    return Step::kMoved;
  }
  if (const int e = edge_along(S.Q, fq.index, S.X_QP * p - q_Q, S.slack); e >= 0) {
    fq = {FeatureKind::kEdge, e};
    return Step::kMoved;
  }
  return Step::kClosest;
}

Step vertex_edge(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  const Vec3& p = S.P.vertices[fp.index];
  const Polytope::Edge& edge = S.Q.edges[fq.index];
  const Vec3& tail = S.Q.vertices[edge.tail];
  const Vec3 p_Q = S.X_QP * p;
  const double along = edge.direction.dot(p_Q - tail);
  x = {p, S.X_PQ * Vec3(tail + edge.direction * std::clamp(along, 0.0, edge.length)), true};
  if (along < -S.slack || along > edge.length + S.slack) {
    fq = {FeatureKind::kVertex, along < 0.0 ? edge.tail : edge.head};
    return Step::kMoved;
  }
  const double left = S.Q.sides[edge.left_slot].normal.dot(p_Q) - S.Q.sides[edge.left_slot].offset;
  const double right = S.Q.sides[edge.right_slot].normal.dot(p_Q) - S.Q.sides[edge.right_slot].offset;
  if (std::min(left, right) < -S.slack) {
    fq = {FeatureKind::kFace, left < right ? edge.left : edge.right};
    return Step::kMoved;
  }
  if (const int e = edge_along(S.P, fp.index, x.q - p, S.slack); e >= 0) {
    fp = {FeatureKind::kEdge, e};
    return Step::kMoved;
  }
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

/// The face `p` is highest above.
int highest_face(const Polytope& Q, const Vec3& p, double& height) noexcept {
  int best = 0;
  height = -std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < Q.faces.size(); ++f) {
    const double h = Q.faces[f].normal.dot(p) - Q.faces[f].offset;
    if (h > height) {
      height = h;
      best = static_cast<int>(f);
    }
  }
  return best;
}

Step vertex_face(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  const Vec3& p = S.P.vertices[fp.index];
  const Polytope::Face& face = S.Q.faces[fq.index];
  const Vec3 p_Q = S.X_QP * p;
  const double height = face.normal.dot(p_Q) - face.offset;
  const Vec3 n_P = S.X_PQ.R * face.normal;
  if (const int slot = slot_outside(S.Q, face, p_Q, S.slack); slot >= 0) {
    fq = {FeatureKind::kEdge, S.Q.face_edges[slot]};
    return Step::kMoved;
  }
  x = {p, p - n_P * height, true};
  if (height < -S.slack) {  // behind the face: inside the piece, or in front of another face
    double most = 0.0;
    const int highest = highest_face(S.Q, p_Q, most);
    if (highest == fq.index || most < -S.slack) {
      x = {p, p, true};
      return Step::kOverlap;
    }
    fq.index = highest;
    return Step::kMoved;
  }
  if (const int e = edge_along(S.P, fp.index, -n_P, tolerances::kVoronoiSlack); e >= 0) {
    fp = {FeatureKind::kEdge, e};
    return Step::kMoved;
  }
  return Step::kClosest;
}

/// A segment's end as its vertex, when the closest point is there.
bool at_end(const Polytope::Edge& edge, double s, Feature& f) noexcept {
  if (s > 0.0 && s < edge.length) return false;
  f = {FeatureKind::kVertex, s > 0.0 ? edge.head : edge.tail};
  return true;
}

/// The face at `edge` in whose column the unit direction `d` from the edge leads; -1 when in neither.
int face_toward(const Polytope& P, const Polytope::Edge& edge, const Vec3& d, double slack) noexcept {
  const double left = P.sides[edge.left_slot].normal.dot(d);
  const double right = P.sides[edge.right_slot].normal.dot(d);
  if (std::min(left, right) >= -slack) return -1;
  return left < right ? edge.left : edge.right;
}

/// From edge to edge: the points' difference, or the cross product where it has more digits; and its angular
/// error.
struct Across {
  Vec3 direction;
  double slack;
};

Across across_edges(const Sides& S, const Vec3& u, const Vec3& w, const Vec3& d) noexcept {
  const double gap = d.norm();
  const Vec3 c = u.cross(w);
  const double sine = c.norm();
  if (gap >= sine * S.P.size) return {gap > 0.0 ? Vec3(d / gap) : d, gap > 0.0 ? S.slack / gap : 0.0};
  return {c.dot(d) < 0.0 ? Vec3(-c / sine) : Vec3(c / sine),
          std::max(S.slack / S.P.size, tolerances::kVoronoiSlack) / sine};
}

Step edge_edge(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  const Polytope::Edge& e = S.P.edges[fp.index];
  const Polytope::Edge& g = S.Q.edges[fq.index];
  const Vec3& p0 = S.P.vertices[e.tail];
  const Vec3 q0 = S.X_PQ * S.Q.vertices[g.tail];
  const Vec3 w = S.X_PQ.R * g.direction;
  const SegmentPair at = nearest_on_segments(p0, e.direction, e.length, q0, w, g.length);
  x = {p0 + e.direction * at.s, q0 + w * at.t, true};
  const bool p_end = at_end(e, at.s, fp);
  const bool q_end = at_end(g, at.t, fq);
  if (p_end || q_end) return Step::kMoved;
  const Across across = across_edges(S, e.direction, w, x.q - x.p);
  if (const int f = face_toward(S.P, e, across.direction, across.slack); f >= 0) {
    fp = {FeatureKind::kFace, f};
    return Step::kMoved;
  }
  if (const int f = face_toward(S.Q, g, -(S.X_QP.R * across.direction), across.slack); f >= 0) {
    fq = {FeatureKind::kFace, f};
    return Step::kMoved;
  }
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
    const SegmentPair at = nearest_on_segments(p0, u, length, q0, g.direction, g.length);
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
Step edge_face(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  const Polytope::Edge& e = S.P.edges[fp.index];
  const Polytope::Face& face = S.Q.faces[fq.index];
  const Vec3 p0 = S.X_QP * S.P.vertices[e.tail];
  const Vec3 u = S.X_QP.R * e.direction;
  const Clip clip = clip_to_column(S.Q, face, p0, u, e.length, S.slack);
  if (clip.empty) {
    fq = {FeatureKind::kEdge, nearest_edge(S.Q, face, p0, u, e.length)};
    return Step::kMoved;
  }
  const double low = face.normal.dot(p0 + u * clip.low) - face.offset;
  const double high = face.normal.dot(p0 + u * clip.high) - face.offset;
  if (std::min(low, high) < -S.slack && std::max(low, high) > S.slack) {
    const double at = clip.low + (clip.high - clip.low) * low / (low - high);
    const Vec3 common = S.P.vertices[e.tail] + e.direction * at;
    x = {common, common, true};
    return Step::kOverlap;
  }
  const bool take_low = std::abs(low) <= std::abs(high);
  const int slot = take_low ? clip.low_slot : clip.high_slot;
  if (slot >= 0) {
    fq = {FeatureKind::kEdge, S.Q.face_edges[slot]};
  } else {
    fp = {FeatureKind::kVertex, take_low ? e.tail : e.head};
  }
  return Step::kMoved;
}

/// Dispatch on the kinds, P owning the lower one.
Step step(const Sides& S, Feature& fp, Feature& fq, Points& x) noexcept {
  if (fp.kind == FeatureKind::kVertex) {
    if (fq.kind == FeatureKind::kVertex) return vertex_vertex(S, fp, fq, x);
    return fq.kind == FeatureKind::kEdge ? vertex_edge(S, fp, fq, x) : vertex_face(S, fp, fq, x);
  }
  return fq.kind == FeatureKind::kEdge ? edge_edge(S, fp, fq, x) : edge_face(S, fp, fq, x);
}

}  // namespace

March voronoi_march(const PairView& pair, Feature a, Feature b, double slack) noexcept {
  const Sides forward{pair.A, pair.B, pair.X_AB, pair.X_BA, slack};
  const Sides backward{pair.B, pair.A, pair.X_BA, pair.X_AB, slack};
  if (a.kind == FeatureKind::kFace && b.kind == FeatureKind::kFace)
    b = {FeatureKind::kVertex, vertex_of(pair.B, b)};

  March best;
  double least = std::numeric_limits<double>::infinity();
  Feature mark_a, mark_b;  // a state to be met again if the walk goes in circles [Brent 1980]
  int next_mark = 8;
  const int bound = 64 + static_cast<int>(pair.A.edges.size() + pair.B.edges.size()) / 4;
  int steps = 0;
  while (steps < bound) {
    const Feature was_a = a;
    const Feature was_b = b;
    const bool swapped = a.kind > b.kind;
    Points x;
    const Step outcome = swapped ? step(backward, b, a, x) : step(forward, a, b, x);
    ++steps;
    if (x.known) {
      const double gap = (x.p - x.q).squaredNorm();
      if (gap < least || outcome != Step::kMoved) {
        least = gap;
        best = {was_a,
                was_b,
                swapped ? pair.X_AB * x.q : x.p,
                swapped ? pair.X_AB * x.p : x.q,
                MarchEnd::kBounded,
                0};
      }
    }
    if (outcome != Step::kMoved) {
      best.end = outcome == Step::kClosest ? MarchEnd::kClosest : MarchEnd::kOverlap;
      break;
    }
    if (a == mark_a && b == mark_b) {
      best.end = MarchEnd::kCircle;
      break;
    }
    if (steps == next_mark) {
      mark_a = a;
      mark_b = b;
      next_mark *= 2;
    }
  }
  best.steps = steps;
  return best;
}

}  // namespace tactum
