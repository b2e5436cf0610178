#include "tactum/collision/manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collision/cases.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/planar_patch.h"
#include "tactum/collision/supporting_feature.h"

namespace tactum {
namespace {

using Kind = FeatureKind;

struct Contact {
  PairDistance closest;
  Manifold patch;
};

/// How far the patch's points are from the plane of the face they are on, of either piece that takes part
/// with one.
double off_the_faces(const Polytope& A, const Polytope& B, const Pose& X_AB, const Manifold& patch) {
  double off = 0.0;
  for (const ContactPoint& p : patch.points) {
    const Vec3 in_b = X_AB.inverse() * p.p_b;
    if (patch.a.kind == Kind::kFace) {
      const Polytope::Face& face = A.faces[std::size_t(patch.a.index)];
      off = std::max(off, std::abs(face.normal.dot(p.p_a) - face.offset));
    }
    if (patch.b.kind == Kind::kFace) {
      const Polytope::Face& face = B.faces[std::size_t(patch.b.index)];
      off = std::max(off, std::abs(face.normal.dot(in_b) - face.offset));
    }
  }
  return off;
}

Contact contact(const Polytope& A, const Polytope& B, const Pose& X_AB, double tolerance) {
  Contact c;
  PairCache cache;
  c.closest = closest_features(A, B, X_AB, cache);
  contact_manifold(A, B, X_AB, c.closest, tolerance, c.patch);
  EXPECT_LT(off_the_faces(A, B, X_AB, c.patch),
            1e-13 * (1.0 + X_AB.p.norm() + A.extent.magnitude + B.extent.magnitude));
  return c;
}

Vec3 centroid(const Manifold& patch) {
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& p : patch.points) sum += p.weight * 0.5 * (p.p_a + p.p_b);
  return sum;
}

/// Second moments about the centroid, along two unit directions.
double second_moment(const Manifold& patch, const Vec3& u, const Vec3& v) {
  const Vec3 c = centroid(patch);
  double sum = 0.0;
  for (const ContactPoint& p : patch.points) {
    const Vec3 r = 0.5 * (p.p_a + p.p_b) - c;
    sum += p.weight * u.dot(r) * v.dot(r);
  }
  return sum;
}

void expect_kinds(const Manifold& patch, Kind a, Kind b, std::size_t points) {
  EXPECT_EQ(patch.a.kind, a);
  EXPECT_EQ(patch.b.kind, b);
  EXPECT_EQ(patch.points.size(), points);
}

/// What holds for every patch.
void expect_sound(const Contact& c, double tolerance, double slack) {
  ASSERT_FALSE(c.patch.points.empty());
  double weight = 0.0;
  for (const ContactPoint& p : c.patch.points) {
    weight += p.weight;
    EXPECT_NEAR(p.distance, c.patch.normal.dot(p.p_a - p.p_b), slack);
    EXPECT_LE(p.distance, tolerance + slack);
    EXPECT_GE(p.distance, c.closest.distance - slack);
  }
  EXPECT_NEAR(weight, 1.0, 1e-14);
}

const Polytope& box() {
  static const Polytope P = make_box({0.02, 0.03, 0.01});
  return P;
}

Pose above(double x, double y, double z, const Mat3& R = Mat3::Identity()) { return {R, {x, y, z}}; }

TEST(Manifold, FaceOnFaceHasAreaAndMomentsOfTheSharedRectangle) {
  // B beside and below A: shared rectangle 0.03 x 0.04 about (0.005, 0.01).
  const Contact c = contact(box(), box(), above(0.01, 0.02, -0.0201), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  EXPECT_NEAR(c.patch.area, 0.03 * 0.04, 1e-15);
  EXPECT_TRUE(centroid(c.patch).isApprox(Vec3(0.005, 0.01, -0.01005), 1e-12));
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitX(), Vec3::UnitX()), 0.03 * 0.03 / 12, 1e-15);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitY(), Vec3::UnitY()), 0.04 * 0.04 / 12, 1e-15);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitX(), Vec3::UnitY()), 0.0, 1e-15);
  EXPECT_TRUE(c.patch.normal.isApprox(Vec3::UnitZ()));
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0001, 1e-15);
}

