#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/collision/patch_work.h"

namespace tactum::detail {
namespace {

/// Intervals of a line, apart from each other: one, but where the stretches of an edge leave a part of it
/// out.
class Intervals {
 public:
  Intervals() noexcept = default;
  explicit Intervals(const PatchInterval& only) noexcept { add(only); }

  /// One that touches or overlaps others is one with them. Beyond the room the last takes in what is between.
  void add(PatchInterval next) noexcept {
    if (next.empty()) return;
    std::size_t kept = 0;
    for (const PatchInterval& old : intervals_) {
      const bool apart = old.low > next.high + kTouch || next.low > old.high + kTouch;
      if (apart)
        intervals_[kept++] = old;
      else
        next = {std::min(next.low, old.low), std::max(next.high, old.high)};
    }
    while (intervals_.size() > kept) intervals_.pop_back();
    if (intervals_.push_back(next)) return;
    PatchInterval& last = intervals_.back();
    last = {std::min(next.low, last.low), std::max(next.high, last.high)};
  }
  void keep_below(double at0, double at1, double limit) noexcept {
    std::size_t kept = 0;
    for (PatchInterval interval : intervals_) {
      interval.keep_below(at0, at1, limit);
      if (!interval.empty()) intervals_[kept++] = interval;
    }
    while (intervals_.size() > kept) intervals_.pop_back();
  }
  bool empty() const noexcept { return intervals_.empty(); }
  const PatchInterval* begin() const noexcept { return intervals_.begin(); }
  const PatchInterval* end() const noexcept { return intervals_.end(); }

 private:
  static constexpr double kTouch = tolerances::kCoplanar;  // in lengths of the edge
  StaticVector<PatchInterval, 8> intervals_;
};

/// The cut that a leaning face makes: only this share of its rise is kept. Told by the rise at a strip's
/// ends.
struct StripCut {
  double at0 = 0.0, at1 = 0.0, share = 1.0;
};

/// Of a linear function over `kept` the least value, or with a negative sign the largest.
double least_of(const Intervals& kept, double at0, double at1, double sign = 1.0) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const PatchInterval& interval : kept)
    for (double s : {interval.low, interval.high}) least = std::min(least, sign * (at0 + (at1 - at0) * s));
  return sign * least;
}

/// Two points with the length's moments: the Gauss points where it is one interval.
std::pair<double, double> quadrature(const Intervals& kept) noexcept {
  double length = 0.0;
  double middle = 0.0;
  for (const PatchInterval& interval : kept) {
    length += interval.high - interval.low;
    middle += (interval.high - interval.low) * 0.5 * (interval.high + interval.low);
  }
  if (!(length > 0.0)) return {kept.begin()->low, kept.begin()->low};
  middle /= length;
  double spread = 0.0;
  for (const PatchInterval& interval : kept) {
    const double own = interval.high - interval.low;
    const double off = 0.5 * (interval.high + interval.low) - middle;
    spread += own * (own * own / 12.0 + off * off);
  }
  const double reach = std::sqrt(spread / length);
  return {middle - reach, middle + reach};
}

/// Two points on the kept part of a strip.
void interval_contact(const PatchWork& w, const Strip& strip, Intervals kept,
                      const StripCut& cut = {}) noexcept {
  const Vec3& n = w.closest.normal;
  const double gap0 = n.dot(strip.a0 - strip.b0);
  const double gap1 = n.dot(strip.a1 - strip.b1);
  if (kept.empty()) return point_contact(w);
  const double least = least_of(kept, gap0, gap1);
  if (least >= w.tolerance) return point_contact(w);
  kept.keep_below(gap0, gap1, cut_level(w, least));
  if (kept.empty()) return point_contact(w);
  if (cut.share < 1.0) {
    const double highest = std::max(0.0, least_of(kept, cut.at0, cut.at1, -1.0));
    kept.keep_below(cut.at0, cut.at1, highest * cut.share);
    if (kept.empty()) return point_contact(w);
  }
  const auto [first, second] = quadrature(kept);
  std::uint64_t name = w.name(4);
  for (double s : {first, second})
    w.out.points.push_back({strip.a0 + (strip.a1 - strip.a0) * s, strip.b0 + (strip.b1 - strip.b0) * s,
                            gap0 + (gap1 - gap0) * s, 0.5, name++});
}

/// A segment's ends in the contact plane.
struct Segment {
  Vec2 x0, x1;
  /// Where `x` is along it, in parts of its length.
  double place(const Vec2& x) const noexcept { return (x - x0).dot(x1 - x0) / (x1 - x0).squaredNorm(); }
};

Segment flat_edge(const Projection& plane, const Polytope& P, int edge, const Pose& X) noexcept {
  return {plane.flat(X * P.vertices[P.edges[edge].tail]), plane.flat(X * P.vertices[P.edges[edge].head])};
}

