#include "tactum/collision/manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/collision/pair_view.h"
#include "tactum/collision/planar_patch.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

/// How much of the patch is kept when a feature leans by `lean` out of `most`: all up to half, then less, to none.
double share_kept(double lean, double most) noexcept { return std::clamp(2.0 * (most - lean) / most, 0.0, 1.0); }

/// The feature of one piece that takes part, and how much of the patch its leaning leaves.
struct Facing {
  Feature feature;
  double share = 1.0;
};

/// Calls visit(face) for the faces that hold feature `f`.
template <class Visit>
void for_faces_at(const Polytope& P, const Feature& f, const Visit& visit) noexcept {
  if (f.kind == Kind::kFace) return visit(f.index);
  if (f.kind == Kind::kEdge) {
    visit(P.edges[f.index].left);
    visit(P.edges[f.index].right);
    return;
  }
  for (int e : P.edges_at(f.index)) visit(P.edges[e].tail == f.index ? P.edges[e].left : P.edges[e].right);
}

/// The largest feature at `f` square to `outward` (unit, P's frame) within `angle`. Beside a face that leans as little
/// the patch shrinks too, so that rolling from one face to the next passes through their edge.
Facing facing_feature(const Polytope& P, const Feature& f, const Vec3& outward, double angle) noexcept {
  int face = -1;
  double lean = 2.0;
  double next = 2.0;
  for_faces_at(P, f, [&](int candidate) {
    const Vec3& normal = P.faces[candidate].normal;
    const double sine = normal.dot(outward) > 0.0 ? normal.cross(outward).norm() : 2.0;
    if (sine < lean) {
      next = lean;
      lean = sine;
      face = candidate;
    } else {
      next = std::min(next, sine);
    }
  });
  if (lean < angle) {
    const double lead = next > lean ? 2.0 * (next - lean) / (next + lean) : 0.0;
    return {{Kind::kFace, face}, share_kept(lean, angle) * std::min(1.0, lead)};
  }
  if (f.kind != Kind::kVertex) return {f, 1.0};
  int edge = -1;
  lean = angle;
  for (int e : P.edges_at(f.index))
    if (const double slope = std::abs(P.edges[e].direction.dot(outward)); slope < lean) {
      lean = slope;
      edge = e;
    }
  return edge >= 0 ? Facing{{Kind::kEdge, edge}, share_kept(lean, angle)} : Facing{f, 1.0};
}

/// The contact plane: coordinates x along e1, e2 and height along n, from a point near the contact.
struct Tangent {
  Vec3 origin, e1, e2, n;

  Vec2 flat(const Vec3& p) const noexcept { return {e1.dot(p - origin), e2.dot(p - origin)}; }
  double height(const Vec3& p) const noexcept { return n.dot(p - origin); }
  Vec3 point(const Vec2& x, double z) const noexcept { return origin + e1 * x.x() + e2 * x.y() + n * z; }
};

/// Height of a plane over the contact plane, linear in x.
struct Height {
  double at_origin = 0.0;
  Vec2 slope = Vec2::Zero();
  double operator()(const Vec2& x) const noexcept { return at_origin + slope.dot(x); }
};

Height height_of_plane(const Tangent& tangent, const Vec3& normal, const Vec3& on_plane) noexcept {
  const double up = normal.dot(tangent.n);
  return {normal.dot(on_plane - tangent.origin) / up, {-normal.dot(tangent.e1) / up, -normal.dot(tangent.e2) / up}};
}

/// A segment seen from above: its ends and their heights.
struct Segment {
  Vec2 x0, x1;
  double z0 = 0.0, z1 = 0.0;
};

struct Work {
  const PairView& pair;
  const PairDistance& closest;
  double tolerance;
  double angle;
  Tangent tangent;
  Facing a, b;
  Manifold& out;
};

void face_outline(const Tangent& tangent, const Polytope& P, int face_index, const Pose& X, PatchPolygon& loop) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  const int stride = (face.count + kPatchCorners - 1) / kPatchCorners;
  loop.clear();
  for (int i = 0; i < face.count; i += stride)
    loop.push_back(tangent.flat(X * P.vertices[P.face_vertices[face.first + i]]));
  if (twice_area(loop) < 0.0) std::reverse(loop.begin(), loop.end());
}

Height face_height(const Tangent& tangent, const Polytope& P, int face_index, const Pose& X) noexcept {
  const Polytope::Face& face = P.faces[face_index];
  return height_of_plane(tangent, X.R * face.normal, X * P.vertices[P.face_vertices[face.first]]);
}

