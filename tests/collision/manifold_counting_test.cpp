/// Manifolds against referees that count: points of a grid over two faces, steps along an edge over a face.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "collision/cases.h"
#include "collision/manifold_contact.h"
#include "support/effort.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/planar_patch.h"
#include "tactum/collision/supporting_feature.h"

namespace tactum {
namespace {

using namespace manifold_tests;

/// A face of P over or under an edge of Q, in the projection along `n`, all in P's frame.
struct EdgeAndFace {
  const Polytope& P;
  const Polytope::Face& face;
  Vec3 tail, head;  ///< of the edge
  Vec3 n;           ///< from B to A
  bool face_of_a;

  Vec3 at(double s) const { return tail + (head - tail) * s; }
  Vec3 on_face(double s) const {
    return at(s) + n * ((face.offset - face.normal.dot(at(s))) / face.normal.dot(n));
  }
  Vec3 corner(int i) const {
    return P.vertices[std::size_t(P.face_vertices[std::size_t(face.first + i % face.count)])];
  }
  bool inside(double s) const {
    for (int i = 0; i < face.count; ++i)
      if ((corner(i + 1) - corner(i)).cross(on_face(s) - corner(i)).dot(face.normal) < 0.0) return false;
    return true;
  }
  double gap(double s) const { return (face_of_a ? n : Vec3(-n)).dot(on_face(s) - at(s)); }
  /// Away from the contact, from the point of one of the face's edges that is square to it along the normal.
  double rise(double s, const Polytope::Edge& from) const {
    const Vec3& start = P.vertices[std::size_t(from.tail)];
    const Vec3 flat = from.direction - n * n.dot(from.direction);
    const Vec3 off =
        on_face(s) - start - from.direction * (flat.dot(on_face(s) - start) / flat.squaredNorm());
    return (face_of_a ? n : Vec3(-n)).dot(off);
  }
};

/// The kept part of the edge, by steps along it.
PatchInterval interval_by_steps(const EdgeAndFace& pair, const SupportingFeature& on_face,
                                const SupportingFeature& on_edge, double closest, double tolerance,
                                int steps) {
  std::vector<double> kept;
  double least = closest;
  for (int k = 0; k <= steps; ++k)
    if (const double s = static_cast<double>(k) / steps; pair.inside(s)) {
      kept.push_back(s);
      least = std::min(least, pair.gap(s));
    }
  const double share = std::min(std::max(on_face.face_share, on_face.along_share), on_edge.along_share);
  const double level = least + (tolerance - least) * share;
  std::erase_if(kept, [&](double s) { return pair.gap(s) > level; });
  if (on_face.face_share < 1.0) {
    const Polytope::Edge& from = pair.P.edges[std::size_t(on_face.edge)];
    double highest = 0.0;
    for (double s : kept) highest = std::max(highest, pair.rise(s, from));
    std::erase_if(kept, [&](double s) { return pair.rise(s, from) > highest * on_face.face_share; });
  }
  return kept.empty() ? PatchInterval{1.0, 0.0} : PatchInterval{kept.front(), kept.back()};
}

/// The face is P's, the edge the roof's; either may be A.
struct EdgeOverFace {
  const Polytope& P;
  const Polytope& roof;
  Pose X_PQ;  ///< of the roof in P
  bool face_of_a;

