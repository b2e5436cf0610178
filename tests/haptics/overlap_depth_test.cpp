/// The depth of an overlap along the relative motion, a setting of the penalty response [Gregory 2000, 4.1].

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "support/longest_step.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::overlap_depth_test {
namespace {

/// A grasped block that its joint leads obliquely into a fixed plate, whose top is at z = 0.
struct Case {
  const char* name;
  double size_m = 0.02;      ///< length of the block
  double angle_rad = 0.6;    ///< between the motion and the normal of the plate
  double azimuth_rad = 0.0;  ///< of the motion in the plane of the plate
  double dt_s = 1e-3;
  bool plate_first = false;  ///< in the list of bodies
  bool on_hinge = false;     ///< about y, at azimuth 0, instead of on a slider
  double seam_m = NAN;       ///< the plate is cut there square to x, and at y = 0, if at all
};

/// Four boxes that make up a plate; those beyond the seam come first.
std::shared_ptr<const Part> cut_plate(const Vec3& half, double seam_m) {
  std::vector<std::vector<Vec3>> boxes;
  for (const double x_end : {half.x(), -half.x()})
    for (const double y_end : {half.y(), -half.y()}) {
      std::vector<Vec3>& corners = boxes.emplace_back();
      for (const double x : {seam_m, x_end})
        for (const double y : {0.0, y_end})
          for (const double z : {half.z(), -half.z()}) corners.emplace_back(x, y, z);
    }
  Result<Part> part = part_from_clouds(boxes);
  EXPECT_TRUE(part);
  EXPECT_EQ(part->pieces.size(), 4u);
  return std::make_shared<const Part>(std::move(*part));
}

struct Oblique {
  explicit Oblique(const Case& of, OverlapDepth depth = OverlapDepth::kShortest)
      : at(of), block(of.plate_first ? 1 : 0) {
    World world;
    world.bodies.resize(2);
    Body& grasped = world.bodies[block];
    grasped.part = solid_box(half());
    grasped.mass_kg = 0.05;
    grasped.inertia_B = 1e-5 * Mat3::Identity();
    grasped.X_WB.p = Vec3(0.0, 0.0, half().z()) - start_m() * motion();
    if (at.on_hinge) {
      grasped.joint = {.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = anchor()};
    } else {
      grasped.joint = {.kind = JointKind::kSlider, .axis_W = motion()};
    }
    Body& plate = world.bodies[1 - block];
    const Vec3 plate_half = at.size_m * Vec3(3.0, 3.0, 1.0);
    plate.part = std::isnan(at.seam_m) ? solid_box(plate_half) : cut_plate(plate_half, at.seam_m);
    plate.X_WB.p.z() = -plate_half.z();
    plate.joint.kind = JointKind::kFixed;
    FrameSettings settings;
    settings.response = ResponseModel::kPenalty;
    settings.dt_s = at.dt_s;
    settings.penalty.max_step_m = longest_step_setting(step_m(), at.dt_s);
    settings.penalty.depth = depth;
    settings.tool.body = static_cast<int>(block);
    settings.coupling.damping_Ns_per_m = 0.0;
    settings.coupling.damping_Nms_per_rad = 0.0;
    k_c = settings.coupling.stiffness_N_per_m;
    k_s = settings.penalty.stiffness_N_per_m;
    simulation = std::move(*Simulation::make(std::move(world), settings));
  }

