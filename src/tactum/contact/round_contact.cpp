#include "tactum/contact/round_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tactum/base/tolerances.h"
#include "tactum/contact/patch_corners.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Lines whose directions differ by a smaller sine lie along each other.
constexpr double kAlong = 1e5 * tolerances::kSameNormal;
/// A walk to the closest feature crosses a few features from those of the facets.
constexpr int kMostWalkSteps = 64;

/// Where a round piece is nearest to the other one, all in the frame of the other.
struct Meeting {
  struct Point {
    Vec3 on_round, on_other;
    double distance = 0.0;  // [m]
  };
  Vec3 normal = Vec3::Zero();  // toward the round piece
  Feature on_other;
  StaticVector<Point, 2> points;

  void add(const Vec3& on_round, double distance) noexcept {
    points.push_back({on_round, on_round - distance * normal, distance});
  }
};

/// The middle of a ball, or the axis of a cylinder, in the frame of the other piece.
struct Core {
  Vec3 center, axis;
  double half_length, radius;

  Core(const RoundPiece& round, const Pose& X) noexcept
      : center(X * round.center),
        axis(rotated(X.R, round.axis)),
        half_length(round.half_length_m),
        radius(round.radius_m) {}
  Vec3 at(double along) const noexcept { return center + along * axis; }
  /// Nearest to a point of the core at `along`, which is as near as any: false where it is at the point.
  bool meet(double along, const Vec3& p, Meeting& m) const noexcept {
    const Vec3 apart = at(along) - p;
    const double length = apart.norm();
    if (!(length > tolerances::kCertificate * radius)) return false;
    m.normal = apart * (1.0 / length);
    m.add(at(along) - radius * m.normal, length - radius);
    return true;
  }
};

const Polytope::Side& side_at(const Polytope& P, int slot) noexcept { return P.sides[Index(slot)]; }

double beyond(const Polytope::Side& side, const Vec3& p) noexcept { return side.normal.dot(p) - side.offset; }

/// The side of a face that `p` is farthest outside of; null when it is above the face.
const Polytope::Side* left_over(const Polytope& P, const Polytope::Face& face, const Vec3& p) noexcept {
  const Polytope::Side* most = nullptr;
  double by = 0.0;
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const double out = beyond(side_at(P, slot), p);
    if (out > by) {
      by = out;
      most = &side_at(P, slot);
    }
  }
  return most;
}

/// The face that a point is farthest above.
int highest_face(const Polytope& P, const Vec3& p) noexcept {
  int best = 0;
  for (int f = 1; f < P.counts[2]; ++f)
    if (P.faces[f].normal.dot(p) - P.faces[f].offset > P.faces[best].normal.dot(p) - P.faces[best].offset)
      best = f;
  return best;
}

/// A step of the walk to the feature of P in whose Voronoi region `p` is: the next feature, or the same.
Feature step_towards(const Polytope& P, const Vec3& p, const Feature& at) noexcept {
  if (at.kind == FeatureKind::kFace) {
    const Polytope::Side* const over = left_over(P, P.faces[at.index], p);
    return over == nullptr ? at : Feature{FeatureKind::kEdge, over->edge};
  }
  if (at.kind == FeatureKind::kEdge) {
    const Polytope::Edge& edge = P.edges[at.index];
    const double along = edge.direction.dot(p - P.vertices[Index(edge.tail)]);
    if (along < 0.0) return {FeatureKind::kVertex, edge.tail};
    if (along > edge.length) return {FeatureKind::kVertex, edge.head};
    if (beyond(side_at(P, edge.left_slot), p) < 0.0) return {FeatureKind::kFace, edge.left};
    if (beyond(side_at(P, edge.right_slot), p) < 0.0) return {FeatureKind::kFace, edge.right};
    return at;
  }
  for (const Polytope::Ray& ray : P.rays_at(at.index))
    if (ray.direction.dot(p - P.vertices[Index(at.index)]) > 0.0) return {FeatureKind::kEdge, ray.edge};
  return at;
}

/// A ball over P: the nearest point of P to its centre.
bool meet_ball(const Polytope& P, const Core& core, Feature at, Meeting& m) noexcept {
  const Vec3& c = core.center;
  if (at.kind == FeatureKind::kFace && !(P.faces[at.index].normal.dot(c) > P.faces[at.index].offset))
    at = {FeatureKind::kFace, highest_face(P, c)};
  for (int steps = 0;; ++steps) {
    const Feature next = step_towards(P, c, at);
    if (next == at) break;
    if (steps == kMostWalkSteps) return false;
    at = next;
  }
  m.on_other = at;
  if (at.kind == FeatureKind::kFace) {
    const Polytope::Face& face = P.faces[at.index];
    const double height = face.normal.dot(c) - face.offset;
    if (!(height > 0.0)) return false;
    m.normal = face.normal;
    m.add(c - core.radius * face.normal, height - core.radius);
    return true;
  }
  if (at.kind == FeatureKind::kVertex) return core.meet(0.0, P.vertices[Index(at.index)], m);
  const Polytope::Edge& edge = P.edges[at.index];
  const Vec3& tail = P.vertices[Index(edge.tail)];
  return core.meet(0.0, tail + edge.direction.dot(c - tail) * edge.direction, m);
}