  Contact found(double tolerance) const {
    return face_of_a ? contact(P, roof, X_PQ, tolerance) : contact(roof, P, X_PQ.inverse(), tolerance);
  }
};

/// Counts of the kinds of cases, so that the test can check that there were enough of each.
struct CountedIntervals {
  int level = 0;
  int leaning = 0;
  int cut = 0;
};

/// Compares the ends of the segment that the manifold has with those that are found by steps along the edge.
void expect_counted_interval(const EdgeOverFace& at, CountedIntervals& tally) {
  constexpr double kTolerance = 3e-4;
  constexpr int kSteps = 2000;
  const Contact c = at.found(kTolerance);
  const Feature& face = at.face_of_a ? c.patch.a : c.patch.b;
  const Feature& edge = at.face_of_a ? c.patch.b : c.patch.a;
  if (face.kind != Kind::kFace || edge.kind != Kind::kEdge || c.patch.points.size() != 2) return;
  const Polytope::Edge& line = at.roof.edges[std::size_t(edge.index)];
  const Vec3& tail = at.roof.vertices[std::size_t(line.tail)];
  const EdgeAndFace pair{at.P,
                         at.P.faces[std::size_t(face.index)],
                         at.X_PQ * tail,
                         at.X_PQ * at.roof.vertices[std::size_t(line.head)],
                         at.face_of_a ? c.patch.normal : Vec3(at.X_PQ.R * c.patch.normal),
                         at.face_of_a};
  const Vec3 out = at.face_of_a ? Vec3(-pair.n) : pair.n;  // of P
  const SupportingFeature on_face =
      supporting_feature(at.P, at.face_of_a ? c.closest.a : c.closest.b, out, tolerances::kPatchAngle);
  const SupportingFeature on_line =
      supporting_feature(at.roof, at.face_of_a ? c.closest.b : c.closest.a, -(at.X_PQ.R.transpose() * out),
                         tolerances::kPatchAngle);
  const PatchInterval expected =
      interval_by_steps(pair, on_face, on_line, c.closest.distance, kTolerance, kSteps);
  const auto place = [&](const ContactPoint& p) {
    const Vec3 on_roof = at.face_of_a ? Vec3(at.X_PQ.inverse() * p.p_b) : p.p_a;
    return line.direction.dot(on_roof - tail) / line.length;
  };
  const double first = place(c.patch.points[0]);
  const double second = place(c.patch.points[1]);
  const double to_end = 0.5 * std::sqrt(3.0) * (second - first);  // from the middle of the Gauss points
  if (expected.empty()) {                                         // between two steps
    EXPECT_LT(2.0 * to_end, 1.0 / kSteps);
    return;
  }
  EXPECT_NEAR(0.5 * (first + second) - to_end, expected.low, 2.0 / kSteps);
  EXPECT_NEAR(0.5 * (first + second) + to_end, expected.high, 2.0 / kSteps);
  ++(on_face.face_share < 1.0 ? tally.leaning : tally.level);
  tally.cut += expected.high - expected.low < 0.99 ? 1 : 0;
}

/// Faces of four, five and two hundred corners (more than an area takes of one), of A and of B, over an edge
/// that is turned, shifted and out of level, partly beyond the face and partly beyond the tolerance; where it
/// crosses a border of the face steeply the face leans, and less of it counts.
TEST(Manifold, EdgeOverAFaceAgreesWithCounting) {
  const Polytope roof = make_box({0.02, 0.03, 0.01});
  const Mat3 on_edge = exp_rotation(Vec3(0, 0.25 * kPi, 0));  // about y: an edge along y points up
  const double height = std::sqrt(0.02 * 0.02 + 0.01 * 0.01) * std::sin(std::atan2(0.01, 0.02) + 0.25 * kPi);
  CountedIntervals tally;
  for (const Polytope& P : {box(), make_prism(5, 0.02, 0.02), make_prism(200, 0.02, 0.02)}) {
    Random random(std::uint64_t(P.faces.size()));
    for (int i = 0; i < testing::effort(200, 40); ++i) {
      SCOPED_TRACE(std::to_string(P.faces.size()) + " faces, case " + std::to_string(i));
      const double out_of_level = i % 2 ? random.uniform(0.018, 0.034) : random.uniform(0.0, 0.004);
      const Mat3 R = exp_rotation(Vec3(0, 0, random.uniform(-kPi, kPi))) *
                     exp_rotation(Vec3(out_of_level, 0, 0)) * on_edge;
      Pose X_PQ{R, {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), -0.011 - height}};
      PairCache cache;
      X_PQ.p.z() += closest_features(P, roof, X_PQ, cache).distance - 1e-4;
      for (bool face_of_a : {true, false}) expect_counted_interval({P, roof, X_PQ, face_of_a}, tally);
    }
  }
  EXPECT_GT(tally.level, testing::effort(200, 40));
  EXPECT_GT(tally.leaning, testing::effort(50, 10));
  EXPECT_GT(tally.cut, testing::effort(200, 40));
}

/// Whether a point is within the borders of a face, in the projection along a direction.
bool over(const Polytope& P, const Polytope::Face& face, const Vec3& p, const Vec3& along) {
  for (int s = face.first; s < face.first + face.count; ++s) {  // the border's plane holds the direction
    const Vec3& u = P.edges[std::size_t(P.sides[std::size_t(s)].edge)].direction;
    Vec3 side = u.cross(along);
    if (side.dot(P.sides[std::size_t(s)].normal) < 0) side = -side;
    if (side.dot(p - P.vertices[std::size_t(P.face_vertices[std::size_t(s)])]) > 0) return false;
  }
  return true;
}

/// A patch of two faces by the points of a fine grid, along e1 and e2 of a plane square to its normal.
struct GridCount {
  double area = 0.0;                                  ///< [m^2]
  Vec2 mean = Vec2::Zero();                           ///< [m]
  Eigen::Matrix2d central = Eigen::Matrix2d::Zero();  ///< second moments about the mean [m^2]
};

GridCount count_points(const Polytope& A, const Polytope& B, const Pose& X, const Manifold& patch,
                       double tolerance, const Vec3& e1, const Vec3& e2) {
  const Polytope::Face& fa = A.faces[std::size_t(patch.a.index)];
  const Polytope::Face& fb = B.faces[std::size_t(patch.b.index)];
  const Vec3 nb = X.R * fb.normal;
  const double ob = fb.offset + nb.dot(X.p);
  const Vec3& n = patch.normal;
  constexpr int kCells = 700;
  const double cell = 0.1 / kCells;
  double count = 0;
  Vec2 first = Vec2::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (int iy = 0; iy < kCells; ++iy)
    for (int ix = 0; ix < kCells; ++ix) {
      const Vec2 xy((ix + 0.5) * cell - 0.05, (iy + 0.5) * cell - 0.05);
      const Vec3 p = e1 * xy.x() + e2 * xy.y();
      const double za = (fa.offset - fa.normal.dot(p)) / fa.normal.dot(n);
      const double zb = (ob - nb.dot(p)) / nb.dot(n);
      if (za - zb > tolerance) continue;
      if (!over(A, fa, p, n) || !over(B, fb, X.inverse() * p, X.R.transpose() * n)) continue;
      count += 1;
      first += xy;
      second += xy * xy.transpose();
    }
  const Vec2 mean = first / count;
  return {count * cell * cell, mean, second / count - mean * mean.transpose()};
}

/// Area, centroid and second moments by counting points of a fine grid.
TEST(Manifold, MomentsAgreeWithCounting) {
  const std::uint64_t seed = 31;
  Random random(seed);
  for (int i = 0; i < (cases::kSlowness > 1 ? 4 : 60); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Polytope B = make_prism(3 + random.index(7), 0.02, 0.02);
    const double tilt = i % 2 ? 0.0 : random.uniform(0.0, 0.4 * tolerances::kPatchAngle);
    const double heading = random.uniform(-kPi, kPi);
    const Mat3 R = exp_rotation(tilt * Vec3(std::cos(heading), std::sin(heading), 0)) *
                   exp_rotation(Vec3(0, 0, random.uniform(-3, 3)));
    const double x = random.uniform(-0.015, 0.015);
    const double y = random.uniform(-0.015, 0.015);
    Pose X{R, {x, y, -0.021}};
    PairCache cache;
    X.p.z() += closest_features(A, B, X, cache).distance - 1e-5;  // nearly touching
    const double tolerance = 2e-4;
    const Contact c = contact(A, B, X, tolerance);
    expect_sound(c, tolerance, 1e-12);
    if (c.patch.points.size() != 4 || c.patch.area < 2e-5) continue;
    const Vec3 e1 = any_orthogonal(c.patch.normal);
    const Vec3 e2 = c.patch.normal.cross(e1);
    const GridCount counted = count_points(A, B, X, c.patch, tolerance, e1, e2);
    const Vec3 m = centroid(c.patch);
    const double length = std::sqrt(c.patch.area);
    const double spread = counted.central.trace();
    EXPECT_NEAR(counted.area / c.patch.area, 1.0, 0.03);
    EXPECT_NEAR(e1.dot(m), counted.mean.x(), 0.01 * length);
    EXPECT_NEAR(e2.dot(m), counted.mean.y(), 0.01 * length);
    EXPECT_NEAR(second_moment(c.patch, e1, e1), counted.central(0, 0), 0.02 * spread);
    EXPECT_NEAR(second_moment(c.patch, e1, e2), counted.central(0, 1), 0.02 * spread);
    EXPECT_NEAR(second_moment(c.patch, e2, e2), counted.central(1, 1), 0.02 * spread);
  }
}

}  // namespace
}  // namespace tactum