TEST(Manifold, FaceOnFaceWhenOverlapping) {
  const Contact c = contact(box(), box(), above(0.01, 0.02, -0.0195), 0.001);
  EXPECT_NEAR(c.closest.distance, -0.0005, 1e-12);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  EXPECT_NEAR(c.patch.area, 0.03 * 0.04, 1e-12);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, -0.0005, 1e-12);
}

TEST(Manifold, EdgeOnFaceIsTheClippedInterval) {
  const Mat3 on_edge = exp_rotation(Vec3(0, 0.25 * kPi, 0));  // about y: an edge along y points up
  const double height = std::sqrt(0.02 * 0.02 + 0.01 * 0.01) * std::sin(std::atan2(0.01, 0.02) + 0.25 * kPi);
  const Contact c = contact(box(), box(), above(0, 0.015, -0.01 - height - 0.0002, on_edge), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kEdge, 2);
  EXPECT_NEAR(centroid(c.patch).y(), 0.0075, 1e-12);  // y from -0.015 to 0.03
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitY(), Vec3::UnitY()), 0.045 * 0.045 / 12, 1e-14);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0002, 1e-12);
}

/// A face of P over or under an edge of Q, looked at along `n`, all in P's frame.
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

/// Faces of four, five and two hundred corners (more than an area takes of one), of A and of B, over an edge
/// that is turned, shifted and out of level, partly beyond the face and partly beyond the tolerance; where it
/// crosses a border of the face steeply the face leans, and less of it counts.
TEST(Manifold, EdgeOverAFaceAgreesWithCounting) {
  constexpr double kTolerance = 3e-4;
  constexpr int kSteps = 2000;
  const Polytope roof = make_box({0.02, 0.03, 0.01});
  const Mat3 on_edge = exp_rotation(Vec3(0, 0.25 * kPi, 0));  // about y: an edge along y points up
  const double height = std::sqrt(0.02 * 0.02 + 0.01 * 0.01) * std::sin(std::atan2(0.01, 0.02) + 0.25 * kPi);
  int level = 0;
  int leaning = 0;
  int cut = 0;
  for (const Polytope& P : {box(), make_prism(5, 0.02, 0.02), make_prism(200, 0.02, 0.02)}) {
    Random random(std::uint64_t(P.faces.size()));
    for (int i = 0; i < 200; ++i) {
      const double out_of_level = i % 2 ? random.uniform(0.018, 0.034) : random.uniform(0.0, 0.004);
      const Mat3 R = exp_rotation(Vec3(0, 0, random.uniform(-kPi, kPi))) *
                     exp_rotation(Vec3(out_of_level, 0, 0)) * on_edge;
      Pose X_PQ{R, {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), -0.011 - height}};
      PairCache cache;
      X_PQ.p.z() += closest_features(P, roof, X_PQ, cache).distance - 1e-4;
      for (bool face_of_a : {true, false}) {
        const Contact c =
            face_of_a ? contact(P, roof, X_PQ, kTolerance) : contact(roof, P, X_PQ.inverse(), kTolerance);
        const Feature& face = face_of_a ? c.patch.a : c.patch.b;
        const Feature& edge = face_of_a ? c.patch.b : c.patch.a;
        if (face.kind != Kind::kFace || edge.kind != Kind::kEdge || c.patch.points.size() != 2) continue;
        const Polytope::Edge& line = roof.edges[std::size_t(edge.index)];
        const Vec3& tail = roof.vertices[std::size_t(line.tail)];
        const EdgeAndFace pair{P,
                               P.faces[std::size_t(face.index)],
                               X_PQ * tail,
                               X_PQ * roof.vertices[std::size_t(line.head)],
                               face_of_a ? c.patch.normal : Vec3(R * c.patch.normal),
                               face_of_a};
        const Vec3 out = face_of_a ? Vec3(-pair.n) : pair.n;  // of P
        const SupportingFeature on_face =
            supporting_feature(P, face_of_a ? c.closest.a : c.closest.b, out, tolerances::kPatchAngle);
        const SupportingFeature on_line = supporting_feature(roof, face_of_a ? c.closest.b : c.closest.a,
                                                             -(R.transpose() * out), tolerances::kPatchAngle);
        const PatchInterval expected =
            interval_by_steps(pair, on_face, on_line, c.closest.distance, kTolerance, kSteps);
        const auto place = [&](const ContactPoint& p) {
          const Vec3 on_roof = face_of_a ? Vec3(X_PQ.inverse() * p.p_b) : p.p_a;
          return line.direction.dot(on_roof - tail) / line.length;
        };
        const double first = place(c.patch.points[0]);
        const double second = place(c.patch.points[1]);
        const double reach = 0.5 * std::sqrt(3.0) * (second - first);  // of Gauss points, to the ends
        if (expected.empty()) {                                        // between two steps
          EXPECT_LT(2.0 * reach, 1.0 / kSteps) << i;
          continue;
        }
        EXPECT_NEAR(0.5 * (first + second) - reach, expected.low, 2.0 / kSteps) << i;
        EXPECT_NEAR(0.5 * (first + second) + reach, expected.high, 2.0 / kSteps) << i;
        ++(on_face.face_share < 1.0 ? leaning : level);
        cut += expected.high - expected.low < 0.99 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(level, 200);
  EXPECT_GT(leaning, 50);
  EXPECT_GT(cut, 200);
}

TEST(Manifold, ParallelEdgesShareAnInterval) {
  const Polytope prism = make_prism(4, 0.02, 0.06);  // corners on x and y: an edge along z at x = 0.02
  const Contact c = contact(prism, prism, above(-0.0403, 0, 0.02), 0.001);
  expect_kinds(c.patch, Kind::kEdge, Kind::kEdge, 2);
  EXPECT_NEAR(centroid(c.patch).z(), 0.01, 1e-12);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitZ(), Vec3::UnitZ()), 0.04 * 0.04 / 12, 1e-14);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0003, 1e-12);
}

