#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/collision/patch_work.h"

namespace tactum::inline v0_1::detail {
namespace {

/// B's face as the plane of a patch of two faces: x along its first side, y from there inward, with the
/// origin in the corner where that side ends. A is projected along the contact normal. So B's points are the
/// part's own, and where the face is a rectangle its sides are values of a coordinate.
class ReferenceFace {
 public:
  explicit ReferenceFace(const PatchWork& w) noexcept
      : w_(w),
        face_(w.B.faces[w.b.feature.index]),
        sides_(&w.B.sides[face_.first]),
        along_(face_.rectangle ? sides_[1].normal : Vec3(face_.normal.cross(sides_[0].normal))),
        origin_(w.X_AB * corner(1)) {
    if (face_.rectangle) {
      box_.low.x() = -w.B.edges[sides_[0].edge].length;
      box_.high.y() = w.B.edges[sides_[1].edge].length;
    }
    const Mat3& R = w.X_AB.R;
    const Projection b = of_b();
    x_ = b.x * both(R(0, 0)) + b.y * both(R(0, 1)) + b.z * both(R(0, 2));
    y_ = b.x * both(R(1, 0)) + b.y * both(R(1, 1)) + b.z * both(R(1, 2));
    z_ = b.x * both(R(2, 0)) + b.y * both(R(2, 1)) + b.z * both(R(2, 2));
  }

  bool rectangle() const noexcept { return face_.rectangle; }
  /// The whole face, if it is a rectangle.
  const PatchBox& box() const noexcept { return box_; }
  /// A bound on the gap over it, if it is a rectangle: one of the overlap's that costs almost nothing.
  double largest(const Height& gap) const noexcept {
    return gap.at_origin + std::max(gap.slope.x() * box_.low.x(), 0.0) +
           std::max(gap.slope.y() * box_.high.y(), 0.0);
  }
  /// The coordinates of points in B's frame.
  Projection of_b() const noexcept {
    const Vec3& out = sides_[0].normal;
    return {corner(1), Two{along_.x(), -out.x()}, Two{along_.y(), -out.y()}, Two{along_.z(), -out.z()}};
  }
  /// The coordinates of points in A's frame, the same for all on a line along the normal: by the axes' cross
  /// products with it.
  Projection along_normal() const noexcept {
    const Vec3& n = w_.closest.normal;
    const Two u = {x_[1], -x_[0]};
    const Two v = {y_[1], -y_[0]};
    const Two t = {z_[1], -z_[0]};
    return {origin_, v * both(n.z()) - t * both(n.y()), t * both(n.x()) - u * both(n.z()),
            u * both(n.y()) - v * both(n.x()), both(1.0 / cosine())};
  }
  /// Between the face's normal and the contact's.
  double cosine() const noexcept { return face_.normal.dot(w_.n_B); }
  /// How the face rises along the normal.
  Vec2 slope() const noexcept { return vec2(dots(w_.closest.normal)); }
  /// The direction of B's own x, or y where that is steep, in the face: the same for all faces in one plane,
  /// so that the points are those of an uncut part. [-]
  Vec2 axis() const noexcept {
    constexpr double kSteep = 0.55;  // no normal of a simple ratio
    const int own = std::abs(face_.normal.x()) < kSteep ? 0 : 1;
    return Vec2(along_[own], -sides_[0].normal[own]).normalized();
  }
  /// Up to A's face along the normal.
  Height gap() const noexcept {
    const Polytope::Face& over = w_.A.faces[w_.a.feature.index];
    const double per_gap = -1.0 / over.normal.dot(w_.closest.normal);
    return {(over.normal.dot(origin_) - over.offset) * per_gap, vec2(dots(over.normal) * both(per_gap))};
  }
  const Vec3& origin() const noexcept { return origin_; }
  Vec3 ex() const noexcept { return {x_[0], y_[0], z_[0]}; }
  Vec3 ey() const noexcept { return {x_[1], y_[1], z_[1]}; }

