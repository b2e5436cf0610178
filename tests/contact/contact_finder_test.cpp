#include "tactum/contact/contact_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <tuple>

#include "oracles/exhaustive.h"
#include "support/effort.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/base/random.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// A ring of boxes with a few extra ones inside.
Part cluttered_part(Random& random) {
  std::vector<std::vector<Vec3>> clouds;
  for (int k = 0; k < 14; ++k) {
    const Pose X{exp_rotation(random_vector(random, 2)), random_vector(random, 0.03)};
    std::vector<Vec3> cloud;
    for (int i = 0; i < 8; ++i)
      cloud.push_back(X * Vec3(i & 1 ? 0.004 : -0.004, i & 2 ? 0.003 : -0.003, i & 4 ? 0.006 : -0.006));
    clouds.push_back(cloud);
  }
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part);
  part->true_surface = {};  // every pair by itself: settling between pieces is tested in seams_test.cpp
  return std::move(*part);
}

/// Four cluttered parts that wander about one place, with a speed that changes every 50 frames; the third
/// stands still.
class Wanderers {
 public:
  Wanderers(Random& random, double speed) : random_(random), speed_(speed) {
    for (int i = 0; i < 4; ++i) {
      parts.push_back(cluttered_part(random));
      X.push_back({exp_rotation(random_vector(random, 1)), random_vector(random, 0.025)});
    }
    for (std::size_t i = 0; i < 4; ++i) bodies.push_back({&parts[i], i != 2});
  }

  /// Sets the velocities of a frame, and how far each body gets in it.
  void steer(int frame, const ContactFinder& finder) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (frame % 50 == 0) {
        V_[i].v = speed_ * random_vector(random_, 0.3);
        V_[i].w = speed_ * random_vector(random_, 5.0);
      }
      V_[i].v -= 0.005 * X[i].p;  // stay together
      if (!bodies[i].moves) V_[i] = {};
      motion_bound[i] = (V_[i].v.norm() + V_[i].w.norm() * finder.radius(static_cast<int>(i))) * 1e-3;
    }
  }
  void move() {
    for (std::size_t i = 0; i < 4; ++i) X[i] = renormalized(advanced(X[i], V_[i], 1e-3));
  }

  std::vector<Part> parts;
  std::vector<CollisionBody> bodies;
  std::vector<Pose> X;
  std::vector<double> motion_bound = std::vector<double>(4, 0.0);

 private:
  Random& random_;
  double speed_;
  std::vector<Twist> V_ = std::vector<Twist>(4);
};

/// The distance of each patch, by its bodies and pieces.
using PatchDistances = std::map<std::tuple<int, int, int, int>, double>;

PatchDistances distances_of(std::span<const ContactPatch> patches) {
  PatchDistances out;
  for (const ContactPatch& patch : patches)
    out[{patch.body_a, patch.body_b, patch.piece_a, patch.piece_b}] = patch.distance;
  return out;
}

/// Tests all pairs of pieces of two bodies: there is a patch of those that are nearer than the tolerance,
/// with their distance, and of no others.
void expect_patches_of_all_near_pairs(const Wanderers& all, int a, int b, double min_tolerance,
                                      const PatchDistances& found) {
  const auto A = static_cast<std::size_t>(a);
  const auto B = static_cast<std::size_t>(b);
  const Pose X_AB = relative_pose(all.X[A], all.X[B]);
  const double tolerance = std::max(min_tolerance, all.motion_bound[A] + all.motion_bound[B]);
  for (int p = 0; p < 14; ++p)
    for (int q = 0; q < 14; ++q) {
      PairCache cold;
      const PairDistance d = closest_features(all.parts[A].pieces[std::size_t(p)],
                                              all.parts[B].pieces[std::size_t(q)], X_AB, cold);
      if (std::abs(d.distance - tolerance) < 1e-9) continue;
      const auto at = found.find({a, b, p, q});
      ASSERT_EQ(at != found.end(), d.distance < tolerance) << "distance " << d.distance;
      if (at != found.end() && d.distance > 0.0) {
        ASSERT_NEAR(at->second, d.distance, 1e-9);
      }
    }
}