/// The stretch of a cylinder's line over a face, by its distances along the axis.
struct LineStretch {
  double from, to;
  bool cut_from = false, cut_to = false;  ///< it ends at a side of the face, not at the cylinder's end
};

LineStretch stretch_over(const Polytope& P, const Polytope::Face& face, const Core& core,
                         const Vec3& line) noexcept {
  LineStretch over{-core.half_length, core.half_length};
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    const Polytope::Side& side = side_at(P, slot);
    const double out = beyond(side, line);
    const double rate = side.normal.dot(core.axis);
    if (std::abs(rate) < tolerances::kSameNormal) {
      if (out > 0.0) over.to = over.from - 1.0;  // beside it all along
    } else if (rate > 0.0 && -out / rate < over.to) {
      over.to = -out / rate;
      over.cut_to = true;
    } else if (rate < 0.0 && -out / rate > over.from) {
      over.from = -out / rate;
      over.cut_from = true;
    }
  }
  return over;
}

/// A cylinder over a face, along a line or on the rim of one end. False where it stands on that end, lies
/// beside the face, or is nearest over an edge of it, which it crosses.
bool meet_face(const Polytope& P, int number, const Core& core, double margin, Meeting& m) noexcept {
  const Polytope::Face& face = P.faces[number];
  const double lean = face.normal.dot(core.axis);
  const Vec3 square = face.normal - lean * core.axis;
  const double length = square.norm();
  if (2.0 * core.radius * length < margin || !(face.normal.dot(core.center) > face.offset)) return false;
  const Vec3 line = core.center - (core.radius / length) * square;
  const LineStretch over = stretch_over(P, face, core, line);
  if (!(over.from <= over.to)) return false;
  const bool crosses = lean > 0.0 ? over.cut_from : over.cut_to;
  if (crosses && std::abs(lean) > kAlong) return false;
  m.normal = face.normal;
  m.on_other = {FeatureKind::kFace, number};
  for (const double along : {over.from, over.to}) {
    const Vec3 p = line + along * core.axis;
    m.add(p, face.normal.dot(p) - face.offset);
  }
  return true;
}

/// A cylinder over an edge; false where they are not nearest between their ends.
bool meet_edge(const Polytope& P, int number, const Core& core, Meeting& m) noexcept {
  const Polytope::Edge& edge = P.edges[number];
  const Vec3& tail = P.vertices[Index(edge.tail)];
  const double b = core.axis.dot(edge.direction);
  const double sine_sq = 1.0 - b * b;
  const Vec3 w = core.center - tail;
  const double on_edge = edge.direction.dot(w);
  m.on_other = {FeatureKind::kEdge, number};
  double along = 0.0;
  if (sine_sq > kAlong * kAlong) {
    along = (b * on_edge - core.axis.dot(w)) / sine_sq;
    const double at_edge = on_edge + b * along;
    if (std::abs(along) > core.half_length || at_edge < 0.0 || at_edge > edge.length) return false;
    if (!core.meet(along, tail + at_edge * edge.direction, m)) return false;
  } else {
    const double low = std::max(0.0, on_edge - core.half_length);
    const double high = std::min(edge.length, on_edge + core.half_length);
    if (!(low <= high)) return false;
    for (const double at_edge : {low, high})
      if (!core.meet((at_edge - on_edge) / b, tail + at_edge * edge.direction, m)) return false;
  }
  return beyond(side_at(P, edge.left_slot), core.at(along)) >= 0.0 &&
         beyond(side_at(P, edge.right_slot), core.at(along)) >= 0.0;
}

/// A cylinder over a corner.
bool meet_corner(const Polytope& P, int number, const Core& core, Meeting& m) noexcept {
  const Vec3& p = P.vertices[Index(number)];
  const double along = core.axis.dot(p - core.center);
  if (std::abs(along) > core.half_length) return false;
  for (const Polytope::Ray& ray : P.rays_at(number))
    if (ray.direction.dot(core.at(along) - p) > 0.0) return false;
  m.on_other = {FeatureKind::kVertex, number};
  return core.meet(along, p, m);
}

/// A cylinder over P: over the face beside the closest feature, else over the nearest of its edges and
/// corners. `outward` is the direction toward the cylinder that was found for the facets.
bool meet_cylinder(const Polytope& P, const Core& core, const Feature& at, const Vec3& outward, double margin,
                   Meeting& m) noexcept {
  const int number = reference_face(P, at, outward);
  if (meet_face(P, number, core, margin, m)) return true;
  double least = 1e300;
  const auto offer = [&](const Meeting& other, bool meets) {
    if (!meets || !(other.points[0].distance < least)) return;
    least = other.points[0].distance;
    m = other;
  };
  const Polytope::Face& face = P.faces[number];
  for (int slot = face.first; slot < face.first + face.count; ++slot) {
    Meeting on_edge, on_corner;
    const bool over_edge = meet_edge(P, side_at(P, slot).edge, core, on_edge);
    offer(on_edge, over_edge);
    const bool over_corner = meet_corner(P, P.face_vertices[Index(slot)], core, on_corner);
    offer(on_corner, over_corner);
  }
  return least < 1e300;
}

