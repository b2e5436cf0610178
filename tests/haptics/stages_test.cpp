/// The first stages of a frame, each alone: the hand, and where bodies touch.

#include <gtest/gtest.h>

#include <array>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/haptics/contact_stage.h"
#include "tactum/haptics/hand_stage.h"
#include "tactum/math/screw.h"

namespace tactum::stages_test {
namespace {

DeviceSample sample_at(const Pose& X_DH, double time_s) {
  DeviceSample sample;
  sample.valid = true;
  sample.X_DH = X_DH;
  sample.time_s = time_s;
  return sample;
}

/// Two boxes of 20 x 14 x 10 mm and of 100 x 100 x 20 mm, whose gap along z is `gap`.
World two_boxes(double gap) {
  World world;
  add_body(world, {.part = solid_box({0.010, 0.007, 0.005}),
                   .mass_kg = 0.05,
                   .X_WP = {Mat3::Identity(), {0, 0, 0.005 + gap}}});
  add_body(world, {.part = solid_box({0.05, 0.05, 0.01}),
                   .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                   .joint = {.kind = JointKind::kFixed}});
  return world;
}

/// The first sample pulls nothing; afterwards the hand goes `scale` times as far, and turns as the handle.
/// A hand that holds a body.
std::array<HandInput, 1> holding(int body) {
  std::array<HandInput, 1> hands;
  hands[0].grasped.body = body;
  return hands;
}

TEST(HandStage, TheFirstSampleIsTheGraspAndMotionIsScaled) {
  for (const double scale : {0.1, 1.0, 3.0, 20.0}) {
    const World world = two_boxes(0.001);
    FrameSettings settings;
    settings.tool.body = 0;
    settings.tool.X_BH.p = {0.002, 0.001, 0.005};
    settings.workspace.scale = scale;
    settings.workspace.X_WD.R = exp_rotation({0, 0, 0.5});
    const WorldState bodies = initial_state(world);
    HandStage hand = begin_hand(settings);
    const Pose first{exp_rotation({0.2, -0.1, 0.4}), {0.03, -0.01, 0.02}};
    GraspedPart grasped =
        track_hand(world, settings, settings.dt_s, sample_at(first, 0.0), bodies.X_WB, hand);
    ASSERT_TRUE(grasped.hand_known);
    EXPECT_EQ(grasped.body, 0);
    const Pose at_grasp = bodies.X_WB[0] * grasped.X_BH;
    EXPECT_LT((grasped.X_WH.p - at_grasp.p).norm(), 1e-12);
    EXPECT_LT(log_rotation(grasped.X_WH.R.transpose() * at_grasp.R).norm(), 1e-12);
    const Vec3 step(0.001, 0.0004, -0.0002);
    const Pose second{first.R * exp_rotation({0.01, 0, 0}), first.p + step};
    const Pose before = grasped.X_WH;
    grasped = track_hand(world, settings, settings.dt_s, sample_at(second, 0.001), bodies.X_WB, hand);
    const Vec3 expected = settings.workspace.X_WD.R * (scale * step);
    EXPECT_LT((grasped.X_WH.p - before.p - expected).norm(), 1e-12 * scale);
    EXPECT_LT((grasped.V_WH.v - expected / 0.001).norm(), 1e-9 * scale);
    EXPECT_NEAR(grasped.V_WH.w.norm(), 10.0, 1e-9);
  }
}

TEST(HandStage, NothingIsKnownBeforeAValidSampleAndABadOneIsIgnored) {
  const World world = two_boxes(0.001);
  FrameSettings settings;
  settings.tool.body = 0;
  const WorldState bodies = initial_state(world);
  HandStage hand = begin_hand(settings);
  DeviceSample bad = sample_at({Mat3::Identity(), {0.01, 0, 0}}, 0.0);
  bad.valid = false;
  EXPECT_FALSE(track_hand(world, settings, settings.dt_s, bad, bodies.X_WB, hand).hand_known);
  const GraspedPart good = track_hand(world, settings, settings.dt_s,
                                      sample_at({Mat3::Identity(), {0.01, 0, 0}}, 0.001), bodies.X_WB, hand);
  EXPECT_TRUE(good.hand_known);
  DeviceSample nan = sample_at({Mat3::Identity(), {std::nan(""), 0, 0}}, 0.002);
  const GraspedPart kept = track_hand(world, settings, settings.dt_s, nan, bodies.X_WB, hand);
  EXPECT_EQ(kept.X_WH.p, good.X_WH.p);
  EXPECT_EQ(kept.V_WH.v.norm(), 0.0);
}

/// A device that is slower than the loop is read twice: the hand goes on with its velocity, at any ratio.
TEST(HandStage, ASampleReadAgainKeepsTheVelocity) {
  const World world = two_boxes(0.001);
  FrameSettings settings;
  settings.tool.body = 0;
  const WorldState bodies = initial_state(world);
  for (const int repeats : {1, 2, 3, 10}) {
    HandStage hand = begin_hand(settings);
    for (int i = 0; i < 20; ++i) {
      const double time_s = 0.001 * repeats * i;
      const Pose X{exp_rotation({0.2 * time_s, 0, 0}), {0.1 * time_s, 0, 0}};
      for (int k = 0; k < repeats; ++k) {
        const GraspedPart grasped =
            track_hand(world, settings, settings.dt_s, sample_at(X, time_s), bodies.X_WB, hand);
        if (i == 0) continue;
        EXPECT_NEAR(grasped.V_WH.v.x(), 0.1, 1e-12) << repeats << " " << i << " " << k;
        EXPECT_NEAR(grasped.V_WH.w.x(), 0.2, 1e-9);
      }
    }
  }
}

/// A button in a sample whose pose cannot be used grasps nothing before the hand is known.
TEST(HandStage, NothingIsGraspedBeforeTheHandIsKnown) {
  const World world = two_boxes(0.001);
  FrameSettings settings;
  settings.tool.picks = true;
  settings.tool.pick_distance_m = 1.0;
  const WorldState bodies = initial_state(world);
  HandStage hand = begin_hand(settings);
  DeviceSample sample = sample_at({Mat3::Identity(), {std::nan(""), 0, 0}}, 0.0);
  sample.buttons = 1;
  EXPECT_EQ(track_hand(world, settings, settings.dt_s, sample, bodies.X_WB, hand).body, -1);
  EXPECT_FALSE(hand.known);
}

/// A patch is found where the gap is below the sum of the motion bounds, with the exact distance.
TEST(ContactStage, FindsTheGapWithinTheMotionBound) {
  for (const double gap : {-0.0001, 0.0, 2e-5, 0.0009, 0.0011, 0.01}) {
    const World world = two_boxes(gap);
    const FrameSettings settings;
    const WorldState bodies = initial_state(world);
    ContactStage stage(world, settings, bodies.X_WB);
    FrameReport report;
    const std::array<double, 2> bound{0.001, 0.0};
    find_near_pairs(settings, bodies.X_WB, bound, holding(0), stage);
    const auto patches = find_patches(world, settings, bodies.X_WB, PatchPoints::kQuadrature, stage, report);
    ASSERT_EQ(patches.size(), gap < 0.001 ? 1u : 0u) << gap;
    EXPECT_EQ(report.penetrating, gap < 0.0);
    EXPECT_EQ(report.flags, 0u);
    if (patches.empty()) continue;
    EXPECT_NEAR(patches[0].distance, gap, 1e-15);
    EXPECT_NEAR(report.min_distance_m, gap, 1e-15);
    EXPECT_NEAR(report.tolerance_m, 0.001, 1e-15);
    EXPECT_EQ(patches[0].body_a, 0);
    EXPECT_EQ(patches[0].body_b, 1);
    EXPECT_LT((patches[0].manifold.normal - Vec3::UnitZ()).norm(), 1e-12);
  }
}

/// The grasped part goes first, then what touched it in the last frame.
TEST(ContactStage, GivesPrioritiesByTheLastPatches) {
  const World world = two_boxes(0.0005);
  const FrameSettings settings;
  const WorldState bodies = initial_state(world);
  ContactStage stage(world, settings, bodies.X_WB);
  const std::array<double, 2> bound{0.001, 0.0};
  FrameReport report;
  find_near_pairs(settings, bodies.X_WB, bound, holding(0), stage);
  EXPECT_EQ(stage.priority[0], priority::kGrasped);
  EXPECT_EQ(stage.priority[1], priority::kOther);
  find_patches(world, settings, bodies.X_WB, PatchPoints::kClosest, stage, report);
  find_near_pairs(settings, bodies.X_WB, bound, holding(0), stage);
  EXPECT_EQ(stage.priority[1], priority::kTouchesGrasped);
  find_near_pairs(settings, bodies.X_WB, bound, holding(-1), stage);
  EXPECT_EQ(stage.priority[0], priority::kOther);
  EXPECT_EQ(stage.priority[1], priority::kOther);
}

}  // namespace
}  // namespace tactum::stages_test
