#include "tactum/contact/revolved_contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using Circle = Revolution::Circle;

/// Lines whose directions differ by a smaller sine lie along each other.
constexpr double kLeastSine = 1e5 * tolerances::kSameNormal;
/// The curved surface is met along about the normal of the facets: within 0.64 rad.
constexpr double kSameSide = 0.8;

/// Where a feature lies on a surface of revolution.
struct OnCircle {
  const Circle* circle = nullptr;  ///< null: it does not
  double from_m = 0.0, to_m = 0.0;
  bool between = false;  ///< on the facets between two circles of one radius
};

/// The vertices of a feature.
struct FeatureVertices {
  std::array<int, 3> number{};
  Index count = 0;

  FeatureVertices(const SurfaceTree& tree, const Feature& feature) noexcept {
    if (feature.kind == FeatureKind::kVertex) {
      number[count++] = feature.index;
    } else if (feature.kind == FeatureKind::kEdge) {
      for (const int vertex : tree.edge(feature.index)) number[count++] = vertex;
    } else {
      for (const int vertex : tree.triangle(feature.index)) number[count++] = vertex;
    }
  }
};

OnCircle circle_at(const RevolvedSide& side, const Feature& feature) noexcept {
  if (side.revolution == nullptr) return {};
  const FeatureVertices vertices(side.tree, feature);
  OnCircle on;
  for (Index i = 0; i < vertices.count; ++i) {
    const std::int32_t number = side.revolution->circle_of[Index(vertices.number[i])];
    if (number < 0) return {};
    const Circle& circle = side.revolution->circles[Index(number)];
    if (on.circle == nullptr) {
      on = {&circle, circle.from_m, circle.to_m, false};
    } else if (&circle != on.circle) {
      const double enough = tolerances::kCoplanarMeshOffset * side.tree.size();
      if (std::abs(circle.radius_m - on.circle->radius_m) > enough) return {};
      on.from_m = std::min(on.from_m, circle.from_m);
      on.to_m = std::max(on.to_m, circle.to_m);
      on.between = true;
    }
  }
  return on;
}

/// The axis of a surface of revolution, in A's frame.
struct RevolvedAxis {
  Vec3 center, direction;

  double along(const Vec3& p) const noexcept { return direction.dot(p - center); }
  Vec3 at(double along_m) const noexcept { return center + along_m * direction; }
};

/// The contact, with the normal from the other surface toward the turned one.
struct CircleContact {
  Vec3 on_round, on_other, normal;
  double distance = 0.0;  // [m]
};

/// A circle over a face: its lowest point.
bool circle_over_face(const RevolvedAxis& axis, const OnCircle& on, double margin,
                      CircleContact& m) noexcept {
  const double along = on.between ? axis.along(m.on_round) : on.circle->along_m;
  const Vec3 square = m.normal - m.normal.dot(axis.direction) * axis.direction;
  const double length = square.norm();
  if (2.0 * on.circle->radius_m * length < margin) return false;
  m.on_round = axis.at(along) - (on.circle->radius_m / length) * square;
  m.distance = m.normal.dot(m.on_round - m.on_other);
  m.on_other = m.on_round - m.distance * m.normal;
  return true;
}

/// A cylinder over a point of an edge or corner.
bool cylinder_over_point(const RevolvedAxis& axis, const OnCircle& on, const Vec3& p,
                         CircleContact& m) noexcept {
  const double along = axis.along(p);
  if (!(on.to_m > on.from_m) || along < on.from_m || along > on.to_m) return false;
  const Vec3 toward = axis.at(along) - p;
  const double length = toward.norm();
  if (!(length > tolerances::kCertificate * on.circle->radius_m)) return false;
  const Vec3 normal = toward / length;
  if (normal.dot(m.normal) < kSameSide) return false;
  m.normal = normal;
  m.distance = length - on.circle->radius_m;
  m.on_other = p;
  m.on_round = p + m.distance * normal;
  return true;
}

/// The point of an edge that is nearest to the axis; false where that is beyond its ends.
bool nearest_to_axis(const RevolvedAxis& axis, const Vec3& tail, const Vec3& edge, Vec3& p) noexcept {
  const double length = edge.norm();
  const Vec3 e = edge / length;
  const double b = e.dot(axis.direction);
  const double sine_sq = 1.0 - b * b;
  if (sine_sq <= kLeastSine * kLeastSine) return true;  // all are: the one that was found stays
  const Vec3 w = axis.center - tail;
  const double at = (e.dot(w) - b * axis.direction.dot(w)) / sine_sq;
  p = tail + at * e;
  return at >= 0.0 && at <= length;
}

}  // namespace

bool meet_revolved(const RevolvedSide& a, const RevolvedSide& b, const Pose& X_AB, double margin,
                   SurfaceMinimum& minimum) noexcept {
  const OnCircle on_a = circle_at(a, minimum.a);
  const OnCircle on_b = circle_at(b, minimum.b);
  const bool round_is_a = on_a.circle != nullptr;
  if (round_is_a == (on_b.circle != nullptr)) return false;
  const OnCircle& on = round_is_a ? on_a : on_b;
  const Revolution& revolution = round_is_a ? *a.revolution : *b.revolution;
  const Pose X_round = round_is_a ? Pose{} : X_AB;
  const Pose X_other = round_is_a ? X_AB : Pose{};
  const SurfaceTree& other_tree = round_is_a ? b.tree : a.tree;
  const Feature& other = round_is_a ? minimum.b : minimum.a;
  const RevolvedAxis axis{X_round * revolution.center, rotated(X_round.R, revolution.axis)};
  CircleContact m{round_is_a ? minimum.p_a : minimum.p_b, round_is_a ? minimum.p_b : minimum.p_a,
                  round_is_a ? minimum.normal : Vec3(-minimum.normal), minimum.distance};
  bool meets = false;
  if (other.kind == FeatureKind::kFace) {
    meets = circle_over_face(axis, on, margin, m);
  } else {
    Vec3 p = m.on_other;
    bool within = true;
    if (other.kind == FeatureKind::kEdge) {
      const std::array<int, 2> ends = other_tree.edge(other.index);
      const Vec3 tail = X_other * other_tree.vertex(ends[0]);
      within = nearest_to_axis(axis, tail, X_other * other_tree.vertex(ends[1]) - tail, p);
    }
    meets = within && cylinder_over_point(axis, on, p, m);
  }
  if (!meets) return false;
  minimum.distance = m.distance;
  minimum.p_a = round_is_a ? m.on_round : m.on_other;
  minimum.p_b = round_is_a ? m.on_other : m.on_round;
  minimum.normal = round_is_a ? m.normal : Vec3(-m.normal);
  (round_is_a ? minimum.a : minimum.b) = {FeatureKind::kVertex, on.circle->first_vertex};
  minimum.round = true;
  return true;
}

}  // namespace tactum::inline v0_1
