// Nothing crosses on its way, whatever its speed and however surfaces are wound: judged by a referee that
// knows triangles and topology only.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/judged.h"
#include "support/rig.h"
#include "support/sample_meshes.h"
#include "support/solid_box.h"
#include "support/surface_shapes.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum::crossing_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

std::shared_ptr<const Part> surface_part(const TriangleMesh& mesh) {
  Result<Part> part = part_from_mesh(mesh, {.pieces = PieceSource::kSurface});
  EXPECT_TRUE(part) << part.error().message();
  return std::make_shared<const Part>(std::move(*part));
}

/// A ring of 40 mm, of wire of 6 mm.
std::shared_ptr<const Part> ring() {
  static const std::shared_ptr<const Part> part = surface_part(testing::torus(24, 10, 0.02, 0.003));
  return part;
}

struct Judged : testing::Judged {
  /// False, with a failure, where something has crossed.
  bool step(const Pose& hand, int frame, int variant) {
    simulation->step(hand);
    const auto faults = referee->judge(simulation->state().world.X_WB);
    if (faults.empty()) return true;
    ADD_FAILURE() << "variant " << variant << ", frame " << frame << ": bodies " << faults[0].body_a
                  << " and " << faults[0].body_b
                  << (faults[0].surfaces_cross ? " cross" : " have come loose");
    return false;
  }
};

Vec3 some_vector(Random& random, double length) {
  Vec3 v;
  do v = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  while (v.norm() > 1.0);
  return length * v;
}

/// The pose of a ring that hangs in one whose axis is y, about its inner side.
Pose hanging(Random& random) {
  const Mat3 lean = exp_rotation(some_vector(random, 0.2));
  return {lean * exp_rotation({0.5 * kPi, 0, 0}) * exp_rotation({0, 0.5 * kPi, 0}),
          Vec3(0, 0, -0.026) + some_vector(random, 0.003)};
}

/// The hand draws a ring against the one in which it hangs, along and aside, and turns it, at 0.05 to 5 m/s.
TEST(Crossing, AHeldRingIsNotDrawnThroughTheOneInWhichItHangs) {
  Random random(91);
  const int variants = testing::effort(12, 2);
  for (int variant = 0; variant < variants; ++variant) {
    Judged judged;
    const Mat3 upright = exp_rotation({0.5 * kPi, 0, 0});
    add_body(judged.world,
             {.part = ring(), .X_WP = {upright, Vec3::Zero()}, .joint = {.kind = JointKind::kFixed}});
    const int grasped =
        add_body(judged.world, {.part = ring(), .density_kg_per_m3 = 7800, .X_WP = hanging(random)});
    judged.settings.tool.body = grasped;
    if (variant % 3 == 1) judged.settings.friction = {{0.0, 0.3, 0.3, 0.0}, 2};
    if (variant % 4 == 3) judged.settings.dt_s = 0.5e-3;
    judged.begin();
    const double speed = 0.05 * std::pow(100.0, random.unit());
    const Vec3 far = some_vector(random, 1.0).normalized() * random.uniform(0.02, 0.08);
    const Vec3 turn = some_vector(random, 1.5);
    const double frames = far.norm() / (speed * judged.settings.dt_s);
    for (int frame = 0; frame < 600; ++frame) {
      const double share = std::min(1.0, frame / frames);
      if (!judged.step({exp_rotation(turn * share), far * share}, frame, variant)) break;
    }
  }
}