/// Two round pieces: A's core against B's. Their points on B are on its curved surface.
bool meet_cores(const Core& a, const Core& b, Meeting& m) noexcept {
  const double cosine = a.axis.dot(b.axis);
  const bool lines = a.half_length > 0.0 && b.half_length > 0.0;
  const Vec3 w = a.center - b.center;
  const double of_a = a.axis.dot(w);
  const double of_b = b.axis.dot(w);
  const double sine_sq = 1.0 - cosine * cosine;
  StaticVector<double, 2> along_a, along_b;
  if (lines && sine_sq <= kAlong * kAlong) {
    const double low = std::max(-b.half_length, of_b - a.half_length);
    const double high = std::min(b.half_length, of_b + a.half_length);
    if (!(low <= high)) return false;
    for (const double at : {low, high}) {
      along_b.push_back(at);
      along_a.push_back((at - of_b) / cosine);
    }
  } else {
    const double at_a = lines ? (cosine * of_b - of_a) / sine_sq : a.half_length > 0.0 ? -of_a : 0.0;
    const double at_b = lines ? of_b + cosine * at_a : b.half_length > 0.0 ? of_b : 0.0;
    if (std::abs(at_a) > a.half_length || std::abs(at_b) > b.half_length) return false;
    along_a.push_back(at_a);
    along_b.push_back(at_b);
  }
  m.on_other = {FeatureKind::kVertex, 0};
  for (Index i = 0; i < along_a.size(); ++i) {
    if (!a.meet(along_a[i], b.at(along_b[i]), m)) return false;
    Meeting::Point& point = m.points[i];
    point.distance -= b.radius;
    point.on_other += b.radius * m.normal;
  }
  return true;
}

/// The round piece `round` against the facets of the other.
bool meet_facets(const RoundSide& round, const Pose& X, const Polytope& other, const Feature& at,
                 const Vec3& outward, double margin, Meeting& m) noexcept {
  const Core core(*round.round, X);
  return round.is(RoundKind::kSphere) ? meet_ball(other, core, at, m)
                                      : meet_cylinder(other, core, at, outward, margin, m);
}

/// A corner at a feature: rounds have no faces.
Feature corner_at(const Polytope& P, const Feature& at) noexcept {
  if (at.kind == FeatureKind::kVertex) return at;
  const int vertex = at.kind == FeatureKind::kEdge ? P.edges[at.index].tail
                                                   : P.face_vertices[Index(P.faces[at.index].first)];
  return {FeatureKind::kVertex, vertex};
}

}  // namespace

bool meet_round(const RoundSide& a, const RoundSide& b, const Pose& X_AB, double margin, PairDistance& found,
                StaticVector<ContactPoint, Manifold::kMostPoints>& points) noexcept {
  if (a.round == nullptr && b.round == nullptr) return false;
  if (a.round != nullptr && b.round != nullptr && !a.round->made && !b.round->made) return false;
  Meeting m;
  bool round_is_a = true;
  Feature on_a = corner_at(a.piece, found.a);
  Feature on_b = corner_at(b.piece, found.b);
  if (a.round != nullptr && b.round != nullptr &&
      meet_cores(Core(*a.round, Pose{}), Core(*b.round, X_AB), m)) {
    // Everything is in A's frame already.
  } else if (m = {}; a.round != nullptr && meet_facets(a, X_AB.inverse(), b.piece, found.b,
                                                       rotated_back(X_AB.R, found.normal), margin, m)) {
    on_b = m.on_other;
    m.normal = rotated(X_AB.R, m.normal);
    for (Meeting::Point& point : m.points)
      point = {X_AB * point.on_round, X_AB * point.on_other, point.distance};
  } else if (m = {}; b.round != nullptr && meet_facets(b, X_AB, a.piece, found.a, -found.normal, margin, m)) {
    on_a = m.on_other;
    round_is_a = false;
    m.normal = -m.normal;
  } else {
    return false;
  }
  const Meeting::Point* nearest = m.points.begin();
  for (const Meeting::Point& point : m.points) {
    if (point.distance < nearest->distance) nearest = &point;
    if (!(point.distance < margin)) continue;
    points.push_back({round_is_a ? point.on_round : point.on_other,
                      round_is_a ? point.on_other : point.on_round, point.distance, 1.0,
                      point_id(on_a, on_b, points.size())});
  }
  for (ContactPoint& point : points) point.weight = 1.0 / static_cast<double>(points.size());
  found.distance = nearest->distance;
  found.p_a = round_is_a ? nearest->on_round : nearest->on_other;
  found.p_b = round_is_a ? nearest->on_other : nearest->on_round;
  found.normal = m.normal;
  found.a = on_a;
  found.b = on_b;
  return true;
}

}  // namespace tactum::inline v0_1
