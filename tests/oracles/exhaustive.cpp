#include "oracles/exhaustive.h"

#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

namespace tactum::oracle {
namespace {

using Real = long double;
using Point = Eigen::Matrix<Real, 3, 1>;
using Loop = std::vector<Point>;

/// A piece with its own planes and sides, in A's frame.
struct Solid {
  std::vector<Point> points;
  std::vector<Loop> faces;
  std::vector<Point> normals;
  std::vector<std::pair<Point, Point>> sides;
};

Solid solid_of(const Polytope& P, const Pose& X) {
  Solid solid;
  const Eigen::Matrix<Real, 3, 3> R = X.R.cast<Real>();
  const Point p = X.p.cast<Real>();
  for (const Vec3& v : P.vertices) solid.points.push_back(R * v.cast<Real>() + p);
  std::set<std::pair<int, int>> seen;
  for (const Polytope::Face& face : P.faces) {
    Loop loop;
    Point normal = Point::Zero();
    for (int i = 0; i < face.count; ++i) {
      const int a = P.face_vertices[std::size_t(face.first + i)];
      const int b = P.face_vertices[std::size_t(face.first + (i + 1) % face.count)];
      loop.push_back(solid.points[std::size_t(a)]);
      if (seen.insert(std::minmax(a, b)).second)
        solid.sides.emplace_back(solid.points[std::size_t(a)], solid.points[std::size_t(b)]);
    }
    for (std::size_t i = 0; i < loop.size(); ++i)
      normal += Point(loop[i] - loop[0]).cross(Point(loop[(i + 1) % loop.size()] - loop[0]));
    solid.normals.push_back(normal.normalized());
    solid.faces.push_back(std::move(loop));
  }
  return solid;
}

Real segments_distance(const Point& p0, const Point& p1, const Point& q0, const Point& q1) {
  // The closest pair is inside both segments, or at an end of one: try all.
  const auto to_segment = [](const Point& x, const Point& a, const Point& b) {
    const Point u = b - a;
    const Real t = std::min<Real>(1, std::max<Real>(0, u.dot(x - a) / u.squaredNorm()));
    return (x - a - t * u).norm();
  };
  Real best = std::min(std::min(to_segment(p0, q0, q1), to_segment(p1, q0, q1)),
                       std::min(to_segment(q0, p0, p1), to_segment(q1, p0, p1)));
  const Point u = p1 - p0;
  const Point w = q1 - q0;
  const Point c = u.cross(w);
  const Real cc = c.squaredNorm();
  if (cc > 0) {
    const Point r = q0 - p0;
    const Real s = r.cross(w).dot(c) / cc;
    const Real t = r.cross(u).dot(c) / cc;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) best = std::min(best, (p0 + s * u - q0 - t * w).norm());
  }
  return best;
}

/// Is the foot of `x` inside the face's outline, by at least `margin`?
bool over_face(const Loop& loop, const Point& normal, const Point& x, Real margin) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Point side = loop[(i + 1) % loop.size()] - loop[i];
    if (normal.cross(side).normalized().dot(x - loop[i]) < margin) return false;
  }
  return true;
}

void corners_to_faces(const Solid& corners, const Solid& faces, Real& best) {
  for (std::size_t f = 0; f < faces.faces.size(); ++f)
    for (const Point& x : corners.points) {
      const Real height = std::abs(faces.normals[f].dot(x - faces.faces[f][0]));
      if (height < best && over_face(faces.faces[f], faces.normals[f], x, 0)) best = height;
    }
}

Real gap_along(const Solid& a, const Solid& b, const Point& n) {
  Real low = INFINITY;
  Real high = -INFINITY;
  for (const Point& x : a.points) low = std::min(low, n.dot(x));
  for (const Point& x : b.points) high = std::max(high, n.dot(x));
  return low - high;
}

/// Height of `x` above the highest face plane: negative inside.
Real outside(const Solid& solid, const Point& x) {
  Real most = -INFINITY;
  for (std::size_t f = 0; f < solid.faces.size(); ++f)
    most = std::max(most, solid.normals[f].dot(x - solid.faces[f][0]));
  return most;
}

/// Distance of a point to a piece it should be on: 0 inside, exact over faces, a lower bound elsewhere.
Real off_piece(const Solid& solid, const Point& x) {
  Real off = std::max<Real>(0, outside(solid, x));
  if (solid.faces.size() == 2)  // flat: the outline bounds it too
    for (std::size_t i = 0; i < solid.faces[0].size(); ++i) {
      const Loop& loop = solid.faces[0];
      const Point side = loop[(i + 1) % loop.size()] - loop[i];
      off = std::max(off, -solid.normals[0].cross(side).normalized().dot(x - loop[i]));
    }
  return off;
}

