#include "tactum/contact/steady_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "collision/cases.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/manifold.h"
#include "tactum/collision/penetration.h"

namespace tactum {
namespace {

const SteadyLimits kLimits(0.001);

Vec3 centroid(const Manifold& patch) {
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& p : patch.points) sum += p.weight * 0.5 * (p.p_a + p.p_b);
  return sum;
}

/// A box's edge pushed into another's: the direction of least depth switches between the sides. Every shown
/// depth separates,
/// the normal never turns faster than it may, and it arrives.
TEST(SteadyContact, ASwitchingNormalTurnsSlowlyAndAlwaysSeparates) {
  const std::uint64_t seed = 71;
  Random random(seed);
  const Polytope box = make_box({0.04, 0.05, 0.06});
  int switches = 0;
  for (int run = 0; run < std::max(2, cases::some_of(40)); ++run) {
    PairCache cache;
    SteadyContact last;
    Vec3 before = Vec3::Zero();
    double depth_before = 0.0;
    int behind = 0;
    const Mat3 R = exp_rotation(cases::random_vector(random, 0.3));
    const double depth = random.uniform(5e-4, 2e-3);
    for (int frame = 0; frame < 240; ++frame) {
      // Into the edge along x = y, past it and back: which side is nearer changes.
      const double along = 1.5e-3 * std::sin(0.05 * frame);
      Pose X{R, {0.0, 0.0, 0.01}};
      X.p.x() = 0.0795 - depth + along;
      X.p.y() = 0.0995 - depth - along;
      const PairDistance found = penetration_depth(box, box, X, cache);
      if (found.distance >= 0.0) {
        before.setZero();
        last = {};
        continue;
      }
      const PairDistance shown = steady_depth(box, box, X, found, kLimits, last);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", run " + std::to_string(run) + ", frame " +
                   std::to_string(frame));
      EXPECT_NEAR(shown.normal.norm(), 1.0, 1e-12);
      EXPECT_NEAR(shown.normal.dot(shown.p_a - shown.p_b), shown.distance, 1e-12);
      EXPECT_LE(shown.distance, found.distance + 1e-9);
      // True supports: moved out along the normal, the pieces only touch.
      int a = 0;
      int b = 0;
      a = support_vertex(box, -shown.normal);
      b = support_vertex(box, X.R.transpose() * shown.normal);
      EXPECT_NEAR(shown.normal.dot(box.vertices[std::size_t(a)] - X * box.vertices[std::size_t(b)]),
                  shown.distance, 1e-12);
      if (!before.isZero()) {
        const double turn = before.cross(shown.normal).norm();
        EXPECT_LE(turn, std::sin(kLimits.turn_rad) + 1e-9);
        EXPECT_GT(before.dot(shown.normal), 0.0);
        EXPECT_LE(std::abs(shown.distance - depth_before), 2.0 * kLimits.turn_rad * 4e-3 + 4e-4);
      }
      const bool there = shown.normal.dot(found.normal) > 1.0 - 1e-12;
      behind = there ? 0 : behind + 1;
      switches += behind == 1;
      EXPECT_LE(behind, 63);
      before = shown.normal;
      depth_before = shown.distance;
    }
  }
  std::printf("  seed %llu: %d switches blended\n", static_cast<unsigned long long>(seed), switches);
  if (cases::kSlowness == 1) {  // a few poses need not hold a switch
    EXPECT_GT(switches, 0);
  }
}