TEST(ContactFinder, FindsEveryPatchThatTestingAllPairsFinds) {
  constexpr double kMinTolerance = 1e-4;
  for (std::uint64_t seed = 1; seed <= testing::effort(6u, 2u); ++seed) {
    Random random(seed);
    const double speed = seed % 2 ? 1.0 : 0.05;  // a hasty and a careful hand
    Wanderers all(random, speed);
    ContactFinder finder(all.bodies, all.X);
    int patches = 0;
    int runs = 0;
    for (int frame = 0; frame < 300; ++frame) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", frame " + std::to_string(frame));
      all.steer(frame, finder);
      finder.find_near_pairs(all.X, all.motion_bound, kMinTolerance);
      finder.find_patches(all.X, 1 << 20, PatchPoints::kClosest);
      runs += finder.work().broad_phase_runs;
      const PatchDistances found = distances_of(finder.patches());
      patches += static_cast<int>(found.size());
      for (int a = 0; a < 4; ++a)
        for (int b = a + 1; b < 4; ++b)
          ASSERT_NO_FATAL_FAILURE(expect_patches_of_all_near_pairs(all, a, b, kMinTolerance, found));
      all.move();
    }
    EXPECT_GT(patches, 300) << "seed " << seed << ": the test must have something to find";
    if (speed < 0.1) {
      EXPECT_LT(runs, 150) << "a careful hand's lists must be kept for some frames";
    }
    EXPECT_EQ(finder.work().uncertified, 0);
  }
}

/// Two rings that come near, part and come near again: the patches are those that a query of its own finds,
/// and far away there are hardly any queries.
TEST(ContactFinder, AsksSurfacesThatAreApartSeldom) {
  const Result<Part> ring =
      part_from_mesh(testing::torus(40, 20, 0.02, 0.006), {.pieces = PieceSource::kSurface});
  ASSERT_TRUE(ring);
  const double tolerance = 1e-4;
  const auto pose = [](int frame) {
    return Pose{exp_rotation(Vec3(0.001, 0.002, 0.3)), {0, 0, 0.01255 + 5e-4 * std::cos(frame * 2e-3 * kPi)}};
  };
  const CollisionBody body{&*ring, true};
  std::vector<Pose> X = {Pose(), pose(0)};
  ContactFinder finder({body, body}, X);
  std::vector<SurfaceMinimum> minima;
  minima.reserve(10000);
  const std::vector<double> motion_bound(2, 0.0);
  std::array<int, 2> queries{};  // apart, near
  std::array<int, 2> frames{};
  for (int frame = 0; frame < 2000; ++frame) {
    X[1] = pose(frame);
    finder.find_near_pairs(X, motion_bound, tolerance);
    finder.find_patches(X, 1000, PatchPoints::kClosest);
    surface_minima(ring->tree, ring->tree, X[1], {tolerance, 0.0, tolerances::kConeInflation}, minima);
    ASSERT_EQ(finder.patches().empty(), minima.empty()) << frame;
    const std::size_t near = minima.empty() ? 0 : 1;
    queries[near] += finder.work().surface_queries;
    ++frames[near];
    for (const ContactPatch& patch : finder.patches()) {
      EXPECT_TRUE(std::any_of(minima.begin(), minima.end(), [&](const SurfaceMinimum& m) {
        return m.a == patch.manifold.a && m.b == patch.manifold.b && m.distance == patch.distance;
      }));
    }
  }
  EXPECT_GT(frames[1], 200);
  EXPECT_GT(frames[0], 500);
  EXPECT_LT(queries[0], frames[0] / 5);
}

TEST(ContactFinder, WithABudgetEveryPairsTurnComes) {
  Random random(9);
  std::vector<Part> parts;
  parts.push_back(cluttered_part(random));
  parts.push_back(cluttered_part(random));
  const std::vector<Pose> X(2);
  ContactFinder finder({{&parts[0], true}, {&parts[1], true}}, X);
  const std::vector<double> motion_bound(2, 0.001);
  finder.find_near_pairs(X, motion_bound, 1e-4);
  finder.find_patches(X, 1 << 20);
  const int all = finder.work().exact_tests;
  const std::size_t patches = finder.patches().size();
  EXPECT_FALSE(finder.budget_limited());
  ASSERT_GT(all, 20);
  ContactFinder limited({{&parts[0], true}, {&parts[1], true}}, X);
  int tests = 0;
  for (int frame = 0; frame * 5 < all + 5; ++frame) {
    limited.find_near_pairs(X, motion_bound, 1e-4);
    limited.find_patches(X, 10);
    const ContactWork& work = limited.work();
    EXPECT_TRUE(limited.budget_limited());
    EXPECT_LE(work.exact_tests, 5) << "half is kept for the poses on trial";
    EXPECT_EQ(work.due, work.exact_tests + work.unchecked);
    EXPECT_EQ(work.left_unproven > 0, limited.blocked(0));
    tests += work.exact_tests;
    if (frame == 0) {
      EXPECT_EQ(work.unchecked, all - 5);
    }
  }
  // Nothing moves: each pair has been tested once, its answer holds, and its patch is handed on.
  EXPECT_EQ(tests, all);
  EXPECT_EQ(limited.work().unchecked, 0);
  EXPECT_EQ(limited.patches().size(), patches);
}