 private:
  const Vec3& corner(int i) const noexcept { return w_.B.vertices[w_.B.face_vertices[face_.first + i]]; }
  /// The dot products of a vector with both axes.
  Two dots(const Vec3& v) const noexcept { return x_ * both(v.x()) + y_ * both(v.y()) + z_ * both(v.z()); }

  const PatchWork& w_;
  const Polytope::Face& face_;
  const Polytope::Side* sides_;
  PatchBox box_;
  Vec3 along_;     // x, B's frame
  Vec3 origin_;    // A's frame
  Two x_, y_, z_;  // the components of both axes, A's frame
};

/// How far a leaning face has risen from the line of its edge: linear, zero on the line.
struct Rise {
  Vec2 slope = Vec2::Zero();
  double offset = 0.0;
  double operator()(const Vec2& x) const noexcept { return slope.dot(x) - offset; }
};

Rise rise_from_edge(const Projection& plane, const Polytope& P, int edge, const Vec2& face_slope) noexcept {
  const Vec2 on_line = plane.flat(P.vertices[P.edges[edge].tail]);
  const Vec2 along = (plane.flat(P.vertices[P.edges[edge].head]) - on_line).normalized();
  const Vec2 across = face_slope - along * along.dot(face_slope);
  return {across, across.dot(on_line)};
}

/// A place on B with the gap over it, as a linear function of the face's coordinates.
struct OnB {
  Two xy, z_gap;

  OnB operator+(const OnB& x) const noexcept { return {xy + x.xy, z_gap + x.z_gap}; }
  OnB operator*(double by) const noexcept { return {xy * both(by), z_gap * both(by)}; }
};

/// ... and with the place on A over it: the data of a contact point.
struct OnBoth {
  Two a_xy;
  double a_z;
  Two b_xy, b_z_gap;

