#include "tactum/collision/manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/collision/contact_plane.h"
#include "tactum/collision/facing_feature.h"
#include "tactum/collision/pair_view.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

/// What a handler works on. Built in place: copying vectors that have just been written makes the processor
/// wait for them.
struct Work {
  const Polytope& A;
  const Polytope& B;
  const Pose& X_AB;
  const PairDistance& closest;
  double tolerance;
  double angle;
  Vec3 n_B;  ///< the normal in B's frame
  Facing a, b;
  Tangent tangent;
  Manifold& out;

  Work(const Polytope& of_a, const Polytope& of_b, const Pose& X, const PairDistance& at, double below,
       double within, Manifold& patch) noexcept
      : A(of_a),
        B(of_b),
        X_AB(X),
        closest(at),
        tolerance(below),
        angle(within),
        n_B(rotated_back(X.R, at.normal)),
        a(facing_feature(A, at.a, -at.normal, angle)),
        b(facing_feature(B, at.b, n_B, angle)),
        tangent(contact_plane(A, a.feature, at.p_b, at.normal)),
        out(patch) {}

  Vec3 vertex_b(int v) const noexcept { return X_AB * B.vertices[v]; }
  /// The contact plane in B's frame.
  Tangent tangent_B() const noexcept {
    Tangent plane{rotated_back(X_AB.R, tangent.origin - X_AB.p), rotated_back(X_AB.R, tangent.e1), {}, n_B};
    plane.e2 = plane.n.cross(plane.e1);
    return plane;
  }
};

/// How much of the gap's range is kept as the features lean.
double gap_share(const Work& w) noexcept {
  const auto share_of = [](const Facing& f) {
    return f.feature.kind == Kind::kFace ? std::max(f.face_share, f.along_share) : f.along_share;
  };
  return std::min(share_of(w.a), share_of(w.b));
}

/// The gap above which the patch ends: the tolerance, or nearer the least gap when the features lean. That of
/// a stretch (seam_settler.h) is the whole contact's, `closest` is where the least is.
double cut_level(const Work& w, double least_gap) noexcept {
  const double share = gap_share(w);
  least_gap = std::min(least_gap, w.closest.distance);
  return share >= 1.0 ? w.tolerance : least_gap + (w.tolerance - least_gap) * share;
}

void point_contact(const Work& w) noexcept {
  w.out.points.clear();
  w.out.area = 0.0;
  w.out.points.push_back({w.closest.p_a, w.closest.p_b, w.closest.distance, 1.0, 0});
}

/// Points of A and of B over each other at both ends of a segment; linear between.
struct Strip {
  Vec3 a0, a1, b0, b1;
};

/// The cut that a leaning face makes: only this share of its rise is kept. Told by the rise at a strip's
/// ends.
struct StripCut {
  double at0 = 0.0, at1 = 0.0, share = 1.0;
};

/// Two Gauss points on the kept part of a strip.
void interval_contact(const Work& w, const Strip& strip, PatchInterval kept,
                      const StripCut& cut = {}) noexcept {
  const double gap0 = w.tangent.n.dot(strip.a0 - strip.b0);
  const double gap1 = w.tangent.n.dot(strip.a1 - strip.b1);
  const auto gap = [&](double s) { return gap0 + (gap1 - gap0) * s; };
  if (kept.empty()) return point_contact(w);
  const double least = std::min(gap(kept.low), gap(kept.high));
  if (least >= w.tolerance) return point_contact(w);
  kept.keep_below(gap0, gap1, cut_level(w, least));
  if (kept.empty()) return point_contact(w);
  if (cut.share < 1.0) {
    const auto rise = [&](double s) { return cut.at0 + (cut.at1 - cut.at0) * s; };
    kept.keep_below(cut.at0, cut.at1, std::max({0.0, rise(kept.low), rise(kept.high)}) * cut.share);
    if (kept.empty()) return point_contact(w);
  }
  const double middle = 0.5 * (kept.low + kept.high);
  const double reach = 0.5 * (kept.high - kept.low) / std::sqrt(3.0);
  for (double s : {middle - reach, middle + reach})
    w.out.points.push_back(
        {strip.a0 + (strip.a1 - strip.a0) * s, strip.b0 + (strip.b1 - strip.b0) * s, gap(s), 0.5, 0});
}

/// Keeps the part of x0..x1 inside a convex, counter-clockwise window.
PatchInterval clip_segment(const Vec2& x0, const Vec2& x1, const PatchPolygon& window) noexcept {
  PatchInterval kept;
  const std::size_t n = window.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& corner = window[i];
    const Vec2 side = window[i + 1 == n ? 0 : i + 1] - corner;
    const Vec2 outward(side.y(), -side.x());
    kept.keep_below(outward.dot(x0 - corner), outward.dot(x1 - corner), 0.0);
  }
  return kept;
}

/// The strip of an edge and the face over or under it, clipped by the face; as (edge, face).
struct EdgeOverFace {
  Vec3 edge0, edge1, face0, face1;
  PatchInterval kept;
  StripCut cut;
};

