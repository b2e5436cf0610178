/// The grasped part follows the hand at every workspace scale, size and rate. Where a limit keeps it behind,
/// the report has a flag; nothing is crossed.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::step_limits_test {
namespace {

const std::vector<double> kRates_Hz = testing::frame_rates_Hz();
constexpr ResponseModel kResponses[] = {ResponseModel::kConstraint, ResponseModel::kPenalty};

FrameSettings settings_of(double scale, ResponseModel response, double rate_Hz) {
  FrameSettings settings;
  settings.dt_s = 1.0 / rate_Hz;
  settings.response = response;
  settings.workspace.scale = scale;
  settings.tool.body = 0;
  settings.smoothing.on = false;
  return settings;
}

World block_of(const Vec3& half) {
  World world;
  add_body(world, {.part = solid_box(half), .mass_kg = 0.05});
  return world;
}

void add_fixed(World& world, const Vec3& half, const Vec3& p_W) {
  add_body(world,
           {.part = solid_box(half), .X_WP = {Mat3::Identity(), p_W}, .joint = {.kind = JointKind::kFixed}});
}

std::unique_ptr<Simulation> simulation_of(World world, const FrameSettings& settings) {
  return std::move(*Simulation::make(std::move(world), settings));
}

/// From rest to rest in unit time; the fastest rate is 1.875.
double minimum_jerk(double u) {
  u = std::min(1.0, u);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}
constexpr double kFastest = 1.875;

double lag_m(const FrameReport& report) { return (report.X_WH_proxy.p - report.X_WH.p).norm(); }
double lag_rad(const FrameReport& report) {
  return log_rotation(report.X_WH_proxy.R * report.X_WH.R.transpose()).norm();
}

TEST(StepLimits, APartInFreeSpaceFollowsTheHandWithinAFrame) {
  for (const ResponseModel response : kResponses)
    for (const double rate_Hz : kRates_Hz)
      for (const double scale : {0.1, 1.0, 10.0, 20.0})
        for (const double size : {0.02, 0.02 * scale}) {
          SCOPED_TRACE(::testing::Message() << int(response) << ", " << rate_Hz << " Hz, scale " << scale
                                            << ", half " << size << " m");
          const auto simulation =
              simulation_of(block_of({size, 0.7 * size, 0.5 * size}), settings_of(scale, response, rate_Hz));
          const double distance = 0.08;  // at the device, in 0.4 s: up to 0.375 m/s
          const double fastest = kFastest * distance / 0.4;
          double most = 0.0;
          for (int i = 0; i < 0.5 * rate_Hz; ++i) {
            simulation->step({Mat3::Identity(), {distance * minimum_jerk(i / (0.4 * rate_Hz)), 0, 0}});
            most = std::max(most, lag_m(simulation->report()));
            EXPECT_EQ(simulation->report().flags, 0u) << "frame " << i;
          }
          EXPECT_LT(most, scale * fastest / rate_Hz);
        }
}

TEST(StepLimits, ABarOfAnyLengthTurnsWithTheHand) {
  for (const double rate_Hz : kRates_Hz)
    for (const double length : {0.1, 1.0, 10.0})
      for (const double grasp : {0.0, 0.5}) {  // in the middle, and at an end
        SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, " << length << " m, at " << grasp);
        FrameSettings settings = settings_of(1.0, ResponseModel::kConstraint, rate_Hz);
        settings.tool.X_BH.p.x() = grasp * length;
        const auto simulation =
            simulation_of(block_of({0.5 * length, 0.01 * length, 0.01 * length}), settings);
        double most = 0.0;
        for (int i = 0; i < 0.6 * rate_Hz; ++i) {
          simulation->step({exp_rotation({0, 0, minimum_jerk(i / (0.5 * rate_Hz))}), Vec3::Zero()});
          most = std::max(most, lag_rad(simulation->report()));
          EXPECT_EQ(simulation->report().flags, 0u) << "frame " << i;
        }
        EXPECT_LT(most, kFastest / 0.5 / rate_Hz);
        EXPECT_LT(lag_rad(simulation->report()), 1e-9);
      }
}

TEST(StepLimits, ThePublishedThresholdHoldsALongBarBackAndIsFlagged) {
  for (const double rate_Hz : kRates_Hz)
    for (const double length : {1.0, 10.0}) {
      SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, " << length << " m");
      const auto simulation = simulation_of(block_of({0.5 * length, 0.01 * length, 0.01 * length}),
                                            settings_of(1.0, ResponseModel::kPenalty, rate_Hz));
      std::uint32_t flags = 0;
      for (int i = 0; i < 0.6 * rate_Hz; ++i) {
        simulation->step({exp_rotation({0, 0, minimum_jerk(i / (0.5 * rate_Hz))}), Vec3::Zero()});
        flags |= simulation->report().flags;
      }
      EXPECT_GT(lag_rad(simulation->report()), 0.01);
      EXPECT_EQ(flags, frame_flag::kStepLimited);
    }
}

/// A wall in the scene, met by a hand that moves steadily: what is felt is k_t times how far the hand is past
/// the place where it meets the wall, from the frame on in which it is past it.
TEST(StepLimits, AWallIsFeltWhenTheHandIsThere) {
  for (const double rate_Hz : kRates_Hz)
    for (const double scale : {0.1, 1.0, 10.0, 20.0})
      for (const double size : {0.02, 0.02 * scale})
        for (const double speed : {0.1, 0.4}) {
          SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, scale " << scale << ", half " << size
                                            << " m, " << speed << " m/s");
          World world = block_of({size, 0.7 * size, 0.5 * size});
          const double gap = 0.05 * scale;  // 50 mm at the device
          add_fixed(world, {0.01 * scale, 2 * size, 2 * size}, {size + gap + 0.01 * scale, 0, 0});
          FrameSettings settings = settings_of(scale, ResponseModel::kConstraint, rate_Hz);
          settings.coupling.damping_Ns_per_m = 0.0;
          const auto simulation = simulation_of(std::move(world), settings);
          for (int i = 0; i * speed / rate_Hz < 0.055; ++i) {
            const double x = i * speed / rate_Hz;
            simulation->step({Mat3::Identity(), {x, 0, 0}});
            const double right = 600.0 * std::max(0.0, x - 0.05);
            const double skin = 1.4e-5 * size;  // a little more than 5e-6 of the block's diagonal
            ASSERT_NEAR(-simulation->report().smoothed.f.x(), right, 600.0 * skin / scale) << "frame " << i;
            EXPECT_FALSE(simulation->report().penetrating);
          }
        }
}

