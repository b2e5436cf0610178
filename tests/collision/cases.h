#pragma once
/// The shapes and poses the contact core is tried on: compact, thin, flat, round; and poses made to be
/// degenerate.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

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

/// What a pose of the list is made to show.
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
  return exp_rotation(to * angle) * Quat::FromTwoVectors(from, to).normalized().toRotationMatrix();
}

/// A gap from the whole range that matters, relative to the size: 0, +-1e-14 ... +-1.
inline double random_gap(Random& random) {
  const int kind = random.index(8);
  const double magnitude = std::pow(10.0, random.uniform(-14.0, 0.0));
  if (kind == 0) return 0.0;
  return kind < 6 ? magnitude : -magnitude;
}

/// X_AB of the given making: features of A and B set against each other at a random gap along A's outward
/// direction.
inline Pose make_pose(Random& random, const Polytope& A, const Polytope& B, Making making) {
  const double size = 0.5 * (A.extent.size + B.extent.size);
  Pose X{random_rotation(random), Vec3::Zero()};
  const auto pick = [&](std::size_t n) {
    return static_cast<std::size_t>(random.index(static_cast<int>(n)));
  };
  const Polytope::Face& fa = A.faces[pick(A.faces.size())];
  const Polytope::Face& fb = B.faces[pick(B.faces.size())];
  const Polytope::Edge& ea = A.edges[pick(A.edges.size())];
  const Polytope::Edge& eb = B.edges[pick(B.edges.size())];
  const std::size_t va = pick(A.vertices.size());
  const std::size_t vb = pick(B.vertices.size());
  const double gap = random_gap(random) * size;
  const double quarter = 0.5 * kPi * random.index(4);
  const double angle = random.index(2) ? quarter : random.uniform(-kPi, kPi);
  const double tilt = random.index(3) ? 0.0 : std::pow(10.0, random.uniform(-16.0, -2.0));
  const Vec3 tilt_axis = random_unit(random) * tilt;
  const double share = random.index(4) ? random.unit() : random.index(2);
  Vec3 outward = fa.normal;
  Vec3 on_a = A.vertices[va];
  Vec3 on_b = B.vertices[vb];
  const Vec3 face_point = [&] {  // a point of A's face, often a corner's or a side's
    const Vec3& p = A.vertices[std::size_t(A.face_vertices[std::size_t(fa.first)])];
    const Vec3& q = A.vertices[std::size_t(A.face_vertices[std::size_t(fa.first + 1)])];
    const Vec3& r = A.vertices[std::size_t(A.face_vertices[std::size_t(fa.first + 2)])];
    return Vec3(p + share * (q - p) + 0.3 * share * (r - q));
  }();
  switch (making) {
    case Making::kFaceToFace:
      X.R = turning(fb.normal, -fa.normal, angle);
      on_a = face_point;
      on_b = B.vertices[std::size_t(B.face_vertices[std::size_t(fb.first)])];
      break;
    case Making::kEdgeToEdge: {
      outward = (A.sides[std::size_t(ea.left_slot)].normal + A.sides[std::size_t(ea.right_slot)].normal)
                    .normalized();
      const Vec3 out_b =
          (B.sides[std::size_t(eb.left_slot)].normal + B.sides[std::size_t(eb.right_slot)].normal)
              .normalized();
      X.R = turning(out_b, -outward, angle);
      if (random.index(2)) {  // parallel edges
        const Vec3 u = X.R * eb.direction;
        const Vec3 w = ea.direction;
        X.R = exp_rotation(outward * std::atan2(outward.dot(u.cross(w)), u.dot(w))) * X.R;
      }
      on_a = A.vertices[std::size_t(ea.tail)] + ea.direction * (ea.length * share);
      on_b = B.vertices[std::size_t(eb.tail)] + eb.direction * (eb.length * 0.5);
      break;
    }
    case Making::kVertexOverEdge:
      outward = (A.sides[std::size_t(ea.left_slot)].normal + A.sides[std::size_t(ea.right_slot)].normal)
                    .normalized();
      X.R = turning((B.vertices[vb] - B.extent.center).normalized(), -outward, angle);
      on_a = A.vertices[std::size_t(ea.tail)] + ea.direction * (ea.length * share);
      break;
    case Making::kVertexOverFace:
      X.R = turning((B.vertices[vb] - B.extent.center).normalized(), -outward, angle);
      on_a = face_point;
      break;
    case Making::kVertexToVertex:
      outward = (A.vertices[va] - A.extent.center).normalized();
      X.R = turning((B.vertices[vb] - B.extent.center).normalized(), -outward, angle);
      break;
    case Making::kAligned: {
      X.R = exp_rotation(Vec3(0, 0, quarter));
      const Vec3 step = random_vector(random, 1.0);
      for (int i = 0; i < 3; ++i)  // often flush with A
        on_a[i] = random.index(3) ? on_a[i] : A.extent.center[i] + step[i] * size;
      outward = Vec3::Unit(random.index(3));
      if (random.index(2)) outward = -outward;
      break;
    }
    case Making::kRandom:
    case Making::kCount: {
      const Vec3 direction = random_unit(random);
      X.p = A.extent.center - X.R * B.extent.center +
            direction * (A.extent.radius + B.extent.radius) * random.uniform(0.0, 1.3);
      return X;
    }
  }
  X.R = exp_rotation(tilt_axis) * X.R;
  X.p = on_a + outward * gap - X.R * on_b;
  return X;
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TACTUM_CASES_SLOW
#endif
#endif
#if defined(TACTUM_CASES_SLOW) || defined(__SANITIZE_ADDRESS__)
inline constexpr int kSlowness =
    100;  ///< a sanitized build takes a few poses only: it looks for faults of memory
#else
inline constexpr int kSlowness = 1;
#endif

/// How many of `poses` this build tries.
inline int some_of(int poses) { return poses / kSlowness; }

inline bool full() { return std::getenv("TACTUM_FULL") != nullptr; }

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