/// `up` is +1 when the face is A's, which rises over the contact plane, -1 when it is B's.
EdgeOverFace edge_over_face(const Work& w, const Polytope& E, int edge, const Pose& X_E, const Polytope& F,
                            const Facing& facing, const Pose& X_F, double up) noexcept {
  const int face = facing.feature.index;
  EdgeOverFace strip;
  strip.edge0 = X_E * E.vertices[E.edges[edge].tail];
  strip.edge1 = X_E * E.vertices[E.edges[edge].head];
  const Vec2 x0 = w.tangent.flat(strip.edge0);
  const Vec2 x1 = w.tangent.flat(strip.edge1);
  const Tangent plane = up > 0.0 ? w.tangent : w.tangent_B();
  const Height height = face_height(plane, F, face);
  strip.face0 = w.tangent.point(x0, height(x0));
  strip.face1 = w.tangent.point(x1, height(x1));
  PatchPolygon window;
  face_outline(plane, F, face, up > 0.0, window);
  strip.kept = clip_segment(x0, x1, window);
  if (facing.face_share < 1.0) {
    const Rise rise = rise_from_edge(w.tangent, F, facing.edge, X_F, up * height.slope);
    strip.cut = {rise(x0), rise(x1), facing.face_share};
  }
  return strip;
}

void edge_a_face_b(const Work& w) noexcept {
  const EdgeOverFace x = edge_over_face(w, w.A, w.a.feature.index, {}, w.B, w.b, w.X_AB, -1.0);
  interval_contact(w, {x.edge0, x.edge1, x.face0, x.face1}, x.kept, x.cut);
}

void face_a_edge_b(const Work& w) noexcept {
  const EdgeOverFace x = edge_over_face(w, w.B, w.b.feature.index, w.X_AB, w.A, w.a, {}, 1.0);
  interval_contact(w, {x.face0, x.face1, x.edge0, x.edge1}, x.kept, x.cut);
}

/// Parallel edges share an interval. Edges that cross at a small angle share the part about the crossing
/// where they are no farther apart sideways than the tolerance; the larger the angle, the less, down to the
/// crossing.
void edge_edge_contact(const Work& w) noexcept {
  const Polytope::Edge& ea = w.A.edges[w.a.feature.index];
  const Polytope::Edge& eb = w.B.edges[w.b.feature.index];
  const Vec3& a0 = w.A.vertices[ea.tail];
  const Vec3& a1 = w.A.vertices[ea.head];
  const Vec3 b_tail = w.vertex_b(eb.tail);
  const Vec3 b_head = w.vertex_b(eb.head);
  const Vec2 along = w.tangent.flat(a1) - w.tangent.flat(a0);
  const double length_sq = along.squaredNorm();
  // B's ends, in parts of A's length along A and across it.
  const Vec2 tail = w.tangent.flat(b_tail) - w.tangent.flat(a0);
  const Vec2 head = w.tangent.flat(b_head) - w.tangent.flat(a0);
  const double s0 = along.dot(tail) / length_sq;
  const double s1 = along.dot(head) / length_sq;
  const double side0 = (along.x() * tail.y() - along.y() * tail.x()) / length_sq;
  const double side1 = (along.x() * head.y() - along.y() * head.x()) / length_sq;
  const double rate = (side1 - side0) / (s1 - s0);  // tangent of the angle between them
  if (!(std::abs(rate) < w.angle)) return point_contact(w);
  PatchInterval kept{std::max(0.0, std::min(s0, s1)), std::min(1.0, std::max(s0, s1))};
  if (std::abs(rate) > tolerances::kSamePlane) {
    const double crossing = s0 - side0 / rate;
    const double apart =
        std::max(w.tolerance, 0.0) / std::sqrt(length_sq) * share_kept(std::abs(rate), w.angle);
    kept.low = std::max(kept.low, crossing - apart / std::abs(rate));
    kept.high = std::min(kept.high, crossing + apart / std::abs(rate));
  }
  const Vec3 b_per_part = (b_head - b_tail) / (s1 - s0);
  const Vec3 b0 = b_tail - b_per_part * s0;
  interval_contact(w, {a0, a1, b0, b0 + b_per_part}, kept);
}

/// A polygon without area: the interval between its farthest corners.
void sliver_contact(const Work& w, const PatchPolygon& polygon, const Height& za, const Height& zb) noexcept {
  Vec2 x0 = polygon[0];
  Vec2 x1 = polygon[0];
  for (const Vec2& x : polygon)
    if ((x - x0).squaredNorm() > (x1 - x0).squaredNorm()) x1 = x;
  for (const Vec2& x : polygon)
    if ((x - x1).squaredNorm() > (x0 - x1).squaredNorm()) x0 = x;
  if (x1.x() < x0.x()) std::swap(x0, x1);  // along A's feature, so that the ends keep their places
  interval_contact(w,
                   {w.tangent.point(x0, za(x0)), w.tangent.point(x1, za(x1)), w.tangent.point(x0, zb(x0)),
                    w.tangent.point(x1, zb(x1))},
                   {});
}

