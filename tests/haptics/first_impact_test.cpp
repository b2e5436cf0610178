/// The first time of impact in the penalty response, of bodies that turn [Gregory 2000, 6.1; Mirtich 1996b].

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "support/longest_step.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::first_impact_test {
namespace {

/// A hand turns a bar about y, at the largest step, over a plate whose top is at z = 0. Turned by `a` from
/// lying flat, its lowest corner,
/// `rho` from the middle and at the angle `alpha` there, is  rho cos(alpha - a)  below the middle.
struct Case {
  const char* name;
  double size_m = 0.1;  ///< length of the bar
  double dt_s = 1e-3;
  double turn_rad = 0.03;    ///< in a frame
  double before_rad = 0.05;  ///< where the first frame starts, before the corner is lowest
  double gap_m = -2e-4;      ///< under the corner at its lowest, for a bar of 1 m; negative: it hits
  double rising_m = 0.0;     ///< by which the plate rises in a frame
  int bar_pieces = 1, plate_pieces = 1;
};

/// A box of so many boxes side by side along x.
std::shared_ptr<const Part> cut_box(const Vec3& half, int pieces) {
  std::vector<std::vector<Vec3>> boxes;
  for (int i = 0; i < pieces; ++i) {
    std::vector<Vec3>& corners = boxes.emplace_back();
    for (const int end : {i, i + 1})
      for (const double y : {-half.y(), half.y()})
        for (const double z : {-half.z(), half.z()})
          corners.emplace_back(half.x() * (2.0 * end / pieces - 1.0), y, z);
  }
  Result<Part> part = part_from_clouds(boxes);
  EXPECT_TRUE(part);
  EXPECT_EQ(part->pieces.size(), static_cast<std::size_t>(pieces));
  return std::make_shared<const Part>(std::move(*part));
}

struct Swing {
  explicit Swing(const Case& of) : at(of) {
    World world;
    world.bodies.resize(2);
    Body& bar = world.bodies[0];
    bar.part = cut_box(half(), at.bar_pieces);
    bar.mass_kg = 1.0;
    bar.inertia_B = at.size_m * at.size_m * Mat3::Identity();
    bar.X_WB = {exp_rotation({0.0, alpha() - at.before_rad, 0.0}), {0.0, 0.0, height()}};
    bar.joint = {.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = bar.X_WB.p};
    Body& plate = world.bodies[1];
    const Vec3 plate_half = at.size_m * Vec3(2.0, 1.0, 0.3);
    plate.part = cut_box(plate_half, at.plate_pieces);
    plate.mass_kg = 1.0;
    plate.inertia_B = at.size_m * at.size_m * Mat3::Identity();
    plate.X_WB.p = {0.3 * at.size_m, 0.0, -plate_half.z()};
    if (at.rising_m == 0.0) plate.joint.kind = JointKind::kFixed;
    plate.V_WB.v.z() = at.rising_m / at.dt_s;
    FrameSettings settings;
    settings.response = ResponseModel::kPenalty;
    settings.dt_s = at.dt_s;
    settings.tool.body = 0;
    settings.penalty.max_step_m = longest_step_setting(at.turn_rad * half().norm(), at.dt_s);
    simulation = std::move(*Simulation::make(std::move(world), settings));
    simulation->step(Pose{});  // the hand takes the bar
  }