TEST(ContactFinder, PairsOfTheHeldPartAreTestedBeforeAllOthers) {
  Random random(5);
  const Part part = cluttered_part(random);
  std::vector<Pose> X;
  std::vector<CollisionBody> bodies;
  for (int i = 0; i < 6; ++i) {
    X.push_back({exp_rotation(random_vector(random, 1)), random_vector(random, 0.02)});
    bodies.push_back({&part, true});
  }
  const std::vector<double> motion_bound(6, 1e-3);
  const std::vector<std::uint8_t> priority = {priority::kOther,          priority::kOther,
                                              priority::kOther,          priority::kGrasped,
                                              priority::kTouchesGrasped, priority::kOther};
  ContactFinder finder(bodies, X);
  ContactFinder all(bodies, X);
  for (ContactFinder* each : {&finder, &all}) each->find_near_pairs(X, motion_bound, 1e-4);
  all.find_patches(X, 1 << 20, PatchPoints::kClosest);
  int of_grasped = 0;
  for (const ContactPatch& patch : all.patches())
    of_grasped += patch.body_a == 3 || patch.body_b == 3 ? 1 : 0;
  const int budget = all.work().exact_tests / 2;
  finder.find_patches(X, budget, PatchPoints::kClosest, priority);
  int found = 0;
  for (const ContactPatch& patch : finder.patches()) found += patch.body_a == 3 || patch.body_b == 3 ? 1 : 0;
  EXPECT_GT(of_grasped, 5);
  EXPECT_EQ(found, of_grasped);
  EXPECT_EQ(finder.work().left_of_grasped, 0);
  EXPECT_FALSE(finder.blocked(3) && finder.work().left_unproven == 0);
  EXPECT_GT(finder.work().left_unproven, 0);
  // With less than its own pairs need, it is blocked.
  ContactFinder poor(bodies, X);
  poor.find_near_pairs(X, motion_bound, 1e-4);
  poor.find_patches(X, 3, PatchPoints::kQuadrature, priority);
  EXPECT_EQ(poor.work().exact_tests, 3);
  EXPECT_GT(poor.work().left_of_grasped, 0);
  EXPECT_TRUE(poor.blocked(3));
}

/// With too little room for near pairs the flag is set; once the room suffices, no pair that was left out is
/// missed.
TEST(ContactFinder, WhatFoundNoRoomIsLookedForAgain) {
  Random random(9);
  const Part part = cluttered_part(random);
  const std::vector<CollisionBody> bodies(2, {&part, true});
  const std::vector<double> motion_bound(2, 2e-4);
  for (const std::size_t room : {5, 20}) {
    std::vector<Pose> X = {{Mat3::Identity(), Vec3(0, 0, 0.01)}, {}};
    ContactFinder finder(bodies, X, {.pairs = room});
    int short_of_room = 0;
    int found = 0;
    for (int frame = 0; frame < testing::effort(1200, 450); ++frame) {
      // Apart, until hardly a pair is near, and together again.
      X[0].p.x() = 0.07 * (0.5 - 0.5 * std::cos(2 * kPi * frame / 400.0));
      finder.find_near_pairs(X, motion_bound, 1e-3);
      finder.find_patches(X, 1 << 20, PatchPoints::kClosest);
      ASSERT_LE(finder.work().near_pairs, int(room));
      if (finder.work().capacity_reached) {
        ++short_of_room;
        continue;
      }
      ContactFinder fresh(bodies, X);
      fresh.find_near_pairs(X, motion_bound, 1e-3);
      fresh.find_patches(X, 1 << 20, PatchPoints::kClosest);
      ASSERT_EQ(finder.patches().size(), fresh.patches().size()) << "frame " << frame;
      for (std::size_t i = 0; i < fresh.patches().size(); ++i) {
        const double gap = fresh.patches()[i].distance;  // a depth may be another one with memory
        ASSERT_NEAR(std::max(0.0, finder.patches()[i].distance), std::max(0.0, gap), 1e-9)
            << "frame " << frame;
      }
      found += static_cast<int>(fresh.patches().size());
    }
    EXPECT_GT(short_of_room, 0) << "room " << room;
    EXPECT_GT(found, 0) << "room " << room;
  }
}