/// The contact plane, told in the frame of either piece: coordinates x along e1, e2 and height along n, from
/// a point near the contact.
struct Tangent {
  Vec3 origin, e1, e2, n;

  Projection projection() const noexcept {
    return {origin, Two{e1.x(), e2.x()}, Two{e1.y(), e2.y()}, Two{e1.z(), e2.z()}};
  }
  Vec3 point(const Vec2& x, double z) const noexcept { return origin + e1 * x.x() + e2 * x.y() + n * z; }
};

/// 1 / sqrt(1 - lean), for `lean` in [0, 1). Where three terms of its series do they stand in for the
/// root and the quotient, which all that follows would wait for.
double grown_to_unit(double lean) noexcept {
  return lean < tolerances::kThreeTerms ? 1.0 + lean * (0.5 + lean * 0.375) : 1.0 / std::sqrt(1.0 - lean);
}

/// Along A's edge, or a side of its face: nearly square to the normal already in the answers of the queries.
Tangent contact_plane(const PatchWork& w) noexcept {
  const Feature& a = w.a.feature;
  const int edge = a.kind == FeatureKind::kEdge ? a.index : w.A.sides[w.A.faces[a.index].first].edge;
  const Vec3& u = w.A.edges[edge].direction;
  const Vec3& n = w.closest.normal;
  const double along = n.dot(u);
  const double lean = along * along;
  const Vec3 e1 = lean < 0.75 ? Vec3((u - n * along) * grown_to_unit(lean)) : any_orthogonal(n);
  return {w.closest.p_b, e1, n.cross(e1), n};
}

/// ... in B's frame.
Tangent in_b(const PatchWork& w, const Tangent& plane) noexcept {
  const Vec3 e1 = rotated_back(w.X_AB.R, plane.e1);
  return {rotated_back(w.X_AB.R, plane.origin - w.X_AB.p), e1, w.n_B.cross(e1), w.n_B};
}

Height face_height(const Tangent& plane, const Polytope& P, int face_index) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const double per_up = 1.0 / face.normal.dot(plane.n);
  return {(face.offset - face.normal.dot(plane.origin)) * per_up,
          {-face.normal.dot(plane.e1) * per_up, -face.normal.dot(plane.e2) * per_up}};
}

/// Keeps the part of a segment inside a convex, counter-clockwise window.
PatchInterval clip_segment(const Segment& segment, const PatchPolygon& window) noexcept {
  PatchInterval kept;
  const std::size_t n = window.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& corner = window[i];
    const Vec2 side = window[i + 1 == n ? 0 : i + 1] - corner;
    const Vec2 outward(side.y(), -side.x());
    kept.keep_below(outward.dot(segment.x0 - corner), outward.dot(segment.x1 - corner), 0.0);
  }
  return kept;
}

/// The part of a stretch, along the line of the contact's edge.
PatchInterval along(const Segment& line, const Segment& stretch, const PatchInterval& kept) noexcept {
  if (kept.empty()) return kept;
  const double from = line.place(stretch.x0);
  const double per_part = line.place(stretch.x1) - from;
  const double low = from + per_part * kept.low;
  const double high = from + per_part * kept.high;
  return {std::min(low, high), std::max(low, high)};
}

/// An edge and the face over or under it. `up` is +1 when the face is A's, which rises over the contact
/// plane, -1 when it is B's.
struct EdgeAndFace {
  const Polytope& E;
  int edge;
  const Pose& X_E;
  const Polytope& F;
  int face;
  double up;
};

PatchInterval clipped(const Projection& plane, const EdgeAndFace& pair, const Segment& segment) noexcept {
  PatchPolygon window;
  face_outline(plane, pair.F, pair.face, pair.up > 0.0, window);
  return clip_segment(segment, window);
}