TEST(Manifold, CrossingEdgesMeetInAPoint) {
  const Polytope prism = make_prism(4, 0.02, 0.06);
  const Mat3 turned = exp_rotation(Vec3(0.5 * kPi, 0, 0));  // the edge now along y
  const Contact c = contact(prism, prism, above(-0.0403, 0.001, 0.002, turned), 0.001);
  expect_kinds(c.patch, Kind::kEdge, Kind::kEdge, 1);
  EXPECT_TRUE(centroid(c.patch).isApprox(Vec3(-0.02015, 0, 0.002), 0.06));
  EXPECT_NEAR(c.patch.points[0].distance, 0.0003, 1e-12);
}

TEST(Manifold, VertexOnFaceEdgeAndVertex) {
  const Polytope tip =
      *convex_hull({{0, 0, 0}, {0.01, 0, -0.03}, {-0.01, 0.01, -0.03}, {-0.01, -0.01, -0.03}});
  const Contact face = contact(box(), tip, above(0.003, 0.004, -0.0101), 0.001);
  expect_kinds(face.patch, Kind::kFace, Kind::kVertex, 1);
  EXPECT_TRUE(face.patch.points[0].p_b.isApprox(Vec3(0.003, 0.004, -0.0101), 1e-12));
  const Polytope prism = make_prism(4, 0.02, 0.06);
  const Mat3 sideways = exp_rotation(Vec3(0, 0.5 * kPi, 0));  // the tip now points along x
  const Contact edge = contact(prism, tip, above(-0.0202, 0, 0.01, sideways), 0.001);
  expect_kinds(edge.patch, Kind::kEdge, Kind::kVertex, 1);
  EXPECT_NEAR(edge.patch.points[0].distance, 0.0002, 1e-12);
  const Mat3 down = exp_rotation(Vec3(kPi, 0, 0));
  const Contact vertex = contact(tip, tip, above(0, 0, 0.0003, down), 0.001);
  expect_kinds(vertex.patch, Kind::kVertex, Kind::kVertex, 1);
  EXPECT_NEAR(vertex.patch.points[0].distance, 0.0003, 1e-12);
}