  Vec3 half() const { return 0.5 * at.size_m * Vec3(1.0, 0.7, 0.5); }
  double step_m() const { return std::min(0.02 * at.size_m, 0.5e-3); }
  double start_m() const { return 2.0 * step_m(); }
  double pressed_m() const { return 10.0 * step_m(); }
  Vec3 motion() const {
    const double across = std::sin(at.angle_rad);
    return {across * std::cos(at.azimuth_rad), across * std::sin(at.azimuth_rad), -std::cos(at.angle_rad)};
  }
  /// So that the middle of the block begins to move at the angle of the case.
  Vec3 anchor() const {
    const double arm = 3.0 * at.size_m;
    return Vec3(-arm, 0.0, half().z() + arm * std::tan(at.angle_rad)) - start_m() * motion();
  }
  /// The hand goes on along the joint by `ahead_m`, and turns with it.
  void hand_at(double ahead_m) {
    Pose X_DH{Mat3::Identity(), ahead_m * motion()};
    if (at.on_hinge) {
      const Vec3 arm = simulation->world().bodies[block].X_WB.p - anchor();
      X_DH.R = exp_rotation({0.0, ahead_m / arm.norm(), 0.0});
      X_DH.p = X_DH.R * arm - arm;
    }
    simulation->step(X_DH);
  }
  void press() {
    const double ahead = start_m() + pressed_m();
    for (int i = 0; i <= 50; ++i) hand_at(ahead * i / 50.0);
    for (int i = 0; i < 200; ++i) hand_at(ahead);
  }
  /// How far beyond touching the block has come along the slider.
  double entered_m() const {
    return (simulation->bodies().X_WB[block].p - simulation->world().bodies[block].X_WB.p).dot(motion()) -
           start_m();
  }
  std::vector<ContactRow> rows() const {
    const std::span<const ContactRow> rows = simulation->state().response.rows();
    return {rows.begin(), rows.end()};
  }

  Case at;
  std::size_t block;
  double k_c = 0.0, k_s = 0.0;
  std::unique_ptr<Simulation> simulation;
};

/// By how much the depth of every point grows where the motion makes this angle with the normal.
double expected_scale(double cosine) {
  const double ratio = 1.0 / cosine;
  return ratio <= 2.0 ? ratio : ratio >= 4.0 ? 1.0 : 1.0 + 0.5 * (4.0 - ratio);
}

/// The seam lies so that the block extends over it by 1.1 times its depth at rest: the motion back leads out
/// of the pieces there through the wall that they share with the others.
Case over_a_seam() {
  Case at{.name = "over a seam of the plate", .angle_rad = 0.9};
  const double c = std::cos(at.angle_rad);
  const double step = 0.02 * at.size_m;
  const double entered = (10.0 - c) / (1.0 + c) * step;  // as in the test below, with k_c = k_s
  at.seam_m = 0.5 * at.size_m + entered * std::sin(at.angle_rad) - 1.1 * entered * c;
  return at;
}

std::vector<Case> cases() {
  return {{.name = "a block of 20 mm"},
          {.name = "steeper", .angle_rad = 0.2, .azimuth_rad = 4.0},
          {.name = "flatter", .angle_rad = 1.0, .azimuth_rad = 2.1},
          {.name = "a block of 1 mm", .size_m = 1e-3, .angle_rad = 0.8},
          {.name = "a block of 10 m", .size_m = 10.0, .angle_rad = 0.8},
          {.name = "the plate is body 0", .azimuth_rad = 1.0, .plate_first = true},
          {.name = "10 kHz", .dt_s = 1e-4},
          {.name = "250 Hz", .dt_s = 4e-3},
          over_a_seam()};
}

TEST(OverlapDepth, AtRestTheForceIsThatOfTheDepthAlongTheMotion) {
  for (const Case& at : cases()) {
    SCOPED_TRACE(at.name);
    for (const OverlapDepth depth : {OverlapDepth::kAlongMotion, OverlapDepth::kShortest}) {
      Oblique block(at, depth);
      block.press();
      // Along the slider k_c (q_hand - q) = k_s (delta + scale q c) c: the normal, and the shortest depth
      // q c, lean from the motion by the angle of the cosine c.
      const double c = std::cos(at.angle_rad);
      const double scale = depth == OverlapDepth::kAlongMotion ? 1.0 / c : 1.0;
      const double q = (block.k_c * block.pressed_m() - block.k_s * block.step_m() * c) /
                       (block.k_c + block.k_s * scale * c * c);
      EXPECT_NEAR(block.entered_m(), q, 1e-8 * at.size_m + 1e-4 * q);
      EXPECT_NEAR(block.simulation->report().min_distance_m, -q * c, 1e-8 * at.size_m + 1e-4 * q);
    }
  }
}

/// Two simulations in the same state, to compare the effect of the setting on the next frame.
void expect_scaled(const Case& at) {
  SCOPED_TRACE(at.name);
  Oblique shortest(at);
  Oblique along(at);
  shortest.press();
  along.press();
  along.simulation->settings().penalty.depth = OverlapDepth::kAlongMotion;
  for (Oblique* block : {&shortest, &along}) block->hand_at(block->start_m() + block->pressed_m());
  const std::vector<ContactRow> plain = shortest.rows();
  const std::vector<ContactRow> scaled = along.rows();
  ASSERT_EQ(plain.size(), scaled.size());
  ASSERT_FALSE(plain.empty());
  double weight = 0.0;
  Vec3 middle = Vec3::Zero();
  for (const ContactRow& row : plain) {
    weight += row.stiffness;
    middle += row.stiffness * row.p_W;
  }
  middle /= weight;
  const Vec3 motion =
      at.on_hinge ? Vec3::UnitY().cross(middle - shortest.anchor()).normalized() : shortest.motion();
  int overlapping = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double scale = expected_scale(-motion.z());
    overlapping += plain[i].distance < 0.0 ? 1 : 0;
    EXPECT_NEAR(scaled[i].distance, plain[i].distance * (plain[i].distance < 0.0 ? scale : 1.0),
                1e-8 * at.size_m);
    EXPECT_EQ(scaled[i].n_BA_W, plain[i].n_BA_W);  // the force keeps the contact normal
  }
  EXPECT_GT(overlapping, 0);
}

