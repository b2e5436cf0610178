#include "tactum/scene/goal.h"

#include <gtest/gtest.h>

#include "tactum/math/screw.h"

namespace tactum::goal_test {
namespace {

/// Two hinged bodies about z and one free.
World three_bodies() {
  World world;
  for (const char* name : {"driving", "driven", "free"}) {
    Body body;
    body.name = name;
    body.joint.kind = name[0] == 'f' ? JointKind::kFree : JointKind::kHinge;
    world.bodies.push_back(body);
  }
  world.bodies[1].X_WB.p = {0.1, 0, 0};
  return world;
}

WorldState turned(const World& world, double driving, double driven) {
  WorldState state = initial_state(world);
  state.X_WB[0].R = exp_rotation(Vec3(0, 0, driving));
  state.X_WB[1].R = exp_rotation(Vec3(0, 0, driven));
  return state;
}

TEST(Goals, AnglesAreCountedOverManyTurns) {
  const World world = three_bodies();
  GoalRecord record(
      world, {{.kind = GoalKind::kTurned, .body = 0, .amount = 12.0},
              {.kind = GoalKind::kTurned, .body = 0, .amount = -1.0},
              {.kind = GoalKind::kTurnedTo, .body = 0, .amount = 3.0, .tolerance = 0.1},
              {.kind = GoalKind::kFollowed, .body = 1, .driver = 0, .amount = 0.5, .tolerance = 0.01}});
  double angle = 0.0;
  for (; angle < 12.5; angle += 0.3) record.watch(world, turned(world, angle, -0.5 * angle));
  EXPECT_NEAR(record.angle(0), 12.3, 1e-9);
  EXPECT_NEAR(record.angle(1), -6.15, 1e-9);
  EXPECT_TRUE(record.met(0));
  EXPECT_FALSE(record.met(1));  // never turned in the other direction
  EXPECT_FALSE(record.met(2));
  EXPECT_TRUE(record.met(3));
  for (; angle > 3.0; angle -= 0.3) record.watch(world, turned(world, angle, -0.5 * angle));
  EXPECT_TRUE(record.met(0));  // was there once
  EXPECT_TRUE(record.met(2));
  EXPECT_FALSE(record.all_met());
  record.watch(world, turned(world, 3.0, -1.4));
  EXPECT_FALSE(record.met(3));  // judged at the end
  EXPECT_NE(record.describe(world, 3).find("not met"), std::string::npos);
}

TEST(Goals, TurnedByLessThanAsked) {
  const World world = three_bodies();
  GoalRecord record(world, {{.kind = GoalKind::kTurned, .body = 0, .amount = -1.0}});
  record.watch(world, turned(world, -0.9, 0.0));
  EXPECT_FALSE(record.met(0));
  record.watch(world, turned(world, -1.1, 0.0));
  EXPECT_TRUE(record.met(0));
}

TEST(Goals, WaysAndPlacesOfAPointOfTheBody) {
  const World world = three_bodies();
  GoalRecord record(world,
                    {{.kind = GoalKind::kMovedBy, .body = 2, .vector_W = -Vec3::UnitZ(), .amount = 0.02},
                     {.kind = GoalKind::kMovedTo,
                      .body = 2,
                      .p_BQ = {0.01, 0, 0},
                      .vector_W = {0.01, 0, -0.03},
                      .tolerance = 0.001}});
  WorldState state = initial_state(world);
  state.X_WB[2].p = {0.5, 0, -0.019};
  record.watch(world, state);
  EXPECT_FALSE(record.met(0));
  state.X_WB[2].p = {0, 0, -0.0295};
  record.watch(world, state);
  state.X_WB[2].p.setZero();
  record.watch(world, state);
  EXPECT_TRUE(record.met(0));
  EXPECT_TRUE(record.met(1));
  EXPECT_TRUE(record.all_met());
}

TEST(Goals, NoneIsMetAtTheStartByItself) {
  const World world = three_bodies();
  const GoalRecord record(
      world, {{.kind = GoalKind::kMovedBy, .body = 2, .vector_W = Vec3::UnitZ(), .amount = 0.02}});
  EXPECT_FALSE(record.all_met());
  EXPECT_TRUE(GoalRecord(world, {}).all_met());
}

TEST(Goals, NonFinitePosesAreNoSuccess) {
  const World world = three_bodies();
  GoalRecord record(world,
                    {{.kind = GoalKind::kMovedTo, .body = 2, .vector_W = Vec3::UnitX(), .tolerance = 0.1},
                     {.kind = GoalKind::kFollowed, .body = 1, .driver = 0, .amount = 1.0, .tolerance = 9.0}});
  WorldState state = initial_state(world);
  state.X_WB[2].p.setConstant(std::nan(""));
  state.X_WB[1].R.setConstant(std::nan(""));
  record.watch(world, state);
  EXPECT_FALSE(record.met(0));
  EXPECT_FALSE(record.met(1));
}

}  // namespace
}  // namespace tactum::goal_test