TEST(Manifold, ManyCorneredFacesFit) {
  const Polytope prism = make_prism(200, 0.02, 0.01);
  const Contact c = contact(prism, prism, above(0.001, 0, -0.0101, exp_rotation(Vec3(0, 0, 0.01))), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  const double r = 0.02;
  const double lens = 2 * r * r * std::acos(0.001 / (2 * r)) - 0.0005 * std::sqrt(4 * r * r - 1e-6);
  EXPECT_NEAR(c.patch.area / lens, 1.0, 0.01);
  EXPECT_LT(c.patch.area, lens);  // never more than there is
}

/// A pose that is none leaves the nearest points.
TEST(Manifold, OfAPoseThatIsNotFiniteIsAPoint) {
  const Pose level = above(0.001, 0.002, -0.02);
  PairCache cache;
  const PairDistance closest = closest_features(box(), box(), level, cache);
  Pose broken = level;
  broken.p.x() = std::nan("");
  Manifold patch;
  contact_manifold(box(), box(), broken, closest, 1e-2, patch);
  ASSERT_EQ(patch.points.size(), 1u);
  EXPECT_EQ(patch.points[0].p_a, closest.p_a);
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
    const Polytope::Face& fa = A.faces[std::size_t(c.patch.a.index)];
    const Polytope::Face& fb = B.faces[std::size_t(c.patch.b.index)];
    const Vec3 nb = X.R * fb.normal;
    const double ob = fb.offset + nb.dot(X.p);
    const Vec3 n = c.patch.normal;
    const Vec3 e1 = any_orthogonal(n);
    const Vec3 e2 = n.cross(e1);
    const auto over = [](const Polytope& P, const Polytope::Face& f, const Vec3& p, const Vec3& along) {
      for (int s = f.first; s < f.first + f.count; ++s) {  // the border's plane holds the common normal
        const Vec3& u = P.edges[std::size_t(P.sides[std::size_t(s)].edge)].direction;
        Vec3 side = u.cross(along);
        if (side.dot(P.sides[std::size_t(s)].normal) < 0) side = -side;
        if (side.dot(p - P.vertices[std::size_t(P.face_vertices[std::size_t(s)])]) > 0) return false;
      }
      return true;
    };
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
    const Eigen::Matrix2d central = second / count - mean * mean.transpose();
    const Vec3 m = centroid(c.patch);
    const double length = std::sqrt(c.patch.area);
    EXPECT_NEAR(count * cell * cell / c.patch.area, 1.0, 0.03);
    EXPECT_NEAR(e1.dot(m), mean.x(), 0.01 * length);
    EXPECT_NEAR(e2.dot(m), mean.y(), 0.01 * length);
    EXPECT_NEAR(second_moment(c.patch, e1, e1), central(0, 0), 0.02 * central.trace());
    EXPECT_NEAR(second_moment(c.patch, e1, e2), central(0, 1), 0.02 * central.trace());
    EXPECT_NEAR(second_moment(c.patch, e2, e2), central(1, 1), 0.02 * central.trace());
  }
}