/// Rings fall onto one another, free, 1 to 12 mm deep, as they come to lie; one begins with a throw.
TEST(Crossing, AFreeRingDoesNotFallThroughTheOneInWhichItHangs) {
  Random random(92);
  const int variants = testing::effort(12, 2);
  for (int variant = 0; variant < variants; ++variant) {
    Judged judged;
    judged.world.gravity_W = {0, 0, -kGravity};
    const Mat3 upright = exp_rotation({0.5 * kPi, 0, 0});
    add_body(judged.world,
             {.part = ring(), .X_WP = {upright, Vec3::Zero()}, .joint = {.kind = JointKind::kFixed}});
    const Twist thrown{some_vector(random, variant % 3 == 0 ? 10.0 : 1.0),
                       some_vector(random, variant % 3 == 1 ? 50.0 : 5.0)};
    add_body(judged.world,
             {.part = ring(), .density_kg_per_m3 = 7800, .X_WP = hanging(random), .V_WB = thrown});
    if (variant % 2 == 1) judged.settings.impacts.restitution = {std::vector<double>(4, 0.5), 2};
    judged.begin();
    for (int frame = 0; frame < 400; ++frame)
      if (!judged.step(Pose(), frame, variant)) break;
  }
}

/// A small ball flies at a wall of a tenth of a millimetre, and a bar that turns up to four radians a frame
/// at a pin; neither is on the other side afterwards.
TEST(Crossing, ThinWallsAndPinsHoldAgainstWhatIsFast) {
  for (const double speed : {1.0, 10.0, 100.0, 1000.0}) {
    for (const bool surface : {false, true}) {
      Judged judged;
      TriangleMesh wall = testing::box_mesh({0.05, 0.05, 0.00005});
      add_body(judged.world, {.part = surface ? surface_part(wall) : solid_box({0.05, 0.05, 0.00005}),
                              .joint = {.kind = JointKind::kFixed}});
      const Polytope sphere = make_icosphere(1, 0.001);
      const auto ball = std::make_shared<const Part>(
          *part_from_clouds({std::vector<Vec3>(sphere.vertices.begin(), sphere.vertices.end())}));
      const int number = add_body(judged.world, {.part = ball,
                                                 .density_kg_per_m3 = 1000,
                                                 .X_WP = {Mat3::Identity(), {0.003, 0.002, 0.0207}},
                                                 .V_WB = {{0, 0, -speed}, {30, 0, 0}}});
      judged.begin();
      for (int frame = 0; frame < 60; ++frame)
        if (!judged.step(Pose(), frame, static_cast<int>(speed))) break;
      EXPECT_GT(judged.X_WB(number).p.z(), 0.0) << speed;
    }
  }
  for (const double rate : {500.0, 2100.0, 3600.0, 4200.0}) {
    Judged judged;
    add_body(judged.world, {.part = solid_box({0.00025, 0.00025, 0.01}),
                            .X_WP = {Mat3::Identity(), {0, 0.28, 0}},
                            .joint = {.kind = JointKind::kFixed}});
    const int rod = add_body(
        judged.world, {.part = solid_box({0.15, 0.0005, 0.005}),
                       .density_kg_per_m3 = 1000,
                       .X_WP = {Mat3::Identity(), {0.15, 0, 0}},
                       .V_WB = {{0, 0.15 * rate, 0}, {0, 0, rate}},
                       .joint = {.kind = JointKind::kHinge, .axis_W = {0, 0, 1}, .anchor_W = Vec3::Zero()}});
    judged.begin();
    for (int frame = 0; frame < 20; ++frame) {
      judged.step(Pose(), frame, static_cast<int>(rate));
      const Vec3 along = judged.X_WB(rod).R.col(0);
      EXPECT_LE(std::atan2(along.y(), along.x()), 0.5 * kPi) << rate;
      EXPECT_GE(std::atan2(along.y(), along.x()), -1e-9) << rate;
    }
  }
}