  Vec3 half() const { return 0.5 * at.size_m * Vec3(1.0, 0.2, 0.3); }
  double rho() const { return std::hypot(half().x(), half().z()); }
  double alpha() const { return std::atan2(half().x(), half().z()); }
  double height() const { return rho() + at.gap_m * at.size_m; }
  /// Of the corner over the plate, `frames` after the start.
  double gap_after(double frames) const {
    return height() - (frames + 1.0) * at.rising_m - rho() * std::cos(at.before_rad - at.turn_rad * frames);
  }
  /// When the corner reaches the plate, in frames from the start: the first root, between samples.
  double impact() const {
    double free = 0.0;
    while (gap_after(free + 1e-3) > 0.0 && free < 10.0) free += 1e-3;
    double beyond = free + 1e-3;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (free + beyond);
      (gap_after(middle) > 0.0 ? free : beyond) = middle;
    }
    return free;
  }
  /// The published estimate: distance over the closing speed at the start of the frame.
  double estimated_impact(int frame) const {
    const double speed = at.rising_m + at.turn_rad * rho() * std::sin(at.before_rad - at.turn_rad * frame);
    return frame + gap_after(frame) / speed;
  }
  /// The hand is farther ahead than a frame may follow.
  void step() { simulation->step(Pose{exp_rotation({0.0, 1.0, 0.0}), Vec3::Zero()}); }

  Case at;
  std::unique_ptr<Simulation> simulation;
};

std::vector<Case> striking() {
  return {{.name = "a bar of 0.1 m on a hinge"},
          {.name = "a bar of 2 mm", .size_m = 2e-3},
          {.name = "a bar of 10 m", .size_m = 10.0},
          {.name = "10 kHz", .dt_s = 1e-4},
          {.name = "250 Hz", .dt_s = 4e-3},
          {.name = "a plate that rises", .gap_m = -1.5e-4, .rising_m = 5e-6},
          {.name = "both of several pieces", .bar_pieces = 3, .plate_pieces = 4}};
}

TEST(FirstImpact, OfABarThatTurnsIsWhereItsCornerReachesThePlate) {
  for (const Case& at : striking()) {
    SCOPED_TRACE(at.name);
    Swing swing(at);
    const double expected = swing.impact();
    const int frame = static_cast<int>(expected);
    for (int i = 0; i < frame; ++i) {
      swing.step();
      EXPECT_EQ(swing.simulation->report().time_of_impact_s, at.dt_s) << "frame " << i;
    }
    swing.step();
    EXPECT_NEAR(frame + swing.simulation->report().time_of_impact_s / at.dt_s, expected, 1e-5);
    EXPECT_GT(std::abs(swing.estimated_impact(frame) - expected), 0.05) << "the estimate would do as well";
    EXPECT_GT(swing.simulation->report().contact_points, 0);
    EXPECT_GT(swing.simulation->report().validation_tests, 0);
  }
}

/// The closing speed at the start of the frame would take the corner into the plate; turning lifts it before.
TEST(FirstImpact, WhatSwingsPastIsNotPushed) {
  for (Case at : striking()) {
    if (at.rising_m > 0.0) continue;
    SCOPED_TRACE(at.name);
    at.gap_m = 2e-5;
    Swing swing(at);
    bool estimated = false;
    for (int i = 0; i < 4; ++i) {
      if (at.before_rad > at.turn_rad * i) estimated |= swing.estimated_impact(i) < i + 1;
      swing.step();
      EXPECT_EQ(swing.simulation->report().time_of_impact_s, at.dt_s) << "frame " << i;
    }
    EXPECT_TRUE(estimated) << "the estimate would do as well";
    EXPECT_NEAR(swing.simulation->bodies().V_WB[0].w.y(), at.turn_rad / at.dt_s,
                1e-9 * at.turn_rad / at.dt_s);
  }
}

/// Where no test is left the published estimate stands.
TEST(FirstImpact, WithoutBudgetItIsThePublishedEstimate) {
  const Case at{.name = "no budget"};
  Swing swing(at);
  const int frame = static_cast<int>(swing.impact());
  for (int i = 0; i < frame; ++i) swing.step();
  swing.simulation->settings().budget.max_exact_tests = 0;  // the contact is known from the frame before
  swing.step();
  EXPECT_NEAR(frame + swing.simulation->report().time_of_impact_s / at.dt_s, swing.estimated_impact(frame),
              1e-3);
  EXPECT_EQ(swing.simulation->report().validation_tests, 0);
}

}  // namespace
}  // namespace tactum::first_impact_test
