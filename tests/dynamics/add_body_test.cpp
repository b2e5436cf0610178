#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tactum/dynamics/world.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/rotation.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::add_body_test {
namespace {

/// The part about its centre of mass, made from points that are moved by `offset`.
std::shared_ptr<const Part> part_of(const Polytope& shape, const Vec3& offset = Vec3::Zero(),
                                    bool about_center = true) {
  std::vector<Vec3> points = shape.vertices;
  for (Vec3& point : points) point += offset;
  Result<Part> part = part_from_clouds({points}, {.about_center_of_mass = about_center});
  EXPECT_TRUE(part);
  return std::make_shared<const Part>(std::move(*part));
}

TEST(AddBody, ABoxHasTheMassAndInertiaOfTheFormula) {
  const Vec3 half(0.03, 0.02, 0.01);
  const double mass = 700.0 * 8.0 * half.prod();
  World world;
  const Result<int> index =
      world.add({.name = "box", .part = part_of(make_box(half)), .density_kg_per_m3 = 700.0});
  ASSERT_TRUE(index);
  EXPECT_EQ(*index, 0);
  const Body& body = world.bodies[0];
  const Vec3 squared = half.cwiseAbs2();
  const Vec3 inertia = mass / 3.0 * (Vec3::Constant(squared.sum()) - squared);
  EXPECT_NEAR(body.mass_kg, mass, 1e-12 * mass);
  EXPECT_LT((body.inertia_B - Mat3(inertia.asDiagonal())).norm(), 1e-12 * inertia.norm());
}

TEST(AddBody, FinerBallsComeToTheFormulaOfTheSphere) {
  const double radius = 0.02, density = 1000.0;
  const double mass = density * 4.0 / 3.0 * kPi * std::pow(radius, 3);
  const double inertia = 0.4 * mass * radius * radius;
  double mass_error = 1e9, inertia_error = 1e9;  // of the coarser ball
  for (int subdivisions = 1; subdivisions <= 4; ++subdivisions) {
    World world;
    ASSERT_TRUE(world.add({.part = part_of(make_icosphere(subdivisions, radius))}));
    const double mass_now = std::abs(world.bodies[0].mass_kg - mass) / mass;
    const double inertia_now = (world.bodies[0].inertia_B - inertia * Mat3::Identity()).norm() / inertia;
    EXPECT_LT(mass_now, 0.3 * mass_error) << "a quarter by theory";
    EXPECT_LT(inertia_now, 0.3 * inertia_error);
    mass_error = mass_now;
    inertia_error = inertia_now;
  }
  EXPECT_LT(inertia_error, 0.01);
}

TEST(AddBody, ThePartOfAShapeBesideItsOriginStandsWhereItsPointsWere) {
  const Vec3 offset(0.3, -0.2, 0.1);
  const Pose X_WP{exp_rotation(Vec3(0.3, 0.5, -0.2)), {1.0, 2.0, 3.0}};
  const auto part = part_of(make_box({0.03, 0.02, 0.01}), offset);
  World world;
  ASSERT_TRUE(world.add({.part = part, .X_WP = X_WP}));
  EXPECT_LT((part->origin - offset).norm(), 1e-14);
  EXPECT_LT(part->mass.center.norm(), 1e-14);
  EXPECT_LT((world.bodies[0].X_WB.p - X_WP * offset).norm(), 1e-14);
  EXPECT_EQ(world.bodies[0].X_WB.R, X_WP.R);
}

TEST(AddBody, AMeshIsMadeAboutItsCentreOfMassToo) {
  const Polytope box = make_box({0.03, 0.02, 0.01});
  TriangleMesh mesh = part_of(box)->surface;
  for (Vec3& vertex : mesh.vertices) vertex = 1000.0 * vertex + Vec3(500, 0, 0);  // in millimetres
  const Result<Part> part = part_from_mesh(mesh, {.scale = 0.001, .about_center_of_mass = true});
  ASSERT_TRUE(part);
  EXPECT_LT((part->origin - Vec3(0.5, 0, 0)).norm(), 1e-12);
  EXPECT_LT(part->mass.center.norm(), 1e-12);
}

TEST(AddBody, AMassCountsInsteadOfADensity) {
  const auto part = part_of(make_box({0.03, 0.02, 0.01}));
  World world;
  ASSERT_TRUE(world.add({.part = part}));
  ASSERT_TRUE(world.add({.part = part, .mass_kg = 0.25}));
  const Body& by_density = world.bodies[0];
  const Body& by_mass = world.bodies[1];
  EXPECT_EQ(by_density.mass_kg, part->mass.mass);
  EXPECT_NEAR(by_mass.mass_kg, 0.25, 1e-15);
  EXPECT_LT((by_mass.inertia_B / by_mass.mass_kg - by_density.inertia_B / by_density.mass_kg).norm(), 1e-18);
}

TEST(AddBody, TheAxisOfAJointBecomesAUnitVector) {
  World world;
  ASSERT_TRUE(world.add({.part = part_of(make_box({0.03, 0.02, 0.01})),
                         .joint = {.kind = JointKind::kHinge, .axis_W = Vec3(0, 3, 4)}}));
  EXPECT_LT((world.bodies[0].joint.axis_W - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
}

TEST(AddBody, NonsenseIsToldAndChangesNothing) {
  const auto part = part_of(make_box({0.03, 0.02, 0.01}));
  const double none = std::numeric_limits<double>::quiet_NaN();
  World world;
  ASSERT_TRUE(world.add({.name = "first", .part = part}));
  const auto expect_error = [&](const BodySpec& spec, const char* words) {
    const Result<int> added = world.add(spec);
    ASSERT_FALSE(added) << words;
    EXPECT_NE(added.error().message().find(words), std::string::npos) << added.error().message();
    EXPECT_EQ(world.bodies.size(), 1u);
  };
  expect_error({.name = "a"}, "no part");
  expect_error({.name = "first", .part = part}, "two bodies of one name");
  expect_error({.part = part_of(make_box({0.03, 0.02, 0.01}), {0.01, 0, 0}, false)}, "centre of mass");
  for (const double bad : {0.0, -1.0, none}) {
    expect_error({.part = part, .density_kg_per_m3 = bad}, "density is not positive");
    expect_error({.part = part, .mass_kg = bad}, "mass is not positive");
  }
  expect_error({.part = part, .density_kg_per_m3 = 1.0, .mass_kg = 1.0}, "two masses");
  expect_error({.part = part, .X_WP = {Mat3::Identity(), {0, none, 0}}}, "not finite");
  expect_error({.part = part, .X_WP = {Mat3::Zero(), Vec3::Zero()}}, "no rotation");
  expect_error({.part = part, .V_WB = {{none, 0, 0}, Vec3::Zero()}}, "not finite");
  expect_error({.part = part, .joint = {.kind = JointKind::kSlider, .axis_W = Vec3::Zero()}}, "no direction");
  expect_error({.part = part, .joint = {.kind = JointKind::kHinge, .friction = -0.1}}, "negative");
  expect_error({.part = part, .joint = {.kind = JointKind::kHinge, .lower = 0.1, .upper = 0.2}}, "limits");
  expect_error({.part = part, .load = {.constant = {Vec3(none, 0, 0), Vec3::Zero()}}},
               "constant force or torque is not finite");
  for (const double bad : {-1.0, none, std::numeric_limits<double>::infinity()}) {
    expect_error({.part = part, .load = {.constant = {}, .damping_Ns_per_m = bad}}, "damping is negative");
    expect_error({.part = part, .load = {.constant = {}, .damping_Nms_per_rad = bad}}, "damping is negative");
  }
  const BodyLoad drag{.constant = {}, .damping_Ns_per_m = 1.0};
  expect_error({.part = part, .joint = {.kind = JointKind::kFixed}, .load = drag}, "a fixed body has a load");
}

}  // namespace
}  // namespace tactum::add_body_test