/// A small box that rolls over the face of a large one, at any speed, and whichever of the two is A: the
/// normal is that face's, and turns with it.
TEST(SteadyContact, ANormalTurnsWithTheBodyOfItsFace) {
  const Polytope floor = make_box({0.1, 0.1, 0.01});
  const Polytope small = make_box({0.01, 0.01, 0.01});
  for (const double rate : {5.0, 49.0, 80.0, 200.0, 1000.0}) {
    for (const bool floor_is_a : {true, false}) {
      SCOPED_TRACE(::testing::Message() << rate << " rad/s, the floor is A: " << floor_is_a);
      const Polytope& A = floor_is_a ? floor : small;
      const Polytope& B = floor_is_a ? small : floor;
      PairCache cache;
      SteadyContact last;
      for (int frame = 0; frame < 100; ++frame) {
        const double angle = 0.2 + rate * 0.001 * frame;
        const double height = 0.01 * (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
        const Pose X_FS{exp_rotation({0.0, angle, 0.0}), {0.0, 0.0, 0.01 + height - 5e-4}};
        const Pose X_AB = floor_is_a ? X_FS : X_FS.inverse();
        const PairDistance found = penetration_depth(A, B, X_AB, cache);
        const PairDistance shown = steady_depth(A, B, X_AB, found, kLimits, last);
        EXPECT_NEAR(found.distance, -5e-4, 1e-9);
        EXPECT_NEAR(shown.distance, -5e-4, 1e-9) << frame;
      }
    }
  }
}

/// No shape and no motion of 0.03 mm and 1 mrad moves the shown centroid by 0.1 mm; the points keep their
/// distances.
TEST(SteadyContact, TheCentroidTakesNoStepOnAnyShape) {
  const std::uint64_t seed = 72;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  double worst = 0.0;
  double worst_raw = 0.0;
  const int runs = cases::full() ? 2000 : std::max(3, cases::some_of(150));
  for (int run = 0; run < runs; ++run) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    Pose X = cases::make_pose(random, A, B, cases::Making(run % int(cases::Making::kCount)));
    PairCache cache;
    SteadyContact last;
    Vec3 before = Vec3::Zero();
    Vec3 raw_before = Vec3::Zero();
    bool have = false;
    Vec3 v = Vec3::Zero();
    Vec3 w = Vec3::Zero();
    for (int frame = 0; frame < 200; ++frame) {
      if (frame % 50 == 0) {
        v = cases::random_unit(random) * 3e-5;
        w = cases::random_unit(random) * 1e-3;
      }
      const Vec3 center = X * B.extent.center + v;
      X.R = renormalized({exp_rotation(w) * X.R, Vec3::Zero()}).R;
      X.p = center - X.R * B.extent.center;
      const PairDistance now = closest_features(A, B, X, cache);
      Manifold patch;
      contact_manifold(A, B, X, now, 1e-4, patch);
      const Manifold raw = patch;
      steady_centroid(X, patch, kLimits, last);
      if (patch.points.empty()) {
        have = false;
        if (now.distance > 1e-4) X.p += now.normal * (now.distance - 5e-5);  // back into touch
        continue;
      }
      for (std::size_t i = 0; i < patch.points.size(); ++i)
        EXPECT_NEAR(patch.normal.dot(patch.points[i].p_a - patch.points[i].p_b), raw.points[i].distance,
                    1e-9);
      const Vec3 c = centroid(patch);
      if (have) {
        // Square to the normal, where it is steadied; along it a depth may grow as fast as the pieces move.
        const Vec3 step = c - before;
        const double sideways = (step - patch.normal * patch.normal.dot(step)).norm();
        worst = std::max(worst, sideways);
        worst_raw = std::max(worst_raw, (centroid(raw) - raw_before).norm());
        // Beyond 20 mm it catches up, by a fifth of what is more in a frame.
        const double behind = 0.25 * std::max(0.0, (centroid(raw) - c).norm() - 0.02);
        EXPECT_LE(sideways, 1e-4 + behind) << "seed " << seed << " run " << run << " frame " << frame;
      }
      before = c;
      raw_before = centroid(raw);
      have = true;
    }
  }
  std::printf("  seed %llu: largest step of the centroid %.3g mm, of the bare patch's %.3g mm\n",
              static_cast<unsigned long long>(seed), worst * 1e3, worst_raw * 1e3);
}

/// A box slides and turns on another: four points that keep their identities and their places.
TEST(SteadyContact, PointsKeepTheirIdentities) {
  const Polytope box = make_box({0.02, 0.02, 0.02});  // square: the patch has no long axis to follow
  std::map<std::uint64_t, Vec3> places;
  PairCache cache;
  for (int frame = 0; frame < 1000; ++frame) {
    const Pose X{exp_rotation(Vec3(1e-5 * std::sin(0.3 * frame), 1e-5 * std::cos(0.7 * frame), 1e-3 * frame)),
                 {1e-5 * frame, -0.5e-5 * frame, -0.04002}};
    Manifold patch;
    contact_manifold(box, box, X, closest_features(box, box, X, cache), 1e-4, patch);
    ASSERT_EQ(patch.points.size(), 4u);
    for (const ContactPoint& point : patch.points) {
      const auto known = places.find(point.id);
      if (frame == 0) {
        EXPECT_EQ(known, places.end());
      } else {
        ASSERT_NE(known, places.end());
        ASSERT_LE((point.p_a - known->second).norm(), 1e-4) << "frame " << frame;
      }
      places[point.id] = point.p_a;
    }
  }
  EXPECT_EQ(places.size(), 4u);
}

}  // namespace
}  // namespace tactum
