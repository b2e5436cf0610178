#include "tactum/dynamics/resting_contact.h"

#include <gtest/gtest.h>

#include <array>

namespace tactum {
namespace {

/// A body of 10 g between two walls that both ask it to move off by 0.1 um.
TEST(RestingContact, WhatHasNoRoomToOpenStaysWhereItIs) {
  const std::array<Pose, 2> X_WB{};
  std::array<Mobility, 2> W{Mobility::Zero(), Mobility::Zero()};
  W[0].diagonal() << 100, 100, 100, 1e6, 1e6, 1e6;
  RestingContact resting(2, 2);
  for (int frame = 0; frame < 20; ++frame) {
    resting.begin();
    for (const int side : {0, 1}) {
      ContactRow row;
      row.body_a = 0;
      row.body_b = 1;
      row.p_W = side == 0 ? Vec3(-0.01, 0, 0) : Vec3(0.01, 0, 0);
      row.n_BA_W = side == 0 ? Vec3(1, 0, 0) : Vec3(-1, 0, 0);
      row.friction = 0.3;
      resting.add(row, side, 0, static_cast<std::uint64_t>(side), -1e-7, X_WB, W, 1e-3);
    }
    std::array<Twist, 2> V{};
    const SolverResult result = resting.solve(120, 1e-9, std::array<char, 2>{}, V);
    EXPECT_TRUE(result.converged) << frame;
    EXPECT_LT(result.iterations, 60);
    EXPECT_LT(V[0].v.norm(), 1e-9) << "m/s";
    resting.end();
  }
}

}  // namespace
}  // namespace tactum
