#include "tactum/haptics/frame.h"

#include <gtest/gtest.h>

#include "support/add_body.h"
#include "support/pressed_block.h"
#include "support/rig.h"
#include "support/sandbox.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::frame_test {
namespace {

constexpr double kPlateTop = 0.0;  // z of the plate's upper face [m]

/// An open square of 0.1 m at height zero facing up, divided n by n: a surface.
std::shared_ptr<const Part> grid_part(int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(0.1 * i / n - 0.05, 0.1 * j / n - 0.05, 0.0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  Result<Part> part = part_from_mesh(mesh);
  EXPECT_TRUE(part);
  EXPECT_TRUE(part->is_surface());
  EXPECT_EQ(part->groups.count, 2);  // the face and its back
  return std::make_shared<const Part>(std::move(*part));
}

/// A grasped box of 20 x 14 x 10 mm over a fixed plate, both moved by X.
struct Bench {
  World world;
  FrameSettings settings;
  Pose X_WU;  // the whole set-up in the world

  explicit Bench(const Pose& X = {}, std::shared_ptr<const Part> plate = solid_box({0.05, 0.05, 0.01}))
      : X_WU(X) {
    const Vec3 middle(0, 0, plate->is_surface() ? kPlateTop : -0.01);  // of the plate
    add_body(world, {.part = solid_box({0.010, 0.007, 0.005}),
                     .mass_kg = 0.05,
                     .X_WP = X * Pose{Mat3::Identity(), {0, 0, 0.008}}});
    add_body(world, {.part = std::move(plate),
                     .X_WP = X * Pose{Mat3::Identity(), middle},
                     .joint = {.kind = JointKind::kFixed}});
    settings.tool.body = 0;
    settings.response = ResponseModel::kPenalty;
    settings.workspace.X_WD = {X.R, Vec3::Zero()};
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    settings.safety = safety_limits({.name = "test",
                                     .senses_rotation = true,
                                     .actuates_force = true,
                                     .actuates_torque = true,
                                     .max_force_N = 20.0,
                                     .max_torque_Nm = 1.0});
  }

  /// Moves the handle from its start by X_DH over 200 frames, then holds for `hold` frames.
  FrameReport press(const Pose& X_DH, int hold = 1200) const {
    FrameState state(world, settings);
    FrameReport report;
    for (int i = 0; i <= 200 + hold; ++i) {
      DeviceSample sample;
      sample.valid = true;
      sample.time_s = i * 1e-3;
      sample.X_DH = interpolated(Pose{}, X_DH, std::min(1.0, i / 200.0));
      FrameTick tick;
      tick.index = static_cast<std::uint64_t>(i);
      tick.now_s = i * 1e-3;
      haptic_frame(world, settings, sample, tick, state, report);
    }
    return report;
  }
};

TEST(Frame, NothingIsFeltInFreeSpace) {
  const FrameReport report = Bench().press({exp_rotation({0.1, 0.2, 0.3}), {0.001, 0.002, 0.02}});
  EXPECT_EQ(report.contact_points, 0);
  EXPECT_LT(report.shown.f.norm(), 1e-9);
  EXPECT_LT(report.shown.t.norm(), 1e-9);
}

TEST(Frame, PressedFlatTheForceIsThePublishedLaw) {
  const Bench bench;
  const double pressed = 0.004;  // the hand is so far below where the block touches [m]
  const FrameReport report = bench.press({Mat3::Identity(), {0, 0, -0.003 - pressed}});
  // At rest k_c (pressed + d) = k_s (delta - d), with delta the threshold step the proxy would like to make.
  const double k_c = bench.settings.coupling.stiffness_N_per_m;
  const double k_s = bench.settings.penalty.stiffness_N_per_m;
  const double delta = bench.settings.penalty.max_step_m;
  const double d = (k_s * delta - k_c * pressed) / (k_c + k_s);
  EXPECT_NEAR(report.min_distance_m, d, 1e-6);
  EXPECT_NEAR(report.shown.f.z(), k_c * (pressed + d), 1e-3);
  EXPECT_LT(report.shown.f.head<2>().norm(), 1e-6);
  EXPECT_LT(report.shown.t.norm(), 1e-6);
  EXPECT_EQ(report.grasped_contact_points, 4);
  EXPECT_TRUE(report.penetrating);
  EXPECT_LT((report.restoring.f - report.coupling.f).norm(),
            1e-3);  // the hand feels the forces on the part
}

TEST(Frame, PressedOffCentreTheTorqueIsLeverTimesForce) {
  Bench bench;
  bench.settings.tool.X_BH.p = {0.004, 0.002, 0.005};  // the hand holds it beside the middle
  const FrameReport report = bench.press({Mat3::Identity(), {0, 0, -0.005}});
  // Balance at the handle: the contact's restoring wrench, moved there, is what the coupling shows.
  const Wrench at_handle = moved(report.restoring, report.X_WH_proxy.R * bench.settings.tool.X_BH.p);
  EXPECT_GT(report.shown.f.z(), 0.5);
  EXPECT_LT((at_handle.f - report.shown.f).norm(), 2e-3);
  EXPECT_LT((at_handle.t - report.shown.t).norm(), 2e-5);
}

TEST(Frame, TheSameEverywhereInTheWorld) {
  const Pose moved_world{exp_rotation({0.7, -1.1, 0.4}), {0.3, -0.2, 0.5}};
  const Pose pressed{exp_rotation({0.02, -0.03, 0.05}), {0.001, 0.0005, -0.006}};
  const FrameReport here = Bench().press(pressed);
  const FrameReport there = Bench(moved_world).press(pressed);
  EXPECT_GT(here.shown.f.norm(), 0.5);
  EXPECT_LT((here.shown.f - there.shown.f).norm(), 1e-6);
  EXPECT_LT((here.shown.t - there.shown.t).norm(), 1e-8);
}

TEST(Frame, AWallFeelsTheSameHoweverFinelyItIsMeshed) {
  const auto pressed = [](std::shared_ptr<const Part> plate, double depth) {
    Bench bench({}, std::move(plate));
    bench.settings.penalty.stiffness_N_per_m =
        1200.0;  // twice the coupling's: kept off while the hand is near
    return bench.press({Mat3::Identity(), {0.0012, 0.0007, -0.003 - depth}});
  };
  const std::shared_ptr<const Part> solid = solid_box({0.05, 0.05, 0.01});
  for (double depth : {0.0003, 0.002}) {
    const FrameReport expected = pressed(solid, depth);
    EXPECT_EQ(expected.penetrating, depth > 0.001);
    for (int n : {1, 3, 16}) {
      const FrameReport meshed = pressed(grid_part(n), depth);
      EXPECT_NEAR(meshed.shown.f.z(), expected.shown.f.z(), 1e-6) << n;
      EXPECT_LT((meshed.shown.t - expected.shown.t).norm(), 1e-8) << n;
      EXPECT_EQ(meshed.contact_points, 4) << n;
    }
  }
}

TEST(Frame, WithoutAHandNothingIsSent) {
  const Bench bench;
  FrameState state(bench.world, bench.settings);
  FrameReport report;
  const Wrench sent = haptic_frame(bench.world, bench.settings, DeviceSample{}, FrameTick{}, state, report);
  EXPECT_TRUE(is_zero(sent));
  EXPECT_TRUE(report.flags & frame_flag::kNoHand);
}

TEST(Frame, ANonFinitePoseSendsZeroAndHarmsNothing) {
  const Bench bench;
  FrameState state(bench.world, bench.settings);
  FrameReport report;
  for (int i = 0; i < 50; ++i) {
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = i * 1e-3;
    if (i == 30) sample.X_DH.p.x() = std::nan("");
    FrameTick tick;
    tick.now_s = sample.time_s;
    const Wrench sent = haptic_frame(bench.world, bench.settings, sample, tick, state, report);
    ASSERT_TRUE(sent.finite());
    if (i == 30) {
      EXPECT_TRUE(is_zero(sent));
    }
    ASSERT_TRUE(state.world.X_WB[0].finite());
  }
}

TEST(Frame, APoseThatIsNoneIsNotFollowed) {
  const Bench bench;
  const Pose none[] = {{Mat3::Zero(), Vec3::Zero()},            // a driver's empty buffer
                       {-Mat3::Identity(), Vec3::Zero()},       // a reflection
                       {Mat3::Identity(), Vec3(0, 0, 1e200)}};  // finite, and nowhere
  for (const Pose& X_DH : none) {
    FrameState state(bench.world, bench.settings);
    FrameReport report;
    const Pose before = state.world.X_WB[0];
    for (int i = 0; i < 20; ++i) {
      DeviceSample sample;
      sample.valid = true;
      sample.time_s = i * 1e-3;
      if (i == 0 || i == 10) sample.X_DH = X_DH;  // as the very first sample, and later
      FrameTick tick;
      tick.now_s = sample.time_s;
      const Wrench sent = haptic_frame(bench.world, bench.settings, sample, tick, state, report);
      if (i == 0 || i == 10) {
        EXPECT_TRUE(is_zero(sent));
        EXPECT_TRUE(report.safety & safety_flag::kImplausiblePose);
      }
    }
    EXPECT_LT((state.world.X_WB[0].p - before.p).norm(), 1e-12);
    EXPECT_LT((state.hand.grasp.X_BH.R - Mat3::Identity()).norm(), 1e-12);
  }
}

TEST(Frame, GraspingPullsNothing) {
  Bench bench;
  bench.settings.tool.X_BH.p = {0.003, 0.0, 0.005};
  FrameState state(bench.world, bench.settings);
  FrameReport report;
  DeviceSample sample;
  sample.valid = true;
  sample.X_DH = {exp_rotation({0.5, 0.2, -0.9}), {0.05, -0.02, 0.03}};  // wherever the handle happens to be
  haptic_frame(bench.world, bench.settings, sample, FrameTick{}, state, report);
  EXPECT_LT(report.coupling.f.norm(), 1e-9);
  EXPECT_LT(report.coupling.t.norm(), 1e-9);
}

/// Pairs that are near at load time are known: the first frame has no walk from afar.
TEST(Frame, TheFirstBeginsWithWhatIsNear) {
  Rig rig(2);
  rig.settings.shading.on = false;  // the facets are the surface
  const Polytope ball = make_icosphere(3, 0.02);
  for (Body& body : rig.world.bodies) body.part = solid_of(ball);
  rig.world.bodies[1].joint.kind = JointKind::kFixed;
  rig.world.bodies[1].X_WB = {exp_rotation(Vec3(0.3, 0.5, 0.1)), Vec3(0.024, 0.02, 0.02501)};  // 20 um apart
  rig.step({});
  EXPECT_EQ(rig.report.work.near_pairs, 1);
  EXPECT_EQ(rig.report.work.feature_steps, 0);
}

TEST(Hand, TheClutchLetsTheHandleMoveAndTheHandStay) {
  Workspace workspace;
  workspace.clutch_button = 1;
  workspace.scale = 2.0;
  HandTracking hand;
  DeviceSample sample;
  sample.valid = true;
  follow_hand(workspace, sample, 1e-3, hand);
  sample.X_DH.p = {0.01, 0, 0};
  follow_hand(workspace, sample, 1e-3, hand);
  EXPECT_NEAR(hand.X_WH.p.x(), 0.02, 1e-15);
  sample.buttons = 2;
  sample.X_DH.p = {-0.03, 0, 0};
  follow_hand(workspace, sample, 1e-3, hand);
  EXPECT_NEAR(hand.X_WH.p.x(), 0.02, 1e-15);
  EXPECT_LT(hand.V_WH.v.norm(), 1e-12);
  sample.buttons = 0;
  sample.X_DH.p = {-0.02, 0, 0};
  follow_hand(workspace, sample, 1e-3, hand);
  EXPECT_NEAR(hand.X_WH.p.x(), 0.04, 1e-15);
}

}  // namespace
}  // namespace tactum::frame_test