/// A rectangle is clipped by its own coordinates, any other face side by side: B with a corner that is a hair
/// off square has the same patch.
TEST(Manifold, OfARectangleIsThatOfAFaceThatNearlyIsOne) {
  const std::uint64_t seed = 39;
  Random random(seed);
  int patches = 0;
  for (int i = 0; i < cases::some_of(5000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Vec3 half(random.uniform(0.002, 0.03), random.uniform(0.002, 0.03), 0.01);
    constexpr double kHair = 1e-10;
    const auto brick = [&](double off) {
      std::vector<Vec3> corners;
      for (const double z : {-half.z(), half.z()})
        for (const Vec2& at : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1 + off), Vec2(-1, 1)})
          corners.push_back({half.x() * at.x(), half.y() * at.y(), z});
      return *convex_hull(corners);
    };
    const Pose X{
        exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
        {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), -0.0202}};
    const Contact square = contact(A, brick(0.0), X, 5e-4);
    if (square.patch.points.size() != 4) continue;
    const Contact nearly = contact(A, brick(kHair), X, 5e-4);
    ASSERT_EQ(nearly.patch.points.size(), 4u);
    ++patches;
    expect_sound(square, 5e-4, 1e-12);
    EXPECT_NEAR(nearly.patch.area, square.patch.area, 1e-10);
    EXPECT_LT((centroid(nearly.patch) - centroid(square.patch)).norm(), 1e-8);
    const Vec3 u = any_orthogonal(square.patch.normal);
    EXPECT_NEAR(second_moment(nearly.patch, u, u), second_moment(square.patch, u, u), 1e-11);
  }
  EXPECT_GT(patches, cases::some_of(1000));
}

