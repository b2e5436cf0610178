#include "tactum/dynamics/resting_contact.h"

#include <gtest/gtest.h>

#include <array>

namespace tactum {
namespace {

constexpr double kStep = 1e-3;

/// A body of 10 g; the other one of each pair does not move.
std::array<Mobility, 2> mobilities() {
  std::array<Mobility, 2> W{Mobility::Zero(), Mobility::Zero()};
  W[0].diagonal() << 100, 100, 100, 1e6, 1e6, 1e6;
  return W;
}

ContactRow contact_at(const Vec3& p_W, const Vec3& n_BA_W) {
  ContactRow row;
  row.body_a = 0;
  row.body_b = 1;
  row.p_W = p_W;
  row.n_BA_W = n_BA_W;
  row.friction = 0.3;
  return row;
}

/// What one frame's contacts with walls, each too near by 0.1 um, push with.
struct Pushed {
  SolverResult result;
  Twist V;
  std::array<double, 2> impulse{};  // [N s]
};

Pushed frame_between(RestingContact& resting, std::span<const Vec3> normals, int sweeps,
                     const Joint& joint = {}) {
  const std::array<Pose, 2> X_WB{};
  const std::array<Mobility, 2> W = mobilities();
  resting.begin();
  for (int i = 0; i < static_cast<int>(normals.size()); ++i) {
    const Vec3& n = normals[static_cast<std::size_t>(i)];
    resting.add(contact_at(-0.01 * n, n), i, 0, static_cast<std::uint64_t>(i), -1e-7, X_WB, W, kStep);
  }
  Body body;
  body.joint = joint;
  if (joint.kind != JointKind::kFree) resting.add_joint(0, 0, body, X_WB[0], W[0], kStep);
  Pushed pushed;
  std::array<Twist, 2> V{};
  pushed.result = resting.solve(sweeps, 1e-9, std::array<char, 2>{}, V);
  pushed.V = V[0];
  resting.for_each([&](int index, double normal, const Vec3&) {
    pushed.impulse[static_cast<std::size_t>(index)] = normal;
  });
  resting.end();
  return pushed;
}

TEST(RestingContact, WhatHasNoRoomToOpenStaysWhereItIs) {
  const std::array<Vec3, 2> walls{Vec3(1, 0, 0), Vec3(-1, 0, 0)};
  for (const int sweeps : {120, 40}) {
    RestingContact resting(2, 2);
    for (int frame = 0; frame < 100; ++frame) {
      const Pushed pushed = frame_between(resting, walls, sweeps);
      EXPECT_TRUE(pushed.result.converged) << frame;
      EXPECT_LT(pushed.V.v.norm(), 1e-9) << "m/s";
      EXPECT_LT(pushed.impulse[0], 1e-12) << "N s: pressed together by nothing, frame " << frame;
    }
  }
}

/// The sweeps in vain are not made in every frame.
TEST(RestingContact, WhatHadNoRoomIsSeldomAskedAgain) {
  const std::array<Vec3, 2> walls{Vec3(1, 0, 0), Vec3(-1, 0, 0)};
  RestingContact resting(2, 2);
  int sweeps = 0;
  for (int frame = 0; frame < 100; ++frame) sweeps += frame_between(resting, walls, 120).result.iterations;
  EXPECT_LT(sweeps, 600);
  // With one wall gone there is room, and soon it is taken.
  double fastest = 0.0;
  for (int frame = 0; frame < 20; ++frame)
    fastest = std::max(fastest, frame_between(resting, std::span(walls).first(1), 120).V.v.x());
  EXPECT_NEAR(fastest, 1e-4, 1e-9) << "m/s";
}

/// A slider that stands 0.1 um beyond its end, and is kept there by a wall.
TEST(RestingContact, AJointBeyondItsEndIsNotPressedAgainstAWall) {
  Joint joint;
  joint.kind = JointKind::kSlider;
  joint.axis_W = Vec3(1, 0, 0);
  joint.upper = -1e-7;
  RestingContact resting(2, 2);
  int sweeps = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const Pushed pushed = frame_between(resting, std::array<Vec3, 1>{Vec3(1, 0, 0)}, 120, joint);
    EXPECT_LT(pushed.V.v.norm(), 1e-9) << "m/s";
    EXPECT_LT(pushed.impulse[0], 1e-12) << "N s, frame " << frame;
    sweeps += pushed.result.iterations;
  }
  EXPECT_LT(sweeps, 600);
}

/// Two walls that just touch, and a second order that would have either open.
TEST(RestingContact, WhatIsTightenedWithoutRoomIsNotPressedTogether) {
  const std::array<Pose, 2> X_WB{};
  const std::array<Mobility, 2> W = mobilities();
  RestingContact resting(2, 2);
  std::array<Twist, 2> V{};
  for (int frame = 0; frame < 20; ++frame) {
    resting.begin();
    for (const int side : {0, 1}) {
      const Vec3 n(side == 0 ? 1.0 : -1.0, 0, 0);
      resting.add(contact_at(-0.01 * n, n), side, 0, static_cast<std::uint64_t>(side), 0.0, X_WB, W, kStep);
    }
    V[0] = {};
    resting.solve(120, 1e-9, std::array<char, 2>{}, V);
    for (const int side : {0, 1}) resting.tighten(side, 1e-7, kStep);
    EXPECT_TRUE(resting.solve(120, 1e-9, std::array<char, 2>{}, V).converged);
    resting.for_each([&](int, double normal, const Vec3&) { EXPECT_LT(normal, 1e-12) << "N s"; });
    resting.end();
  }
}

/// An impulse of the last frame's normal lies across this frame's, where a contact turned by a right angle.
TEST(RestingContact, WhatDoesNotPushDoesNotRub) {
  const std::array<Pose, 2> X_WB{};
  const std::array<Mobility, 2> W = mobilities();
  RestingContact resting(1, 2);
  std::array<Twist, 2> V{};
  const auto frame = [&](const Vec3& normal, double gap_m) {
    resting.begin();
    resting.add(contact_at(Vec3::Zero(), normal), 0, 0, 7, gap_m, X_WB, W, kStep);
    V[0] = {};
    resting.solve(120, 1e-9, std::array<char, 2>{}, V);
    resting.end();
  };
  frame(Vec3(0, 0, 1), -1e-7);
  EXPECT_GT(V[0].v.z(), 0.0);
  frame(Vec3(1, 0, 0), 1e-3);
  EXPECT_LT(V[0].v.norm(), 1e-15) << "m/s";
}

/// The edge of a body that slides at 100 m/s and digs in: friction turns it down by a hundredth more than the
/// normal force lifts it, so that no force is enough while it slides.
TEST(RestingContact, WhatDigsInIsPressedNoHarderForEver) {
  const std::array<Pose, 2> X_WB{};
  const std::array<Mobility, 2> W = mobilities();
  ContactRow row = contact_at(Vec3(0.01, 0, -0.02), Vec3(0, 0, 1));
  row.friction = 1.01;
  RestingContact resting(1, 2);
  resting.begin();
  resting.add(row, 0, 0, 7, 0.0, X_WB, W, kStep);
  std::array<Twist, 2> V{Twist{.v = Vec3(100, 0, -0.01)}, Twist{}};
  EXPECT_TRUE(resting.solve(120, 1e-9, std::array<char, 2>{}, V).converged);
  resting.tighten(0, 1e-9, kStep);  // sweeps begin again, with friction as its cone has it
  EXPECT_TRUE(resting.solve(120, 1e-9, std::array<char, 2>{}, V).converged);
  const Vec3 at_edge = V[0].v + V[0].w.cross(row.p_W);
  EXPECT_GT(at_edge.z(), -1e-9) << "m/s";
  EXPECT_LT(at_edge.x(), 100.0);
  resting.for_each([&](int, double normal, const Vec3& impulse_W) {
    EXPECT_LE(impulse_W.head<2>().norm(), row.friction * normal * (1.0 + 1e-12));
  });
}

}  // namespace
}  // namespace tactum
