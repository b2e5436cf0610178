#pragma once
/// The shapes and poses the contact core is tried on: compact, thin, flat, round; and poses made to be
/// degenerate.

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "support/effort.h"
#include "support/rotation_between.h"
#include "tactum/base/random.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"

namespace tactum::cases {

struct Shape {
  std::string name;
  Polytope polytope;
};

inline Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

inline Vec3 random_unit(Random& random) {
  for (;;) {
    const Vec3 v = random_vector(random, 1.0);
    const double length = v.norm();
    if (length > 0.1 && length < 1.0) return v / length;
  }
}

inline Mat3 random_rotation(Random& random) {
  const Vec3 axis = random_unit(random);
  return exp_rotation(axis * random.uniform(0.0, kPi));
}

inline Polytope random_hull(Random& random, int points, const Vec3& size) {
  std::vector<Vec3> cloud;
  for (int i = 0; i < points; ++i) cloud.push_back(random_unit(random).cwiseProduct(size));
  return *convex_hull(cloud);
}

/// Shapes of hand size [m]. `large` adds those with hundreds of vertices.
inline std::vector<Shape> shapes(Random& random, bool large) {
  std::vector<Shape> list;
  list.push_back({"box", make_box({0.02, 0.03, 0.05})});
  list.push_back({"cube", make_box({0.025, 0.025, 0.025})});
  list.push_back({"needle", make_box({0.001, 0.001, 0.05})});
  list.push_back({"plate", make_box({0.05, 0.05, 0.0005})});
  list.push_back({"prism 6", make_prism(6, 0.02, 0.04)});
  list.push_back({"prism 3 needle", make_prism(3, 0.001, 0.1)});
  list.push_back({"tetrahedron", *convex_hull({{0, 0, 0}, {0.04, 0, 0}, {0, 0.05, 0}, {0.01, 0.01, 0.06}})});
  list.push_back({"hull 12", random_hull(random, 12, {0.02, 0.03, 0.03})});
  list.push_back({"hull 20 flat", random_hull(random, 20, {0.03, 0.03, 0.0003})});
  list.push_back({"icosahedron", make_icosphere(0, 0.03)});
  list.push_back({"triangle", *flat_polygon({{0, 0, 0.01}, {0.05, 0, 0.01}, {0.01, 0.03, 0.01}})});
  list.push_back({"thin triangle", *flat_polygon({{0, 0, 0}, {0.05, 0, 0}, {0.025, 0.0005, 0}})});
  list.push_back({"flat octagon", *convex_hull({{3, 1, 0},
                                                {1, 3, 0},
                                                {-1, 3, 0},
                                                {-3, 1, 0},
                                                {-3, -1, 0},
                                                {-1, -3, 0},
                                                {1, -3, 0},
                                                {3, -1, 0}})});
  for (Vec3& v : list.back().polytope.vertices) v *= 0.01;
  {
    std::vector<Vec3> corners = list.back().polytope.vertices;
    list.back().polytope = *convex_hull(corners);
  }
  if (large) {
    list.push_back({"prism 64", make_prism(64, 0.02, 0.05)});
    list.push_back({"hull 150", random_hull(random, 150, {0.02, 0.03, 0.05})});
    list.push_back({"ellipsoid 162", make_ellipsoid(2, {0.03, 0.01, 0.05})});
    list.push_back({"sphere 162", make_icosphere(2, 0.025)});
    list.push_back({"sphere 642", make_icosphere(3, 0.025)});
  }
  return list;
}

/// The purpose of a pose of the list.
enum class Making {
  kRandom,
  kFaceToFace,
  kEdgeToEdge,
  kVertexOverEdge,
  kVertexOverFace,
  kVertexToVertex,
  kAligned,
  kCount
};

/// A rotation that takes unit `from` to unit `to`, then turned about `to` by `angle`.
inline Mat3 turning(const Vec3& from, const Vec3& to, double angle) {
  return exp_rotation(to * angle) * testing::rotation_between(from, to);
}

/// A gap from the whole range that matters, relative to the size: 0, +-1e-14 ... +-1.
inline double random_gap(Random& random) {
  const int kind = random.index(8);
  const double magnitude = std::pow(10.0, random.uniform(-14.0, 0.0));
  if (kind == 0) return 0.0;
  return kind < 6 ? magnitude : -magnitude;
}

/// Random choices for a pose of any kind: features of A and of B, and numbers.
struct PoseDraw {
  const Polytope::Face& face_a;
  const Polytope::Face& face_b;
  const Polytope::Edge& edge_a;
  const Polytope::Edge& edge_b;
  Vec3 vertex_a, vertex_b;
  double gap = 0.0;      ///< relative to the size
  double quarter = 0.0;  ///< a multiple of a right angle
  double angle = 0.0;    ///< often the same
  Vec3 tilt = Vec3::Zero();
  double share = 0.0;  ///< how far along an edge, or over a face; often an end
};

inline PoseDraw draw_pose(Random& random, const Polytope& A, const Polytope& B) {
  const auto pick = [&](const auto& list) -> const auto& {
    return list[static_cast<std::size_t>(random.index(static_cast<int>(list.size())))];
  };
  PoseDraw draw{.face_a = pick(A.faces),
                .face_b = pick(B.faces),
                .edge_a = pick(A.edges),
                .edge_b = pick(B.edges),
                .vertex_a = pick(A.vertices),
                .vertex_b = pick(B.vertices)};
  draw.gap = random_gap(random);
  draw.quarter = 0.5 * kPi * random.index(4);
  draw.angle = random.index(2) ? draw.quarter : random.uniform(-kPi, kPi);
  const double tilt = random.index(3) ? 0.0 : std::pow(10.0, random.uniform(-16.0, -2.0));
  draw.tilt = random_unit(random) * tilt;
  draw.share = random.index(4) ? random.unit() : random.index(2);
  return draw;
}

/// Two points that are set against each other, and how B is turned for it.
struct Placement {
  Mat3 R;        ///< of X_AB
  Vec3 on_a;     ///< in A
  Vec3 on_b;     ///< in B
  Vec3 outward;  ///< of A, unit
};

/// Away from the piece, between the two faces of an edge.
inline Vec3 outward_of(const Polytope& P, const Polytope::Edge& edge) {
  return (P.sides[std::size_t(edge.left_slot)].normal + P.sides[std::size_t(edge.right_slot)].normal)
      .normalized();
}

/// The point of an edge that is so far along it.
inline Vec3 point_of(const Polytope& P, const Polytope::Edge& edge, double share) {
  return P.vertices[std::size_t(edge.tail)] + edge.direction * (edge.length * share);
}

/// A point of A's face, often a corner's or a side's.
inline Vec3 face_point(const Polytope& A, const PoseDraw& draw) {
  const auto corner = [&](int i) -> const Vec3& {
    return A.vertices[std::size_t(A.face_vertices[std::size_t(draw.face_a.first + i)])];
  };
  return corner(0) + draw.share * (corner(1) - corner(0)) + 0.3 * draw.share * (corner(2) - corner(1));
}

/// B with its vertex toward A, against `on_a`.
inline Placement vertex_against(const Polytope& B, const PoseDraw& draw, const Vec3& on_a,
                                const Vec3& outward) {
  return {turning((draw.vertex_b - B.extent.center).normalized(), -outward, draw.angle), on_a, draw.vertex_b,
          outward};
}

inline Placement face_to_face(const Polytope& A, const Polytope& B, const PoseDraw& draw) {
  return {turning(draw.face_b.normal, -draw.face_a.normal, draw.angle), face_point(A, draw),
          B.vertices[std::size_t(B.face_vertices[std::size_t(draw.face_b.first)])], draw.face_a.normal};
}

inline Placement edge_to_edge(Random& random, const Polytope& A, const Polytope& B, const PoseDraw& draw) {
  const Vec3 outward = outward_of(A, draw.edge_a);
  Mat3 R = turning(outward_of(B, draw.edge_b), -outward, draw.angle);
  if (random.index(2)) {  // parallel edges
    const Vec3 u = R * draw.edge_b.direction;
    const Vec3 w = draw.edge_a.direction;
    R = exp_rotation(outward * std::atan2(outward.dot(u.cross(w)), u.dot(w))) * R;
  }
  return {R, point_of(A, draw.edge_a, draw.share), point_of(B, draw.edge_b, 0.5), outward};
}

/// B with its axes along those of A, often flush with it.
inline Placement aligned(Random& random, const Polytope& A, const PoseDraw& draw, double size) {
  Placement out{exp_rotation(Vec3(0, 0, draw.quarter)), draw.vertex_a, draw.vertex_b, Vec3::Zero()};
  const Vec3 step = random_vector(random, 1.0);
  for (int i = 0; i < 3; ++i)
    out.on_a[i] = random.index(3) ? out.on_a[i] : A.extent.center[i] + step[i] * size;
  out.outward = Vec3::Unit(random.index(3));
  if (random.index(2)) out.outward = -out.outward;
  return out;
}

/// X_AB of the given making: features of A and B set against each other at a random gap along A's outward
/// direction; of kRandom, B anywhere near A.
inline Pose make_pose(Random& random, const Polytope& A, const Polytope& B, Making making) {
  const double size = 0.5 * (A.extent.size + B.extent.size);
  const Mat3 R = random_rotation(random);
  const PoseDraw draw = draw_pose(random, A, B);
  const auto posed = [&](const Placement& at) {
    const Mat3 tilted = exp_rotation(draw.tilt) * at.R;
    return Pose{tilted, at.on_a + at.outward * (draw.gap * size) - tilted * at.on_b};
  };
  switch (making) {
    case Making::kFaceToFace:
      return posed(face_to_face(A, B, draw));
    case Making::kEdgeToEdge:
      return posed(edge_to_edge(random, A, B, draw));
    case Making::kVertexOverEdge:
      return posed(vertex_against(B, draw, point_of(A, draw.edge_a, draw.share), outward_of(A, draw.edge_a)));
    case Making::kVertexOverFace:
      return posed(vertex_against(B, draw, face_point(A, draw), draw.face_a.normal));
    case Making::kVertexToVertex:
      return posed(vertex_against(B, draw, draw.vertex_a, (draw.vertex_a - A.extent.center).normalized()));
    case Making::kAligned:
      return posed(aligned(random, A, draw, size));
    case Making::kRandom:
    case Making::kCount:
      break;
  }
  const Vec3 direction = random_unit(random);
  return {R, A.extent.center - R * B.extent.center +
                 direction * (A.extent.radius + B.extent.radius) * random.uniform(0.0, 1.3)};
}

/// A sanitized build takes a few poses only.
inline constexpr int kSlowness = testing::kSanitized ? 100 : 1;

/// How many of `poses` this build tries.
inline int some_of(int poses) { return poses / kSlowness; }

inline bool full() { return testing::full_run(); }

inline std::string describe(const Pose& X) {
  char text[400];
  std::snprintf(text, sizeof text,
                "R = %.17g %.17g %.17g / %.17g %.17g %.17g / %.17g %.17g %.17g, p = %.17g %.17g %.17g",
                X.R(0, 0), X.R(0, 1), X.R(0, 2), X.R(1, 0), X.R(1, 1), X.R(1, 2), X.R(2, 0), X.R(2, 1),
                X.R(2, 2), X.p.x(), X.p.y(), X.p.z());
  return text;
}

/// The same piece `by` times as large.
inline Polytope scaled(const Polytope& P, double by) {
  std::vector<Vec3> corners = P.vertices;
  for (Vec3& x : corners) x *= by;
  return *convex_hull(corners);
}

/// The same piece with its vertices in another order.
inline Polytope renamed(const Polytope& P, Random& random) {
  std::vector<Vec3> corners = P.vertices;
  for (std::size_t i = corners.size(); i > 1; --i)
    std::swap(corners[i - 1], corners[std::size_t(random.index(int(i)))]);
  return *convex_hull(corners);
}

}  // namespace tactum::cases