struct GapRange {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
};

GapRange gap_range(const Height& gap, const PatchPolygon& polygon) noexcept {
  GapRange range;
  for (const Vec2& x : polygon) {
    const double here = gap(x);
    range.least = std::min(range.least, here);
    range.most = std::max(range.most, here);
  }
  return range;
}

/// One of four points: B's surface is under A's, along the normal.
inline void add_quarter(const Work& w, const Vec3& p_a, double gap) noexcept {
  w.out.points.push_back({p_a, p_a - w.tangent.n * gap, gap, 0.25, 0});
}

void face_face_contact(const Work& w) noexcept {
  const Tangent tangent_B = w.tangent_B();
  const Height za = face_height(w.tangent, w.A, w.a.feature.index);
  const Height zb = face_height(tangent_B, w.B, w.b.feature.index);
  const Height gap{za.at_origin - zb.at_origin, za.slope - zb.slope};
  PatchPolygon polygon;
  PatchPolygon window;
  face_outline(w.tangent, w.A, w.a.feature.index, true, polygon);
  face_outline(tangent_B, w.B, w.b.feature.index, false, window);
  const GapRange before = gap_range(gap, polygon);
  clip_polygon(polygon, window);
  if (polygon.empty()) return point_contact(w);
  // Where the whole face is within the tolerance the gap cuts nothing.
  if (before.most > w.tolerance || gap_share(w) < 1.0) {
    const GapRange range = gap_range(gap, polygon);
    if (range.least >= w.tolerance) return point_contact(w);
    if (const double level = cut_level(w, range.least); range.most > level)
      clip_polygon(polygon, gap.slope, level - gap.at_origin);
  }
  const auto cut_toward_edge = [&](const Rise& rise, double share) {
    double highest = 0.0;
    for (const Vec2& x : polygon) highest = std::max(highest, rise(x));
    clip_polygon(polygon, rise.slope, rise.offset + highest * share);
  };
  if (w.a.face_share < 1.0)
    cut_toward_edge(rise_from_edge(w.tangent, w.A, w.a.edge, {}, za.slope), w.a.face_share);
  if (w.b.face_share < 1.0)
    cut_toward_edge(rise_from_edge(w.tangent, w.B, w.b.edge, w.X_AB, -zb.slope), w.b.face_share);
  if (polygon.empty()) return point_contact(w);
  const PatchMoments m = moments_of(polygon);
  const double size = std::max(w.A.size, w.B.size);
  if (m.area <= tolerances::kPatchArea * size * size) return sliver_contact(w, polygon, za, zb);
  w.out.area = m.area;
  const PatchSpread arms = spread_of(m);
  const Vec3 center = w.tangent.point(m.centroid, za(m.centroid));
  const double center_gap = gap(m.centroid);
  for (const Vec2* arm : {&arms.u, &arms.v}) {
    const Vec3 to_a = w.tangent.e1 * arm->x() + w.tangent.e2 * arm->y() + w.tangent.n * za.slope.dot(*arm);
    const double opens = gap.slope.dot(*arm);
    add_quarter(w, center + to_a, center_gap + opens);
    add_quarter(w, center - to_a, center_gap - opens);
  }
}

using Handler = void (*)(const Work&) noexcept;

/// The six combinations (nine with A and B exchanged), by the kinds of A's and B's feature.
constexpr std::array<std::array<Handler, 3>, 3> kHandlers = {{
    // B: vertex       edge               face
    {point_contact, point_contact, point_contact},      // A: vertex
    {point_contact, edge_edge_contact, edge_a_face_b},  // A: edge
    {point_contact, face_a_edge_b, face_face_contact},  // A: face
}};

/// The places: among the four points of an area, two of a line, or the one. Arms and ends go with the
/// features, so the places do.
void name_points(Manifold& patch) noexcept {
  const std::size_t points = patch.points.size();
  const std::uint64_t first = points == 4 ? 0 : points == 2 ? 4 : 6;
  for (std::size_t i = 0; i < points; ++i) patch.points[i].id = point_id(patch.a, patch.b, first + i);
}

}  // namespace

void contact_manifold_within(const Polytope& A, const Polytope& B, const Pose& X_AB,
                             const PairDistance& closest, double tolerance, double angle,
                             Manifold& out) noexcept {
  out.points.clear();
  out.area = 0.0;
  out.normal = closest.normal;
  out.a = closest.a;
  out.b = closest.b;
  if (!(closest.distance < tolerance) || !(closest.normal.squaredNorm() > 0.0) || closest.a.index < 0 ||
      closest.b.index < 0)
    return;
  const Work work(A, B, X_AB, closest, tolerance, angle, out);
  out.a = work.a.feature;
  out.b = work.b.feature;
  kHandlers[static_cast<std::size_t>(out.a.kind)][static_cast<std::size_t>(out.b.kind)](work);
  name_points(out);
}

void contact_manifold(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                      double tolerance, Manifold& out) noexcept {
  contact_manifold_within(A, B, X_AB, closest, tolerance, tolerances::kPatchAngle, out);
}

}  // namespace tactum
