/// The published response with bodies that move by impulses, against closed forms: weight in the hand, free
/// bodies that fall, bounce, slide and rest, and such that the grasped part pushes or presses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/solid_box.h"
#include "tactum/haptics/simulation.h"
#include "tactum/math/screw.h"

namespace tactum::penalty_mechanics_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Case {
  double size_m = 0.03;  ///< side of the free cube
  double mass_kg = 0.05;
  double rate_Hz = 1000.0;
  double mu = 0.0;  ///< friction
  double e = 0.0;   ///< restitution
  bool floor_first = true;
  int floor_bodies = 1;

  std::string name() const {
    return std::to_string(size_m) + " m, " + std::to_string(mass_kg) + " kg, " + std::to_string(rate_Hz) +
           " Hz, mu " + std::to_string(mu) + ", e " + std::to_string(e);
  }
};

const Case kCases[] = {{},
                       {.size_m = 0.003, .mass_kg = 0.002},
                       {.size_m = 0.3, .mass_kg = 20.0},
                       {.rate_Hz = 500.0},
                       {.rate_Hz = 4000.0},
                       {.floor_first = false},
                       {.floor_bodies = 2}};

/// A cube over a floor whose top is at z = 0, and, where the hand holds something, a bar beside it.
class OnFloor {
 public:
  int cube = -1, bar = -1;

  OnFloor(const Case& c, const Pose& X_cube, const Twist& V_cube, const Vec3* bar_at = nullptr)
      : frames_a_second_(c.rate_Hz) {
    World world;
    world.gravity_W = {0, 0, -kGravity};
    const double s = c.size_m;
    const auto add_floor = [&] {
      for (int i = 0; i < c.floor_bodies; ++i)
        add_body(world, {.part = solid_box(s * Vec3(20.0 / c.floor_bodies, 20.0, 1.0)),
                         .X_WP = {Mat3::Identity(), {s * 40.0 / c.floor_bodies * i, 0, -s}},
                         .joint = {.kind = JointKind::kFixed}});
    };
    if (c.floor_first) add_floor();
    cube = add_body(
        world,
        {.part = solid_box(0.5 * s * Vec3(1, 1, 1)), .mass_kg = c.mass_kg, .X_WP = X_cube, .V_WB = V_cube});
    if (!c.floor_first) add_floor();
    FrameSettings settings;
    if (bar_at != nullptr) {
      bar = add_body(world, {.part = solid_box(0.5 * s * Vec3(0.5, 0.5, 0.5)),
                             .mass_kg = 1e-6,  // [kg] its weight is not to be felt
                             .X_WP = {Mat3::Identity(), *bar_at}});
      settings.tool.body = bar;
    }
    const int n = static_cast<int>(world.bodies.size());
    settings.response = ResponseModel::kPenalty;
    settings.dt_s = 1.0 / c.rate_Hz;
    settings.smoothing.on = false;
    if (c.mu > 0.0) settings.friction = {std::vector<double>(static_cast<std::size_t>(n * n), c.mu), n};
    settings.impacts.restitution = {std::vector<double>(static_cast<std::size_t>(n * n), c.e), n};
    simulation_ = std::move(*Simulation::make(world, settings));
  }
  /// The hand holds still, or moves with V_W.
  void run(double time_s, const Vec3& V_W = Vec3::Zero()) {
    const auto frames = static_cast<long>(std::lround(time_s * frames_a_second_));
    for (long i = 0; i < frames; ++i) {
      X_.p += V_W / frames_a_second_;
      simulation_->step(X_);
      highest_m_ = std::max(highest_m_, p().z());
      penetrating_ += simulation_->report().penetrating ? 1 : 0;
    }
  }
  void forget_highest() { highest_m_ = -1e300; }
  const Vec3& p() const { return simulation_->state().world.X_WB[static_cast<std::size_t>(cube)].p; }
  const Vec3& p_bar() const { return simulation_->state().world.X_WB[static_cast<std::size_t>(bar)].p; }
  const FrameReport& report() const { return simulation_->report(); }
  double highest_m() const { return highest_m_; }
  int penetrating() const { return penetrating_; }

 private:
  double frames_a_second_;
  Pose X_;
  std::unique_ptr<Simulation> simulation_;
  double highest_m_ = -1e300;
  int penetrating_ = 0;
};

Pose at_height(double z) { return {Mat3::Identity(), {0, 0, z}}; }