Segment edge_segment(const Tangent& tangent, const Polytope& P, int edge_index, const Pose& X) noexcept {
  const Vec3 tail = X * P.vertices[P.edges[edge_index].tail];
  const Vec3 head = X * P.vertices[P.edges[edge_index].head];
  return {tangent.flat(tail), tangent.flat(head), tangent.height(tail), tangent.height(head)};
}

/// The gap above which the patch ends: the tolerance, or nearer the least gap when the features lean.
double cut_level(const Work& w, double least_gap) noexcept {
  const double share = w.a.share * w.b.share;
  return share >= 1.0 ? w.tolerance : least_gap + (w.tolerance - least_gap) * share;
}

void add_point(const Work& w, const Vec2& x, double za, double zb, double weight) noexcept {
  w.out.points.push_back({w.tangent.point(x, za), w.tangent.point(x, zb), za - zb, weight});
}

void point_contact(const Work& w) noexcept {
  w.out.points.clear();
  w.out.area = 0.0;
  w.out.points.push_back({w.closest.p_a, w.closest.p_b, w.closest.distance, 1.0});
}

/// Two Gauss points on the kept part of a segment, where A has heights a0..a1 and B has b0..b1 along it.
void interval_contact(const Work& w, const Vec2& x0, const Vec2& x1, PatchInterval kept, double a0, double a1, double b0,
                      double b1) noexcept {
  const double gap0 = a0 - b0;
  const double gap1 = a1 - b1;
  const auto gap = [&](double s) { return gap0 + (gap1 - gap0) * s; };
  if (kept.empty()) return point_contact(w);
  const double least = std::min(gap(kept.low), gap(kept.high));
  if (least >= w.tolerance) return point_contact(w);
  kept.keep_below(gap0, gap1, cut_level(w, least));
  if (kept.empty()) return point_contact(w);
  const double middle = 0.5 * (kept.low + kept.high);
  const double reach = 0.5 * (kept.high - kept.low) / std::sqrt(3.0);
  for (double s : {middle - reach, middle + reach})
    add_point(w, x0 + (x1 - x0) * s, a0 + (a1 - a0) * s, b0 + (b1 - b0) * s, 0.5);
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

void edge_face_contact(const Work& w, const Segment& edge, const PatchPolygon& window, const Height& face, bool edge_of_a) noexcept {
  const PatchInterval kept = clip_segment(edge.x0, edge.x1, window);
  const double f0 = face(edge.x0);
  const double f1 = face(edge.x1);
  if (edge_of_a) {
    interval_contact(w, edge.x0, edge.x1, kept, edge.z0, edge.z1, f0, f1);
  } else {
    interval_contact(w, edge.x0, edge.x1, kept, f0, f1, edge.z0, edge.z1);
  }
}

void edge_a_face_b(const Work& w) noexcept {
  PatchPolygon window;
  face_outline(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB, window);
  edge_face_contact(w, edge_segment(w.tangent, w.pair.A, w.a.feature.index, {}), window,
                    face_height(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB), true);
}

void face_a_edge_b(const Work& w) noexcept {
  PatchPolygon window;
  face_outline(w.tangent, w.pair.A, w.a.feature.index, {}, window);
  edge_face_contact(w, edge_segment(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB), window,
                    face_height(w.tangent, w.pair.A, w.a.feature.index, {}), false);
}

/// Parallel edges share an interval. Edges that cross at a small angle share the part about the crossing where they are
/// no farther apart sideways than the tolerance; the larger the angle, the less, down to the crossing.
void edge_edge_contact(const Work& w) noexcept {
  const Segment a = edge_segment(w.tangent, w.pair.A, w.a.feature.index, {});
  const Segment b = edge_segment(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB);
  const Vec2 along = a.x1 - a.x0;
  const double length_sq = along.squaredNorm();
  const double s0 = along.dot(b.x0 - a.x0) / length_sq;  // B's ends along A, in parts of A
  const double s1 = along.dot(b.x1 - a.x0) / length_sq;
  const auto sideways = [&](const Vec2& x) { return (along.x() * (x - a.x0).y() - along.y() * (x - a.x0).x()) / length_sq; };
  const double side0 = sideways(b.x0);
  const double side1 = sideways(b.x1);
  const double tangent_of_angle = std::abs(side1 - side0) / std::abs(s1 - s0);
  if (!(tangent_of_angle < w.angle)) return point_contact(w);
  PatchInterval kept{std::max(0.0, std::min(s0, s1)), std::min(1.0, std::max(s0, s1))};
  const double rate = (side1 - side0) / (s1 - s0);  // sideways per part of A
  if (std::abs(rate) > tolerances::kSamePlane) {
    const double crossing = s0 - side0 / rate;
    const double reach =
        std::max(w.tolerance, 0.0) / std::sqrt(length_sq) * share_kept(tangent_of_angle, w.angle) / std::abs(rate);
    kept.low = std::max(kept.low, crossing - reach);
    kept.high = std::min(kept.high, crossing + reach);
  }
  const double slope_b = (b.z1 - b.z0) / (s1 - s0);
  const double b_at_0 = b.z0 - slope_b * s0;
  interval_contact(w, a.x0, a.x1, kept, a.z0, a.z1, b_at_0, b_at_0 + slope_b);
}

/// A polygon without area: the interval between its farthest corners.
void sliver_contact(const Work& w, const PatchPolygon& polygon, const Height& za, const Height& zb) noexcept {
  Vec2 x0 = polygon[0];
  Vec2 x1 = polygon[0];
  for (const Vec2& x : polygon)
    if ((x - x0).squaredNorm() > (x1 - x0).squaredNorm()) x1 = x;
  for (const Vec2& x : polygon)
    if ((x - x1).squaredNorm() > (x0 - x1).squaredNorm()) x0 = x;
  interval_contact(w, x0, x1, {}, za(x0), za(x1), zb(x0), zb(x1));
}

void face_face_contact(const Work& w) noexcept {
  PatchPolygon polygon;
  PatchPolygon window;
  PatchPolygon scratch;
  face_outline(w.tangent, w.pair.A, w.a.feature.index, {}, polygon);
  face_outline(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB, window);
  const Height za = face_height(w.tangent, w.pair.A, w.a.feature.index, {});
  const Height zb = face_height(w.tangent, w.pair.B, w.b.feature.index, w.pair.X_AB);
  clip_polygon(polygon, window, scratch);
  if (polygon.empty()) return point_contact(w);
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2& x : polygon) least = std::min(least, za(x) - zb(x));
  if (least >= w.tolerance) return point_contact(w);
  clip_polygon(polygon, za.slope - zb.slope, cut_level(w, least) - (za.at_origin - zb.at_origin), scratch);
  if (polygon.empty()) return point_contact(w);
  const PatchMoments m = moments_of(polygon);
  if (m.area <= tolerances::kPatchArea * w.pair.size * w.pair.size) return sliver_contact(w, polygon, za, zb);
  w.out.area = m.area;
  const Vec2 across(-m.axis.y(), m.axis.x());
  const Vec2 major = m.axis * std::sqrt(2.0 * m.major);
  const Vec2 minor = across * std::sqrt(2.0 * m.minor);
  for (const Vec2& x : {Vec2(m.centroid + major), Vec2(m.centroid - major), Vec2(m.centroid + minor), Vec2(m.centroid - minor)})
    add_point(w, x, za(x), zb(x), 0.25);
}