  static OnBoth over(const OnB& b, const Vec3& n) noexcept {
    return {b.xy + Two{n.x(), n.y()} * both(b.z_gap[1]), b.z_gap[0] + n.z() * b.z_gap[1], b.xy, b.z_gap};
  }
  OnBoth operator+(const OnBoth& x) const noexcept {
    return {a_xy + x.a_xy, a_z + x.a_z, b_xy + x.b_xy, b_z_gap + x.b_z_gap};
  }
  OnBoth operator-(const OnBoth& x) const noexcept {
    return {a_xy - x.a_xy, a_z - x.a_z, b_xy - x.b_xy, b_z_gap - x.b_z_gap};
  }
  void store(ContactPoint& point) const noexcept {
    std::memcpy(point.p_a.data(), &a_xy, sizeof a_xy);
    point.p_a.z() = a_z;
    std::memcpy(point.p_b.data(), &b_xy, sizeof b_xy);
    point.p_b.z() = b_z_gap[0];
    point.distance = b_z_gap[1];
  }
};

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

/// The area where both faces are, one over the other: the polygon of the contact's own pieces, and those of
/// the other stretches, which are computed anew for every visit.
class Overlap {
 public:
  Overlap(const PatchWork& w, const ReferenceFace& reference) noexcept
      : w_(w), reference_(reference), along_normal_(reference.along_normal()) {
    face_outline(along_normal_, w.A, w.a.feature.index, true, own_);
  }
  const PatchPolygon& own() const noexcept { return own_; }
  const Projection& along_normal() const noexcept { return along_normal_; }
  /// Clips A's face by B's.
  void clip() noexcept {
    if (reference_.rectangle())
      return clip_polygon(own_, reference_.box(), w_.A.extent.size + w_.B.extent.size);
    PatchPolygon window;
    face_outline(reference_.of_b(), w_.B, w_.b.feature.index, false, window);
    clip_polygon(own_, window);
  }
  /// Keeps the part where slope . x <= offset.
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
      face_outline(along_normal_, *other.A, other.a.index, true, polygon);
      face_outline(reference_.of_b(), *other.B, other.b.index, false, window);
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
  const ReferenceFace& reference_;
  const Projection along_normal_;
  PatchPolygon own_;
  StaticVector<Cut, 3> cuts_;  // one by the gap, one for each face that leans
};

/// The moments of all polygons together.
PatchMoments moments_of_all(const Overlap& overlap) noexcept {
  PatchMoments sum;
  overlap.visit([&](const PatchPolygon& polygon) { sum = together(sum, moments_of(polygon)); });
  return sum;
}

/// The interval between the corners of the contact's own polygon that are farthest apart.
void sliver_contact(const PatchWork& w, const ReferenceFace& reference, const Height& gap,
                    const PatchPolygon& polygon) noexcept {
  if (polygon.empty()) return point_contact(w);
  Vec2 x0 = polygon[0];
  Vec2 x1 = polygon[0];
  for (const Vec2& x : polygon)
    if ((x - x0).squaredNorm() > (x1 - x0).squaredNorm()) x1 = x;
  for (const Vec2& x : polygon)
    if ((x - x1).squaredNorm() > (x0 - x1).squaredNorm()) x0 = x;
  // Along the coordinate in which they differ more, so that the ends keep their places.
  const int axis = std::abs(x1.x() - x0.x()) > std::abs(x1.y() - x0.y()) ? 0 : 1;
  if (x1[axis] < x0[axis]) std::swap(x0, x1);
  const auto on_b = [&](const Vec2& x) -> Vec3 {
    return reference.origin() + reference.ex() * x.x() + reference.ey() * x.y();
  };
  const Vec3& n = w.closest.normal;
  strip_contact(w, {on_b(x0) + n * gap(x0), on_b(x1) + n * gap(x1), on_b(x0), on_b(x1)});
}

}  // namespace

void face_face_contact(const PatchWork& w) noexcept {
  const ReferenceFace reference(w);
  if (!std::isfinite(reference.origin().sum())) return point_contact(w);  // nor is the pose
  Overlap overlap(w, reference);
  overlap.clip();
  const Height gap = reference.gap();
  const bool alone = w.others.empty();
  if (overlap.own().empty() && alone) return point_contact(w);
  // Where B's whole face is within the tolerance the gap cuts nothing.
  const bool whole =
      alone && gap_share(w) >= 1.0 && reference.rectangle() && reference.largest(gap) <= w.tolerance;
  if (!whole) {
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
    cut_toward_edge(rise_from_edge(overlap.along_normal(), w.A, w.a.edge, reference.slope() + gap.slope),
                    w.a.face_share);
  if (w.b.face_share < 1.0)
    cut_toward_edge(rise_from_edge(reference.of_b(), w.B, w.b.edge, -reference.slope()), w.b.face_share);
  const PatchMoments m = alone ? moments_of(overlap.own()) : moments_of_all(overlap);
  const double size = std::max(w.A.extent.size, w.B.extent.size);
  if (m.area <= tolerances::kPatchArea * size * size) return sliver_contact(w, reference, gap, overlap.own());
  const PatchSpread arms = spread_of(m, reference.axis());
  w.out.area = m.area * reference.cosine();
  const Vec3& n = w.closest.normal;
  const Vec3& o = reference.origin();
  const Vec3 ex = reference.ex();
  const Vec3 ey = reference.ey();
  const OnB origin{Two{o.x(), o.y()}, Two{o.z(), gap.at_origin}};
  const OnB per_x{Two{ex.x(), ex.y()}, Two{ex.z(), gap.slope.x()}};
  const OnB per_y{Two{ey.x(), ey.y()}, Two{ey.z(), gap.slope.y()}};
  const OnBoth center = OnBoth::over(origin + per_x * m.centroid.x() + per_y * m.centroid.y(), n);
  const OnBoth u = OnBoth::over(per_x * arms.u.x() + per_y * arms.u.y(), n);
  const OnBoth v = OnBoth::over(per_x * arms.v.x() + per_y * arms.v.y(), n);
  auto& points = w.out.points;
  points.clear();
  const std::uint64_t name = w.name(0);
  for (std::uint64_t place = 0; place < 4; ++place)
    points.push_back({Vec3::Zero(), Vec3::Zero(), 0.0, 0.25, name + place});
  (center + u).store(points[0]);
  (center - u).store(points[1]);
  (center + v).store(points[2]);
  (center - v).store(points[3]);
}

}  // namespace tactum::inline v0_1::detail