TEST(Manifold, SwappingAAndBTurnsTheNormalAndKeepsThePatch) {
  const std::uint64_t seed = 32;
  Random random(seed);
  for (int i = 0; i < cases::some_of(2000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Polytope B = make_prism(3 + random.index(7), 0.02, 0.02);
    Pose X{exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
           {random.uniform(-0.02, 0.02), 0, -0.0202}};
    const Contact ab = contact(A, B, X, 5e-4);
    const Contact ba = contact(B, A, X.inverse(), 5e-4);
    if (ab.patch.points.empty()) {
      EXPECT_TRUE(ba.patch.points.empty());
      continue;
    }
    expect_sound(ab, 5e-4, 1e-12);
    EXPECT_LT((X.R * ba.patch.normal + ab.patch.normal).norm(), 1e-9);
    EXPECT_NEAR(ab.patch.area, ba.patch.area, 1e-9);
    EXPECT_LT((X * centroid(ba.patch) - centroid(ab.patch)).norm(), 1e-7);
  }
}

/// Where the patch is, how large and how it spreads: told the same whatever the vertices are called, a
/// kilometre away (1e-12 m of the poses' own rounding), and for parts of 1 mm to 10 m.
TEST(Manifold, NamesPlaceAndScaleDoNotMatter) {
  const std::uint64_t seed = 33;
  Random random(seed);
  int patches = 0;
  for (int i = 0; i < cases::some_of(1000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Polytope B = make_prism(3 + random.index(7), 0.02, 0.02);
    const Pose X{
        exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
        {random.uniform(-0.02, 0.02), 0, -0.0202}};
    const Contact here = contact(A, B, X, 5e-4);
    if (here.patch.points.size() != 4) continue;
    ++patches;
    const auto expect_same = [&](const Contact& other, double by, double slack) {
      EXPECT_LT((other.patch.normal - here.patch.normal).norm(), 1e-9);
      EXPECT_NEAR(other.patch.area, here.patch.area * by * by, 0.02 * slack * by * by);
      EXPECT_LT((centroid(other.patch) - by * centroid(here.patch)).norm(), slack * by);
      const Vec3 u = any_orthogonal(here.patch.normal);
      EXPECT_NEAR(second_moment(other.patch, u, u), by * by * second_moment(here.patch, u, u),
                  0.02 * slack * by * by);
    };
    expect_same(contact(cases::renamed(A, random), cases::renamed(B, random), X, 5e-4), 1.0, 1e-9);
    const Pose X_WA{cases::random_rotation(random), cases::random_unit(random) * 1000.0};
    expect_same(contact(A, B, relative_pose(X_WA, X_WA * X), 5e-4), 1.0, 1e-8);
    for (double by : {0.02, 200.0})
      expect_same(contact(cases::scaled(A, by), cases::scaled(B, by), {X.R, X.p * by}, 5e-4 * by), by, 1e-9);
  }
  EXPECT_GT(patches, cases::some_of(100));
}

/// Largest step of the patch's centroid while a prism rocks through flat against a box, by 3.4 degrees to
/// either side, in steps of `step` [rad], at a distance of half the tolerance.
double largest_jump(std::uint64_t seed, double step) {
  Random random(seed);
  const Polytope A = make_box({0.0125, 0.0125, 0.0125});
  const Polytope B = make_prism(6, 0.02, 0.02);
  const double tolerance = 1e-4;
  double worst = 0.0;
  for (int run = 0; run < (cases::kSlowness > 1 ? 1 : 12); ++run) {
    const double spin = random.uniform(-3, 3);
    const double offset = random.uniform(-0.01, 0.01);
    const double heading = random.uniform(-3, 3);
    const Vec3 axis(std::cos(heading), std::sin(heading), 0);
    PairCache cache;
    Vec3 last = Vec3::Zero();
    bool have = false;
    for (double tilt = -0.06; tilt <= 0.06; tilt += step) {
      Pose X{exp_rotation(axis * tilt) * exp_rotation(Vec3(0, 0, spin)), {offset, 0.003, -0.03}};
      X.p.z() += closest_features(A, B, X, cache).distance - 5e-5;
      const PairDistance closest = closest_features(A, B, X, cache);
      Manifold patch;
      contact_manifold(A, B, X, closest, tolerance, patch);
      if (patch.points.empty()) return INFINITY;
      const Vec3 now = centroid(patch);
      if (have) worst = std::max(worst, (now - last).norm());
      last = now;
      have = true;
    }
  }
  return worst;
}

/// No jump: with finer steps the largest one shrinks in proportion. (It is not small by itself: with a gap of
/// 50 um the normal turns by 3 mrad while two edges slide past each other by 0.2 um.)
TEST(Manifold, CentroidMovesContinuously) {
  const std::uint64_t seed = 33;
  const double coarse = largest_jump(seed, cases::kSlowness > 1 ? 4e-4 : 2e-5);
  const double fine = cases::kSlowness > 1 ? 0.0 : largest_jump(seed, 1e-6);
  std::printf("  seed %llu: largest step of the centroid %.3g mm at 20 microradians, %.3g mm at 1\n",
              static_cast<unsigned long long>(seed), coarse * 1e3, fine * 1e3);
  EXPECT_LT(coarse, cases::kSlowness > 1 ? 1.0 : 1e-3);
  EXPECT_LT(fine, 0.25 * coarse);
}

TEST(Manifold, NeverEmptyBelowTheTolerance) {
  const std::uint64_t seed = 34;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int poses = cases::full() ? 1000000 : cases::some_of(20000);
  int patches = 0;
  for (int i = 0; i < poses; ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X =
        cases::make_pose(random, a.polytope, b.polytope, cases::Making(i % int(cases::Making::kCount)));
    const double size = std::max(a.polytope.extent.size, b.polytope.extent.size);
    const Contact c = contact(a.polytope, b.polytope, X, 0.01 * size);
    if (c.closest.distance >= 0.01 * size) {
      EXPECT_TRUE(c.patch.points.empty());
      continue;
    }
    ++patches;
    SCOPED_TRACE(a.name + " / " + b.name + ", seed " + std::to_string(seed) + ", case " + std::to_string(i) +
                 " " + cases::describe(X));
    ASSERT_FALSE(c.patch.points.empty());
    double weight = 0.0;
    for (const ContactPoint& p : c.patch.points) {
      weight += p.weight;
      EXPECT_TRUE(p.p_a.allFinite() && p.p_b.allFinite());
      EXPECT_NEAR(p.distance, c.patch.normal.dot(p.p_a - p.p_b), 1e-9 * size);
      // Quadrature points stay over the patch, so near both pieces.
      EXPECT_LT((p.p_a - a.polytope.extent.center).norm(), a.polytope.extent.radius * 1.3 + 0.02 * size);
      EXPECT_LT((p.p_b - X * b.polytope.extent.center).norm(), b.polytope.extent.radius * 1.3 + 0.02 * size);
    }
    EXPECT_NEAR(weight, 1.0, 1e-14);
  }
  EXPECT_GT(patches, poses / 4);
}

}  // namespace
}  // namespace tactum