using Handler = void (*)(const Work&) noexcept;

/// The six combinations (nine with A and B exchanged), by the kinds of A's and B's feature.
constexpr std::array<std::array<Handler, 3>, 3> kHandlers = {{
    // B: vertex       edge               face
    {point_contact, point_contact, point_contact},          // A: vertex
    {point_contact, edge_edge_contact, edge_a_face_b},      // A: edge
    {point_contact, face_a_edge_b, face_face_contact},      // A: face
}};

}  // namespace

void contact_manifold_within(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                             double tolerance, double angle, Manifold& out) noexcept {
  out.points.clear();
  out.area = 0.0;
  out.normal = closest.normal;
  out.a = closest.a;
  out.b = closest.b;
  if (!(closest.distance < tolerance) || closest.normal.isZero() || closest.a.index < 0 || closest.b.index < 0) return;
  const PairView pair(A, B, X_AB);
  const Vec3& n = closest.normal;
  Tangent tangent{closest.p_b, any_orthogonal(n), Vec3::Zero(), n};
  tangent.e2 = n.cross(tangent.e1);
  const Work work{pair,
                  closest,
                  tolerance,
                  angle,
                  tangent,
                  facing_feature(A, closest.a, -n, angle),
                  facing_feature(B, closest.b, pair.X_BA.R * n, angle),
                  out};
  out.a = work.a.feature;
  out.b = work.b.feature;
  kHandlers[static_cast<std::size_t>(out.a.kind)][static_cast<std::size_t>(out.b.kind)](work);
}

void contact_manifold(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                      double tolerance, Manifold& out) noexcept {
  contact_manifold_within(A, B, X_AB, closest, tolerance, tolerances::kPatchAngle, out);
}

}  // namespace tactum
