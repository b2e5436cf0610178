/// Force fields as the hand feels them: the load on the grasped part, carried by the coupling, beside
/// contact, and its energy.

#include "tactum/response/field_pull.h"

#include <gtest/gtest.h>

#include "support/allocation_guard.h"
#include "support/block_rig.h"

namespace tactum::field_pull_test {
namespace {

const DipoleField kDipole{.moment_Nm3 = 2e-6, .core_m = 0.01};
const WellField kWell{.depth_J = 0.02, .width_m = 0.02};
const VortexField kVortex{.circulation_J = 0.1, .core_m = 0.015};

/// The grasped block in fields, far above the plate unless it is lowered.
struct FieldRig : BlockRig {
  explicit FieldRig(const ForceField& field, ResponseModel response = ResponseModel::kConstraint) {
    world.fields.push_back(field);
    world.bodies[0].field_points = spread_over(world.bodies[0].part->surface, 60);
    world.bodies[0].X_WB.p = {0.0, 0.0, 0.2};
    settings.response = response;
    settings.tool.X_BH.p = {0.004, -0.003, 0.006};
    settings.safety = safety_limits({.name = "test",
                                     .senses_rotation = true,
                                     .actuates_force = true,
                                     .actuates_torque = true,
                                     .max_force_N = 20.0,
                                     .max_torque_Nm = 1.0});
    settings.port.keeps_balance = true;
    settings.port.damping_Ns_per_m = 0.05;  // of a Premium; a field that is sampled generates a little
  }
  /// The load of the fields at the present pose of the grasped part, at the handle.
  Wrench truth() {
    const Wrench load =
        field_load(world.fields, world.bodies[0].field_points, X_WB(), settings.tool.X_BH.p).at_centre;
    return moved(load, X_WB().R * settings.tool.X_BH.p);
  }
};

Pose above(const Vec3& p, const Vec3& turn = Vec3::Zero()) { return {exp_rotation(turn), p}; }

template <class Shape>
ForceField in_the_air(const Shape& shape, double scale = 1.0) {
  return {.shape = shape, .X_WF = {exp_rotation({0.3, 0.2, 0.1}), {0.0, 0.0, 0.2}}, .scale = scale};
}

constexpr ResponseModel kBoth[] = {ResponseModel::kConstraint, ResponseModel::kPenalty};

TEST(FieldPull, AtRestTheHandFeelsForceAndTorqueOfTheField) {
  for (const ResponseModel response : kBoth)
    for (const ForceField& field : {in_the_air(kDipole), in_the_air(kWell), in_the_air(kVortex)}) {
      FieldRig rig(field, response);
      rig.go(above({0.012, -0.008, 0.006}, {0.3, -0.2, 0.4}), 200);
      for (int i = 0; i < 500; ++i) rig.step(rig.X_DH);
      const Wrench truth = rig.truth();
      EXPECT_GT(truth.f.norm(), 0.05);
      EXPECT_GT(truth.t.norm(), 1e-4);
      EXPECT_LT((rig.report.coupling.f - truth.f).norm(), 1e-9);
      EXPECT_LT((rig.report.coupling.t - truth.t).norm(), 1e-9);
      EXPECT_LT((moved(rig.report.field, rig.X_WB().R * rig.settings.tool.X_BH.p).f - truth.f).norm(), 1e-9);
    }
}

TEST(FieldPull, ContactAndFieldAddUp) {
  // The well is under the plate's top: it presses the block down and aside, the plate holds it.
  FieldRig rig({.shape = kWell, .X_WF = {Mat3::Identity(), {0.006, 0.0, 0.0}}, .scale = 2.0});
  rig.world.bodies[0].X_WB.p.z() = 0.008;
  rig.go(above({0.002, 0.001, -0.004}, {0.02, 0.01, 0.1}), 300);
  for (int i = 0; i < 500; ++i) rig.step(rig.X_DH);
  EXPECT_EQ(rig.penetrating_frames, 0);
  EXPECT_GT(rig.report.active_constraints, 0);
  const Wrench field = moved(rig.report.field, rig.X_WB().R * rig.settings.tool.X_BH.p);
  EXPECT_GT(field.f.norm(), 0.2);
  EXPECT_LT((rig.unaccounted() + field).f.norm(), 1e-9);
  EXPECT_LT((rig.unaccounted() + field).t.norm(), 1e-9);
}

TEST(FieldPull, SteeperThanTheCouplingItStillComesToRest) {
  // 600 N/m is the coupling: fields of 600 to 60 000 N/m all round, and vortices of the same steepness.
  for (const ResponseModel response : kBoth)
    for (const double steep : {600.0, 6000.0, 60000.0}) {
      const WellField well{.depth_J = steep * 0.02 * 0.02, .width_m = 0.02};
      const VortexField vortex{.circulation_J = steep * 2.0 * kPi * 0.01 * 0.01, .core_m = 0.01};
      for (const ForceField& field : {in_the_air(well), in_the_air(vortex)}) {
        FieldRig rig(field, response);
        const bool turns = std::holds_alternative<VortexField>(field.shape);
        if (turns && steep > 600.0) continue;  // no spring holds against a vortex that is steeper than it
        rig.go(above({0.003, -0.002, 0.002}, {0.05, -0.02, 0.04}), 200);
        for (int i = 0; i < 3000; ++i) rig.step(rig.X_DH);
        const Pose before = rig.X_WB();
        rig.step(rig.X_DH);
        EXPECT_LT((rig.X_WB().p - before.p).norm(), 1e-9) << steep << (turns ? " vortex" : " well");
        EXPECT_LT((rig.report.coupling.f - rig.truth().f).norm(), 1e-5 * steep) << steep;
      }
    }
}

TEST(FieldPull, AWellGivesBackWhatItTookAndAVortexGivesEveryTurn) {
  for (const bool turns : {false, true}) {
    FieldRig rig(turns ? ForceField{.shape = kVortex, .X_WF = {Mat3::Identity(), {0, 0, 0.2}}}
                       : ForceField{.shape = kWell, .X_WF = {Mat3::Identity(), {0, 0, 0.2}}});
    rig.settings.tool.X_BH.p.setZero();
    rig.go(above({0.02, 0, 0}), 400);
    for (int i = 0; i < 300; ++i) rig.step(rig.X_DH);
    const double before_J = rig.begun().hand.field.given_J;
    const Vec3 place = rig.X_WB().p;
    for (int i = 1; i <= 2000; ++i) {
      const double angle = 2.0 * kPi * i / 2000.0;
      rig.step(above({0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.0}));
      EXPECT_EQ(rig.report.port.stiffness_share, 1.0) << "what a field gives is taken from the coupling";
      EXPECT_GT(rig.report.port.balance_J, -1e-4);
    }
    for (int i = 0; i < 300; ++i) rig.step(rig.X_DH);
    EXPECT_LT((rig.X_WB().p - place).norm(), 1e-9);
    const double given_J = rig.begun().hand.field.given_J - before_J;
    if (!turns) {
      EXPECT_NEAR(given_J, 0.0, 1e-8);
      continue;
    }
    // The part follows a little farther out and ahead: the mean of the points decides. A turn's work is
    // torque times angle, which stays the same all round.
    const Wrench load = rig.begun().hand.field.load.at_centre;
    const double radius = rig.X_WB().p.head<2>().norm();
    const Vec3 round = Vec3::UnitZ().cross(rig.X_WB().p).normalized();
    EXPECT_NEAR(given_J, load.f.dot(round) * 2.0 * kPi * radius, 0.02 * given_J);
    EXPECT_GT(given_J, 0.05);
  }
}

TEST(FieldPull, TheWorkOfAStepIsThatOfItsPotential) {
  FieldRig rig({.shape = kDipole, .X_WF = {Mat3::Identity(), {0, 0, 0.2}}});
  const auto energy = [&] {
    double sum = 0.0;
    for (const FieldPoint& point : rig.world.bodies[0].field_points)
      sum += point.weight * potential_at(kDipole, rig.X_WB() * point.p_B - Vec3(0, 0, 0.2));
    return sum;
  };
  rig.step(rig.X_DH);
  const double start_J = energy() + rig.begun().hand.field.given_J;
  Pose X;
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-3 * i;
    X = above({0.02 * std::sin(3.0 * t), 0.015 * std::sin(5.0 * t), 0.01 * std::sin(7.0 * t)},
              {0.3 * std::sin(4.0 * t), 0.2 * std::sin(2.0 * t), 0.0});
    rig.step(X);
  }
  for (int i = 0; i < 300; ++i) rig.step(X);
  EXPECT_NEAR(energy() + rig.begun().hand.field.given_J, start_J, 2e-6);
}

TEST(FieldPull, OnlyWhatIsHeldIsPulledAndLettingGoEndsIt) {
  FieldRig rig(in_the_air(kDipole));
  rig.settings.tool.body = -1;
  rig.settings.tool.picks = true;
  rig.settings.tool.pick_distance_m = 1.0;
  rig.step({});
  EXPECT_TRUE(rig.report.field.f.isZero(0.0));
  EXPECT_EQ(rig.begun().hand.field.body, -1);
}

TEST(FieldPull, TakesNoMemory) {
  FieldRig rig(in_the_air(kDipole));
  rig.step({});
  Pose X;
  const AllocationGuard guard;
  for (int i = 0; i < 500; ++i) {
    X.p.x() = 1e-5 * i;
    rig.step(X);
  }
  EXPECT_EQ(guard.allocations(), 0u);
}

TEST(FieldPull, TheSentenceWarnsOfSteepFields) {
  World world;
  const Coupling coupling{.stiffness_N_per_m = 1000.0};
  EXPECT_EQ(field_sentence(world, coupling), "");
  world.fields.push_back({.shape = kWell});  // 50 N/m
  EXPECT_EQ(field_sentence(world, coupling), "force fields: up to 50 N/m, 5 % of the coupling");
  world.fields[0].scale = -12.0;
  EXPECT_NE(field_sentence(world, coupling).find("600 N/m, 60 % of the coupling: steeper"),
            std::string::npos);
}

}  // namespace
}  // namespace tactum::field_pull_test