/// Bodies that crowd together, each as far as its patches allow, and stand still where they are blocked: with
/// any budget nothing is ever entered, as separating axes see it.
TEST(ContactFinder, WhatABudgetLeavesIsNotEntered) {
  for (const int budget : {3, 8}) {
    Random random(21);
    const Part part = cluttered_part(random);
    constexpr std::size_t kBodies = 5;
    std::vector<Pose> X;
    std::vector<Twist> V(kBodies);
    const std::vector<CollisionBody> bodies(kBodies, {&part, true});
    for (std::size_t i = 0; i < kBodies; ++i)
      X.push_back({exp_rotation(random_vector(random, 1)),
                   0.11 * Vec3(double(i % 2), double(i / 2), 0.3 * double(i % 3))});
    const Vec3 middle(0.055, 0.11, 0.033);
    ContactFinder finder(bodies, X);
    std::vector<double> motion_bound(kBodies);
    int safely = 0;
    int unproven = 0;
    for (int frame = 0; frame < 1500; ++frame) {
      for (std::size_t i = 0; i < kBodies; ++i) {
        if (frame % 40 == 0) V[i] = {2.0 * (middle - X[i].p), random_vector(random, 3.0)};
        motion_bound[i] = (V[i].v.norm() + V[i].w.norm() * finder.radius(static_cast<int>(i))) * 1e-3;
      }
      finder.find_near_pairs(X, motion_bound, 1.5e-3);  // more than they go
      finder.find_patches(X, budget, PatchPoints::kClosest);
      ASSERT_LE(finder.work().exact_tests, budget);
      safely += finder.work().unchecked - finder.work().left_unproven;
      unproven += finder.work().left_unproven;
      std::vector<double> room(kBodies, 1.0);  // [m]
      for (const ContactPatch& patch : finder.patches())
        for (const int body : {patch.body_a, patch.body_b})
          room[std::size_t(body)] = std::min(room[std::size_t(body)], 0.45 * patch.distance);
      for (std::size_t i = 0; i < kBodies; ++i) {
        // A body that goes nearly half of each gap is soon so near that rounding decides the sign.
        ASSERT_GE(room[i], -1e-13 * part.size) << "budget " << budget << " frame " << frame;
        const double share = std::clamp(room[i] / motion_bound[i], 0.0, 1.0);
        if (!finder.blocked(static_cast<int>(i))) X[i] = renormalized(advanced(X[i], V[i], 1e-3 * share));
      }
      if (frame % 50 != 0) continue;
      for (std::size_t a = 0; a < kBodies; ++a)
        for (std::size_t b = a + 1; b < kBodies; ++b)
          for (const Polytope& A : part.pieces)
            for (const Polytope& B : part.pieces)
              ASSERT_FALSE(oracle::surely_overlap(A, B, relative_pose(X[a], X[b]), 1e-9L))
                  << "frame " << frame;
    }
    EXPECT_GT(unproven, 0) << "budget " << budget << ": nothing was short";
    EXPECT_GT(safely, 0) << "budget " << budget;
  }
}

TEST(Schedule, TheMostUrgentComeFirst) {
  constexpr int kHeadStartFrames = 8;
  std::vector<DuePair> due;
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const auto rank = static_cast<std::uint8_t>(random.index(3));
    due.push_back({i, rank, random.index(4) == 0, random.index(20)});
  }
  const std::vector<DuePair> all = due;
  const int budget = 40;
  ASSERT_EQ(prioritise(due, budget, kHeadStartFrames), budget);
  const auto priority = [](const DuePair& d) {
    return std::tuple(d.priority, d.last_checked - (d.was_in_contact ? kHeadStartFrames : 0), d.pair);
  };
  auto lowest_priority_taken = priority(due[0]);
  for (int i = 0; i < budget; ++i)
    lowest_priority_taken = std::max(lowest_priority_taken, priority(due[std::size_t(i)]));
  for (std::size_t i = budget; i < due.size(); ++i) EXPECT_GT(priority(due[i]), lowest_priority_taken);
  for (int i = 1; i < budget; ++i) EXPECT_LT(due[std::size_t(i) - 1].pair, due[std::size_t(i)].pair);
  EXPECT_EQ(prioritise(due, 1000, kHeadStartFrames), 100);
  EXPECT_EQ(prioritise(due, 0, kHeadStartFrames), 0);
}

}  // namespace
}  // namespace tactum