TEST(StepLimits, AHandThatIsFasterThanThePartMayFollowIsFlagged) {
  for (const ResponseModel response : kResponses)
    for (const double rate_Hz : kRates_Hz)
      for (const double scale : {0.1, 1.0, 20.0}) {
        SCOPED_TRACE(::testing::Message() << int(response) << ", " << rate_Hz << " Hz, scale " << scale);
        const double size = 0.02 * scale;
        const auto run = [&](const Twist& fast, double duration_s) {
          const auto simulation =
              simulation_of(block_of({size, 0.7 * size, 0.5 * size}), settings_of(scale, response, rate_Hz));
          std::uint32_t flags = 0;
          for (int i = 0; i < duration_s * rate_Hz; ++i) {
            simulation->step({exp_rotation(fast.w * (i / rate_Hz)), fast.v * (i / rate_Hz)});
            flags |= simulation->report().flags;
          }
          return flags;
        };
        EXPECT_EQ(run({{0.4, 0, 0}, {0, 0, 1.0}}, 0.1), 0u);
        EXPECT_EQ(run({{2.0, 0, 0}, Vec3::Zero()}, 0.05), frame_flag::kStepLimited);
        const bool penalty = response == ResponseModel::kPenalty;
        EXPECT_EQ(run({Vec3::Zero(), {0, 0, 30.0}}, 0.05),
                  penalty ? frame_flag::kStepLimited : frame_flag::kTurnLimited);
      }
}