/// The strip of an edge and the face over or under it, clipped by the face.
void edge_over_face(const PatchWork& w, const EdgeAndFace& pair, const Facing& facing,
                    const Pose& X_F) noexcept {
  const bool face_is_a = pair.up > 0.0;
  const Tangent in_a = contact_plane(w);
  const Projection of_a = in_a.projection();
  const Segment segment = flat_edge(of_a, pair.E, pair.edge, pair.X_E);
  const Tangent of_face = face_is_a ? in_a : in_b(w, in_a);
  const Height height = face_height(of_face, pair.F, pair.face);
  const Vec3 edge0 = pair.X_E * pair.E.vertices[pair.E.edges[pair.edge].tail];
  const Vec3 edge1 = pair.X_E * pair.E.vertices[pair.E.edges[pair.edge].head];
  const Vec3 face0 = in_a.point(segment.x0, height(segment.x0));
  const Vec3 face1 = in_a.point(segment.x1, height(segment.x1));
  Intervals kept(clipped(of_face.projection(), pair, segment));
  for (const Stretch& other : w.others) {
    const EdgeAndFace next =
        face_is_a ? EdgeAndFace{*other.B, other.b.index, pair.X_E, *other.A, other.a.index, 1.0}
                  : EdgeAndFace{*other.A, other.a.index, pair.X_E, *other.B, other.b.index, -1.0};
    const Segment stretch = flat_edge(of_a, next.E, next.edge, next.X_E);
    kept.add(along(segment, stretch, clipped(of_face.projection(), next, stretch)));
  }
  StripCut cut;
  if (facing.face_share < 1.0) {
    const Rise rise = rise_from_edge(of_a, pair.F, facing.edge, X_F, pair.up * height.slope);
    cut = {rise(segment.x0), rise(segment.x1), facing.face_share};
  }
  if (face_is_a)
    interval_contact(w, {face0, face1, edge0, edge1}, kept, cut);
  else
    interval_contact(w, {edge0, edge1, face0, face1}, kept, cut);
}

}  // namespace

void edge_a_face_b(const PatchWork& w) noexcept {
  const Pose in_a;
  edge_over_face(w, {w.A, w.a.feature.index, in_a, w.B, w.b.feature.index, -1.0}, w.b, w.X_AB);
}

void face_a_edge_b(const PatchWork& w) noexcept {
  edge_over_face(w, {w.B, w.b.feature.index, w.X_AB, w.A, w.a.feature.index, 1.0}, w.a, {});
}

/// Parallel edges share an interval. Edges that cross at a small angle share the part about the crossing
/// where they are no farther apart sideways than the tolerance; the larger the angle, the less, down to the
/// crossing.
void edge_edge_contact(const PatchWork& w) noexcept {
  const Projection plane = contact_plane(w).projection();
  const Segment line = flat_edge(plane, w.A, w.a.feature.index, {});
  const Segment over = flat_edge(plane, w.B, w.b.feature.index, w.X_AB);
  // B's ends, in parts of A's length along A and across it.
  const Vec2 along_a = line.x1 - line.x0;
  const double length_sq = along_a.squaredNorm();
  const Vec2 tail = over.x0 - line.x0;
  const Vec2 head = over.x1 - line.x0;
  const double s0 = along_a.dot(tail) / length_sq;
  const double s1 = along_a.dot(head) / length_sq;
  const double side0 = (along_a.x() * tail.y() - along_a.y() * tail.x()) / length_sq;
  const double side1 = (along_a.x() * head.y() - along_a.y() * head.x()) / length_sq;
  const double rate = (side1 - side0) / (s1 - s0);  // tangent of the angle between them
  if (!(std::abs(rate) < w.angle)) return point_contact(w);
  PatchInterval about;  // the crossing
  about.low = -std::numeric_limits<double>::infinity();
  about.high = std::numeric_limits<double>::infinity();
  if (std::abs(rate) > tolerances::kSamePlane) {
    const double crossing = s0 - side0 / rate;
    const double apart =
        std::max(w.tolerance, 0.0) / std::sqrt(length_sq) * share_kept(std::abs(rate), w.angle);
    about = {crossing - apart / std::abs(rate), crossing + apart / std::abs(rate)};
  }
  const auto common = [&](const PatchInterval& of_a, double b0, double b1) -> PatchInterval {
    return {std::max({of_a.low, std::min(b0, b1), about.low}),
            std::min({of_a.high, std::max(b0, b1), about.high})};
  };
  Intervals kept(common({}, s0, s1));
  for (const Stretch& other : w.others) {
    const Segment of_a = flat_edge(plane, *other.A, other.a.index, {});
    const Segment of_b = flat_edge(plane, *other.B, other.b.index, w.X_AB);
    kept.add(common(along(line, of_a, {}), line.place(of_b.x0), line.place(of_b.x1)));
  }
  const Vec3& a0 = w.A.vertices[w.A.edges[w.a.feature.index].tail];
  const Vec3& a1 = w.A.vertices[w.A.edges[w.a.feature.index].head];
  const Vec3 b_tail = w.vertex_b(w.B.edges[w.b.feature.index].tail);
  const Vec3 b_head = w.vertex_b(w.B.edges[w.b.feature.index].head);
  const Vec3 b_per_part = (b_head - b_tail) / (s1 - s0);
  const Vec3 b0 = b_tail - b_per_part * s0;
  interval_contact(w, {a0, a1, b0, b0 + b_per_part}, kept);
}

void strip_contact(const PatchWork& w, const Strip& strip) noexcept {
  interval_contact(w, strip, Intervals(PatchInterval()));
}

}  // namespace tactum::detail