TEST(OverlapDepth, EveryPointIsDeeperByOneOverTheCosine) {
  for (const Case& at : cases()) expect_scaled(at);
}

TEST(OverlapDepth, OfAPartThatTurnsTheMotionIsThatOfTheMiddleOfThePatch) {
  for (const double angle : {0.0, 0.3, 0.9})
    for (const double size : {2e-3, 0.02, 2.0})
      expect_scaled({.name = "on a hinge", .size_m = size, .angle_rad = angle, .on_hinge = true});
}

/// At 2 times the shortest depth the depth along the motion begins to count less, at 4 it does not count.
TEST(OverlapDepth, AMotionAlongTheSurfaceSaysNothing) {
  for (const double ratio : {1.9, 2.1, 3.0, 3.9, 4.1, 8.0, 30.0})
    expect_scaled({.name = "along the surface", .angle_rad = std::acos(1.0 / ratio)});
}

/// A block that nothing moves, in a plate: its motion has no direction.
TEST(OverlapDepth, WithoutMotionItIsTheShortest) {
  std::vector<std::vector<ContactRow>> rows;
  for (const OverlapDepth depth : {OverlapDepth::kShortest, OverlapDepth::kAlongMotion}) {
    World world;
    world.bodies.resize(2);
    world.bodies[0].part = solid_box({0.01, 0.01, 0.01});
    world.bodies[0].mass_kg = 1.0;
    world.bodies[0].inertia_B = 1e-4 * Mat3::Identity();
    world.bodies[0].X_WB.p.z() = 0.009;
    world.bodies[1].part = solid_box({0.05, 0.05, 0.01});
    world.bodies[1].X_WB.p.z() = -0.01;
    world.bodies[1].joint.kind = JointKind::kFixed;
    FrameSettings settings;
    settings.response = ResponseModel::kPenalty;
    settings.penalty.depth = depth;
    const auto simulation = std::move(*Simulation::make(std::move(world), settings));
    simulation->step(Pose{});
    const std::span<const ContactRow> found = simulation->state().response.rows();
    rows.emplace_back(found.begin(), found.end());
  }
  ASSERT_EQ(rows[0].size(), 4u);
  ASSERT_EQ(rows[1].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(rows[0][i].distance, -0.001, 1e-12);
    EXPECT_EQ(rows[1][i].distance, rows[0][i].distance);
  }
}

/// Each depth takes a test of the budget; where none is left the shortest depth stands.
TEST(OverlapDepth, ADepthCostsATest) {
  Oblique block({.name = "budget"}, OverlapDepth::kAlongMotion);
  block.press();
  EXPECT_EQ(block.simulation->report().validation_tests, 1);
  const double depth = block.rows().front().distance;
  block.simulation->settings().budget.max_exact_tests = 0;  // the overlap is known from the frame before
  block.hand_at(block.start_m() + block.pressed_m());
  EXPECT_EQ(block.simulation->report().validation_tests, 0);
  EXPECT_NEAR(block.rows().front().distance / depth, std::cos(block.at.angle_rad), 1e-6);
}

}  // namespace
}  // namespace tactum::overlap_depth_test