/// A box falls onto a sheet wound either way, from either side, and onto a plate two faces of which are
/// turned inward: it lies there.
TEST(Crossing, WindingDoesNotDecideWhetherAThingIsThere) {
  TriangleMesh sheet;
  sheet.vertices = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh turned = sheet;
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  TriangleMesh plate = testing::box_mesh({0.1, 0.1, 0.01});
  for (const std::size_t face : {std::size_t{4}, std::size_t{5}, std::size_t{6}})
    std::swap(plate.triangles[face][1], plate.triangles[face][2]);
  for (const auto& [floor, top] : {std::pair(&sheet, 0.0), {&turned, 0.0}, {&plate, 0.01}}) {
    for (const double height : {0.0005, 0.02}) {
      Judged judged;
      judged.world.gravity_W = {0, 0, -kGravity};
      add_body(judged.world, {.part = surface_part(*floor), .joint = {.kind = JointKind::kFixed}});
      const int box = add_body(judged.world, {.part = solid_box({0.02, 0.02, 0.02}),
                                              .density_kg_per_m3 = 500,
                                              .X_WP = {Mat3::Identity(), {0, 0, top + 0.02 + height}}});
      judged.begin();
      for (int frame = 0; frame < 400; ++frame)
        if (!judged.step(Pose(), frame, 0)) break;
      EXPECT_NEAR(judged.X_WB(box).p.z(), top + 0.02, 1e-4);
    }
  }
}

/// Presses a block onto the face z = 0 of a fixed part, from above or from below; 3 mm beyond it at last, and
/// 0.8 mm in the published response, in which surfaces may overlap by half a millimetre and no more.
struct Press : Rig {
  Press(const std::shared_ptr<const Part>& block, const std::shared_ptr<const Part>& floor,
        ResponseModel response, double side, double floor_z)
      : Rig(0) {
    settings.response = response;
    add_body(world, {.part = block, .X_WP = {Mat3::Identity(), {0.003, 0.002, side * 0.007}}});
    add_body(
        world,
        {.part = floor, .X_WP = {Mat3::Identity(), {0, 0, floor_z}}, .joint = {.kind = JointKind::kFixed}});
    step({});
    const double press_m = response == ResponseModel::kConstraint ? 0.003 : 0.0008;
    go({Mat3::Identity(), {0.004, 0.001, -side * (0.002 + press_m)}}, 400);
    go(X_DH, 200);
  }
};

/// An open sheet, however wound and cut, is felt from above and from below as the solid plate whose face it
/// is.
TEST(Crossing, AnOpenSheetIsFeltAlikeFromBothSides) {
  const Vec3 half(0.010, 0.007, 0.005);
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    for (const bool surface_block : {false, true}) {
      const auto block = surface_block ? surface_part(testing::box_mesh(half)) : solid_box(half);
      for (const double side : {1.0, -1.0}) {
        Press on_plate(block, surface_part(testing::box_mesh({0.1, 0.1, 0.02})), response, side,
                       -side * 0.02);
        ASSERT_GT(side * on_plate.report.restoring.f.z(), 0.2);
        for (const int cells : {1, 2, 7}) {
          for (const bool turned : {false, true}) {
            TriangleMesh sheet = testing::sheet(cells, 0.1);
            if (turned)
              for (Triangle& t : sheet.triangles) std::swap(t[1], t[2]);
            Press on_sheet(block, surface_part(sheet), response, side, 0.0);
            SCOPED_TRACE(::testing::Message()
                         << "response " << static_cast<int>(response) << ' ' << surface_block << ' ' << side
                         << ' ' << cells << ' ' << turned);
            EXPECT_LT((on_sheet.report.restoring.f - on_plate.report.restoring.f).norm(), 1e-6);
            EXPECT_LT((on_sheet.report.coupling.f - on_plate.report.coupling.f).norm(), 1e-6);
            EXPECT_LT((on_sheet.report.coupling.t - on_plate.report.coupling.t).norm(), 1e-8);
            EXPECT_LT((on_sheet.X_WB().p - on_plate.X_WB().p).norm(), 1e-9);
          }
        }
      }
    }
  }
}

