#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/collision/patch_work.h"

namespace tactum::detail {
namespace {

struct GapRange {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  void extend(const Height& gap, const PatchPolygon& polygon) noexcept {
    for (const Vec2& x : polygon) {
      const double here = gap(x);
      least = std::min(least, here);
      most = std::max(most, here);
    }
  }
};

/// No gap of the polygon is larger, up to rounding: the largest of each coordinate's share.
double bound_of(const Height& gap, const PatchPolygon& polygon) noexcept {
  const Two slope = {gap.slope.x(), gap.slope.y()};
  Two most = both(-std::numeric_limits<double>::infinity());
  for (const Vec2& x : polygon) most = larger(most, slope * two(x));
  return gap.at_origin + most[0] + most[1];
}

/// Where both faces are, one over the other: the polygon of the contact's own pieces, and those of the other
/// stretches, which are made anew whenever they are asked for.
class Overlap {
 public:
  Overlap(const PatchWork& w, const Tangent& tangent_B) noexcept : w_(w), tangent_B_(tangent_B) {
    face_outline(w.tangent, w.A, w.a.feature.index, true, own_);
  }
  const PatchPolygon& own() const noexcept { return own_; }
  /// Clips A's face by B's.
  void clip() noexcept {
    PatchPolygon window;
    face_outline(tangent_B_, w_.B, w_.b.feature.index, false, window);
    clip_polygon(own_, window);
  }
  /// Keeps where slope . x <= offset.
  void cut(const Vec2& slope, double offset) noexcept {
    clip_polygon(own_, slope, offset);
    if (!w_.others.empty()) cuts_.push_back({slope, offset});
  }
  /// Calls visit(polygon) for each that is not empty.
  template <class Visit>
  void visit(const Visit& visit_one) const noexcept {
    if (!own_.empty()) visit_one(own_);
    for (const Stretch& other : w_.others) {
      PatchPolygon polygon;
      PatchPolygon window;
      face_outline(w_.tangent, *other.A, other.a.index, true, polygon);
      face_outline(tangent_B_, *other.B, other.b.index, false, window);
      clip_polygon(polygon, window);
      for (const Cut& cut : cuts_) clip_polygon(polygon, cut.slope, cut.offset);
      if (!polygon.empty()) visit_one(polygon);
    }
  }

 private:
  struct Cut {
    Vec2 slope;
    double offset;
  };
  const PatchWork& w_;
  const Tangent& tangent_B_;
  PatchPolygon own_;
  StaticVector<Cut, 3> cuts_;  // one by the gap, one for each face that leans
};

/// The moments of all polygons as those of one figure.
PatchMoments moments_of_all(const Overlap& overlap) noexcept {
  PatchMoments sum;
  overlap.visit([&](const PatchPolygon& polygon) {
    const PatchMoments m = moments_of(polygon);
    if (m.area > 0.0) sum = together(sum, m);
  });
  return sum;
}

/// The corners of the contact's own polygon that are farthest apart.
void sliver_of(const PatchWork& w, const PatchPolygon& polygon, const Height& za, const Height& zb) noexcept {
  if (polygon.empty()) return point_contact(w);
  Vec2 x0 = polygon[0];
  Vec2 x1 = polygon[0];
  for (const Vec2& x : polygon)
    if ((x - x0).squaredNorm() > (x1 - x0).squaredNorm()) x1 = x;
  for (const Vec2& x : polygon)
    if ((x - x1).squaredNorm() > (x0 - x1).squaredNorm()) x0 = x;
  sliver_contact(w, x0, x1, za, zb);
}

}  // namespace

void face_face_contact(const PatchWork& w) noexcept {
  const Tangent tangent_B = w.tangent_B();
  const Height za = face_height(w.tangent, w.A, w.a.feature.index);
  const Height zb = face_height(tangent_B, w.B, w.b.feature.index);
  const Height gap{za.at_origin - zb.at_origin, za.slope - zb.slope};
  const bool alone = w.others.empty();
  Overlap overlap(w, tangent_B);
  const double bound = bound_of(gap, overlap.own());
  if (!std::isfinite(bound)) return point_contact(w);  // nor is the pose
  overlap.clip();
  if (overlap.own().empty() && alone) return point_contact(w);
  // Where the whole face is within the tolerance the gap cuts nothing.
  if (bound > w.tolerance || gap_share(w) < 1.0 || !alone) {
    GapRange range;
    overlap.visit([&](const PatchPolygon& polygon) { range.extend(gap, polygon); });
    if (range.least >= w.tolerance) return point_contact(w);
    if (const double level = cut_level(w, range.least); range.most > level)
      overlap.cut(gap.slope, level - gap.at_origin);
  }
  const auto cut_toward_edge = [&](const Rise& rise, double share) {
    double highest = 0.0;
    overlap.visit([&](const PatchPolygon& polygon) {
      for (const Vec2& x : polygon) highest = std::max(highest, rise(x));
    });
    overlap.cut(rise.slope, rise.offset + highest * share);
  };
  if (w.a.face_share < 1.0)
    cut_toward_edge(rise_from_edge(w.tangent, w.A, w.a.edge, {}, za.slope), w.a.face_share);
  if (w.b.face_share < 1.0)
    cut_toward_edge(rise_from_edge(w.tangent, w.B, w.b.edge, w.X_AB, -zb.slope), w.b.face_share);
  const PatchMoments m = alone ? moments_of(overlap.own()) : moments_of_all(overlap);
  const double size = std::max(w.A.size, w.B.size);
  if (m.area <= tolerances::kPatchArea * size * size) return sliver_of(w, overlap.own(), za, zb);
  w.out.area = m.area;
  const PatchSpread arms = spread_of(m);
  const Vec3 center_a = w.tangent.point(m.centroid, za(m.centroid));
  const double center_gap = gap(m.centroid);
  const Vec3 center_b = center_a - w.tangent.n * center_gap;
  w.out.points.clear();  // they are none yet; said here, where each goes is known when this is compiled
  for (const Vec2* arm : {&arms.u, &arms.v}) {
    const Vec3 to_a = w.tangent.e1 * arm->x() + w.tangent.e2 * arm->y() + w.tangent.n * za.slope.dot(*arm);
    const double opens = gap.slope.dot(*arm);
    const Vec3 to_b = to_a - w.tangent.n * opens;
    w.out.points.push_back({center_a + to_a, center_b + to_b, center_gap + opens, 0.25, 0});
    w.out.points.push_back({center_a - to_a, center_b - to_b, center_gap - opens, 0.25, 0});
  }
}

}  // namespace tactum::detail