/// A hand at pressing depth is not ahead of a part that may not go on.
TEST(StepLimits, APartHeldBackByAWallIsNotFlagged) {
  for (const ResponseModel response : kResponses)
    for (const double rate_Hz : kRates_Hz)
      for (const double scale : {0.1, 1.0, 20.0}) {
        SCOPED_TRACE(::testing::Message() << int(response) << ", " << rate_Hz << " Hz, scale " << scale);
        World world = block_of(scale * Vec3(0.02, 0.02, 0.02));
        add_fixed(world, scale * Vec3(0.01, 0.04, 0.04), scale * Vec3(0.0301, 0, 0));
        const auto simulation = simulation_of(std::move(world), settings_of(scale, response, rate_Hz));
        for (int i = 0; i < 0.4 * rate_Hz; ++i) {
          simulation->step({Mat3::Identity(), {0.05 * std::min(1.0, i / (0.2 * rate_Hz)), 0, 0}});
          EXPECT_EQ(simulation->report().flags, 0u) << "frame " << i;
        }
      }
}

/// Steps of many times a plate's thickness: the part stays on its side.
TEST(StepLimits, AThinPlateIsNotCrossedByLongSteps) {
  for (const double rate_Hz : kRates_Hz)
    for (const double scale : {1.0, 10.0, 20.0})
      for (const double speed : {0.3, 0.9, 3.0})
        for (const double tilt : {0.0, 0.3, 1.0}) {
          SCOPED_TRACE(::testing::Message()
                       << rate_Hz << " Hz, scale " << scale << ", " << speed << " m/s, tilt " << tilt);
          World world = block_of({0.02, 0.015, 0.01});
          add_fixed(world, {0.0001, 2.0, 2.0}, {0.03 * scale + 0.05, 0, 0});
          const auto simulation =
              simulation_of(std::move(world), settings_of(scale, ResponseModel::kConstraint, rate_Hz));
          for (int i = 0; i * speed / rate_Hz < 0.2; ++i) {
            const double x = i * speed / rate_Hz;
            simulation->step({exp_rotation({0, 0, tilt * std::min(1.0, 20 * x)}), {x, 0, 0}});
            EXPECT_FALSE(simulation->report().penetrating) << "frame " << i;
            ASSERT_LT(simulation->report().X_WH_proxy.p.x(), 0.03 * scale + 0.05) << "frame " << i;
          }
        }
}

/// A long bar, held in its middle or at an end, is swung against a thin post.
TEST(StepLimits, AThinPostIsNotCrossedByALongBar) {
  for (const double rate_Hz : kRates_Hz)
    for (const double length : {0.1, 1.0, 10.0})
      for (const double rate : {2.0, 8.0, 20.0})
        for (const double place : {0.2, 0.45}) {  // of the post along the bar
          SCOPED_TRACE(::testing::Message()
                       << rate_Hz << " Hz, " << length << " m, " << rate << " rad/s, post at " << place);
          World world = block_of(length * Vec3(0.5, 0.01, 0.01));
          add_fixed(world, length * Vec3(0.001, 0.001, 0.1),
                    length * Vec3(place * std::cos(0.5), place * std::sin(0.5), 0));
          const auto simulation =
              simulation_of(std::move(world), settings_of(1.0, ResponseModel::kConstraint, rate_Hz));
          for (int i = 0; i * rate / rate_Hz < 1.5; ++i) {
            simulation->step({exp_rotation({0, 0, i * rate / rate_Hz}), Vec3::Zero()});
            EXPECT_FALSE(simulation->report().penetrating) << "frame " << i;
          }
          // The post's side of the bar stays below the post, however the bar was pushed aside.
          const Pose& X_WB = simulation->bodies().X_WB[0];
          const Vec3 post_B = X_WB.inverse() * simulation->world().bodies[1].X_WB.p;
          EXPECT_GT(post_B.y(), 0.0) << post_B.transpose();
        }
}

}  // namespace
}  // namespace tactum::step_limits_test