TEST(PenaltyMechanics, TheWeightOfTheGraspedPartIsFelt) {
  struct Grasp {
    double mass_kg, size_m, rate_Hz;
    Vec3 handle;
  };
  for (const Grasp& grasp :
       {Grasp{0.15, 0.04, 1000.0, {0.015, 0, 0}}, Grasp{0.15, 0.04, 500.0, {0, 0, 0}},
        Grasp{0.15, 0.04, 4000.0, {0, 0.01, 0.02}}, Grasp{0.002, 0.005, 1000.0, {0.001, 0, 0}},
        Grasp{0.3, 0.5, 1000.0, {0.01, -0.02, 0}}}) {
    SCOPED_TRACE(::testing::Message() << grasp.mass_kg << " kg, " << grasp.size_m << " m, " << grasp.rate_Hz);
    World world;
    world.gravity_W = {0, 0, -kGravity};
    add_body(world, {.part = solid_box(grasp.size_m * Vec3(0.5, 0.4, 0.3)), .mass_kg = grasp.mass_kg});
    FrameSettings settings;
    settings.response = ResponseModel::kPenalty;
    settings.dt_s = 1.0 / grasp.rate_Hz;
    settings.smoothing.on = false;
    settings.tool.body = 0;
    settings.tool.X_BH.p = grasp.handle;
    const auto simulation = std::move(*Simulation::make(world, settings));
    for (int i = 0; i < static_cast<int>(grasp.rate_Hz); ++i) simulation->step(Pose{});
    const Vec3 weight(0, 0, -grasp.mass_kg * kGravity);
    // The lever turns with the part, which yields to its weight.
    const Vec3 lever = -(simulation->state().world.X_WB[0].R * grasp.handle);
    EXPECT_LT((simulation->report().coupling.f - weight).norm(), 1e-6 * weight.norm());
    EXPECT_LT((simulation->report().coupling.t - lever.cross(weight)).norm(),
              1e-4 * weight.norm() * grasp.handle.norm() + 1e-12);
  }
}

/// A cube that falls flat on a floor comes up again to e^2 of its height.
TEST(PenaltyMechanics, AFreeBodyBouncesByItsRestitution) {
  for (Case c : kCases)
    for (const double e : {0.0, 0.5, 0.9}) {
      c.e = e;
      SCOPED_TRACE(c.name());
      const double drop = 0.1;  // [m]
      OnFloor scene(c, at_height(0.5 * c.size_m + drop), {});
      const double fall_s = std::sqrt(2.0 * drop / kGravity);
      scene.run(fall_s + 0.004);
      scene.forget_highest();
      scene.run(1.2 * e * fall_s + 0.02);
      // An impact comes up to a frame early, from where a body without restitution falls again.
      const double speed = std::sqrt(2.0 * kGravity * drop);
      EXPECT_NEAR(scene.highest_m() - 0.5 * c.size_m, e * e * drop, 2.5 * speed / c.rate_Hz);
      EXPECT_EQ(scene.penetrating(), 0);
    }
}

/// A cube that slides over a floor stops after v^2 / (2 mu g).
TEST(PenaltyMechanics, AFreeBodySlidesByItsFriction) {
  for (Case c : kCases)
    for (const double mu : {0.2, 0.5}) {
      c.mu = mu;
      SCOPED_TRACE(c.name());
      const double distance = 6.0 * c.size_m;
      const double speed = std::sqrt(2.0 * mu * kGravity * distance);
      OnFloor scene(c, at_height(0.5 * c.size_m * (1.0 + 1e-5)), {Vec3(speed, 0, 0), Vec3::Zero()});
      scene.run(speed / (mu * kGravity) + 0.05);
      EXPECT_NEAR(scene.p().x(), distance, 0.01 * distance + speed / c.rate_Hz);
      EXPECT_EQ(scene.penetrating(), 0);
    }
}

/// The grasped bar presses the cube on the floor: felt and contact force are the published law, and the cube
/// stays where it is.
TEST(PenaltyMechanics, ABodyPressedOnTheFloorIsFeltByTheLaw) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name());
    const double s = c.size_m;
    const Vec3 bar_at(0, 0, 1.3 * s);
    OnFloor scene(c, at_height(0.5 * s * (1.0 + 1e-5)), {}, &bar_at);
    scene.run(0.1);
    const double depth = 0.002;  // [m] of the hand, below where the bar touches
    scene.run(0.5, Vec3(0, 0, -2.0 * (0.05 * s + depth)));
    scene.run(0.3);
    // Over the depth, with k_s = k_c, proxy and hand part by half of what delta leaves.
    const double gap = scene.p_bar().z() - 0.25 * s - (scene.p().z() + 0.5 * s);
    const FrameSettings defaults;
    const double stretch = depth + gap;
    EXPECT_NEAR(scene.report().coupling.f.z(), defaults.coupling.stiffness_N_per_m * stretch, 0.02);
    EXPECT_NEAR(scene.report().restoring.f.z(), scene.report().coupling.f.z(), 0.02);
    EXPECT_NEAR(scene.p().z(), 0.5 * s, 1e-4 * s);
    EXPECT_GT(scene.report().coupling.f.z(), 0.3);
  }
}