bool sides_pierce(const Solid& a, const Solid& b, Real margin) {
  for (std::size_t f = 0; f < b.faces.size(); ++f)
    for (const auto& [tail, head] : a.sides) {
      const Real h0 = b.normals[f].dot(tail - b.faces[f][0]);
      const Real h1 = b.normals[f].dot(head - b.faces[f][0]);
      if (std::min(h0, h1) > -margin || std::max(h0, h1) < margin) continue;
      if (over_face(b.faces[f], b.normals[f], tail + (head - tail) * (h0 / (h0 - h1)), margin)) return true;
    }
  return false;
}

}  // namespace

long double feature_distance(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  const Solid a = solid_of(A, {});
  const Solid b = solid_of(B, X_AB);
  Real best = INFINITY;
  for (const auto& [p0, p1] : a.sides)
    for (const auto& [q0, q1] : b.sides) best = std::min(best, segments_distance(p0, p1, q0, q1));
  corners_to_faces(a, b, best);
  corners_to_faces(b, a, best);
  return best;
}

long double axes_separation(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  const Solid a = solid_of(A, {});
  const Solid b = solid_of(B, X_AB);
  Real best = -INFINITY;
  const auto try_axis = [&](const Point& axis) {
    const Real length = axis.norm();
    if (length < 1e-12L) return;
    best = std::max(best, gap_along(a, b, axis / length));
    best = std::max(best, gap_along(a, b, -axis / length));
  };
  for (const Solid* solid : {&a, &b})
    for (std::size_t f = 0; f < solid->faces.size(); ++f) {
      try_axis(solid->normals[f]);
      for (std::size_t i = 0; i < solid->faces[f].size(); ++i) {
        const Point side = solid->faces[f][(i + 1) % solid->faces[f].size()] - solid->faces[f][i];
        try_axis(solid->normals[f].cross(side).normalized());
      }
    }
  for (const auto& [p0, p1] : a.sides)
    for (const auto& [q0, q1] : b.sides)
      try_axis(Point(p1 - p0).normalized().cross(Point(q1 - q0).normalized()));
  return best;
}

long double signed_distance(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  const Real separation = axes_separation(A, B, X_AB);
  return separation > 0 ? feature_distance(A, B, X_AB) : separation;
}

bool surely_overlap(const Polytope& A, const Polytope& B, const Pose& X_AB, long double margin) {
  const Solid a = solid_of(A, {});
  const Solid b = solid_of(B, X_AB);
  if (!B.flat)
    for (const Point& x : a.points)
      if (outside(b, x) < -margin) return true;
  if (!A.flat)
    for (const Point& x : b.points)
      if (outside(a, x) < -margin) return true;
  return sides_pierce(a, b, margin) || sides_pierce(b, a, margin);
}

long double support_gap(const Polytope& A, const Polytope& B, const Pose& X_AB, const Vec3& n) {
  const Eigen::Matrix<Real, 3, 3> R = X_AB.R.cast<Real>();
  const Point n_A = n.cast<Real>();
  Real lowest = std::numeric_limits<Real>::infinity();
  Real highest = -lowest;
  for (const Vec3& v : A.vertices) lowest = std::min(lowest, n_A.dot(v.cast<Real>()));
  for (const Vec3& v : B.vertices)
    highest = std::max(highest, n_A.dot(R * v.cast<Real>() + X_AB.p.cast<Real>()));
  return (lowest - highest) / n_A.norm();
}

std::string complaint(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& answer,
                      double tolerance) {
  const Solid a = solid_of(A, {});
  const Solid b = solid_of(B, X_AB);
  const Point n = answer.normal.cast<Real>();
  const Point p_a = answer.p_a.cast<Real>();
  const Point p_b = answer.p_b.cast<Real>();
  std::ostringstream text;
  text.precision(17);
  const auto check = [&](const char* what, Real value) {
    if (!(std::abs(value) <= tolerance)) text << what << " is off by " << value << "; ";
  };
  check("length of the normal", n.norm() - 1 > 1e-12L || n.norm() - 1 < -1e-12L ? Real(1) : Real(0));
  check("p_a = p_b + n distance", (p_a - p_b - n * Real(answer.distance)).norm());
  check("p_a on A", off_piece(a, p_a));
  check("p_b on B", off_piece(b, p_b));
  check("the support planes' gap", gap_along(a, b, n) - Real(answer.distance));
  if (!answer.certified()) text << "not certified; ";
  return text.str();
}

}  // namespace tactum::oracle