/// A grasped peg in free air follows a hand of 0.9 m/s beside a surface part that rests on another: what is
/// elsewhere limits nothing.
TEST(Crossing, NoHandIsHeldBackByASurfaceElsewhere) {
  Judged judged;
  judged.world.gravity_W = {0, 0, -kGravity};
  add_body(judged.world, {.part = solid_box({0.3, 0.3, 0.01}),
                          .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                          .joint = {.kind = JointKind::kFixed}});
  add_body(judged.world, {.part = surface_part(testing::box_mesh({0.02, 0.02, 0.02})),
                          .density_kg_per_m3 = 1000,
                          .X_WP = {Mat3::Identity(), {0.15, 0, 0.0205}}});
  const int grasped = add_body(judged.world, {.part = solid_box({0.005, 0.005, 0.025}),
                                              .density_kg_per_m3 = 1000,
                                              .X_WP = {Mat3::Identity(), {0, -0.05, 0.08}}});
  judged.world.gravity_W = Vec3::Zero();
  judged.settings.tool.body = grasped;
  judged.begin();
  for (int frame = 0; frame <= 300; ++frame) {
    const double y = 0.9e-3 * std::max(0, frame - 100);
    judged.simulation->step(Pose{Mat3::Identity(), {0, y, 0}});
    if (frame > 120) {
      EXPECT_NEAR(judged.X_WB(grasped).p.y(), -0.05 + y, 2.5e-3) << frame;
    }
  }
}

/// The tunnel of [Gregory 2000]: a cube of 1 m between two planes, 0.1 mm and 1 um from either, slides
/// through at 1 to 100 m/s as if it were alone, with friction and without, also while it turns about the
/// planes' normal by up to 0.3 radians a step.
TEST(Crossing, ACubePassesATunnelThatLeavesItAMicrometre) {
  struct Passage {
    double mu, spin, speed, rate_Hz;
  };
  constexpr Passage kPassages[] = {
      {0.0, 0.0, 10.0, 1e3},  {0.3, 0.0, 10.0, 1e3},    {0.0, 0.0, 100.0, 1e3},  {0.3, 0.0, 100.0, 1e3},
      {0.0, 50.0, 10.0, 1e3}, {0.3, -20.0, 10.0, 1e3},  {0.0, 50.0, 100.0, 1e3}, {0.3, -20.0, 100.0, 1e3},
      {0.3, 1.7, 1.0, 1e3},   {0.0, 300.0, 30.0, 1e3},  {0.3, -7.3, 60.0, 4e3},  {0.3, 150.0, 100.0, 5e2},
      {0.0, -40.0, 5.0, 2e3}, {0.3, 300.0, 100.0, 1e3}, {0.0, 0.2, 100.0, 1e3}};
  for (const double gap : {1e-4, 1e-6}) {
    for (const Passage& p : kPassages) {
      Judged judged;
      for (const double side : {-1.0, 1.0})
        add_body(judged.world, {.part = solid_box({5, 2, 0.5}),
                                .X_WP = {Mat3::Identity(), {0, 0, side * (1.0 + gap)}},
                                .joint = {.kind = JointKind::kFixed}});
      // Not a whole number of steps before the planes: a front that is level with theirs when a frame
      // begins is stopped by friction (docs/algorithms/paths.md).
      const int cube = add_body(judged.world, {.part = solid_box({0.5, 0.5, 0.5}),
                                               .density_kg_per_m3 = 1000,
                                               .X_WP = {Mat3::Identity(), {-8.003, 0, 0}},
                                               .V_WB = {{p.speed, 0, 0}, {0, 0, p.spin}}});
      judged.settings.dt_s = 1.0 / p.rate_Hz;
      judged.settings.friction = {std::vector<double>(9, p.mu), 3};
      judged.begin();
      const int frames = static_cast<int>(16.0 / (p.speed * judged.settings.dt_s));
      for (int frame = 0; frame < frames; ++frame) judged.simulation->step(Pose());
      SCOPED_TRACE(::testing::Message() << gap << ' ' << p.speed << ' ' << p.mu << ' ' << p.spin);
      const double time_s = frames * judged.settings.dt_s;
      EXPECT_LT((judged.X_WB(cube).p - Vec3(-8.003 + time_s * p.speed, 0, 0)).norm(), 1e-6);
      EXPECT_LT((judged.X_WB(cube).R - exp_rotation({0, 0, p.spin * time_s})).norm(), 1e-6);
      EXPECT_TRUE(judged.referee->judge(judged.simulation->state().world.X_WB).empty());
    }
  }
}

}  // namespace
}  // namespace tactum::crossing_test