/// A small box, and the plate in the hand, tilted against each other, that it meets: it falls onto the
/// plate, or the hand moves the plate against it.
struct Meeting {
  double size_m = 0.02;  ///< of the box's longest side
  double rate_Hz = 1000.0;
  Vec3 tilt{0.1, 0.05, 0.0};  ///< of the plate [rad]
  double speed = 0.0;         ///< of the plate, along z, where nothing weighs [m/s]
  bool box_first = false;
};

/// The greatest energy that the box has ever had as the hand sees it, of that at the start.
double greatest_energy(const Meeting& c) {
  const double s = c.size_m;
  World world;
  const double gravity = c.speed > 0.0 ? 0.0 : kGravity;
  world.gravity_W = {0, 0, -gravity};
  int box = -1, plate = -1;
  const auto add_box = [&] {
    box = add_body(world, {.part = solid_box(0.5 * s * Vec3(1.0, 0.9, 0.8)),
                           .density_kg_per_m3 = 1500.0,
                           .X_WP = {Mat3::Identity(), s * Vec3(0.15, -0.1, 0.7)}});
  };
  if (c.box_first) add_box();
  plate = add_body(world, {.part = solid_box(s * Vec3(3.0, 3.0, 0.1)),
                           .density_kg_per_m3 = 1500.0,
                           .X_WP = {exp_rotation(c.tilt), Vec3::Zero()}});
  if (!c.box_first) add_box();
  FrameSettings settings;
  settings.response = ResponseModel::kPenalty;
  settings.dt_s = 1.0 / c.rate_Hz;
  settings.tool.body = plate;
  const auto simulation = std::move(*Simulation::make(world, settings));
  const Body& body = world.bodies[std::size_t(box)];
  const WorldState& state = simulation->state().world;
  const auto energy = [&] {
    const Pose& X = state.X_WB[std::size_t(box)];
    const Twist& V = state.V_WB[std::size_t(box)];
    const Vec3 w_B = X.R.transpose() * V.w;
    return 0.5 * body.mass_kg * (V.v - Vec3(0, 0, c.speed)).squaredNorm() +
           0.5 * w_B.dot(body.inertia_B * w_B) + body.mass_kg * gravity * X.p.z();
  };
  const double start = energy();
  // What moving by half a size is worth, or the box's own speed.
  const double whole = c.speed > 0.0 ? start : 0.5 * body.mass_kg * gravity * s;
  double greatest = 0.0;
  const double long_s = c.speed > 0.0 ? 2.0 * s / c.speed : 12.0 * std::sqrt(s / kGravity);
  for (double t = 0.0; t < long_s; t += settings.dt_s) {
    simulation->step(Pose{Mat3::Identity(), {0, 0, c.speed * t}});
    greatest = std::max(greatest, (energy() - start) / whole);
  }
  return greatest;
}

/// A spring that moves evenly, or stands, takes nothing to the box that it does not give back; the force
/// acts where the two touch, not where they touched a moment ago.
TEST(PenaltyMechanics, ThePartInTheHandMakesNoEnergyInABoxThatItMeets) {
  for (const double size_m : {0.01, 0.02, 0.06})
    for (const double rate_Hz : testing::frame_rates_Hz()) {
      // A gram on such a spring turns about its corner in less time than two such frames.
      if (size_m < 0.02 && rate_Hz < 1000.0) continue;
      for (const Vec3& tilt : {Vec3(0.1, 0.05, 0.0), Vec3(0.0, 0.02, 0.3), Vec3(-0.2, 0.1, 0.0)})
        for (const double speed : {0.0, 0.06, 0.3})
          for (const bool box_first : {false, true}) {
            SCOPED_TRACE(::testing::Message()
                         << size_m << " m, " << rate_Hz << " Hz, tilt " << tilt.transpose() << ", " << speed
                         << " m/s, box first " << box_first);
            EXPECT_LT(greatest_energy({size_m, rate_Hz, tilt, speed, box_first}), 0.1);
          }
    }
}

}  // namespace
}  // namespace tactum::penalty_mechanics_test
